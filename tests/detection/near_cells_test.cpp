// What is near is always told; what is far, against exact distances.

#include "surface/near_cells.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

struct CellCase {
  std::string name;
  Mesh mesh;
  double reach;
};

class NearCellsOf : public testing::TestWithParam<CellCase> {
 protected:
  NearCellsOf()
      : prepared_(prepare(GetParam().mesh)),
        faces_{0, 1, 2},
        cells_(prepared_, faces_, GetParam().reach),
        exact_(prepared_.mesh, faces_) {}

  PreparedMesh prepared_;
  std::vector<int> faces_;  // some of the mesh
  NearCells cells_;
  SurfaceIndex exact_;
};

TEST_P(NearCellsOf, MayReachWhatIsWithinReach) {
  Random random(3, "near");
  const SurfaceSamples samples = sample_surface(prepared_.mesh, 4000, random, faces_);
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Vector3d way = Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    EXPECT_TRUE(cells_.may_reach(Vector3d(samples.points.row(i)) + 0.999 * GetParam().reach * way));
  }
}

TEST_P(NearCellsOf, DoNotReachWhatIsFar) {
  Random random(4, "far");
  const double cell = std::max(GetParam().reach, 0.01);  // no box is longer than the diagonal
  int far = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d place = 1.2 * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    if (exact_.within(place, 6 * cell)) continue;
    ++far;
    EXPECT_FALSE(cells_.may_reach(place)) << place.transpose();
  }
  EXPECT_GT(far, 4000);
}

TEST_P(NearCellsOf, ReachNothingOutsideTheBox) {
  for (const double far : {2.0, 1e9, 1e300, -1e9, std::nan("")}) EXPECT_FALSE(cells_.may_reach({far, 0, 0}));
}

INSTANTIATE_TEST_SUITE_P(Meshes, NearCellsOf,
                         testing::Values(CellCase{"box", test::box(1, 2, 3), 0.02},
                                         CellCase{"coarse", test::box(1, 1, 1), 0.05},
                                         CellCase{"fine", test::prism(7, 1, 2), 1e-6},
                                         CellCase{"scalene", test::scalene(), 0.03}),
                         [](const testing::TestParamInfo<CellCase>& of) { return of.param.name; });

TEST(NearCells, OfNoFacesReachNothing) {
  const PreparedMesh prepared = prepare(test::box(1, 1, 1));
  EXPECT_FALSE(NearCells(prepared, {}, 0.1).may_reach(Vector3d::Zero()));
}

}  // namespace
}  // namespace orbifit
