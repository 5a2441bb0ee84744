#include "deformation/laplacian.h"

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/subspace/deformer.h"

#include "base/dense.h"
#include "base/random.h"
#include "basis/subspace_parts.h"
#include "deformation/mesh_laplacian.h"
#include "deformation/point_laplacian.h"
#include "geometry/point_index.h"
#include "models/orbit_model.h"

namespace orbifit {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

struct Sampled {
  Points samples;
  double radius = 0;
  SampleEdges edges;
};

Sampled sampled(const GeneratedModel& model, double radius) {
  SubspaceOptions options;
  options.radius = radius * diagonal(model.mesh.vertices);
  const Subspace subspace = build_subspace(model.mesh, model.truth, options, RunContext{});
  return {subspace->sampling.points, options.radius, neighbour_graph(subspace->sampling.points, 2 * options.radius)};
}

Sparse sample_laplacian(LaplacianKind kind, const Mesh& mesh, const Sampled& sampled) {
  switch (kind) {
    case LaplacianKind::cotangent:
      return cotangent_sample_laplacian(mesh, sampled.samples, sampled.radius, sampled.edges, RunContext{});
    case LaplacianKind::point:
      return point_laplacian(sampled.samples, sampled.edges);
    case LaplacianKind::graph:
      break;
  }
  return graph_laplacian(sampled.edges, sampled.samples.rows());
}

// Symmetric, positive semi-definite, and nothing but the constants in the null space.
void expect_laplacian(const Sparse& laplacian) {
  const Eigen::MatrixXd dense(laplacian);
  const double scale = dense.diagonal().mean();
  EXPECT_LT((dense - dense.transpose()).cwiseAbs().maxCoeff(), 1e-14 * scale);
  EXPECT_LT(dense.rowwise().sum().cwiseAbs().maxCoeff(), 1e-11 * scale);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(dense, Eigen::EigenvaluesOnly);
  EXPECT_GT(solver.eigenvalues()[0], -1e-12 * scale);
  EXPECT_GT(solver.eigenvalues()[1], 1e-7 * scale);
}

TEST(LaplacianKind, NamesAreReadBack) {
  for (const LaplacianKind kind : {LaplacianKind::graph, LaplacianKind::cotangent, LaplacianKind::point}) {
    EXPECT_EQ(parse_laplacian_kind(to_string(kind)), kind);
  }
  EXPECT_FALSE(parse_laplacian_kind("cotan").has_value());
}

using ModelAndKind = std::tuple<std::string, LaplacianKind>;

class LaplacianOfModel : public testing::TestWithParam<ModelAndKind> {};

TEST_P(LaplacianOfModel, IsSymmetricSemiDefiniteAndHasTheConstantsAlone) {
  const GeneratedModel model = generate(std::get<0>(GetParam()));
  const Sampled samples = sampled(model, 0.05);
  const Sparse laplacian = sample_laplacian(std::get<1>(GetParam()), model.mesh, samples);
  expect_laplacian(laplacian);
  const Sparse graph = graph_laplacian(samples.edges, samples.samples.rows());
  EXPECT_NEAR(laplacian.diagonal().mean(), graph.diagonal().mean(), 1e-10);
}

std::string laplacian_test_name(const testing::TestParamInfo<ModelAndKind>& info) {
  return std::get<0>(info.param) + "_" + to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Models, LaplacianOfModel,
                         testing::Combine(testing::Values("bar", "table", "chair", "fan", "wheel"),
                                          testing::Values(LaplacianKind::graph, LaplacianKind::cotangent,
                                                          LaplacianKind::point)),
                         laplacian_test_name);

class LaplacianOfGroup : public testing::TestWithParam<ModelAndKind> {};

// P^T L P = L for the permutations of the samples by the group's elements.
TEST_P(LaplacianOfGroup, HasTheSymmetriesOfTheSamples) {
  OrbitOptions orbit;
  orbit.subdivisions = 1;
  orbit.frame = Random(3, std::get<0>(GetParam())).rotation();
  orbit.centre = {0.3, -0.2, 0.7};
  const GeneratedModel model = generate_orbit(PointGroup::parse(std::get<0>(GetParam())).value(), orbit);
  const Sampled samples = sampled(model, 0.12);
  const Eigen::MatrixXd laplacian(sample_laplacian(std::get<1>(GetParam()), model.mesh, samples));
  const PointIndex index(samples.samples);
  for (const Motion& element : model.truth.regions[0].elements) {
    std::vector<int> image;
    for (Eigen::Index s = 0; s < samples.samples.rows(); ++s) {
      const auto nearest = index.nearest(element(samples.samples.row(s).transpose()), 1).front();
      ASSERT_LT(nearest.distance, 1e-9);
      image.push_back(nearest.index);
    }
    const Eigen::MatrixXd permuted = laplacian(image, image);
    EXPECT_LT((permuted - laplacian).cwiseAbs().maxCoeff(), 1e-9 * laplacian.diagonal().mean());
  }
}

INSTANTIATE_TEST_SUITE_P(Groups, LaplacianOfGroup,
                         testing::Combine(testing::Values("Cs", "C5", "C4v", "D3d", "S4", "Td", "Oh"),
                                          testing::Values(LaplacianKind::graph, LaplacianKind::cotangent,
                                                          LaplacianKind::point)),
                         laplacian_test_name);

class MeshLaplacian : public testing::TestWithParam<std::string> {
 protected:
  Mesh mesh_ = generate(GetParam()).mesh;
};

TEST_P(MeshLaplacian, IsSymmetricSemiDefiniteAndKillsConstants) {
  const Sparse laplacian = cotangent_laplacian(mesh_);
  const double scale = laplacian.diagonal().cwiseAbs().maxCoeff();
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(laplacian.rows());
  EXPECT_LT((laplacian * ones).cwiseAbs().maxCoeff(), 1e-11 * scale);
  EXPECT_EQ((laplacian - Sparse(laplacian.transpose())).norm(), 0);
  Random random(5, GetParam());
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd u = Eigen::VectorXd::NullaryExpr(laplacian.rows(), [&] { return random.normal(); });
    EXPECT_GT(u.dot(laplacian * u), 0);
  }
}

