#include "group/verification.h"

#include <numbers>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

class VerifyBox : public testing::Test {
 protected:
  VerifyBox() : mesh_(test::box(1, 1, 2)), prepared_(prepare(mesh_)) {
    patch_ = make_patch(prepared_, test::all_faces(mesh_), 2000, 0.005, context_, "test");
  }
  RunContext context_;
  Mesh mesh_;
  PreparedMesh prepared_;
  SurfacePatch patch_;
};

TEST_F(VerifyBox, KeepsEveryElementOfItsGroup) {
  const auto motions = judged_motions(*PointGroup::parse("D4h"), GroupFrame::Identity(), Eigen::Vector3d::Zero());
  ASSERT_EQ(motions.size(), 15U);
  const Verification verification = verify(patch_, motions, patch_.tolerance, 0, 0, context_);
  EXPECT_EQ(verification.joint, 1);
  EXPECT_EQ(verification.worst, 1);
  EXPECT_EQ(verification.cluster, 0);
  EXPECT_TRUE(passes(verification));
  EXPECT_LT(measure_residual(patch_, motions, context_).max, 1e-12);
}

TEST_F(VerifyBox, RefusesWhatIsNotInIt) {
  const auto motions = judged_motions(*PointGroup::parse("C3"), GroupFrame::Identity(), Eigen::Vector3d::Zero());
  const Verification verification = verify(patch_, motions, patch_.tolerance, 0, 0, context_);
  EXPECT_FALSE(passes(verification));
  EXPECT_LT(verification.joint, 0.8);
  EXPECT_GT(measure_residual(patch_, motions, context_).max, 0.02);
}

TEST_F(VerifyBox, GivesUpEarlyWhereHopeless) {
  const auto motions = judged_motions(*PointGroup::parse("C5"), GroupFrame::Identity(), Eigen::Vector3d::Zero());
  EXPECT_FALSE(verify(patch_, motions, patch_.tolerance, 0, 0.96, context_).complete);
}

TEST_F(VerifyBox, SameForAnyNumberOfThreads) {
  const auto motions = judged_motions(*PointGroup::parse("D8h"), GroupFrame::Identity(), Eigen::Vector3d::Zero());
  RunContext three = context_;
  three.threads = 3;
  const Verification a = verify(patch_, motions, patch_.tolerance, 0, 0, context_);
  const Verification b = verify(patch_, motions, patch_.tolerance, 0, 0, three);
  EXPECT_EQ(a.kept, b.kept);
  EXPECT_EQ(a.cluster, b.cluster);
}

TEST_F(VerifyBox, AShareThatIsHopelessIsNotCountedToItsEnd) {
  const Motion third = Motion::rotation(Eigen::Vector3d::UnitZ(), 2 * std::numbers::pi / 3, Eigen::Vector3d::Zero());
  const double share = kept_share(patch_, third, patch_.tolerance, 0);
  EXPECT_GT(share, 0.1);
  EXPECT_LT(kept_share(patch_, third, patch_.tolerance, 0, 0.9), share);
  EXPECT_EQ(kept_share(patch_, third, patch_.tolerance, 0, share), share);
}

TEST(Verify, SeesOneMissingBoltAsABlot) {
  std::vector<Mesh> parts{test::prism(40, 1, 0.3)};
  for (int i = 0; i < 8; ++i) {
    const Mesh bolt = test::moved(test::prism(6, 0.08, 0.15), test::shift(0.7, 0, 0.25));
    if (i != 3) parts.push_back(test::moved(bolt, Motion::rotation({0, 0, 1}, i * std::numbers::pi / 4, {0, 0, 0})));
  }
  const Mesh mesh = test::joined(parts);
  const PreparedMesh prepared = prepare(mesh);
  const RunContext context;
  const SurfacePatch patch = make_patch(prepared, test::all_faces(mesh), 4000, 0.005, context, "test");
  const Eigen::Vector3d centre = -prepared.input_of_normalised.translation / prepared.input_of_normalised.scale;
  const auto motions = judged_motions(*PointGroup::parse("C8"), GroupFrame::Identity(), centre);
  const Verification verification = verify(patch, motions, patch.tolerance, 0, 0, context);
  EXPECT_GT(verification.worst, 0.97) << "each motion alone looks good on average";
  EXPECT_GT(verification.cluster, 0.005);
  EXPECT_FALSE(passes(verification));
}

TEST(Objection, NamesTheFirstLimitThatIsBroken) {
  Verification fine;
  fine.joint = 0.99;
  fine.worst = 0.99;
  fine.complete = true;
  EXPECT_EQ(objection(fine), "");
  EXPECT_TRUE(passes(fine));
  const auto spoilt = [&](auto spoil) {
    Verification each = fine;
    spoil(each);
    EXPECT_FALSE(passes(each));
    return objection(each);
  };
  EXPECT_EQ(spoilt([](Verification& v) { v.joint = 0.5; }), "not verified: all its motions together keep 50.0 %");
  EXPECT_EQ(spoilt([](Verification& v) { v.complete = false; }), "not verified: all its motions together keep 99.0 %");
  EXPECT_EQ(spoilt([](Verification& v) { v.worst = 0.9; }), "not verified: one motion keeps 90.0 %");
  EXPECT_EQ(spoilt([](Verification& v) { v.cluster = 0.02; }), "not verified: a blot of 2.0 % has no image");
  EXPECT_EQ(spoilt([](Verification& v) { v.part = 0.25; }), "not verified: of one part 25.0 % is kept");
}

TEST(JudgedMotions, OfContinuousGroupsAreElements) {
  for (const char* symbol : {"Cinfv", "Dinfh", "Kh", "Cinf", "Dinf", "K", "Cinfh"}) {
    const PointGroup group = *PointGroup::parse(symbol);
    const GroupFrame frame = frame_about({0.3, -0.5, 0.8});
    const Eigen::Vector3d centre(1, 2, 3);
    for (const Motion& motion : judged_motions(group, frame, centre)) {
      EXPECT_LT((motion(centre) - centre).norm(), 1e-12);
      EXPECT_LT(orthogonality_error(motion.linear), 1e-12);
      if (group.proper()) {
        EXPECT_GT(motion.linear.determinant(), 0) << symbol;
      }
      if (group.family == PointGroup::Family::K || group.family == PointGroup::Family::Kh) continue;
      EXPECT_LT((motion.linear * frame.col(2)).cross(frame.col(2)).norm(), 1e-12) << symbol;
    }
  }
}

}  // namespace
}  // namespace orbifit
