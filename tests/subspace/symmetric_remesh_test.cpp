#include "orbifit/subspace/symmetric_remesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/point_index.h"
#include "geometry/topology.h"
#include "parts.h"
#include "remeshing/fundamental_domain.h"

namespace orbifit {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

Mesh octasphere(int subdivisions) {
  std::vector<Vector3d> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<int, 3>> triangles{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                            {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int s = 0; s < subdivisions; ++s) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [entry, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (added) {
        const Vector3d mean = points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)];
        points.push_back(mean.normalized());
      }
      return entry->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      for (const std::array<int, 3>& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
        finer.push_back(t);
      }
    }
    triangles = std::move(finer);
  }
  Mesh mesh;
  mesh.vertices.resize(static_cast<Index>(points.size()), 3);
  mesh.faces.resize(static_cast<Index>(triangles.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.row(static_cast<Index>(i)) = points[i].transpose();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) mesh.faces(static_cast<Index>(i), static_cast<Index>(k)) = triangles[i][k];
  }
  return mesh;
}

// A ball with bumps that has just this group, off the origin; its triangles know nothing of it.
GeneratedModel bumpy_ball(const PointGroup& group) {
  Random random(11, group.symbol());
  const GroupFrame frame = random.rotation();
  const std::vector<Eigen::Matrix3d> all = elements(group, frame);
  std::array<Vector3d, 3> bumps;
  for (Vector3d& bump : bumps) bump = random.direction();
  const Vector3d centre(0.3, -0.2, 0.5);
  GeneratedModel model;
  model.mesh = octasphere(4);
  const Eigen::Matrix3d turn = random.rotation();
  for (Index v = 0; v < model.mesh.vertices.rows(); ++v) {
    const Vector3d direction = turn * model.mesh.vertices.row(v).transpose();
    double radius = 1;
    for (const Eigen::Matrix3d& element : all) {
      for (std::size_t b = 0; b < bumps.size(); ++b) {
        const double cosine = direction.dot(element * bumps[b]);
        radius += (0.1 + 0.05 * static_cast<double>(b)) * std::exp(12 * (cosine - 1)) / std::sqrt(all.size());
      }
    }
    model.mesh.vertices.row(v) = (centre + radius * direction).transpose();
  }
  std::vector<int> faces(static_cast<std::size_t>(model.mesh.faces.rows()));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
  model.truth = empty_annotation(model.mesh, 0.005);
  model.truth.regions.push_back(make_region(group, centre, frame, faces, "ball"));
  return model;
}

PointGroup group(const std::string& symbol) {
  return PointGroup::parse(symbol).value();
}

int euler_characteristic(const Mesh& mesh) {
  return static_cast<int>(mesh.vertices.rows()) -
         static_cast<int>(welded_edges(mesh, weld_vertices(mesh.vertices)).size()) +
         static_cast<int>(mesh.faces.rows());
}

SymmetryReport checked(const SymmetricRemesh& result) {
  RunContext context;
  return symmetry_residual(result.mesh, result.annotation, nullptr, CarriedMotions::fixed, context);
}

// Triangles of a region that a motion takes to no triangle of it, with the sides exchanged where it is no rotation.
int unmapped_triangles(const Mesh& mesh, const Region& region, const Motion& motion) {
  const PointIndex index(mesh.vertices);
  const auto rotated = [](std::array<int, 3> t) {
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    return t;
  };
  std::set<std::array<int, 3>> triangles;
  for (const int f : region.faces) triangles.insert(rotated({mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)}));
  int missing = 0;
  for (const int f : region.faces) {
    std::array<int, 3> image{};
    for (int k = 0; k < 3; ++k) {
      const Vector3d point = motion(mesh.vertices.row(mesh.faces(f, k)).transpose());
      image[static_cast<std::size_t>(k)] = index.nearest(point, 1).front().index;
    }
    if (motion.linear.determinant() < 0) std::swap(image[1], image[2]);
    missing += triangles.contains(rotated(image)) ? 0 : 1;
  }
  return missing;
}

