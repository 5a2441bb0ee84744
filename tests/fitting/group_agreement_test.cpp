#include "orbifit/fitting/group_agreement.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/fitting/fit.h"

#include "assessment/group_comparison.h"
#include "scan/scan_preparation.h"

namespace orbifit {
namespace {

// A table, as it is and with one leg elsewhere, scanned and fitted.
class Table : public testing::Test {
 protected:
  Table() : model_(generate("table")), truth_(model_.mesh) {
    options_.align = false;
    options_.judge_groups = true;
  }

  const Region& leg() const { return *std::ranges::find(model_.truth.regions, "leg 1", &Region::name); }

  void move_leg(double by) {
    const Eigen::RowVector3d way =
        by * diagonal(model_.mesh.vertices) * Eigen::RowVector3d(leg().centre.x(), leg().centre.y(), 0).normalized();
    for (const int vertex : vertices_of_faces(model_.mesh, leg().faces)) truth_.vertices.row(vertex) -= way;
  }

  FitResult fitted() {
    ScanOptions views;
    views.views = 5;
    views.elevation = 5;
    scan_ = virtual_scan(truth_, views, context_);
    return fit({model_.mesh, model_.truth, scan_, Similarity{}, {}, {}}, options_, context_);
  }

  const GroupAgreement& of(const FitResult& result, int region) const {
    return *std::ranges::find(result.groups, region, &GroupAgreement::region);
  }

  RunContext context_;
  GeneratedModel model_;
  Mesh truth_;
  PointCloud scan_;
  FitOptions options_;
};

TEST_F(Table, ItsOwnScanAgreesWithAllGroups) {
  const FitResult result = fitted();
  ASSERT_EQ(result.groups.size(), model_.truth.regions.size());
  for (const GroupAgreement& group : result.groups) {
    EXPECT_FALSE(group.disagrees) << group.region << ": " << group.disagreement;
    EXPECT_LT(group.disagreement, 0.006);
  }
  EXPECT_TRUE(result.dropped.empty());
}

// A scan that lies on the fit leaves no doubt, and stands for the fit without groups.
TEST_F(Table, ItsOwnScanIsJudgedWithoutAFreeFit) {
  scan_ = virtual_scan(truth_, {}, context_);
  const PreparedScan scan = prepare_scan(scan_, {}, context_);
  const auto own = agreement_beyond_doubt(truth_, model_.truth, scan, context_);
  ASSERT_TRUE(own);
  ASSERT_EQ(own->size(), model_.truth.regions.size());
  for (const GroupAgreement& group : *own) {
    EXPECT_FALSE(group.disagrees);
    EXPECT_LT(group.disagreement, 1e-9);
    EXPECT_EQ(group.free, group.held);
  }
  // Shifted in steps that the group of the whole does not keep.
  PreparedScan waved = scan;
  const double size = diagonal(truth_.vertices);
  for (auto point : waved.points.rowwise()) point.z() += (point.x() > 0 ? 0.002 : -0.002) * size;
  const auto off = agreement_beyond_doubt(truth_, model_.truth, waved, context_);
  ASSERT_TRUE(off);
  EXPECT_GT(off->front().held, 0.001);  // along legs the step is none
  EXPECT_LE(off->front().held, 0.0021);
  EXPECT_GT(off->front().disagreement, 0.0005);  // what a tilt does not take out
  move_leg(0.06);
  EXPECT_FALSE(agreement_beyond_doubt(truth_, model_.truth, scan, context_));
}

TEST_F(Table, AMovedLegDisagreesWithTheWholeButNotWithItsOwnGroup) {
  move_leg(0.06);
  const FitResult result = fitted();
  const GroupAgreement& whole = of(result, model_.truth.regions.front().id);
  EXPECT_TRUE(whole.disagrees) << whole.disagreement << " " << whole.held << " " << whole.free;
  EXPECT_FALSE(of(result, leg().id).disagrees) << of(result, leg().id).disagreement;
}

TEST_F(Table, RelaxingFollowsTheLegAndKeepsTheOtherGroups) {
  move_leg(0.06);
  const FitResult held = fitted();
  options_.drop_unsupported = true;
  options_.contacts = false;  // the scan's leg has slid along the board
  FitResult relaxed = fitted();
  EXPECT_EQ(std::ranges::count(relaxed.dropped, model_.truth.regions.front().id), 1);
  EXPECT_EQ(std::ranges::count(relaxed.dropped, leg().id), 0);
  EXPECT_EQ(relaxed.rest_annotation.regions.size() + relaxed.dropped.size(), model_.truth.regions.size());
  const auto error = [&](const FitResult& result) {
    return (result.fitted.vertices - truth_.vertices).rowwise().norm().mean() / diagonal(truth_.vertices);
  };
  EXPECT_LT(error(relaxed), 0.5 * error(held));
  EXPECT_LT(symmetry_residual(model_.mesh, relaxed.rest_annotation, &relaxed.fitted, CarriedMotions::moving, context_)
                .worst_excess,
            1e-9);
}

}  // namespace
}  // namespace orbifit
