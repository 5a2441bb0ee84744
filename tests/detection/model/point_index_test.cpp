#include "geometry/point_index.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

struct Cloud {
  const char* name;
  double scale;
  double offset;
  bool on_a_grid;  // many equal distances and repeated points

  friend void PrintTo(const Cloud& cloud, std::ostream* stream) { *stream << cloud.name; }
};

class Neighbours : public testing::TestWithParam<Cloud> {
 protected:
  Eigen::RowVector3d random_point() {
    Eigen::RowVector3d point;
    for (int k = 0; k < 3; ++k) {
      point[k] = GetParam().on_a_grid ? static_cast<double>(random_.below(7)) : random_.uniform();
    }
    return (point.array() + GetParam().offset) * GetParam().scale;
  }

  void SetUp() override {
    points_.resize(700, 3);
    for (int i = 0; i < 700; ++i) points_.row(i) = random_point();
  }

  // All points by distance, then number.
  std::vector<PointIndex::Neighbour> brute(const Eigen::Vector3d& query) const {
    std::vector<PointIndex::Neighbour> all;
    for (int i = 0; i < 700; ++i) all.push_back({i, (points_.row(i).transpose() - query).norm()});
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a.distance < b.distance || (a.distance == b.distance && a.index < b.index);
    });
    return all;
  }

  static void expect_equal(const std::vector<PointIndex::Neighbour>& found,
                           const std::vector<PointIndex::Neighbour>& expected, std::size_t count) {
    ASSERT_EQ(found.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(found[i].index, expected[i].index) << i;
      EXPECT_DOUBLE_EQ(found[i].distance, expected[i].distance);
    }
  }

  Random random_{4, GetParam().name};
  Points points_;
};

TEST_P(Neighbours, NearestAreTheFirstOfAll) {
  const PointIndex index(points_);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d query = random_point();
    const auto all = brute(query);
    for (const int count : {1, 2, 10, 100, 700, 900}) {
      expect_equal(index.nearest(query, count), all, static_cast<std::size_t>(std::min(count, 700)));
    }
  }
}

TEST_P(Neighbours, WithinIsInclusive) {
  const PointIndex index(points_);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d query = random_point();
    const auto all = brute(query);
    const double radius = all[random_.below(600)].distance;
    const auto count = static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [&](const auto& neighbour) { return neighbour.distance <= radius; }));
    expect_equal(index.within(query, radius), all, count);
  }
}

TEST_P(Neighbours, OneAloneIsTheFirst) {
  const PointIndex index(points_);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d query = random_point();
    const PointIndex::Neighbour nearest = index.nearest(query);
    expect_equal({nearest}, brute(query), 1);
    for (const double radius : {nearest.distance, nearest.distance * (1 - 1e-9), nearest.distance * 1.5}) {
      EXPECT_EQ(index.any_within(query, radius), !index.within(query, radius).empty()) << radius;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Clouds, Neighbours,
                         testing::Values(Cloud{"random", 1, 0, false}, Cloud{"grid", 1, 0, true},
                                         Cloud{"far", 1e3, 1e4, false}, Cloud{"tiny", 1e-100, 0, false},
                                         Cloud{"huge_grid", 0x1p300, 2, true}),
                         [](const auto& cloud) { return std::string(cloud.param.name); });

TEST(PointIndex, OfNothingFindsNothing) {
  const PointIndex index(Points(0, 3));
  EXPECT_TRUE(index.nearest({0, 0, 0}, 3).empty());
  EXPECT_TRUE(index.within({0, 0, 0}, 3).empty());
  EXPECT_EQ(index.nearest({0, 0, 0}).index, -1);
  EXPECT_FALSE(index.any_within({0, 0, 0}, 3));
}

TEST(PointIndex, AsksForNothingFindsNothing) {
  const PointIndex index(Points::Zero(1, 3));
  EXPECT_TRUE(index.nearest({0, 0, 0}, 0).empty());
  EXPECT_TRUE(index.within({0, 0, 0}, -1).empty());
  ASSERT_EQ(index.within({0, 0, 0}, 0).size(), 1U);
}

TEST(PointIndex, SortsManyPointsAtOnePlaceByNumber) {
  const PointIndex index(Points::Constant(500, 3, 0.1));
  const auto found = index.nearest({0.1, 0.1, 0.1}, 20);
  ASSERT_EQ(found.size(), 20U);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(found[static_cast<std::size_t>(i)].index, i);
    EXPECT_EQ(found[static_cast<std::size_t>(i)].distance, 0);
  }
}

}  // namespace
}  // namespace orbifit