TEST_P(MeshLaplacian, VertexAreasSumToTheArea) {
  EXPECT_NEAR(vertex_areas(mesh_).sum(), face_areas(mesh_).sum(), 1e-10 * face_areas(mesh_).sum());
  EXPECT_GE(vertex_areas(mesh_).minCoeff(), 0);
}

// trace(x^T L x) / 2 is the area: the Dirichlet energy of the identity map.
TEST_P(MeshLaplacian, DirichletEnergyOfThePositionsIsTwiceTheArea) {
  const double energy = (mesh_.vertices.transpose() * (cotangent_laplacian(mesh_) * mesh_.vertices)).trace();
  EXPECT_NEAR(energy / 2, face_areas(mesh_).sum(), 1e-9 * energy);
}

// A field that is linear in space has the same energy, however fine the triangles.
TEST_P(MeshLaplacian, TessellationKeepsTheSurface) {
  const double longest = 0.02 * diagonal(mesh_.vertices);
  const Mesh fine = tessellated(mesh_, longest);
  for (Eigen::Index f = 0; f < fine.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_LT((fine.vertices.row(fine.faces(f, k)) - fine.vertices.row(fine.faces(f, (k + 1) % 3))).norm(),
                longest * (1 + 1e-6));
    }
  }
  EXPECT_EQ(fine.vertices.topRows(mesh_.vertices.rows()), mesh_.vertices);
  EXPECT_NEAR(face_areas(fine).sum(), face_areas(mesh_).sum(), 1e-10 * face_areas(mesh_).sum());
  const Eigen::Vector3d direction(0.3, -0.5, 0.8);
  const auto energy = [&](const Mesh& mesh) {
    const Eigen::VectorXd field = mesh.vertices * direction;
    return field.dot(cotangent_laplacian(mesh) * field);
  };
  EXPECT_NEAR(energy(fine), energy(mesh_), 1e-9 * energy(mesh_));
}

// Corners at one place may be one vertex or many: the restricted matrix is the same.
TEST_P(MeshLaplacian, RestrictionDoesNotSeeSeams) {
  Mesh soup;
  soup.vertices.resize(3 * mesh_.faces.rows(), 3);
  soup.faces.resize(mesh_.faces.rows(), 3);
  for (Eigen::Index f = 0; f < mesh_.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      soup.vertices.row(3 * f + k) = mesh_.vertices.row(mesh_.faces(f, k));
      soup.faces(f, k) = static_cast<int>(3 * f + k);
    }
  }
  Points samples(40, 3);
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    samples.row(s) = mesh_.vertices.row(s * (mesh_.vertices.rows() - 1) / (samples.rows() - 1));
  }
  const double sigma = 0.1 * diagonal(mesh_.vertices);
  const RunContext context;
  const auto restricted = [&](const Mesh& mesh) {
    return restricted_laplacian(mesh, lift_weights(mesh.vertices, samples, sigma, context), context);
  };
  const Sparse whole = restricted(mesh_);
  EXPECT_LT((whole - restricted(soup)).norm(), 1e-10 * whole.norm());
}

