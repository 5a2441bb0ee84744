#include "support/orbit_region.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr double kOrbitTolerance = 0.004;

/// A mesh made ready, with the regions of groups that are given in the mesh's own frame.
class Made {
 public:
  explicit Made(const Mesh& mesh) : prepared_(prepare(mesh)), whole_(prepared_.mesh) {}

  GroupPlacement placement(const std::string& symbol, const Vector3d& centre = Vector3d::Zero(),
                           const GroupFrame& frame = GroupFrame::Identity()) const {
    const Similarity& input = prepared_.input_of_normalised;
    return {*PointGroup::parse(symbol), frame, (centre - input.translation) / input.scale};
  }

  std::vector<int> symmetric(const GroupPlacement& placement) const {
    return symmetric_faces(prepared_, whole_, placement, kOrbitTolerance, context_);
  }

  std::vector<int> orbit(const GroupPlacement& placement, const std::vector<int>& seeds) const {
    return connected_orbit(prepared_, placement, symmetric(placement), seeds, kOrbitTolerance, context_);
  }

  // Whether every element carries every face onto the region.
  bool closed(const GroupPlacement& placement, const std::vector<int>& faces) const {
    const SurfaceIndex region(prepared_.mesh, faces);
    for (const Motion& motion : judged_motions(placement.group, placement.frame, placement.centre)) {
      for (const int face : faces) {
        Vector3d centroid = Vector3d::Zero();
        for (int k = 0; k < 3; ++k) centroid += prepared_.mesh.vertices.row(prepared_.mesh.faces(face, k)) / 3;
        if (region.nearest(motion(centroid)).distance > kOrbitTolerance) return false;
      }
    }
    return true;
  }

  const PreparedMesh& prepared() const { return prepared_; }

 private:
  PreparedMesh prepared_;
  SurfaceIndex whole_;
  RunContext context_;
};

std::vector<int> numbers(int first, int count) {
  std::vector<int> result(static_cast<std::size_t>(count));
  std::iota(result.begin(), result.end(), first);
  return result;
}

struct PrismCase {
  std::string symbol;
  bool holds;  ///< whether the group permutes a hexagonal prism's faces
};

class HexagonalPrism : public testing::TestWithParam<PrismCase> {};

// A prism, and apart from it a lump without symmetry.
TEST_P(HexagonalPrism, IsFoundBesideWhatBreaksIt) {
  const Mesh prism = test::prism(6, 1, 1);
  const Mesh lump = test::moved(test::scalene(), test::shift(2.5, 1, 0.3));
  const Made made(test::joined({prism, lump}));
  const GroupPlacement placement = made.placement(GetParam().symbol);
  const std::vector<int> faces = made.symmetric(placement);
  if (!GetParam().holds) {
    EXPECT_TRUE(made.orbit(placement, {0}).empty()) << "a side";
    return;
  }
  EXPECT_EQ(faces, numbers(0, 20));
  EXPECT_TRUE(made.closed(placement, faces));
  EXPECT_EQ(made.orbit(placement, {0}), faces);
  EXPECT_TRUE(made.orbit(placement, {20}).empty()) << "a face of the lump";
}

INSTANTIATE_TEST_SUITE_P(Groups, HexagonalPrism,
                         testing::Values(PrismCase{"Cs", true}, PrismCase{"Ci", true}, PrismCase{"C2", true},
                                         PrismCase{"C3", true}, PrismCase{"C6", true}, PrismCase{"C6v", true},
                                         PrismCase{"C6h", true}, PrismCase{"D3d", true}, PrismCase{"D6", true},
                                         PrismCase{"D6h", true}, PrismCase{"S6", true}, PrismCase{"C4", false},
                                         PrismCase{"C5v", false}, PrismCase{"Dinfh", false}, PrismCase{"Oh", false}),
                         [](const auto& test) { return test.param.symbol; });

