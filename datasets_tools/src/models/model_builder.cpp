#include "models/model_builder.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include <Eigen/LU>

#include "orbifit/datasets_tools/symmetry_residual.h"

#include "models/primitives.h"

namespace orbifit {

namespace {

using Family = PointGroup::Family;

constexpr Eigen::Index kMaxMeasured = 1000000;  // vertices

double area_of(const Eigen::VectorXd& areas, const std::vector<int>& faces) {
  return areas(faces).sum();
}

}  // namespace

PartFaces joined(const std::vector<PartFaces>& parts) {
  PartFaces result;
  for (const PartFaces& part : parts) result.insert(result.end(), part.begin(), part.end());
  std::ranges::sort(result);
  return result;
}

LocalFrame image(const Motion& motion, const LocalFrame& placement) {
  LocalFrame result{motion.linear * placement.frame, motion(placement.origin)};
  // A mirror's image of a frame is left-handed; the third axis of three gives way, the group's two stay.
  if (result.frame.determinant() < 0) result.frame.col(1) *= -1;
  return result;
}

PartFaces ModelBuilder::add(const Mesh& part, const Motion& motion) {
  parts_.push_back(moved(part, motion));
  PartFaces faces(static_cast<std::size_t>(part.faces.rows()));
  std::iota(faces.begin(), faces.end(), faces_);
  faces_ += static_cast<int>(part.faces.rows());
  return faces;
}

void ModelBuilder::add_copy(const Mesh& part, const LocalFrame& place, PartCopies& copies) {
  copies.places.push_back(place);
  copies.faces.push_back(add(part, place));
}

void ModelBuilder::declare(const std::string& name, const PointGroup& group, const LocalFrame& about,
                           const PartFaces& faces) {
  Region region = make_region(group, about.origin, about.frame, faces, name);
  std::vector<Motion> measured = region.generators;
  regions_.push_back({std::move(region), std::move(measured)});
}

void ModelBuilder::declare_each(const std::string& name, const PointGroup& group, const PartCopies& copies) {
  for (std::size_t i = 0; i < copies.faces.size(); ++i) {
    declare(name + " " + std::to_string(i + 1), group, copies.places[i], copies.faces[i]);
  }
}

void ModelBuilder::declare_turned(const std::string& name, bool alike, bool round, int facets, const LocalFrame& about,
                                  const PartFaces& faces) {
  declare(name, {alike ? Family::Dnh : Family::Cnv, facets}, about, faces);
  if (!round) return;
  regions_.back().region =
      make_region({alike ? Family::Dinfh : Family::Cinfv, 1}, about.origin, about.frame, faces, name);
}

void ModelBuilder::declare_row(const std::string& name, const Eigen::Vector3d& step,
                               const std::vector<PartFaces>& copies) {
  Pattern pattern;
  pattern.name = name;
  pattern.kind = Pattern::Kind::translation_1d;
  pattern.generators.push_back({Eigen::Matrix3d::Identity(), step});
  for (std::size_t i = 0; i < copies.size(); ++i) {
    pattern.instances.push_back({{Eigen::Matrix3d::Identity(), static_cast<double>(i) * step}, copies[i]});
  }
  patterns_.push_back(std::move(pattern));
}

Mesh ModelBuilder::mesh() const {
  Mesh result;
  Eigen::Index vertices = 0;
  for (const Mesh& part : parts_) vertices += part.vertices.rows();
  result.vertices.resize(vertices, 3);
  result.faces.resize(faces_, 3);
  Eigen::Index vertex = 0;
  Eigen::Index face = 0;
  for (const Mesh& part : parts_) {
    result.vertices.middleRows(vertex, part.vertices.rows()) = part.vertices;
    result.faces.middleRows(face, part.faces.rows()) = part.faces.array() + static_cast<int>(vertex);
    vertex += part.vertices.rows();
    face += part.faces.rows();
  }
  return result;
}

GeneratedModel ModelBuilder::finish() const {
  GeneratedModel model{mesh(), {}};
  if (doubled_) {
    model.mesh.faces.conservativeResize(2 * faces_, 3);
    model.mesh.faces.bottomRows(faces_) = model.mesh.faces.topRows(faces_);
    model.mesh.faces.bottomRows(faces_).col(1).swap(model.mesh.faces.bottomRows(faces_).col(2));
  }
  model.truth = empty_annotation(model.mesh, 0.005);
  const Eigen::VectorXd areas = face_areas(model.mesh);
  // Products of exact motions add rounding only: to measure the generators is enough, and quick.
  SymmetryAnnotation measured = model.truth;
  for (const Declared& declared : regions_) {
    if (area_of(areas, declared.region.faces) < smallest_share_ * areas.sum()) continue;
    model.truth.regions.push_back(declared.region);
    if (doubled_) {
      PartFaces& faces = model.truth.regions.back().faces;
      for (std::size_t i = 0, front = faces.size(); i < front; ++i) faces.push_back(faces[i] + faces_);
    }
    model.truth.regions.back().id = static_cast<int>(model.truth.regions.size()) - 1;
    measured.regions.push_back(model.truth.regions.back());
    measured.regions.back().group = {};
    measured.regions.back().elements = declared.measured;
  }
  for (const Pattern& pattern : patterns_) {
    model.truth.patterns.push_back(pattern);
    model.truth.patterns.back().id = static_cast<int>(model.truth.patterns.size()) - 1;
  }
  measured.patterns = model.truth.patterns;
  set_parents(model.truth.regions);
  if (model.mesh.vertices.rows() > kMaxMeasured) return model;
  RunContext context;
  const SymmetryReport report = symmetry_residual(model.mesh, measured, nullptr, CarriedMotions::fixed, context);
  for (std::size_t r = 0; r < report.regions.size(); ++r) model.truth.regions[r].residual = report.regions[r].floor;
  for (std::size_t p = 0; p < report.patterns.size(); ++p) model.truth.patterns[p].residual = report.patterns[p].floor;
  return model;
}

}  // namespace orbifit
