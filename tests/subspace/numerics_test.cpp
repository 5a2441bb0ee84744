#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/deformer.h"

#include "subspaces.h"

namespace orbifit {
namespace {

constexpr double kExact = 1e-12;  // of the diagonal

// A table where somebody may have put it, and what its legs and top are to do.
struct PlacedTable {
  explicit PlacedTable(double scale = 1, double offset = 0) : model(generate("table")) {
    const Eigen::RowVector3d shift(offset, -offset, 0.5 * offset);
    const double size = diagonal(model.mesh.vertices);
    model.mesh.vertices = (scale * model.mesh.vertices).rowwise() + scale * size * shift;
    model.truth.mesh_diagonal *= scale;
    for (Region& region : model.truth.regions) {
      const Eigen::Vector3d centre = region.centre;
      region.centre = scale * centre + scale * size * shift.transpose();
      for (auto* motions : {&region.generators, &region.elements}) {
        for (Motion& motion : *motions) motion = Motion::about(motion.linear, region.centre);
      }
    }
    model.truth.patterns.clear();
  }

  double size() const { return diagonal(model.mesh.vertices); }

  Handle at(int vertex, const Eigen::Vector3d& moved, double radius = 0.1) const {
    Handle handle = handle_at(model.mesh, model.mesh.vertices.row(vertex).transpose(), radius * size());
    handle.motion = Motion{Eigen::Matrix3d::Identity(), size() * moved};
    return handle;
  }

  int vertices() const { return static_cast<int>(model.mesh.vertices.rows()); }

  GeneratedModel model;
};

// Edits the shape and requires a finite, bounded, exactly symmetric result. `rounding`: of the coordinates themselves,
// in diagonals, as far from the origin they have fewer digits.
void expect_exact(const PlacedTable& shape, const std::vector<Handle>& handles, double alpha, double rounding = 0,
                  SubspaceOptions options = {}) {
  const Mesh& mesh = shape.model.mesh;
  const Subspace subspace = build_subspace(mesh, shape.model.truth, options, RunContext{});
  Deformer deformer(subspace, mesh);
  deformer.set_handles(handles, alpha);
  std::vector<Motion> motions;
  double farthest = 1;
  for (const Handle& handle : handles) {
    motions.push_back(handle.motion);
    farthest = std::max(farthest, handle.motion.translation.norm() / shape.size());
  }
  const Deformation deformation = deformer.solve(motions, 5);
  const Points moved = vertex_displacements(subspace, deformation.state);
  ASSERT_TRUE(moved.allFinite());
  EXPECT_LT(moved.rowwise().norm().maxCoeff(), 100 * farthest * shape.size());
  Mesh edited = mesh;
  edited.vertices += moved;
  RunContext context;
  const SymmetryReport report = symmetry_residual(mesh, shape.model.truth, &edited, CarriedMotions::floating, context);
  EXPECT_LE(report.worst_excess, kExact * farthest + rounding);
}

class Scales : public testing::TestWithParam<double> {};

TEST_P(Scales, OfAnySizeEditsAreExact) {
  const PlacedTable shape(GetParam());
  expect_exact(shape, {shape.at(0, {0.1, 0.05, 0}), shape.at(shape.vertices() - 1, {0, 0, 0})}, 100);
}

INSTANTIATE_TEST_SUITE_P(Numerics, Scales, testing::Values(1e-9, 1e-3, 1e3, 1e9));

class Offsets : public testing::TestWithParam<double> {};

// What a coordinate of so many diagonals can still tell apart is what the result is symmetric to.
TEST_P(Offsets, FarFromTheOriginOnlyTheDigitsAreFewer) {
  const PlacedTable shape(1, GetParam());
  const double rounding = 16 * GetParam() * std::numeric_limits<double>::epsilon();
  expect_exact(shape, {shape.at(0, {0.1, 0.05, 0}), shape.at(shape.vertices() - 1, {0, 0, 0})}, 100, rounding);
}

INSTANTIATE_TEST_SUITE_P(Numerics, Offsets, testing::Values(1e3, 1e6));

class Weights : public testing::TestWithParam<double> {};

TEST_P(Weights, OfAnyWeightHandlesKeepTheSymmetry) {
  const PlacedTable shape;
  expect_exact(shape, {shape.at(0, {0.1, 0.05, 0}), shape.at(shape.vertices() - 1, {0, 0, 0})}, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Numerics, Weights, testing::Values(1e-12, 1e-6, 1, 1e6, 1e12));

TEST(HardHandles, AllOnTheAxis) {
  const PlacedTable shape;
  std::vector<Handle> handles;
  const Eigen::Vector3d centre = shape.model.truth.regions.front().centre;
  for (int v = 0; v < shape.vertices(); ++v) {
    const Eigen::RowVector3d point = shape.model.mesh.vertices.row(v);
    if ((point.head<2>().transpose() - centre.head<2>()).norm() > 1e-9 * shape.size()) continue;
    handles.push_back(shape.at(v, {0.1, 0.2, 0.3}, 1e-6));
  }
  ASSERT_FALSE(handles.empty());
  expect_exact(shape, handles, 100);
}

// Two handles of the same vertices that are to go opposite ways.
TEST(HardHandles, Contradictory) {
  const PlacedTable shape;
  expect_exact(shape, {shape.at(0, {1, 0, 0}), shape.at(0, {-1, 0, 0}), shape.at(0, {0, 1, 0})}, 1e6);
}

TEST(HardHandles, Thousands) {
  const PlacedTable shape;
  std::vector<Handle> handles;
  for (int v = 0; v < shape.vertices() && handles.size() < 3000; v += 2) {
    Handle handle;
    handle.vertices = {v};
    handle.motion.translation = 0.1 * shape.size() * Eigen::Vector3d(std::sin(v), std::cos(3 * v), std::sin(7 * v));
    handles.push_back(handle);
  }
  expect_exact(shape, handles, 100);
}

TEST(HardHandles, FarAway) {
  const PlacedTable shape;
  expect_exact(shape, {shape.at(0, {1e6, 0, 0}), shape.at(shape.vertices() - 1, {0, 0, 0})}, 100);
}

TEST(HardRadius, LargerThanTheShape) {
  const PlacedTable shape;
  SubspaceOptions options;
  options.radius = 100 * shape.size();
  expect_exact(shape, {shape.at(0, {0.1, 0.05, 0})}, 100, 0, options);
}

// So many samples would be needed that the radius is refused, by what it asks for.
TEST(HardRadius, SmallerThanAnEdge) {
  const PlacedTable shape;
  for (const double radius : {1e-4, 1e-12, 1e-300}) {
    SubspaceOptions options;
    options.radius = radius * shape.size();
    try {
      build_subspace(shape.model.mesh, shape.model.truth, options, RunContext{});
      ADD_FAILURE() << radius << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("samples are needed; take a larger radius"), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace orbifit
