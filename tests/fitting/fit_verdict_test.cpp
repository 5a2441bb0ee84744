#include "orbifit/fitting/fit_verdict.h"

#include <algorithm>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"

#include "base/random.h"

namespace orbifit {
namespace {

bool tells(const std::vector<std::string>& verdict, const std::string& what) {
  return std::ranges::any_of(verdict,
                             [&](const std::string& sentence) { return sentence.find(what) != std::string::npos; });
}

class Verdict : public testing::Test {
 protected:
  Verdict() : model_(generate("table")) {
    result_.converged = true;
    result_.inlier_ratio = result_.confidence = 0.95;
  }

  std::vector<std::string> verdict() const { return fit_verdict(result_); }

  GeneratedModel model_;
  FitResult result_;
};

TEST_F(Verdict, OfAGoodFitIsOneSentence) {
  EXPECT_EQ(verdict(),
            std::vector<std::string>{"The fit explains the scan: 95 % of the points that were used lie on it."});
}

TEST_F(Verdict, FallsWithTheConfidence) {
  result_.confidence = 0.8;
  EXPECT_TRUE(tells(verdict(), "most of the scan"));
  result_.confidence = 0.5;
  EXPECT_TRUE(tells(verdict(), "doubtful"));
  result_.converged = false;
  result_.stopped_because = "only 25 % of the scan is explained";
  EXPECT_EQ(verdict().front(), "The fit failed: only 25 % of the scan is explained.");
}

TEST_F(Verdict, NamesWhatLowersTheConfidenceMost) {
  const Eigen::Matrix3d all = Eigen::Matrix3d::Identity();
  result_.confidence = 0.75;
  result_.open_stretches = {{all, 0, 0.2}};
  EXPECT_EQ(verdict().front(),
            "The fit explains most of the scan: 95 % of the points that were used lie on it. The confidence is 75 %, "
            "lowered most by its size, which the scan leaves open.");
  result_.open_poses = {{Motion{}, 0.3, {0, 0, 0}}};
  EXPECT_TRUE(tells(verdict(), "lowered most by its pose"));
  result_.inlier_ratio = 0.6;
  EXPECT_TRUE(tells(verdict(), "lowered most by points that do not lie on it"));
}

TEST_F(Verdict, SaysThatTheSizeIsTheTemplatesOwn) {
  EXPECT_FALSE(tells(verdict(), "own size"));
  result_.own_size = true;
  EXPECT_TRUE(tells(verdict(), "The template has kept its own size: the scan asks for no other."));
  result_.growth = -0.06;
  EXPECT_FALSE(tells(verdict(), "own size"));
  EXPECT_TRUE(tells(verdict(), "its deformed shape is 6 % smaller"));
}

TEST_F(Verdict, TellsWhatTheScanLeavesOpenOfTheSize) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  result_.open_stretches = {{Eigen::Matrix3d::Identity(), 0, 0.2},
                            {z * z.transpose(), 0.05, 0.1},
                            {Eigen::Matrix3d::Identity() - z * z.transpose(), 0.05, 0}};
  result_.fitted = model_.mesh;
  result_.fitted.vertices.col(2) *= 5;  // taller than wide
  EXPECT_EQ(verdict()[1],
            "The scan leaves the size open: all of it up to 20 % larger; its length, along (0, 0, 1), from 5 % smaller "
            "to 10 % larger; its girth about (0, 0, 1), up to 5 % smaller. Stretched so, it explains the scan as "
            "well.");
  EXPECT_EQ(verdict().size(), 2U);
}

TEST_F(Verdict, CallsDimensionsByTheirRank) {
  result_.fitted = model_.mesh;
  result_.fitted.vertices = model_.mesh.vertices * Eigen::Vector3d(5, 1, 0.05).asDiagonal();
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  for (const auto& [axis, name] :
       {std::pair{0, "its length, "}, std::pair{1, "its width, "}, std::pair{2, "its thickness, "}}) {
    result_.open_stretches = {{axes.col(axis) * axes.col(axis).transpose(), 0, 0.1}};
    EXPECT_TRUE(tells(verdict(), name)) << verdict()[1];
  }
}

TEST_F(Verdict, TellsWhichGroupsTheScanContradicts) {
  GroupAgreement group;
  group.disagrees = true;
  group.disagreement = 0.02;
  group.held = 0.01;
  group.free = 0.002;
  result_.groups = {group};
  const std::string sentence =
      "The scan contradicts the symmetry of region 0: fitted without it, places that are images of one another differ "
      "by "
      "2 % of the diagonal, and the scan lies 0.2 % from the fit in place of 1 %";
  EXPECT_EQ(verdict()[1], sentence + ".");
  result_.dropped = {0};
  EXPECT_EQ(verdict()[1], sentence + "; it was dropped.");
}

TEST_F(Verdict, TellsWhereToLookToTellPosesApart) {
  result_.open_poses = {{Motion{}, 0.2, {0, 0, 0.7}}};
  EXPECT_EQ(verdict()[1],
            "Another pose explains the scan as well. A view of where they differ most would tell them apart: around "
            "(0, 0, 0.7).");
  result_.open_poses.resize(5, {Motion{}, 0.1, {1, 2, 3}});
  EXPECT_EQ(verdict()[1],
            "5 other poses explain the scan as well. A view of where they differ most would tell them apart: around "
            "(0, 0, 0.7), (1, 2, 3), (1, 2, 3).");
}

// A ball over the table, as far from it as things are that may be the table's.
TEST(UnexplainedPart, LowersTheConfidenceAndIsSaidWithItsPlace) {
  RunContext context;
  const GeneratedModel model = generate("table");
  PointCloud scan = virtual_scan(model.mesh, {}, context);
  FitOptions options;
  options.align = false;
  const auto fitted = [&] { return fit({model.mesh, model.truth, scan, Similarity{}}, options, context); };
  const FitResult before = fitted();
  EXPECT_LT(before.unexplained_part, 0.01);
  const double size = diagonal(model.mesh.vertices);
  const Eigen::Vector3d top = model.mesh.vertices.colwise().maxCoeff();
  const Eigen::Vector3d centre(0, 0, top.z() + 0.062 * size);
  constexpr int kPoints = 1600;
  const Eigen::Index first = scan.points.rows();
  scan.points.conservativeResize(first + kPoints, 3);
  scan.viewpoints.conservativeResize(first + kPoints, 3);
  Random random(1, "ball");
  for (int i = 0; i < kPoints; ++i) {
    scan.points.row(first + i) = (centre + 0.055 * size * random.direction()).transpose();
    scan.viewpoints.row(first + i) = scan.viewpoints.row(0);
  }
  const FitResult after = fitted();
  EXPECT_GT(after.unexplained_part, 0.02);
  EXPECT_LT(after.confidence, before.confidence - after.unexplained_part);
  EXPECT_LT((after.unexplained_at - centre).norm(), 0.05 * size);
  EXPECT_TRUE(tells(fit_verdict(after), "A connected part of the scan"));
}

}  // namespace
}  // namespace orbifit