// A turned body: round about the axis only, the sphere's group fails.
TEST(SymmetricFaces, OfContinuousGroupsAllowForFacets) {
  const Made made(test::prism(48, 1, 2));
  EXPECT_EQ(made.symmetric(made.placement("Dinfh")).size(),
            static_cast<std::size_t>(made.prepared().mesh.faces.rows()));
  EXPECT_TRUE(made.symmetric(made.placement("Kh")).empty());
}

// Four pegs around an axis, one of them missing, on no plate at all: each pair of opposite pegs counts for itself.
TEST(SymmetricFaces, MustHaveTheirImagesToo) {
  const Mesh peg = test::moved(test::box(0.2, 0.2, 0.5), test::shift(1, 0, 0));
  std::vector<Mesh> parts;
  for (const int quarter : {0, 1, 2}) {
    parts.push_back(test::moved(peg, Motion::rotation({0, 0, 1}, quarter * std::numbers::pi / 2, {0, 0, 0})));
  }
  const Made made(test::joined(parts));
  EXPECT_TRUE(made.symmetric(made.placement("C4")).empty());
  std::vector<int> pair = numbers(0, 12);
  for (const int face : numbers(24, 12)) pair.push_back(face);
  EXPECT_EQ(made.symmetric(made.placement("C2")), pair);
}

// One quad of a wall reaches twice as far as its mirror image.
TEST(SymmetricFaces, LeavesOutACoarseTriangleOfWhichAPartIsSymmetric) {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  mesh.vertices << -1, 0, 0, 0, 0, 0, 2, 0, 0, -1, 1, 0, 0, 1, 0, 2, 1, 0, -1, 0, 1, 2, 0, 1;
  mesh.faces.resize(4, 3);
  mesh.faces << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4;
  const Made made(mesh);
  const GroupPlacement mirror = made.placement("Cs", Vector3d::Zero(), frame_about({1, 0, 0}));
  for (const int face : made.symmetric(mirror)) EXPECT_LT(face, 2) << "half of it has no image";
}

class Pegs : public testing::TestWithParam<int> {};

// Pegs in a ring, all alike, and a ring of smaller ones inside: a seed takes its own ring and not the other.
TEST_P(Pegs, OfTheSeedsRingAreTaken) {
  const int n = GetParam();
  std::vector<Mesh> parts;
  for (const double radius : {2.0, 1.0}) {
    const Mesh peg = test::moved(test::prism(5, 0.1 * radius, 0.4), test::shift(radius, 0, 0));
    for (int i = 0; i < n; ++i) {
      parts.push_back(test::moved(peg, Motion::rotation({0, 0, 1}, 2 * std::numbers::pi * i / n, {0, 0, 0})));
    }
  }
  parts.push_back(test::moved(test::scalene(), test::shift(5, 5, 5)));
  const Made made(test::joined(parts));
  const auto faces_of_peg = static_cast<int>(parts.front().faces.rows());
  const GroupPlacement placement = made.placement("C" + std::to_string(n));
  EXPECT_EQ(made.symmetric(placement), numbers(0, 2 * n * faces_of_peg));
  EXPECT_EQ(made.orbit(placement, {3}), numbers(0, n * faces_of_peg));
  EXPECT_EQ(made.orbit(placement, {n * faces_of_peg + 1}), numbers(n * faces_of_peg, n * faces_of_peg));
  EXPECT_EQ(made.orbit(placement, {3, n * faces_of_peg}), numbers(0, 2 * n * faces_of_peg));
}

INSTANTIATE_TEST_SUITE_P(Orders, Pegs, testing::Values(2, 3, 4, 7, 12));

TEST(OrbitRegion, IsTheSameForAnyNumberOfThreads) {
  const Made made(test::joined({test::prism(6, 1, 1), test::moved(test::box(1, 1, 1), test::shift(3, 0, 0))}));
  RunContext three;
  three.threads = 3;
  const SurfaceIndex whole(made.prepared().mesh);
  const GroupPlacement placement = made.placement("C6v");
  EXPECT_EQ(symmetric_faces(made.prepared(), whole, placement, kOrbitTolerance, three), made.symmetric(placement));
}

}  // namespace
}  // namespace orbifit
