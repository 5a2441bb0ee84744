// Detail that a subspace is too coarse for is found in the scan, and nothing else.

#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/fitting/fit.h"

#include "basis/subspace_parts.h"
#include "deformation/surface_detail.h"
#include "geometry/exposure.h"

namespace orbifit {
namespace {

class Detail : public testing::TestWithParam<GroupMode> {
 protected:
  // The model with waves along its normals, as symmetric as it is, of a length and a height.
  Mesh embossed(double length, double height) {
    const double size = diagonal(template_.mesh.vertices);
    const Subspace subspace = build_subspace(template_.mesh, template_.truth, {}, context_);
    const SubspaceState rest{Eigen::VectorXd::Zero(subspace.degrees_of_freedom()), nullptr};
    const Points normals = vertex_normals(template_.mesh);
    Eigen::VectorXd heights(subspace->orbits.representatives());
    for (Eigen::Index r = 0; r < heights.size(); ++r) {
      const Eigen::RowVector3d place = subspace->orbits.positions.row(r) * (2 * std::numbers::pi / (length * size));
      heights[r] = height * size * (std::sin(place[0]) + std::sin(place[1]) + std::sin(place[2]));
    }
    const auto surface = std::make_shared<const SurfaceVectors>(template_.mesh);
    const DetailMap map = detail_map(subspace, rest, *surface, normals, context_);
    Mesh mesh = template_.mesh;
    mesh.vertices += vertex_displacements(
        subspace, {rest.q, nullptr, surface_detail(subspace, surface, map, normals, heights)}, context_);
    return mesh;
  }

  FitResult fitted(const Mesh& truth, double noise, bool detail) {
    ScanOptions scanner;
    scanner.noise = noise;
    scanner.views = 3;
    scanner.width = 480;
    scanner.height = 360;
    const PointCloud scan = virtual_scan(truth, scanner, context_);
    FitOptions options;
    options.subspace.mode = GetParam();
    options.refinements = 0;
    options.detail = detail;
    return fit({template_.mesh, template_.truth, scan, Similarity{}}, options, context_);
  }

  // Of the vertices that a scanner can see, along the truth's normals; fraction of the diagonal.
  double error(const FitResult& result, const Mesh& truth) const {
    const Exposure exposed(truth);
    const Points normals = vertex_normals(truth);
    double sum = 0, count = 0;
    for (Eigen::Index v = 0; v < truth.vertices.rows(); ++v) {
      if (!exposed(truth.vertices.row(v).transpose())) continue;
      sum += std::abs(normals.row(v).dot(result.fitted.vertices.row(v) - truth.vertices.row(v)));
      ++count;
    }
    return sum / count / diagonal(truth.vertices);
  }

  RunContext context_;
  GeneratedModel template_ = generate("armchair");
};

TEST_P(Detail, IsFoundAndExact) {
  const Mesh truth = embossed(0.05, 0.002);
  const FitResult coarse = fitted(truth, 0, false);
  const FitResult fine = fitted(truth, 0, true);
  ASSERT_TRUE(fine.converged) << fine.stopped_because;
  ASSERT_FALSE(fine.detail_levels.empty());
  EXPECT_TRUE(fine.detail_levels.front().kept);
  for (std::size_t i = 0; i + 1 < fine.detail_levels.size(); ++i) EXPECT_TRUE(fine.detail_levels[i].kept);
  for (const DetailLevel& level : fine.detail_levels) EXPECT_LE(level.kept, level.held_out < level.held_out_before);
  EXPECT_NE(fine.detail, nullptr);
  EXPECT_GT(fine.detail_rms, 0);
  EXPECT_LT(fine.rms, 0.5 * coarse.rms);
  EXPECT_LT(error(fine, truth), 0.6 * error(coarse, truth));
  EXPECT_LT(fine.field_residual, 1e-12);
  // Nothing else has changed.
  EXPECT_EQ((fine.q - coarse.q).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(coarse.detail, nullptr);
}

using DetailOfNoise = Detail;

TEST_P(DetailOfNoise, IsNone) {
  const FitResult coarse = fitted(template_.mesh, 0.002, false);
  const FitResult fine = fitted(template_.mesh, 0.002, true);
  EXPECT_LE(error(fine, template_.mesh), error(coarse, template_.mesh));
}

INSTANTIATE_TEST_SUITE_P(Modes, Detail, testing::Values(GroupMode::floating, GroupMode::moving));
INSTANTIATE_TEST_SUITE_P(Modes, DetailOfNoise, testing::Values(GroupMode::floating));

}  // namespace
}  // namespace orbifit
