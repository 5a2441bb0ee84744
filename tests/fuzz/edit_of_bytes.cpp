#include "edit_of_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/subspace.h"

#include "byte_source.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t kMaxFaces = 200;

using Triangle = std::array<Vector3d, 3>;

struct PlacedGroup {
  PointGroup group;
  Vector3d centre;
  GroupFrame frame;

  std::vector<Motion> motions() const {
    std::vector<Motion> result;
    for (const Eigen::Matrix3d& linear : elements(group, frame)) result.push_back(Motion::about(linear, centre));
    return result;
  }
};

struct Shape {
  Mesh mesh;
  SymmetryAnnotation annotation;
};

Vector3d point(ByteSource& bytes) {
  return {bytes.coordinate(), bytes.coordinate(), bytes.coordinate()};
}

PlacedGroup group(ByteSource& bytes, const Vector3d& centre) {
  constexpr std::array kSymbols{"Cs", "Ci", "C2",  "C3",  "C7",  "C2v", "C3v", "C4v", "C2h", "C3h",
                                "D2", "D3", "D2h", "D3h", "D2d", "D3d", "D5d", "S4",  "S6",  "T",
                                "Td", "Th", "O",   "Oh",  "I",   "C6v", "D6h", "S10"};
  const std::string symbol = kSymbols[static_cast<std::size_t>(bytes.below(static_cast<int>(kSymbols.size())))];
  GroupFrame frame = GroupFrame::Identity();
  if (bytes.flag()) {
    const Vector3d axis = point(bytes);
    if (axis.norm() > 1e-3) frame = frame_about(axis.normalized());
  }
  return {*PointGroup::parse(symbol), centre, frame};
}

std::vector<Triangle> images(const std::vector<Triangle>& part, const PlacedGroup& group) {
  std::vector<Triangle> result;
  for (const Motion& motion : group.motions()) {
    for (const Triangle& triangle : part) {
      if (result.size() == kMaxFaces) throw UsageError("too many faces");
      result.push_back({motion(triangle[0]), motion(triangle[1]), motion(triangle[2])});
    }
  }
  return result;
}

Mesh mesh_of(const std::vector<Triangle>& triangles) {
  Mesh mesh;
  mesh.vertices.resize(3 * static_cast<Index>(triangles.size()), 3);
  mesh.faces.resize(static_cast<Index>(triangles.size()), 3);
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    for (Index k = 0; k < 3; ++k) {
      mesh.vertices.row(3 * f + k) = triangles[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)];
      mesh.faces(f, k) = static_cast<int>(3 * f + k);
    }
  }
  return mesh;
}

