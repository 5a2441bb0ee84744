#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/fitting/fit.h"

#include "base/random.h"

namespace orbifit {
namespace {

Points moved(const Points& points, const Motion& motion) {
  return (points * motion.linear.transpose()).rowwise() + motion.translation.transpose();
}

// A chair seen from one side, and from the other after it has been moved.
class TwoScans : public testing::Test {
 protected:
  TwoScans()
      : template_(generate("chair")),
        truth_(generate("chair", {{"seat_width", 0.5}, {"seat_depth", 0.5}, {"leg_height", 0.5}})) {
    ScanOptions scanner;
    scanner.noise = 0.001;
    first_ = virtual_scan(truth_.mesh, scanner, context_);
    scanner.azimuth = 170;
    scanner.clutter = 0.2;
    second_ = virtual_scan(truth_.mesh, scanner, context_);
    moved_ = second_;
    moved_.points = moved(second_.points, move_);
    moved_.viewpoints = moved(second_.viewpoints, move_);
    context_.on_message = [this](std::string_view text) { messages_ += std::string(text) + "\n"; };
    options_.place = true;
  }

  FitResult fitted(const std::vector<const PointCloud*>& others) {
    FitInput input{template_.mesh, template_.truth, first_, Similarity{}};
    input.others = others;
    return fit(input, options_, context_);
  }

  double error(const FitResult& result) const {
    return (result.fitted.vertices - truth_.mesh.vertices).rowwise().norm().mean() / diagonal(truth_.mesh.vertices);
  }

  RunContext context_;
  GeneratedModel template_, truth_;
  PointCloud first_, second_, moved_;
  Motion move_ = Motion{axis_rotation(Eigen::Vector3d(1, 2, -1).normalized(), 2.2), {3, -1, 0.5}};
  FitOptions options_;
  std::string messages_;
};

TEST_F(TwoScans, InFramesOfTheirOwnAreFittedByOneShapeWithAPoseEach) {
  const FitResult one = fitted({});
  const FitResult two = fitted({&moved_});
  ASSERT_TRUE(two.converged) << two.stopped_because;
  ASSERT_EQ(two.others.size(), 1U);
  EXPECT_EQ(two.other_used, std::vector<char>{1});
  const Motion off = two.others[0] * move_;
  EXPECT_LT(motion_distance(off, Motion{}, bounding_box_centre(truth_.mesh.vertices), 0.5),
            0.01 * diagonal(truth_.mesh.vertices));
  EXPECT_LT(two.hidden_fraction, one.hidden_fraction - 0.1);
  EXPECT_LT(error(two), 0.01);
  EXPECT_LT(two.field_residual, 1e-12);
  EXPECT_LT(two.overlap, 0.97) << "clutter of the second scan goes";
}

TEST_F(TwoScans, InOneFrameAreFittedAsOneScan) {
  PointCloud both = first_;
  both.points.resize(first_.points.rows() + second_.points.rows(), 3);
  both.points << first_.points, second_.points;
  both.viewpoints.resize(both.points.rows(), 3);
  both.viewpoints << first_.viewpoints, second_.viewpoints;
  const FitResult two = fitted({&second_});
  const FitResult merged = fit({template_.mesh, template_.truth, both, Similarity{}}, options_, context_);
  EXPECT_LT(motion_distance(two.others[0], Motion{}, bounding_box_centre(truth_.mesh.vertices), 0.5),
            0.01 * diagonal(truth_.mesh.vertices));
  EXPECT_LT(error(two), error(merged) + 0.002);
}

TEST_F(TwoScans, AreTheSameWithTwoThreads) {
  const FitResult alone = fitted({&moved_});
  context_.threads = 2;
  const FitResult shared = fitted({&moved_});
  EXPECT_EQ(shared.fitted.vertices, alone.fitted.vertices);
}

TEST_F(TwoScans, OfWhichOneShowsNothingOfTheShapeNameIt) {
  PointCloud dust;
  dust.points = Points::Random(40, 3);
  const FitResult one = fitted({});
  const FitResult two = fitted({&dust});
  EXPECT_TRUE(two.converged) << two.stopped_because;
  EXPECT_EQ(two.other_used, std::vector<char>{0});
  EXPECT_NE(messages_.find("left out scan 2"), std::string::npos) << messages_;
  EXPECT_LT(error(two), error(one) + 0.003);
}

TEST_F(TwoScans, OfAKnownSizeAreFittedAtThatSize) {
  first_ = moved_;
  options_.fixed_scale = true;
  const FitResult found = fitted({});
  ASSERT_TRUE(found.converged) << found.stopped_because;
  EXPECT_EQ(found.pose.scale, 1);
  for (const Placement& placement : found.placements) EXPECT_NEAR(placement.pose.scale, 1, 1e-12);
  first_.points *= 1000;  // in other units it is not
  first_.viewpoints *= 1000;
  EXPECT_FALSE(fitted({}).converged);
}

}  // namespace
}  // namespace orbifit
