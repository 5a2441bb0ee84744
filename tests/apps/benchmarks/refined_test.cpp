#include "refined.h"

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/symmetry_residual.h"

namespace orbifit::benchmarks {
namespace {

class Refined : public testing::TestWithParam<int> {};

TEST_P(Refined, KeepsSurfaceAndSymmetries) {
  const int n = GetParam();
  const GeneratedModel base = generate("chair");
  const GeneratedModel fine = refined(base, n);
  // A closed surface has V = F / 2 + chi, and cutting faces leaves chi as it is.
  const Eigen::Index euler = base.mesh.vertices.rows() - base.mesh.faces.rows() / 2;
  EXPECT_EQ(fine.mesh.faces.rows(), n * n * base.mesh.faces.rows());
  EXPECT_EQ(fine.mesh.vertices.rows(), fine.mesh.faces.rows() / 2 + euler);
  EXPECT_NEAR(face_areas(fine.mesh).sum(), face_areas(base.mesh).sum(), 1e-9 * face_areas(base.mesh).sum());
  EXPECT_NEAR((face_normals(fine.mesh).row(0) - face_normals(base.mesh).row(0)).norm(), 0, 1e-9);

  ASSERT_EQ(fine.truth.regions.size(), base.truth.regions.size());
  RunContext context;
  const SymmetryReport report = symmetry_residual(fine.mesh, fine.truth, nullptr, CarriedMotions::fixed, context);
  EXPECT_LT(report.worst_floor, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Cuts, Refined, testing::Values(1, 2, 3, 5));

}  // namespace
}  // namespace orbifit::benchmarks