INSTANTIATE_TEST_SUITE_P(Models, MeshLaplacian, testing::Values("bar", "table", "chair", "fan", "wheel"),
                         [](const auto& model) { return model.param; });

// A square of irregular triangles in a slanted plane.
Mesh planar_patch(int cells) {
  Random random(9, "patch");
  const Eigen::Matrix3d frame = random.rotation();
  Mesh mesh;
  mesh.vertices.resize((cells + 1) * (cells + 1), 3);
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const bool inside = i > 0 && i < cells && j > 0 && j < cells;
      const double jitter = inside ? 0.3 : 0;
      const Eigen::Vector3d place(i + jitter * random.uniform(-1, 1), j + jitter * random.uniform(-1, 1), 0);
      mesh.vertices.row(j * (cells + 1) + i) = (frame * place).transpose();
    }
  }
  mesh.faces.resize(2 * cells * cells, 3);
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i;
      mesh.faces.row(2 * (j * cells + i)) << a, a + 1, a + cells + 2;
      mesh.faces.row(2 * (j * cells + i) + 1) << a, a + cells + 2, a + cells + 1;
    }
  }
  return mesh;
}

// 0.3 is a hair more than three times 0.1 in doubles.
TEST(Tessellation, CutsASideThatIsAMultipleNoFurther) {
  Mesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0, 0, 0, 0.1 + 0.2, 0, 0, 0, 0.1 + 0.2, 0;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  EXPECT_EQ(tessellated(mesh, 0.1 * std::sqrt(2.0)).faces.rows(), 9);
  EXPECT_EQ(tessellated(mesh, 0.099 * std::sqrt(2.0)).faces.rows(), 16);
}

TEST(CotangentLaplacian, IsLinearlyPreciseInsideAPlanarPatch) {
  const int cells = 8;
  const Mesh mesh = planar_patch(cells);
  const Points delta = cotangent_laplacian(mesh) * mesh.vertices;
  for (int j = 1; j < cells; ++j) {
    for (int i = 1; i < cells; ++i) EXPECT_LT(delta.row(j * (cells + 1) + i).norm(), 1e-12);
  }
}

// (L x)_v / A_v = 2 H n, on the unit sphere twice the position.
TEST(CotangentLaplacian, GivesTheMeanCurvatureOfASphere) {
  const int rings = 40;
  const int around = 80;
  Mesh mesh;
  mesh.vertices.resize(2 + (rings - 1) * around, 3);
  mesh.vertices.row(0) << 0, 0, 1;
  mesh.vertices.row(1) << 0, 0, -1;
  const auto at = [&](int ring, int k) {
    return ring == 0 ? 0 : ring == rings ? 1 : 2 + (ring - 1) * around + k % around;
  };
  for (int ring = 1; ring < rings; ++ring) {
    const double polar = std::numbers::pi * ring / rings;
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5 * ring) / around;
      mesh.vertices.row(at(ring, k)) << std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
          std::cos(polar);
    }
  }
  std::vector<Eigen::RowVector3i> faces;
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < around; ++k) {
      if (ring > 0) faces.emplace_back(at(ring, k), at(ring + 1, k), at(ring, k + 1));
      if (ring + 1 < rings) faces.emplace_back(at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1));
    }
  }
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.row(static_cast<Eigen::Index>(f)) = faces[f];
  const Points delta = cotangent_laplacian(mesh) * mesh.vertices;
  const Eigen::VectorXd areas = vertex_areas(mesh);
  for (int ring = 8; ring <= rings - 8; ++ring) {
    for (int k = 0; k < around; ++k) {
      const int v = at(ring, k);
      EXPECT_LT((delta.row(v) / areas[v] - 2 * mesh.vertices.row(v)).norm(), 0.02);
    }
  }
}

