#include "cases/spoil.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"

#include "geometry/topology.h"
#include "models/orbit_model.h"
#include "solids.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

double longest_edge(const Mesh& mesh) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const Points from = mesh.vertices(mesh.faces.col(k), Eigen::all);
    const Points to = mesh.vertices(mesh.faces.col((k + 1) % 3), Eigen::all);
    longest = std::max(longest, (to - from).rowwise().norm().maxCoeff());
  }
  return longest;
}

Vector3d centroid(const Mesh& mesh, Eigen::Index face) {
  return mesh.vertices(mesh.faces.row(face), Eigen::all).colwise().mean();
}

class Subdivided : public testing::TestWithParam<double> {};

TEST_P(Subdivided, KeepsTheSurfaceAndItsClosure) {
  for (const Mesh& mesh :
       {test::solid_box({0, 0, 0}, {1, 2, 3}), test::solid_torus(2, 0.7, 20, 8), generate("table").mesh}) {
    const Derived fine = subdivided(mesh, GetParam());
    EXPECT_LE(longest_edge(fine.mesh), GetParam() * diagonal(mesh.vertices));
    EXPECT_EQ(fine.mesh.vertices.topRows(mesh.vertices.rows()), mesh.vertices);
    const MeshReport before = inspect(mesh);
    const MeshReport after = inspect(fine.mesh);
    EXPECT_TRUE(after.watertight);
    EXPECT_EQ(after.inconsistent_edges, 0);
    EXPECT_EQ(after.degenerate_faces, 0);
    EXPECT_EQ(after.duplicate_vertices, before.duplicate_vertices);
    EXPECT_EQ(after.components, before.components);
    EXPECT_NEAR(after.volume, before.volume, 1e-12 * before.volume);
    // Face by face: the pieces of each have its area, its plane and its orientation.
    ASSERT_EQ(static_cast<Eigen::Index>(fine.source_face.size()), fine.mesh.faces.rows());
    EXPECT_TRUE(std::ranges::is_sorted(fine.source_face));
    const Eigen::VectorXd areas = face_areas(mesh);
    const Eigen::VectorXd pieces = face_areas(fine.mesh);
    const Points normals = face_normals(mesh);
    const Points piece_normals = face_normals(fine.mesh);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(areas.size());
    for (Eigen::Index f = 0; f < pieces.size(); ++f) {
      const int source = fine.source_face[static_cast<std::size_t>(f)];
      sums[source] += pieces[f];
      EXPECT_GT(piece_normals.row(f).dot(normals.row(source)), 1 - 1e-9);
    }
    EXPECT_LT((sums - areas).cwiseAbs().maxCoeff(), 1e-12 * areas.maxCoeff());
  }
}

INSTANTIATE_TEST_SUITE_P(Lengths, Subdivided, testing::Values(0.3, 0.1, 0.03));

TEST(Subdivided, MeetsWhereVerticesAreDoubled) {
  // Two triangles of a square that share no vertex numbers.
  const Mesh mesh{
      Points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}, Triangles{{0, 1, 2}, {3, 4, 5}}, {}};
  const Mesh fine = subdivided(mesh, 0.1).mesh;
  const auto edges = welded_edges(fine, weld_vertices(fine.vertices));
  for (const Edge& edge : edges) {
    const Vector3d a =
        fine.vertices.row(weld_vertices(fine.vertices).representative[static_cast<std::size_t>(edge.vertices[0])]);
    const Vector3d b =
        fine.vertices.row(weld_vertices(fine.vertices).representative[static_cast<std::size_t>(edge.vertices[1])]);
    const bool on_side =
        (a.x() == b.x() && (a.x() == 0 || a.x() == 1)) || (a.y() == b.y() && (a.y() == 0 || a.y() == 1));
    EXPECT_EQ(edge.faces.size(), on_side ? 1U : 2U);
  }
}

TEST(Subdivided, LeavesAFineMeshAlone) {
  const Mesh mesh = test::solid_sphere(1, 3);
  const Derived same = subdivided(mesh, 1);
  EXPECT_EQ(same.mesh.vertices, mesh.vertices);
  EXPECT_EQ(same.mesh.faces, mesh.faces);
}

TEST(Subdivided, RefusesLengthsOutOfRange) {
  const Mesh mesh = test::solid_box({0, 0, 0}, {1, 2, 3});
  for (const double length : {0.0, -1.0, 1.5, 1e-4, std::nan("")}) EXPECT_THROW(subdivided(mesh, length), UsageError);
}

