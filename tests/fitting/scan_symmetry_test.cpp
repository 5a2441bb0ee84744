#include "placement/scan_symmetry.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"

#include "base/random.h"
#include "registration/alignment.h"

namespace orbifit {
namespace {

PreparedScan prepared(const PointCloud& scan, const RunContext& context) {
  ScanPreparationOptions options;
  options.most_points = 4000;
  options.evenly = false;
  return prepare_scan(scan, options, context);
}

std::vector<SymmetryElement> found_in(const PointCloud& cloud, const RunContext& context) {
  const PreparedScan scan = prepared(cloud, context);
  std::vector<int> order(static_cast<std::size_t>(scan.points.rows()));
  std::iota(order.begin(), order.end(), 0);
  Random random(3);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return scan_symmetries(scan, order, SeenSurface(cloud, scan.points), diagonal(scan.points), context);
}

struct Seen {
  const char* model;  // its plane x = 0 is a mirror
  double clutter;
  bool viewpoints;

  friend void PrintTo(const Seen& seen, std::ostream* stream) {
    *stream << seen.model << (seen.clutter > 0 ? "Cluttered" : "") << (seen.viewpoints ? "" : "WithoutViewpoints");
  }
};

class ScanMirror : public testing::TestWithParam<Seen> {};

TEST_P(ScanMirror, ShowsFromItsPlane) {
  RunContext context;
  ScanOptions options;
  options.azimuth = 90;
  options.elevation = 25;
  options.noise = 0.001;
  options.clutter = GetParam().clutter;
  PointCloud scan = virtual_scan(generate(GetParam().model).mesh, options, context);
  Random random(11, GetParam().model);
  const Similarity pose{0.3, random.rotation(), 5 * random.direction()};
  scan.points = from_template(pose, scan.points);
  scan.viewpoints = GetParam().viewpoints ? from_template(pose, scan.viewpoints) : Points(0, 3);
  const Eigen::Vector3d truth = pose.linear.col(0);
  const double size = diagonal(scan.points);
  const std::vector<SymmetryElement> found = found_in(scan, context);
  const auto right = [&](const SymmetryElement& each) {
    return each.kind == SymmetryElement::Kind::plane && std::abs(each.direction.dot(truth)) > 0.99 &&
           std::abs(each.direction.dot(each.point - pose.translation)) < 0.02 * size;
  };
  EXPECT_TRUE(std::ranges::any_of(found, right)) << "of " << found.size();
  for (const SymmetryElement& each : found) {
    EXPECT_NEAR(each.direction.norm(), 1, 1e-12);
    EXPECT_GT(each.support, 0);
    EXPECT_LE(each.support, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Scans, ScanMirror,
                         testing::Values(Seen{"chair", 0, true}, Seen{"chair", 0.3, true}, Seen{"armchair", 0, false},
                                         Seen{"desk_fan", 0, true}),
                         [](const auto& each) { return testing::PrintToString(each.param); });

// Points over the angles from -range to range of a vase about the z axis.
PointCloud vase(double range, int count, double noise) {
  Random random(17);
  PointCloud result;
  result.points.resize(count, 3);
  for (auto point : result.points.rowwise()) {
    const double height = random.uniform(0, 1);
    const double angle = random.uniform(-range, range);
    const double radius = 0.25 + 0.08 * std::sin(5 * height) + noise * random.normal();
    point << radius * std::cos(angle), radius * std::sin(angle), height;
  }
  return result;
}

class ScanAxis : public testing::TestWithParam<double> {};

TEST_P(ScanAxis, ShowsOnOneSide) {
  RunContext context;
  PointCloud scan = vase(GetParam(), 3000, 0.001);
  Random random(19);
  const Similarity pose{20, random.rotation(), 100 * random.direction()};
  scan.points = from_template(pose, scan.points);
  const std::vector<SymmetryElement> found = found_in(scan, context);
  const auto right = [&](const SymmetryElement& each) {
    return each.kind == SymmetryElement::Kind::axis && std::abs(each.direction.dot(pose.linear.col(2))) > 0.995 &&
           each.direction.cross(each.point - pose.translation).norm() < 0.02 * diagonal(scan.points);
  };
  EXPECT_TRUE(std::ranges::any_of(found, right)) << "of " << found.size();
}

INSTANTIATE_TEST_SUITE_P(Ranges, ScanAxis, testing::Values(1.0, 1.4, 3.1));

TEST(ScanSymmetries, OfAFloorAreNone) {
  RunContext context;
  Random random(5);
  PointCloud floor;
  floor.points.resize(2000, 3);
  for (auto point : floor.points.rowwise()) point << random.uniform(-1, 1), random.uniform(-1, 1), 0;
  EXPECT_TRUE(found_in(floor, context).empty());
}

TEST(ScanSymmetries, AreTheSameWithThreeThreads) {
  RunContext context;
  const PointCloud scan = virtual_scan(generate("chair").mesh, {}, context);
  const std::vector<SymmetryElement> one = found_in(scan, context);
  context.threads = 3;
  const std::vector<SymmetryElement> three = found_in(scan, context);
  ASSERT_EQ(one.size(), three.size());
  ASSERT_FALSE(one.empty());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].point, three[i].point);
    EXPECT_EQ(one[i].direction, three[i].direction);
    EXPECT_EQ(one[i].support, three[i].support);
  }
}

}  // namespace
}  // namespace orbifit