double smallest_height(const Mesh& mesh) {
  double smallest = diagonal(mesh.vertices);
  const Eigen::VectorXd areas = face_areas(mesh);
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const auto side = mesh.vertices.row(mesh.faces(f, k)) - mesh.vertices.row(mesh.faces(f, (k + 1) % 3));
      longest = std::max(longest, side.norm());
    }
    smallest = std::min(smallest, 2 * areas[f] / longest);
  }
  return smallest;
}

class SymmetricRemeshOfGroup : public testing::TestWithParam<std::string> {};

TEST_P(SymmetricRemeshOfGroup, MapsTrianglesOntoTrianglesAndStaysClosed) {
  const GeneratedModel model = bumpy_ball(group(GetParam()));
  const SymmetricRemesh result = symmetric_remesh(model.mesh, model.truth, {}, RunContext{});
  ASSERT_EQ(result.annotation.regions.size(), 1U);
  const SymmetryReport report = checked(result);
  EXPECT_TRUE(report.vertices_onto_vertices);
  EXPECT_LE(report.worst_floor, 1e-12);
  for (const Motion& element : result.annotation.regions.front().elements) {
    EXPECT_EQ(unmapped_triangles(result.mesh, result.annotation.regions.front(), element), 0);
  }
  const MeshReport found = inspect(result.mesh);
  EXPECT_TRUE(found.watertight);
  EXPECT_EQ(found.duplicate_vertices, 0);
  EXPECT_EQ(found.non_manifold_edges, 0);
  EXPECT_EQ(found.inconsistent_edges, 0);
  EXPECT_EQ(found.degenerate_faces, 0);
  EXPECT_EQ(found.components, 1);
  EXPECT_EQ(euler_characteristic(result.mesh), 2);
  EXPECT_NEAR(found.volume, inspect(model.mesh).volume, 0.01 * found.volume);
  EXPECT_LT(result.largest_distance, model.truth.tolerance);
  EXPECT_GT(result.largest_distance, 0);
  EXPECT_GE(result.largest_distance, result.mean_distance);
  EXPECT_GT(smallest_height(result.mesh), 0.02 * smallest_height(model.mesh));
}

INSTANTIATE_TEST_SUITE_P(Groups, SymmetricRemeshOfGroup,
                         testing::Values("Cs", "Ci", "C2", "C3", "C7", "C2v", "C5v", "C2h", "C3h", "D2", "D5", "D2h",
                                         "D6h", "D2d", "D3d", "S4", "S6", "T", "Td", "Th", "O", "Oh", "I", "Ih"),
                         [](const auto& name) { return name.param; });

TEST(FundamentalDomain, HasOneImageForEveryElement) {
  for (const char* symbol : {"Cs", "Ci", "C5", "C4v", "D3", "S4", "Th", "O", "Ih"}) {
    const Region region = make_region(group(symbol), Vector3d(1, 2, 3), GroupFrame::Identity(), {}, "");
    const auto finite = generated_group(region.elements, Vector3d(1, 2, 3), 1);
    ASSERT_TRUE(finite) << symbol;
    ASSERT_EQ(finite->order(), region.group.order()) << symbol;
    Random random(3);
    for (const FundamentalDomain& domain : candidate_domains(*finite)) {
      for (int i = 0; i < 20; ++i) {
        const Vector3d point = domain.centre + random.direction();
        const auto inside = [&](const Motion& element) {
          return std::ranges::all_of(
              domain.walls, [&](const Wall& wall) { return wall.normal.dot(element(point) - domain.centre) <= 0; });
        };
        EXPECT_EQ(std::ranges::count_if(finite->elements, inside), 1) << symbol;
      }
    }
  }
}

TEST(GeneratedGroup, RefusesTranslationsAndFreeProducts) {
  Motion step;
  step.translation = Vector3d(0.1, 0, 0);
  EXPECT_FALSE(generated_group({step}, Vector3d::Zero(), 1));
  const Motion a = Motion::rotation(Vector3d::UnitZ(), 1, Vector3d::Zero());
  EXPECT_FALSE(generated_group({a}, Vector3d::Zero(), 1));
}

class SymmetricRemeshOfModel : public testing::TestWithParam<std::string> {};