TEST(Noisy, MovesVerticesAlongNormalsByIndependentGaussians) {
  const Mesh mesh = test::solid_sphere(2, 5);
  const double sigma = 0.003;
  const Mesh moved = noisy(mesh, sigma, 5);
  EXPECT_EQ(moved.faces, mesh.faces);
  const Points normals = vertex_normals(mesh);
  const Points steps = (moved.vertices - mesh.vertices) / (sigma * diagonal(mesh.vertices));
  const Eigen::VectorXd along = (steps.array() * normals.array()).rowwise().sum();
  EXPECT_LT((steps - (normals.array().colwise() * along.array()).matrix()).rowwise().norm().maxCoeff(), 1e-10);
  const double count = static_cast<double>(along.size());
  ASSERT_GT(count, 4000);
  EXPECT_NEAR(along.mean(), 0, 4 / std::sqrt(count));
  EXPECT_NEAR(along.squaredNorm() / count, 1, 4 * std::sqrt(2 / count));
  EXPECT_NEAR(along.array().pow(4).sum() / count, 3, 0.5);
  // Neighbours move independently.
  double product = 0;
  const auto edges = welded_edges(mesh, weld_vertices(mesh.vertices));
  for (const Edge& edge : edges) product += along[edge.vertices[0]] * along[edge.vertices[1]];
  EXPECT_NEAR(product / static_cast<double>(edges.size()), 0, 4 / std::sqrt(static_cast<double>(edges.size())));
}

TEST(Noisy, MovesVerticesAtOnePlaceTogether) {
  const Mesh box = test::solid_box({0, 0, 0}, {1, 2, 3});
  const Mesh twice = test::joined_meshes({box, box});
  const Mesh moved = noisy(twice, 0.01, 1);
  EXPECT_EQ(moved.vertices.topRows(8), moved.vertices.bottomRows(8));
  EXPECT_TRUE(inspect(noisy(generate("armchair", {{"two_sided", 1}}).mesh, 0.001, 1)).degenerate_faces == 0);
}

TEST(Noisy, MovesTwoSidedSheetsToo) {
  Mesh sheet{Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Triangles{{0, 1, 2}, {0, 2, 1}}, {}};
  const Points steps = noisy(sheet, 0.01, 1).vertices - sheet.vertices;
  EXPECT_EQ(steps.leftCols(2).cwiseAbs().maxCoeff(), 0);
  EXPECT_GT(steps.col(2).cwiseAbs().minCoeff(), 0);
}

TEST(Noisy, DependsOnTheSeedAlone) {
  const Mesh mesh = test::solid_sphere(2, 2);
  EXPECT_EQ(noisy(mesh, 0.01, 1).vertices, noisy(mesh, 0.01, 1).vertices);
  EXPECT_NE(noisy(mesh, 0.01, 1).vertices, noisy(mesh, 0.01, 2).vertices);
  EXPECT_EQ(noisy(mesh, 0, 1).vertices, mesh.vertices);
  for (const double sigma : {-0.1, 0.2, std::nan("")}) EXPECT_THROW(noisy(mesh, sigma, 1), UsageError);
}

TEST(Cut, RemovesTheFacesInsideAndNoOthers) {
  const Mesh mesh = test::solid_torus(2, 0.7, 40, 16);
  const HalfSpace half{{0.3, 0, 0}, {2, 1, 0}};
  const CutBall ball{{2, 0, 0}, 1.1};
  const auto in_half = [&](const Vector3d& p) { return (p - half.point).dot(half.normal) > 0; };
  const auto in_ball = [&](const Vector3d& p) { return (p - ball.centre).norm() < ball.radius; };
  const auto check = [&](const Derived& rest, const auto& inside) {
    EXPECT_EQ(rest.mesh.vertices, mesh.vertices);
    ASSERT_EQ(static_cast<Eigen::Index>(rest.source_face.size()), rest.mesh.faces.rows());
    EXPECT_TRUE(std::ranges::is_sorted(rest.source_face));
    std::vector<int> expected;
    for (int f = 0; f < mesh.faces.rows(); ++f) {
      if (!inside(centroid(mesh, f))) expected.push_back(f);
    }
    EXPECT_EQ(rest.source_face, expected);
    EXPECT_LT(expected.size(), static_cast<std::size_t>(mesh.faces.rows()));
    EXPECT_EQ(rest.mesh.faces, Triangles(mesh.faces(expected, Eigen::all)));
  };
  check(cut(mesh, half), in_half);
  check(cut(mesh, ball), in_ball);
}