std::vector<int> first_faces(std::size_t count) {
  std::vector<int> faces(count);
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

// A part with a group of its own, and its images under the group of the whole; perhaps a row of two such wholes.
Shape shape(ByteSource& bytes) {
  std::vector<Triangle> seed;
  for (int count = 1 + bytes.below(3); count > 0; --count) seed.push_back({point(bytes), point(bytes), point(bytes)});
  const PlacedGroup inner = group(bytes, point(bytes));
  const PlacedGroup outer = group(bytes, bytes.flag() ? Vector3d::Zero() : point(bytes));
  const bool nested = bytes.flag();
  const std::vector<Triangle> part = nested ? images(seed, inner) : seed;
  std::vector<Triangle> whole = images(part, outer);
  const std::size_t faces = whole.size();
  const bool row = bytes.below(4) == 1 && 2 * faces <= kMaxFaces;
  const Motion step{Eigen::Matrix3d::Identity(), 3 * point(bytes)};
  for (std::size_t f = 0; row && f < faces; ++f) {
    whole.push_back({step(whole[f][0]), step(whole[f][1]), step(whole[f][2])});
  }
  Shape result;
  result.mesh = mesh_of(whole);
  result.annotation = empty_annotation(result.mesh, 0.005);
  auto& regions = result.annotation.regions;
  regions.push_back(make_region(outer.group, outer.centre, outer.frame, first_faces(faces), "whole"));
  if (nested) regions.push_back(make_region(inner.group, inner.centre, inner.frame, first_faces(part.size()), "part"));
  for (std::size_t r = 0; r < regions.size(); ++r) regions[r].id = static_cast<int>(r);
  set_parents(regions);
  if (row) {
    Pattern pattern;
    pattern.name = "row";
    pattern.kind = Pattern::Kind::translation_1d;
    pattern.generators = {step};
    pattern.instances = {{Motion{}, first_faces(faces)}, {step, first_faces(faces)}};
    for (int& face : pattern.instances[1].faces) face += static_cast<int>(faces);
    result.annotation.patterns.push_back(pattern);
  }
  return result;
}

// What somebody who edits the file by hand may get wrong.
void damage(ByteSource& bytes, SymmetryAnnotation& annotation) {
  Region& region =
      annotation.regions[static_cast<std::size_t>(bytes.below(static_cast<int>(annotation.regions.size())))];
  const int element = bytes.below(static_cast<int>(region.elements.size()));
  switch (bytes.below(6)) {
    case 0:
      region.elements.erase(region.elements.begin() + element);
      return;
    case 1:
      region.elements[static_cast<std::size_t>(element)].translation += 1e-3 * point(bytes);
      return;
    case 2:
      region.faces.resize(region.faces.size() -
                          static_cast<std::size_t>(bytes.below(static_cast<int>(region.faces.size()))));
      return;
    case 3:
      region.centre += 1e-2 * point(bytes);
      return;
    case 4:
      region.group.n += 1;
      return;
    default:
      region = make_region(region.group, region.centre + 2e-3 * point(bytes), frame_about(Vector3d::UnitZ()),
                           region.faces, region.name);
  }
}

SymmetryAnnotation written_and_read(const SymmetryAnnotation& annotation, const Mesh& mesh) {
  return annotation_from_json(to_json(annotation), mesh, "a.json");
}

std::vector<Handle> handles(ByteSource& bytes, const Mesh& mesh, double size) {
  std::vector<Handle> result(1 + static_cast<std::size_t>(bytes.below(3)));
  for (Handle& handle : result) {
    const Index vertex = (256 * bytes.byte() + bytes.byte()) % mesh.vertices.rows();
    handle.vertices = {static_cast<int>(vertex)};
    const Vector3d place = mesh.vertices.row(vertex);
    if (bytes.flag()) handle.motion = Motion::rotation(Vector3d::UnitX(), 3 * bytes.coordinate(), place);
    handle.motion.translation += size * std::pow(10.0, bytes.below(7) - 4) * point(bytes);
  }
  return result;
}

// The region's vertices within `same` of a place. Parts may touch: of several there any may be the image of one.
std::vector<int> vertices_at(const Mesh& mesh, const Region& region, const Vector3d& place, double same) {
  std::vector<int> result;
  for (const int face : region.faces) {
    for (Index k = 0; k < 3; ++k) {
      const int v = mesh.faces(face, k);
      if ((mesh.vertices.row(v).transpose() - place).norm() <= same) result.push_back(v);
    }
  }
  return result;
}

// Of the region's corners, face by face, the vertices where a motion takes them.
std::vector<std::vector<int>> images_of_corners(const Mesh& mesh, const Region& region, const Motion& motion,
                                                double same) {
  std::vector<std::vector<int>> result;
  for (const int face : region.faces) {
    for (Index k = 0; k < 3; ++k) {
      result.push_back(vertices_at(mesh, region, motion(mesh.vertices.row(mesh.faces(face, k)).transpose()), same));
    }
  }
  return result;
}

// Where the mesh has a region's symmetry to rounding, the edited mesh has it.
void require_kept(const Mesh& mesh, const SymmetryAnnotation& annotation, const Mesh& edited,
                  const SymmetryAnnotation& deformed, double allowed) {
  const double same = 1e-13 * std::max(diagonal(mesh.vertices), mesh.vertices.cwiseAbs().maxCoeff());
  for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
    const Region& region = annotation.regions[r];
    for (std::size_t g = 0; g < region.elements.size(); ++g) {
      const auto images = images_of_corners(mesh, region, region.elements[g], same);
      if (std::ranges::any_of(images, [](const auto& there) { return there.empty(); })) continue;
      const Motion& motion = deformed.regions.at(r).elements.at(g);
      for (std::size_t i = 0; i < images.size(); ++i) {
        const int v = mesh.faces(region.faces[i / 3], static_cast<Index>(i % 3));
        const Vector3d image = motion(edited.vertices.row(v).transpose());
        const auto off = [&](int other) { return (image - edited.vertices.row(other).transpose()).norm(); };
        if (!std::ranges::any_of(images[i], [&](int other) { return off(other) <= allowed; })) {
          throw std::logic_error("the edit broke " + region.group.symbol());
        }
      }
    }
  }
}

void edit(ByteSource& bytes, const Shape& shape) {
  const Mesh& mesh = shape.mesh;
  const double size = diagonal(mesh.vertices);
  const RunContext context;
  const SymmetryAnnotation annotation =
      consistent_annotation(mesh, written_and_read(shape.annotation, mesh), context).annotation;
  SubspaceOptions options;
  options.mode = static_cast<GroupMode>(bytes.below(3));
  options.samples = 4 + bytes.below(60);
  options.sharp_features_first = bytes.flag();
  const Subspace subspace = build_subspace(mesh, annotation, options, context);
  DeformerOptions deforming;
  deforming.laplacian = static_cast<LaplacianKind>(bytes.below(3));
  deforming.contacts = bytes.flag();
  Deformer deformer(subspace, mesh, deforming, context);
  const std::vector<Handle> held = handles(bytes, mesh, size);
  deformer.set_handles(held, std::pow(10.0, bytes.below(19) - 9));
  std::vector<Motion> motions;
  double farthest = size;
  for (const Handle& handle : held) {
    motions.push_back(handle.motion);
    const Vector3d place = mesh.vertices.row(handle.vertices[0]);
    farthest = std::max(farthest, (handle.motion(place) - place).norm());
  }
  const Deformation deformation = deformer.solve(motions, 1 + bytes.below(3));
  Mesh edited = mesh;
  edited.vertices += vertex_displacements(subspace, deformation.state, context);
  if (!edited.vertices.allFinite()) throw std::logic_error("the edited mesh is not finite");
  const double extent = std::max(farthest, mesh.vertices.cwiseAbs().maxCoeff());
  const double reach = edited.vertices.cwiseAbs().maxCoeff();
  if (reach > 1000 * extent) {
    throw std::logic_error("the edited mesh reaches " + std::to_string(reach / extent) +
                           " times as far as its handles, by " + to_string(options.mode) + " groups, laplacian " +
                           to_string(deforming.laplacian));
  }
  require_kept(mesh, annotation, edited, deformed_annotation(annotation, subspace, deformation.state, edited),
               1e-11 * extent);
}

}  // namespace

void edit_of_bytes(std::span<const std::uint8_t> data) {
  ByteSource bytes(data);
  try {
    Shape made = shape(bytes);
    if (bytes.below(4) == 1) damage(bytes, made.annotation);
    edit(bytes, made);
  } catch (const Error&) {  // refused, for a reason
  }
}

}  // namespace orbifit