TEST_P(SymmetricRemeshOfModel, KeepsNestedRegionsOfWholeComponents) {
  const GeneratedModel model = generate(GetParam());
  const SymmetricRemesh result = symmetric_remesh(model.mesh, model.truth, {}, RunContext{});
  EXPECT_EQ(result.annotation.regions.size(), model.truth.regions.size());
  const SymmetryReport report = checked(result);
  EXPECT_TRUE(report.vertices_onto_vertices);
  EXPECT_LE(report.worst_floor, 1e-12);
  const MeshReport before = inspect(model.mesh);
  const MeshReport after = inspect(result.mesh);
  EXPECT_EQ(after.watertight, before.watertight);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.non_manifold_edges, before.non_manifold_edges);
  EXPECT_EQ(euler_characteristic(result.mesh), euler_characteristic(model.mesh));
  EXPECT_LT(result.largest_distance, model.truth.tolerance);
}

INSTANTIATE_TEST_SUITE_P(Models, SymmetricRemeshOfModel,
                         testing::Values("armchair", "desk_fan", "wind_mill", "yard_tool", "centre_piece"),
                         [](const auto& name) { return name.param; });

TEST(SymmetricRemesh, TakesContinuousGroupsAsFiniteOnes) {
  const Mesh part = turned_part({{0, 0}, {0.4, 0}, {0.5, 0.3}, {0.2, 0.9}, {0, 1}}, irregular_angles(40));
  const GeneratedModel model = whole(part, group("Cinfv"), Vector3d::Zero());
  const SymmetricRemesh result = symmetric_remesh(model.mesh, model.truth, {}, RunContext{});
  ASSERT_EQ(result.items.size(), 1U);
  EXPECT_EQ(PointGroup::parse(result.items.front().kept_as)->family, PointGroup::Family::Cnv);
  EXPECT_TRUE(checked(result).vertices_onto_vertices);
  EXPECT_LE(checked(result).worst_floor, 1e-12);
  EXPECT_TRUE(inspect(result.mesh).watertight);
  EXPECT_LT(result.mesh.faces.rows(), 3 * part.faces.rows());  // as many rotations as steps, each cut in half
}

// Both sides of a sheet as faces on the same vertices: four meet at every edge, and none stays open where it is cut.
TEST(SymmetricRemesh, WeldsDoubledFaces) {
  GeneratedModel model = bumpy_ball(group("C3"));
  const Index count = model.mesh.faces.rows();
  model.mesh.faces.conservativeResize(2 * count, 3);
  model.mesh.faces.bottomRows(count) = model.mesh.faces.topRows(count).rowwise().reverse();
  model.truth = empty_annotation(model.mesh, 0.005);
  std::vector<int> faces(static_cast<std::size_t>(2 * count));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
  const Region single = bumpy_ball(group("C3")).truth.regions.front();
  Region region = single;
  region.faces = faces;
  model.truth.regions.push_back(region);
  const SymmetricRemesh result = symmetric_remesh(model.mesh, model.truth, {}, RunContext{});
  const MeshReport found = inspect(result.mesh);
  EXPECT_EQ(found.boundary_edges, 0);
  EXPECT_EQ(found.components, 1);
  EXPECT_EQ(found.duplicate_faces, found.faces / 2);
  EXPECT_TRUE(checked(result).vertices_onto_vertices);
  EXPECT_LE(checked(result).worst_floor, 1e-12);
}

SymmetricRemesh mirrored(const Mesh& mesh, const Vector3d& point) {
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
  annotation.regions.push_back(make_region(group("Cs"), point, frame_about(Vector3d::UnitX()), faces, "whole"));
  return symmetric_remesh(mesh, annotation, {}, RunContext{});
}

