#include <vector>

#include <gtest/gtest.h>

#include "orbifit/fitting/fit.h"

#include "cases/fit_cases.h"
#include "stage_clock.h"
#include "start/fit_starts.h"

namespace orbifit {
namespace {

// A chair in any pose among other things, of which a vertex and its place in the scan are told for some.
class ChairByLandmarks : public testing::Test {
 protected:
  ChairByLandmarks() : case_(fit_case(fit_families().front(), FitLevel::anywhere, context_)) {
    options_.place = true;
    context_.on_message = [this](std::string_view text) { messages_ += std::string(text) + "\n"; };
  }

  FitResult fitted(const std::vector<int>& vertices, int wrong) {
    FitInput input{case_.model.mesh, case_.model.truth, case_.scan, Similarity{}};
    for (const int vertex : vertices) {
      Eigen::Vector3d target = case_.truth.vertices.row(vertex);
      if (static_cast<int>(input.landmarks.size()) < wrong) {
        target += 0.5 * diagonal(case_.truth.vertices) * Eigen::Vector3d(0.6, -0.8, 0);
      }
      input.landmarks.push_back({vertex, target});
    }
    return fit(input, options_, context_);
  }

  double hidden(const FitResult& result) const { return score_fit(case_, result.fitted, context_).hidden; }

  RunContext context_;
  FitCase case_;
  FitOptions options_;
  std::string messages_;
};

TEST_F(ChairByLandmarks, IsFittedAsWithoutThem) {
  const FitResult found = fitted({}, 0);
  const FitResult told = fitted({20, 2000, 5000, 9000}, 0);
  ASSERT_TRUE(told.converged) << told.stopped_because;
  EXPECT_TRUE(told.placements.empty()) << "the landmarks say the pose";
  EXPECT_LT(hidden(told), 1.2 * hidden(found) + 1e-4);
  EXPECT_GT(told.overlap, 0.5);
  EXPECT_LT(told.overlap, 0.9);
  for (const LandmarkAgreement& each : told.landmarks) {
    EXPECT_FALSE(each.left_out);
    EXPECT_LT(each.residual, 0.02);
  }
  EXPECT_EQ(messages_, "");
}

TEST_F(ChairByLandmarks, LeavesOutAndNamesTheOneThatContradictsTheOthers) {
  const FitResult told = fitted({700, 20, 2000, 5000, 9000}, 1);
  const FitResult right = fitted({20, 2000, 5000, 9000}, 0);
  ASSERT_EQ(told.landmarks.size(), 5U);
  EXPECT_TRUE(told.landmarks[0].left_out);
  EXPECT_NEAR(told.landmarks[0].residual, 0.5, 0.03);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_FALSE(told.landmarks[i].left_out) << i;
  EXPECT_NE(messages_.find("landmarks[0]"), std::string::npos) << messages_;
  EXPECT_EQ(told.fitted.vertices, right.fitted.vertices);
}

TEST_F(ChairByLandmarks, SeeksThePoseWhereTheScanContradictsThem) {
  const FitResult told = fitted({20, 2000, 5000}, 1);
  ASSERT_TRUE(told.converged) << told.stopped_because;
  EXPECT_TRUE(told.landmarks[0].left_out);
  EXPECT_LT(hidden(told), 0.005);
}

TEST_F(ChairByLandmarks, SeeksThePoseThatOneLandmarkDoesNotDetermine) {
  const FitResult told = fitted({20}, 0);
  ASSERT_TRUE(told.converged) << told.stopped_because;
  EXPECT_FALSE(told.placements.empty());
  EXPECT_LT(told.landmarks[0].residual, 0.12);
}

// Those of another shape would put the template aside.
TEST(Landmarks, DoNotDecideAPoseThatIsKnown) {
  RunContext context;
  const FitCase each = fit_case(fit_families().front(), FitLevel::one_view, context);
  FitInput input{each.model.mesh, each.model.truth, each.scan, each.pose};
  for (const int vertex : {20, 2000, 5000, 9000}) {
    input.landmarks.push_back({vertex, each.truth.vertices.row(vertex).transpose()});
  }
  std::vector<StageTime> times;
  StageClock clock(times);
  FitOptions options;
  for (const bool known : {true, false}) {
    options.align = !known;
    const Similarity pose = find_starts(input, options, false, context, clock).places.front().pose;
    EXPECT_EQ(known, pose.scale == input.pose.scale && pose.linear == input.pose.linear &&
                         pose.translation == input.pose.translation);
  }
  options.align = false;
  const FitResult result = fit(input, options, context);
  EXPECT_TRUE(result.converged) << result.stopped_because;
  EXPECT_LT(score_fit(each, result.fitted, context).hidden, 0.001);
  for (const LandmarkAgreement& told : result.landmarks) EXPECT_FALSE(told.left_out) << told.vertex;
}

}  // namespace
}  // namespace orbifit
