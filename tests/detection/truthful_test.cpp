// Faces beyond the tolerance leave regions.

#include "evidence/truthful.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "domains/region_residual.h"
#include "shapes.h"

namespace orbifit {
namespace {

SymmetryAnnotation with_region(const Mesh& mesh, const Region& region) {
  SymmetryAnnotation annotation = empty_annotation(mesh, test::kTolerance);
  annotation.regions = {region};
  return annotation;
}

Region mirror(const std::vector<int>& faces) {
  return make_region(*PointGroup::parse("Cs"), Eigen::Vector3d::Zero(), frame_about(Eigen::Vector3d::UnitX()), faces,
                     "whole");
}

// A bar along x whose faces end in small ones; the vertex nearest to `at` is moved.
Mesh dented(const Eigen::Vector3d& at, const Eigen::Vector3d& by) {
  Mesh mesh = test::subdivided(test::box(2, 1, 1), 4);
  Eigen::Index nearest = 0;
  (mesh.vertices.rowwise() - at.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  const Eigen::RowVector3d place = mesh.vertices.row(nearest);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    if ((mesh.vertices.row(v) - place).norm() < 1e-9) mesh.vertices.row(v) += by.transpose();
  }
  return mesh;
}

TEST(Truthful, LeavesWhatIsWithinTheTolerance) {
  const Mesh mesh = dented({0.5, 0, 0.5}, {0, 0, 0.004});  // 0.16 % of the diagonal
  SymmetryAnnotation annotation = with_region(mesh, mirror(test::all_faces(mesh)));
  EXPECT_FALSE(make_truthful(prepare(mesh), annotation, nullptr, {}));
  EXPECT_EQ(annotation.regions.at(0).faces.size(), static_cast<std::size_t>(mesh.faces.rows()));
}

class Dent : public testing::TestWithParam<double> {};

TEST_P(Dent, AndItsImageAreTakenOut) {
  const Mesh mesh = dented({0.5, 0, 0.5}, {0, 0, GetParam()});
  SymmetryAnnotation annotation = with_region(mesh, mirror(test::all_faces(mesh)));
  const PreparedMesh prepared = prepare(mesh);
  ASSERT_TRUE(make_truthful(prepared, annotation, nullptr, {}));
  ASSERT_EQ(annotation.regions.size(), 1U);
  const std::vector<int>& left = annotation.regions[0].faces;
  EXPECT_GT(left.size(), 0.9 * static_cast<double>(mesh.faces.rows()));
  const Points middles = face_centroids(mesh);
  const auto missing_at = [&](double x) {
    int count = 0;
    for (int f = 0; f < mesh.faces.rows(); ++f) {
      const bool near = (middles.row(f) - Eigen::RowVector3d(x, 0, 0.5)).norm() < 0.2;
      if (near && !std::ranges::binary_search(left, f)) ++count;
    }
    return count;
  };
  EXPECT_GT(missing_at(0.5), 0);
  EXPECT_GT(missing_at(-0.5), 0) << "the dent's image has no image there";
  measure_residuals(prepared, annotation, {});
  EXPECT_LE(annotation.regions[0].residual.max, test::kTolerance);
  EXPECT_FALSE(make_truthful(prepared, annotation, nullptr, {}));
}

INSTANTIATE_TEST_SUITE_P(OutwardsAndInwards, Dent, testing::Values(0.08, -0.08));

TEST(Truthful, DropsWhatUnravels) {
  const Mesh mesh = test::subdivided(test::box(2, 1, 1), 4);
  Region region = mirror(test::all_faces(mesh));
  region = make_region(region.group, {0.3, 0, 0}, frame_about(Eigen::Vector3d::UnitX()), region.faces, "whole");
  SymmetryAnnotation annotation = with_region(mesh, region);
  Explanation explanation;
  EXPECT_TRUE(make_truthful(prepare(mesh), annotation, &explanation, {}));
  EXPECT_TRUE(annotation.regions.empty());
  ASSERT_EQ(explanation.notes.size(), 1U);
  EXPECT_FALSE(explanation.notes[0].kept);
}

TEST(RegionResidual, OfFacetsIsLessTheirSagitta) {
  // Of twelve facets the sagitta is 3.4 % of the radius.
  const Mesh mesh = test::prism(12, 1, 1);
  const SurfaceIndex index(mesh);
  const double size = diagonal(mesh.vertices);
  const Region round = make_region(*PointGroup::parse("Dinfh"), Eigen::Vector3d::Zero(), GroupFrame::Identity(),
                                   test::all_faces(mesh), "round");
  EXPECT_LT(region_residual(mesh, index, round, test::kTolerance, size, {}).max, 2e-3);
  const Region turned = make_region(*PointGroup::parse("C8"), Eigen::Vector3d::Zero(), GroupFrame::Identity(),
                                    test::all_faces(mesh), "turned");
  const double sagitta = (1 - std::cos(std::numbers::pi / 12)) / size;
  EXPECT_NEAR(region_residual(mesh, index, turned, test::kTolerance, size, {}).max, sagitta, 0.2 * sagitta);
  Region off = round;
  off.centre = {0.1, 0, 0};
  EXPECT_GT(region_residual(mesh, index, off, test::kTolerance, size, {}).max, 0.03);
}

}  // namespace
}  // namespace orbifit
