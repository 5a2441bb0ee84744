#include "scan/seen_surface.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/surface_index.h"

namespace orbifit {
namespace {

// A wall of points at z = 0 that one viewpoint has seen, and a square held in front of it, at it, or behind it.
class Wall : public testing::Test {
 protected:
  Wall() {
    constexpr int kSide = 60;
    scan_.points.resize(kSide * kSide, 3);
    for (int i = 0; i < kSide; ++i) {
      for (int j = 0; j < kSide; ++j) scan_.points.row(i * kSide + j) << i / 29.5 - 1, j / 29.5 - 1, 0;
    }
    scan_.viewpoints.resize(1, 3);
    scan_.viewpoints << 0, 0, 4;
    square_.vertices.resize(4, 3);
    square_.vertices << -0.3, -0.3, 0, 0.3, -0.3, 0, 0.3, 0.3, 0, -0.3, 0.3, 0;
    square_.faces.resize(2, 3);
    square_.faces << 0, 1, 2, 0, 2, 3;
    Random random(2);
    samples_ = sample_surface(square_, 200, random);
  }

  static Similarity at(double height) { return {1, Eigen::Matrix3d::Identity(), {0, 0, height}}; }

  PointCloud scan_;
  Mesh square_;
  SurfaceSamples samples_;
  RunContext context_;
};

TEST_F(Wall, WhatStandsBeforeItShouldHaveBeenSeen) {
  const SeenSurface seen(scan_, scan_.points);
  const SurfaceIndex surface(square_);
  ASSERT_TRUE(seen.knows_viewpoints());
  EXPECT_EQ(seen.look(samples_, surface, at(1), 0.1, context_).missed.size(), 200U);
  EXPECT_EQ(seen.coverage(samples_, surface, at(1), 0.1).through, 200);
  EXPECT_EQ(seen.coverage(samples_, surface, at(1), 0.1).share(), 0);
}

// Where a view has nothing at all, that may have been cut off; where it has the wall, it saw through.
TEST_F(Wall, ThroughIsWhereSomethingFartherWasSeen) {
  const SurfaceIndex surface(square_);
  const auto through = [&](const PointCloud& scan) {
    const SeenSurface seen(scan, scan.points);
    const SeenSurface::Look found = seen.look(samples_, surface, at(1), 0.1, context_);
    EXPECT_EQ(found.missed.size(), 200U);
    EXPECT_EQ(found.seen, 0);
    return std::ranges::count(found.missed, true, &SeenSurface::Missed::through);
  };
  EXPECT_EQ(through(scan_), 200);
  PointCloud holed = scan_;
  std::vector<Eigen::Index> rim;
  for (Eigen::Index i = 0; i < scan_.points.rows(); ++i) {
    if (scan_.points.row(i).cwiseAbs().maxCoeff() > 0.7) rim.push_back(i);
  }
  holed.points = Points(scan_.points(rim, Eigen::all));
  EXPECT_EQ(through(holed), 0);
}

TEST_F(Wall, WhatLiesAtItWasSeen) {
  const SeenSurface seen(scan_, scan_.points);
  const SurfaceIndex surface(square_);
  EXPECT_TRUE(seen.look(samples_, surface, at(0), 0.1, context_).missed.empty());
  EXPECT_EQ(seen.look(samples_, surface, at(0), 0.1, context_).seen, 200);
  EXPECT_EQ(seen.coverage(samples_, surface, at(0), 0.1).share(), 1);
}

// Where little is missing the square may be too large; where much is, the scan has been cut.
TEST_F(Wall, WhatHasBeenCutOffIsNotMissed) {
  const SurfaceIndex surface(square_);
  const auto coverage_without = [&](double from) {
    PointCloud cut = scan_;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < scan_.points.rows(); ++i) {
      const bool around = scan_.points.row(i).cwiseAbs().maxCoeff() > 0.6;
      if (around || scan_.points(i, 0) < from) kept.push_back(i);
    }
    cut.points = Points(scan_.points(kept, Eigen::all));
    return SeenSurface(cut, cut.points).coverage(samples_, surface, at(0), 0.05);
  };
  const SeenSurface::Coverage few = coverage_without(0.24);
  EXPECT_GT(few.nothing, 0);
  EXPECT_EQ(few.cut_off(), 0);
  EXPECT_EQ(few.without_cut_off().share(), few.share());
  EXPECT_LT(few.share(), 1);
  const SeenSurface::Coverage half = coverage_without(0);
  EXPECT_GT(half.nothing, 50);
  EXPECT_EQ(half.seen + half.through + half.nothing, half.samples);
  EXPECT_DOUBLE_EQ(half.cut_off(), half.nothing / 200.0);
  EXPECT_LT(half.share(), 0.6);
  EXPECT_GT(half.without_cut_off().share(), 0.9);
}

TEST_F(Wall, WhatLiesBehindItIsHidden) {
  const SeenSurface seen(scan_, scan_.points);
  EXPECT_TRUE(seen.look(samples_, SurfaceIndex(square_), at(-1), 0.1, context_).missed.empty());
}

TEST_F(Wall, APointIsSeenThroughBeforeItAlone) {
  const SeenSurface seen(scan_, scan_.points);
  const auto through = [&](double x, double height) { return seen.through({x, 0.1, height}, 0.1); };
  EXPECT_TRUE(through(0.1, 1));
  EXPECT_TRUE(through(0.1, 0));
  EXPECT_FALSE(through(0.1, -0.5));
  EXPECT_FALSE(through(5, 1)) << "out of the picture";
}

TEST_F(Wall, WithoutViewpointsNothingIsMissed) {
  scan_.viewpoints.resize(0, 3);
  const SeenSurface seen(scan_, scan_.points);
  EXPECT_FALSE(seen.knows_viewpoints());
  EXPECT_TRUE(seen.look(samples_, SurfaceIndex(square_), at(1), 0.1, context_).missed.empty());
}

TEST_F(Wall, TheSquareHidesWhatStandsBehindIt) {
  Mesh both = square_;  // a smaller square behind the first, in front of the wall
  both.vertices.conservativeResize(8, 3);
  both.vertices.bottomRows(4) = 0.5 * square_.vertices;
  both.vertices.bottomRows(4).col(2).array() -= 0.5;
  both.faces.conservativeResize(4, 3);
  both.faces.bottomRows(2) = square_.faces.array() + 4;
  Random random(2);
  const SurfaceSamples behind = sample_surface(both, 100, random, {2, 3});
  const SeenSurface seen(scan_, scan_.points);
  EXPECT_TRUE(seen.look(behind, SurfaceIndex(both), at(1), 0.1, context_).missed.empty());
}

}  // namespace
}  // namespace orbifit
