#include "orbifit/fitting/group_agreement.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/fitting/fit.h"

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