// A fin is a sheet in the mirror: its own image, and there once.
TEST(SymmetricRemesh, KeepsWhatLiesInAMirror) {
  Mesh mesh = octasphere(3);
  Mesh fin;
  fin.vertices.resize(4, 3);
  fin.vertices << 0, -0.5, 1.2, 0, 0.5, 1.2, 0, 0.5, 1.8, 0, -0.5, 1.8;
  fin.faces.resize(2, 3);
  fin.faces << 0, 1, 2, 0, 2, 3;
  append(mesh, fin);
  const SymmetricRemesh result = mirrored(mesh, Vector3d::Zero());
  ASSERT_EQ(result.items.front().kept_as, "Cs");
  EXPECT_EQ(inspect(result.mesh).components, 2);
  EXPECT_EQ(inspect(result.mesh).duplicate_faces, 0);
  EXPECT_NEAR(face_areas(result.mesh).sum(), face_areas(mesh).sum(), 1e-9);
  EXPECT_EQ(inspect(result.mesh).boundary_edges, 4);
}

// A part that is thinner than the tolerance, off its mirror by a third of its width, keeps that.
TEST(SymmetricRemesh, KeepsTheWidthOfThinParts) {
  Mesh mesh = octasphere(3);
  Mesh rod = octasphere(1);
  rod.vertices.col(0) = 0.006 * rod.vertices.col(0).array() + 0.002;
  rod.vertices.col(1) *= 0.006;
  rod.vertices.col(2).array() += 2.5;
  append(mesh, rod);
  const SymmetricRemesh result = mirrored(mesh, Vector3d::Zero());
  ASSERT_EQ(result.items.front().kept_as, "Cs");
  double width = 0;
  for (const auto& vertex : result.mesh.vertices.rowwise()) {
    if (vertex.z() > 1.2) width = std::max(width, vertex.x());
  }
  EXPECT_NEAR(width, 0.006, 1e-5);
  EXPECT_LE(checked(result).worst_floor, 1e-12);
}

TEST(SymmetricRemesh, CopiesThePartsOfPatterns) {
  Mesh mesh;
  SymmetryAnnotation annotation;
  Pattern pattern;
  pattern.kind = Pattern::Kind::translation_1d;
  Motion step;
  step.translation = Vector3d(0.5, 0.1, 0);
  Motion motion;
  for (int i = 0; i < 4; ++i) {
    pattern.instances.push_back({motion, append(mesh, placed(wedge(0.2), motion))});
    motion = step * motion;
  }
  pattern.generators = {step};
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) += 5e-4 * std::sin(40 * mesh.vertices(v, 0) + 30 * mesh.vertices(v, 1));
  }
  annotation = empty_annotation(mesh, 0.005);
  annotation.patterns.push_back(pattern);
  const SymmetricRemesh result = symmetric_remesh(mesh, annotation, {}, RunContext{});
  ASSERT_EQ(result.annotation.patterns.size(), 1U);
  EXPECT_LE(checked(result).patterns.front().floor.max, 1e-12);
}

TEST(SymmetricRemesh, RefusesToForceASymmetry) {
  GeneratedModel model = bumpy_ball(group("C3"));
  model.truth.regions.front() = make_region(group("C4v"), model.truth.regions.front().centre, GroupFrame::Identity(),
                                            model.truth.regions.front().faces, "wrong");
  try {
    symmetric_remesh(model.mesh, model.truth, {}, RunContext{});
    FAIL() << "was forced";
  } catch (const NoResultError& error) {
    EXPECT_NE(std::string(error.what()).find("wrong"), std::string::npos) << error.what();
  }
  EXPECT_THROW(symmetric_remesh(model.mesh, model.truth, {.min_score = 1.5}, RunContext{}), UsageError);
  EXPECT_THROW(symmetric_remesh(model.mesh, model.truth, {.snap = -1}, RunContext{}), UsageError);
}

TEST(SymmetricRemesh, LeavesOutPartsOfComponents) {
  GeneratedModel model = bumpy_ball(group("C3v"));
  Region half = model.truth.regions.front();
  half.id = 1;
  half.faces.resize(half.faces.size() / 2);
  model.truth.regions.push_back(half);
  const SymmetricRemesh result = symmetric_remesh(model.mesh, model.truth, {}, RunContext{});
  EXPECT_EQ(result.annotation.regions.size(), 1U);
  EXPECT_FALSE(result.items[1].reason.empty());
  EXPECT_EQ(result.source_face.size(), static_cast<std::size_t>(result.mesh.faces.rows()));
  EXPECT_EQ(result.motion_of_face.size(), result.source_face.size());
}

}  // namespace
}  // namespace orbifit
