#include "orbifit/fitting/placement.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/errors.h"

#include "base/random.h"
#include "cases/fit_cases.h"
#include "geometry/surface_index.h"

namespace orbifit {
namespace {

// Mean distance of the vertices posed by one from the surface posed by the other: no symmetry of the mesh counts.
double surface_apart(const Mesh& mesh, const Similarity& a, const Similarity& b) {
  const SurfaceIndex surface(mesh);
  const Similarity back = inverse(b);
  double sum = 0;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    sum += surface.nearest(back(a(mesh.vertices.row(v)))).distance;
  }
  return sum / static_cast<double>(mesh.vertices.rows()) / diagonal(mesh.vertices);
}

void move(PointCloud& scan, const Similarity& pose) {
  for (Points* points : {&scan.points, &scan.viewpoints}) {
    for (Eigen::Index i = 0; i < points->rows(); ++i) points->row(i) = pose(points->row(i).transpose()).transpose();
  }
}

struct Sight {
  const char* model;
  int views;
  double outliers, clutter;
  bool viewpoints;

  friend void PrintTo(const Sight& sight, std::ostream* stream) {
    *stream << sight.model << sight.views << (sight.clutter > 0 ? "Cluttered" : "")
            << (sight.viewpoints ? "" : "WithoutViewpoints");
  }
};

class Placed : public testing::TestWithParam<Sight> {
 protected:
  Placed() : model_(generate(GetParam().model)) {
    ScanOptions options;
    options.views = GetParam().views;
    options.elevation = 30;
    options.noise = 0.002;
    options.outliers = GetParam().outliers;
    options.clutter = GetParam().clutter;
    scan_ = virtual_scan(model_.mesh, options, context_);
    Random random(7, GetParam().model);
    pose_ = {std::pow(10, random.uniform(-2, 2)), random.rotation(), 20 * random.direction()};
    move(scan_, pose_);
    if (!GetParam().viewpoints) scan_.viewpoints.resize(0, 3);
  }

  RunContext context_;
  GeneratedModel model_;
  PointCloud scan_;
  Similarity pose_;
};

TEST_P(Placed, IsWhereItWasPut) {
  const std::vector<Placement> found = find_placements(model_.mesh, model_.truth, scan_, {}, context_);
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(std::ranges::is_sorted(found, std::greater<>(), &Placement::score));
  EXPECT_LT(std::abs(std::log(found.front().pose.scale / pose_.scale)), 0.05);
  EXPECT_LT(surface_apart(model_.mesh, found.front().pose, pose_), 0.015);
}

TEST_P(Placed, IsTheSameWithThreeThreads) {
  PlacementOptions few;
  few.pairs = 300;
  RunContext three;
  three.threads = 3;
  const std::vector<Placement> a = find_placements(model_.mesh, model_.truth, scan_, few, context_);
  const std::vector<Placement> b = find_placements(model_.mesh, model_.truth, scan_, few, three);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].pose.linear, b[i].pose.linear);
    EXPECT_EQ(a[i].pose.translation, b[i].pose.translation);
    EXPECT_EQ(a[i].score(), b[i].score());
  }
}

INSTANTIATE_TEST_SUITE_P(Scans, Placed,
                         testing::Values(Sight{"chair", 1, 0, 0, true}, Sight{"chair", 2, 0.05, 0.3, true},
                                         Sight{"table", 3, 0, 0, true}, Sight{"armchair", 2, 0.05, 0.3, true},
                                         Sight{"desk_fan", 3, 0.05, 0, false}),
                         [](const auto& each) { return testing::PrintToString(each.param); });

TEST(Placement, SymmetricPosesAreOneAnswer) {
  RunContext context;
  const GeneratedModel table = generate("table");
  ScanOptions options;
  options.views = 3;
  const std::vector<Placement> found =
      find_placements(table.mesh, table.truth, virtual_scan(table.mesh, options, context), {}, context);
  ASSERT_FALSE(found.empty());
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_GT(surface_apart(table.mesh, found[i].pose, found.front().pose), 0.002)
        << "a table turned by a quarter is the same table";
  }
}

TEST(Placement, AGivenPoseIsTriedAsWell) {
  RunContext context;
  const GeneratedModel chair = generate("chair");
  const PointCloud scan = virtual_scan(chair.mesh, {}, context);
  PlacementOptions none;
  none.pairs = 1;
  const std::vector<Placement> found = find_placements(chair.mesh, chair.truth, scan, none, context, Similarity{});
  ASSERT_FALSE(found.empty());
  EXPECT_LT(surface_apart(chair.mesh, found.front().pose, Similarity{}), 0.01);
}

class PlacedBySymmetry : public testing::TestWithParam<const char*> {};

TEST_P(PlacedBySymmetry, WhereNoFeatureIsLookedAt) {
  RunContext context;
  const GeneratedModel model = generate(GetParam());
  ScanOptions options;
  options.azimuth = 80;
  options.elevation = 30;
  PointCloud scan = virtual_scan(model.mesh, options, context);
  Random random(9, GetParam());
  const Similarity pose{0.2, random.rotation(), 3 * random.direction()};
  move(scan, pose);
  PlacementOptions none;
  none.pairs = none.proposals = 1;
  const auto found_with = [&](const SymmetryAnnotation& annotation) {
    const std::vector<Placement> found = find_placements(model.mesh, annotation, scan, none, context);
    return !found.empty() && surface_apart(model.mesh, found.front().pose, pose) < 0.015;
  };
  EXPECT_TRUE(found_with(model.truth));
  EXPECT_FALSE(found_with(empty_annotation(model.mesh, 0.005)));
}

INSTANTIATE_TEST_SUITE_P(Models, PlacedBySymmetry, testing::Values("chair", "armchair", "fan"));

TEST(PlacementOptions, RefuseWhatMakesNoSense) {
  const auto refused = [](auto spoil) {
    PlacementOptions options;
    spoil(options);
    EXPECT_THROW(options.validate(), UsageError);
  };
  refused([](PlacementOptions& o) { o.pairs = 0; });
  refused([](PlacementOptions& o) { o.proposals = 0; });
  refused([](PlacementOptions& o) { o.refined = 0; });
  refused([](PlacementOptions& o) { o.scan_points = 9; });
  refused([](PlacementOptions& o) { o.reach = 0; });
  refused([](PlacementOptions& o) { o.reach = 0.2; });
  refused([](PlacementOptions& o) { o.min_scale = 0; });
  refused([](PlacementOptions& o) { o.max_scale = o.min_scale; });
}

}  // namespace
}  // namespace orbifit