TEST(CotangentLaplacian, TakesDegenerateDoubledAndNonManifoldFaces) {
  Mesh mesh;
  mesh.vertices.resize(7, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0, 0, 0, -1, 0, 0, 0, 0;
  mesh.faces.resize(8, 3);
  // Three faces at one edge, one of them twice; then no area: collinear, a corner twice, a point, coincident corners.
  mesh.faces << 0, 1, 2, 0, 1, 3, 0, 1, 5, 0, 1, 5, 0, 4, 1, 0, 0, 1, 2, 2, 2, 0, 6, 3;
  const Eigen::MatrixXd laplacian(cotangent_laplacian(mesh));
  EXPECT_TRUE(laplacian.allFinite());
  EXPECT_TRUE(vertex_areas(mesh).allFinite());
  EXPECT_NEAR(vertex_areas(mesh).sum(), 2, 1e-12);
  EXPECT_EQ(laplacian.row(4).norm(), 0);
  EXPECT_EQ(laplacian.row(6).norm(), 0);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian);
  EXPECT_GT(solver.eigenvalues()[0], -1e-12);
}

// The thinner the triangle, the larger its cotangents, up to a limit.
TEST(CotangentLaplacian, BoundsNeedles) {
  for (const double height : {1e-3, 1e-6, 1e-9, 1e-12}) {
    Mesh mesh;
    mesh.vertices.resize(3, 3);
    mesh.vertices << 0, 0, 0, 1, 0, 0, 0.3, height, 0;
    mesh.faces.resize(1, 3);
    mesh.faces << 0, 1, 2;
    const Eigen::MatrixXd laplacian(cotangent_laplacian(mesh));
    EXPECT_LE(laplacian.cwiseAbs().maxCoeff(), 1.01e4);
    EXPECT_GT(laplacian.cwiseAbs().maxCoeff(), 100);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(laplacian);
    EXPECT_GT(solver.eigenvalues()[0], -1e-9);
  }
}

TEST(CotangentLaplacian, RestrictionIsTheDirichletEnergyOfTheLiftedField) {
  const GeneratedModel model = generate("chair");
  const Sampled samples = sampled(model, 0.08);
  const RunContext context;
  const LiftWeights weights = lift_weights(model.mesh.vertices, samples.samples, samples.radius, context);
  const Sparse restricted = restricted_laplacian(model.mesh, weights, context);
  Random random(2, "field");
  const Eigen::VectorXd u = Eigen::VectorXd::NullaryExpr(weights.cols(), [&] { return random.normal(); });
  const Eigen::VectorXd lifted = weights * u;
  const double energy = lifted.dot(cotangent_laplacian(model.mesh) * lifted);
  EXPECT_NEAR(u.dot(restricted * u), energy, 1e-10 * energy);
}

TEST(CotangentLaplacian, RestrictionDoesNotDependOnThreads) {
  const GeneratedModel model = generate("fan");
  const Sampled samples = sampled(model, 0.05);
  RunContext two;
  two.threads = 2;
  const auto make = [&](const RunContext& context) {
    return Eigen::MatrixXd(
        cotangent_sample_laplacian(model.mesh, samples.samples, samples.radius, samples.edges, context));
  };
  EXPECT_EQ(make(RunContext{}), make(two));
}

// Two clusters that one long edge joins.
TEST(PointLaplacian, KeepsWhatTheEdgesConnect) {
  Points samples(8, 3);
  samples << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 100, 0, 0, 101, 0, 0, 100, 1, 0, 101, 1, 0;
  expect_laplacian(point_laplacian(samples, neighbour_graph(samples, 2)));
}

TEST(PointLaplacian, DoesNotDependOnScaleOrPose) {
  const Sampled samples = sampled(generate("table"), 0.08);
  const Sparse plain = point_laplacian(samples.samples, samples.edges);
  const Eigen::Matrix3d turn = Random(4, "pose").rotation();
  const Points moved = (1e3 * samples.samples * turn.transpose()).rowwise() + Eigen::RowVector3d(5, -7, 9);
  EXPECT_LT((point_laplacian(moved, samples.edges) - plain).norm(), 1e-9 * plain.norm());
}

TEST(PointLaplacian, TakesCoincidentAndLonelySamples) {
  Points samples(2, 3);
  samples << 1, 2, 3, 1, 2, 3;
  EXPECT_TRUE(Eigen::MatrixXd(point_laplacian(samples, {{0, 1}})).allFinite());
  EXPECT_EQ(point_laplacian(samples.topRows(1), {}).norm(), 0);
}

}  // namespace
}  // namespace orbifit
