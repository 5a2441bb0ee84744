#include "geometry/vertex_finder.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/motion.h"

#include "base/random.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kSide = 12;
constexpr double kTolerance = 1e-3;

// A square lattice, with the numbers of neighbours next to one another.
Points lattice() {
  Points result(kSide * kSide, 3);
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) result.row(kSide * i + j) << i, j, 0;
  }
  return result;
}

Points shuffled(Points points, Random& random) {
  for (Eigen::Index i = points.rows() - 1; i > 0; --i) {
    points.row(i).swap(points.row(static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(i + 1)))));
  }
  return points;
}

// Each point once more within the tolerance of itself, or as near as the least distance of which two may share a place.
Points doubled(const Points& points, double distance) {
  Points result(2 * points.rows(), 3);
  result << points, points.rowwise() + Eigen::RowVector3d(distance, 0, 0);
  return result;
}

struct Vertices {
  std::string name;
  Points points;
};

class Walks : public testing::TestWithParam<int> {
 protected:
  static Vertices vertices() {
    Random random(3, "vertices");
    switch (GetParam()) {
      case 0:
        return {"lattice", lattice()};
      case 1:
        return {"shuffled", shuffled(lattice(), random)};
      case 2:
        return {"doubled", doubled(lattice(), 0.5 * kTolerance)};
      case 3:
        return {"nearly doubled", doubled(lattice(), 1.5 * kTolerance)};
      default:
        return {"one", Points::Zero(1, 3)};
    }
  }
};

TEST_P(Walks, AnswerAsEachPlaceByItself) {
  const auto [name, points] = vertices();
  SCOPED_TRACE(name);
  VertexFinder finder(points, kTolerance);
  const double middle = 0.5 * (kSide - 1);
  const std::vector<Motion> motions{
      Motion{},
      Motion::rotation(Vector3d::UnitZ(), 1.5707963267948966, Vector3d(middle, middle, 0)),
      Motion::reflection(Vector3d::UnitX(), Vector3d(middle, 0, 0)),
      Motion{Eigen::Matrix3d::Identity(), Vector3d(3, -2, 0.9 * kTolerance)},
      Motion{Eigen::Matrix3d::Identity(), Vector3d(1, 0, 1.1 * kTolerance)},
      Motion::rotation(Vector3d(1, 2, 3).normalized(), 0.3, Vector3d::Zero()),
  };
  for (const bool prepared : {false, true}) {
    if (prepared) finder.prepare_walks();
    for (const Motion& motion : motions) {
      VertexFinder::Walk walk(finder);
      for (int v = 0; v < static_cast<int>(points.rows()); v += 1 + v % 3) {  // some are left out
        const Vector3d place = motion(points.row(v).transpose());
        EXPECT_EQ(walk.at(v, place), finder.at(place)) << v;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Vertices, Walks, testing::Range(0, 5));

TEST(VertexFinder, TellsOneFromSeveral) {
  const Points points = doubled(lattice(), 1.5 * kTolerance);
  const VertexFinder finder(points, kTolerance);
  EXPECT_EQ(finder.at({2, 3, 0}), 2 * kSide + 3);
  EXPECT_EQ(finder.at({2 + 0.75 * kTolerance, 3, 0}), VertexFinder::kSeveral);
  EXPECT_EQ(finder.at({2 + 1.5 * kTolerance, 3, 0}), kSide * kSide + 2 * kSide + 3);
  EXPECT_EQ(finder.at({2, 3.5, 0}), VertexFinder::kNone);
}

TEST(VertexGrid, VisitsWithinFourTolerances) {
  const Points points = lattice();
  const VertexGrid grid(points, 0.6);
  for (const double distance : {0.1, 0.6, 1.0, 1.5, 2.4}) {
    for (const Vector3d& place : {Vector3d(5, 5, 0), Vector3d(0.3, 7.7, 0.1), Vector3d(4.5, 11.2, -0.4)}) {
      int found = 0;
      grid.visit_within(place, distance, [&](int) { ++found; });
      const auto expected = ((points.rowwise() - place.transpose()).rowwise().norm().array() <= distance).count();
      EXPECT_EQ(found, expected) << distance;
    }
  }
}

}  // namespace
}  // namespace orbifit