TEST(Cut, RefusesWhatHasNoMeaningOrLeavesNothing) {
  const Mesh mesh = test::solid_box({0, 0, 0}, {1, 2, 3});
  EXPECT_THROW(cut(mesh, HalfSpace{{0, 0, 0}, {0, 0, 0}}), UsageError);
  EXPECT_THROW(cut(mesh, CutBall{{0, 0, 0}, 0}), UsageError);
  EXPECT_THROW(cut(mesh, CutBall{{0, 0, 0}, std::nan("")}), UsageError);
  EXPECT_THROW(cut(mesh, CutBall{{0, 0, 0}, 100}), NoResultError);
  EXPECT_THROW(cut(mesh, HalfSpace{{0, 0, -1}, {0, 0, 1}}), NoResultError);
}

TEST(RandomPose, KeepsItsRange) {
  const Mesh mesh = test::solid_box({10, 0, 0}, {11, 2, 3});
  double least = 1e9;
  double most = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Similarity pose = random_pose(mesh, {.smallest_scale = 0.01, .largest_scale = 100, .offset = 5}, seed);
    EXPECT_LT(orthogonality_error(pose.linear), 1e-14);
    EXPECT_GT(pose.linear.determinant(), 0);
    least = std::min(least, pose.scale);
    most = std::max(most, pose.scale);
    const double offset = pose(bounding_box_centre(mesh.vertices)).norm();
    EXPECT_NEAR(offset, 5 * pose.scale * diagonal(mesh.vertices), 1e-9 * offset);
  }
  EXPECT_GE(least, 0.01);
  EXPECT_LT(least, 0.03);
  EXPECT_GT(most, 30);
  EXPECT_LE(most, 100);
  EXPECT_THROW(random_pose(mesh, {.smallest_scale = 0}, 1), UsageError);
  EXPECT_THROW(random_pose(mesh, {.smallest_scale = 2, .largest_scale = 1}, 1), UsageError);
  EXPECT_THROW(random_pose(mesh, {.offset = -1}, 1), UsageError);
}

TEST(Transformed, CarriesTheTruthAlong) {
  const GeneratedModel chair = generate("chair");
  TruthModel model{chair.mesh, {chair.truth, {chair.truth.regions[1]}, {chair.truth.patterns[0]}, {{1, {{1, 2, 3}}}}}};
  const TruthModel posed = transformed(model, random_pose(model.mesh, {}, 3));
  EXPECT_EQ(posed.mesh.faces, model.mesh.faces);
  EXPECT_EQ(posed.truth.expected.mesh_diagonal, diagonal(posed.mesh.vertices));
  EXPECT_EQ(posed.truth.also_accepted, model.truth.also_accepted);
  RunContext context;
  const auto worst = [&](const SymmetryAnnotation& annotation) {
    const SymmetryReport report = symmetry_residual(posed.mesh, annotation, nullptr, CarriedMotions::fixed, context);
    double pattern = 0;
    for (const PatternResidual& residual : report.patterns) pattern = std::max(pattern, residual.floor.max);
    return std::max(report.worst_floor, pattern);
  };
  EXPECT_LT(worst(posed.truth.expected), 1e-12);
  SymmetryAnnotation optional = empty_annotation(posed.mesh, 0.005);
  optional.regions = posed.truth.optional_regions;
  optional.patterns = posed.truth.optional_patterns;
  EXPECT_LT(worst(optional), 1e-12);
}

TEST(Transformed, KeepsMeshesFacingOutwardsUnderMirrors) {
  const Mesh box = test::solid_box({0, 0, 0}, {1, 2, 3});
  Similarity mirror;
  mirror.scale = 2;
  mirror.linear.diagonal() << 1, -1, 1;
  EXPECT_NEAR(inspect(transformed(box, mirror)).volume, 48, 1e-12);
}

TEST(Transformed, TellsResidualsInTheNewDiagonal) {
  TruthModel model{test::solid_box({0, 0, 0}, {1, 2, 3}), {}};
  model.truth.expected = empty_annotation(model.mesh, 0.005);
  model.truth.expected.regions.push_back(
      make_region({PointGroup::Family::Dnh, 2}, {0.5, 1, 1.5}, GroupFrame::Identity(), {0, 1}, "box"));
  model.truth.expected.regions.front().residual = {0.01, 0.02};
  const TruthModel posed = transformed(model, random_pose(model.mesh, {}, 3));
  const double factor = posed.truth.expected.mesh_diagonal / model.truth.expected.mesh_diagonal;
  const double scale = std::cbrt(inspect(posed.mesh).volume / 6);
  EXPECT_NEAR(posed.truth.expected.regions.front().residual.max * factor, 0.02 * scale, 1e-12);
}

}  // namespace
}  // namespace orbifit
