#include "orbifit/datasets_tools/detection_score.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "scored.h"

namespace orbifit {

namespace {

using namespace scored;
using Eigen::Vector3d;
using Regions = std::vector<Region>;

std::string text(const DetectionScore& score) {
  return "\n" + to_text(score);
}

enum class Found { strictly, loosely, missed };

Found found(const DetectionScore& score) {
  const ExpectedRegionScore& region = score.expected_regions.at(0);
  EXPECT_TRUE(region.loose || !region.strict);
  return region.strict ? Found::strictly : region.loose ? Found::loosely : Found::missed;
}

class FiniteGroup : public testing::TestWithParam<std::string> {
 protected:
  // The same group elsewhere, tilted about a line across its main axis, through the middle of what it fixes.
  Region tilted(double degrees) const {
    return moved_group(whole_, Motion::rotation(frame_.col(0), degrees * kDegree, middle()));
  }

  // The centroid, which the group fixes.
  Vector3d middle() const {
    Vector3d sum = Vector3d::Zero();
    const Eigen::VectorXd areas = face_areas(scene_.mesh);
    for (Eigen::Index f = 0; f < areas.size(); ++f) {
      for (int k = 0; k < 3; ++k) sum += areas[f] / 3 * scene_.mesh.vertices.row(scene_.mesh.faces(f, k)).transpose();
    }
    return sum / areas.sum();
  }

  // Moved across the axis, a mirror off its plane, by a percentage of the diagonal.
  Region shifted(double percent) const {
    const Vector3d across = whole_.group.family == PointGroup::Family::Cs ? frame_.col(2) : frame_.col(0);
    const double way = percent / 100 * diagonal(scene_.mesh.vertices);
    return moved_group(whole_, {Eigen::Matrix3d::Identity(), way * across});
  }

  GroupFrame frame_ = Random(7, "frame").rotation();
  Scene scene_ = orbit_scene(GetParam(), frame_);
  Region whole_ = scene_.truth.expected.regions.front();
};

TEST_P(FiniteGroup, TruthScoresFull) {
  const DetectionScore score = scene_.score(scene_.truth.expected);
  EXPECT_TRUE(score.breaches.empty()) << text(score);
  ASSERT_EQ(score.regions.size(), 1U);
  EXPECT_TRUE(score.regions[0].well_formed);
  EXPECT_EQ(score.regions[0].validity, 1);
  EXPECT_EQ(score.regions[0].trivial, Triviality::none);
  EXPECT_NEAR(score.regions[0].area, 1, 1e-12);
  ASSERT_TRUE(score.regions[0].matches.has_value());
  EXPECT_EQ(found(score), Found::strictly);
  EXPECT_EQ(score.summary.expected, 1);
  EXPECT_EQ(score.summary.strict_recall, 1);
  EXPECT_EQ(score.summary.loose_recall, 1);
  EXPECT_EQ(score.summary.precision, 1);
  EXPECT_EQ(score.summary.f1, 1);
  EXPECT_LT(score.summary.axis_error.value(), 1e-6);
  EXPECT_LT(score.summary.offset_error.value(), 1e-12);
}

TEST_P(FiniteGroup, IsValidWithoutATruth) {
  const RunContext context;
  const DetectionScore score = score_detection(scene_.mesh, scene_.truth.expected, nullptr, {}, context);
  EXPECT_EQ(score.summary.precision, 1);
  EXPECT_EQ(score.summary.valid, 1);
  EXPECT_FALSE(score.summary.expected || score.summary.strict_recall || score.summary.f1);
}

TEST_P(FiniteGroup, AxesAreFoundToADegree) {
  if (whole_.group.family == PointGroup::Family::Ci) {
    EXPECT_EQ(found(scene_.score(Regions{tilted(30)})), Found::strictly) << "there are no axes";
    return;
  }
  for (const auto& [degrees, expected] : {std::pair{0.9, Found::strictly}, std::pair{1.1, Found::loosely},
                                          std::pair{2.9, Found::loosely}, std::pair{3.1, Found::missed}}) {
    const DetectionScore score = scene_.score(Regions{tilted(degrees)});
    EXPECT_EQ(found(score), expected) << degrees << text(score);
    EXPECT_NEAR(score.expected_regions[0].axis_error.value(), degrees, 1e-6);
    // Found loosely by the same group is no wrong claim; a miss has to hold by itself.
    if (expected != Found::missed) {
      EXPECT_EQ(score.summary.precision, 1) << degrees;
    }
  }
}

TEST_P(FiniteGroup, FixedSetsAreFoundToAPercent) {
  for (const auto& [percent, expected] : {std::pair{0.9, Found::strictly}, std::pair{1.1, Found::loosely},
                                          std::pair{2.9, Found::loosely}, std::pair{3.1, Found::missed}}) {
    const DetectionScore score = scene_.score(Regions{shifted(percent)});
    EXPECT_EQ(found(score), expected) << percent << text(score);
    EXPECT_NEAR(score.expected_regions[0].offset_error.value(), percent / 100, 1e-9);
  }
}

TEST_P(FiniteGroup, MotionsWhollyOffAreInvalid) {
  const DetectionScore score = scene_.score(Regions{shifted(4)});
  EXPECT_LT(score.regions[0].validity, 0.6) << text(score);
  EXPECT_FALSE(score.regions[0].counts);
  EXPECT_EQ(score.summary.precision, 0);
  EXPECT_EQ(score.summary.f1, 0);
  EXPECT_FALSE(score.summary.axis_error.has_value());
}

TEST_P(FiniteGroup, IsTheSameOnTwoThreads) {
  SymmetryAnnotation predicted = scene_.truth.expected;
  predicted.regions.front() = shifted(0.4);
  EXPECT_EQ(to_text(scene_.score(predicted, 1)), to_text(scene_.score(predicted, 2)));
}

INSTANTIATE_TEST_SUITE_P(Groups, FiniteGroup,
                         testing::Values("Cs", "Ci", "C2", "C3", "C6", "C2v", "C3v", "C5v", "C2h", "C3h", "D2", "D3",
                                         "D2h", "D3h", "D6h", "D2d", "D3d", "S4", "S6", "T", "Td", "Th", "O", "Oh", "I",
                                         "Ih"),
                         [](const auto& given) { return given.param; });

// A region of one group on a mesh that has another one.
struct Claim {
  std::string truth, claim;
  Found expected;
  bool counts;  // towards precision
};

void PrintTo(const Claim& claim, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's
  *out << claim.claim << " on " << claim.truth;
}

class OtherGroup : public testing::TestWithParam<Claim> {};

TEST_P(OtherGroup, IsFoundLooselyIfLargerOrHalf) {
  const GroupFrame frame = Random(8, "frame").rotation();
  const Scene scene = orbit_scene(GetParam().truth, frame);
  const Region& whole = scene.truth.expected.regions.front();
  const DetectionScore score =
      scene.score(Regions{make_region(group_named(GetParam().claim), whole.centre, frame, whole.faces, "")});
  EXPECT_TRUE(score.breaches.empty());
  EXPECT_EQ(found(score), GetParam().expected) << text(score);
  EXPECT_EQ(score.regions[0].counts, GetParam().counts) << text(score);
}

INSTANTIATE_TEST_SUITE_P(
    Claims, OtherGroup,
    testing::Values(Claim{"C4v", "C4", Found::loosely, true}, Claim{"C4v", "C2v", Found::loosely, true},
                    Claim{"C4v", "C2", Found::missed, true}, Claim{"C6", "C3", Found::loosely, true},
                    Claim{"C6", "C2", Found::missed, true}, Claim{"D4h", "D4", Found::loosely, true},
                    Claim{"D4h", "C4h", Found::loosely, true}, Claim{"D4h", "C4", Found::missed, true},
                    Claim{"D3d", "D3", Found::loosely, true}, Claim{"S4", "C2", Found::loosely, true},
                    Claim{"Oh", "O", Found::loosely, true}, Claim{"Oh", "Th", Found::loosely, true},
                    Claim{"O", "T", Found::loosely, true}, Claim{"Oh", "T", Found::missed, true},
                    Claim{"Ih", "I", Found::loosely, true},
                    // Larger ones hold the true one, but the mesh does not have them.
                    Claim{"C4", "C4v", Found::loosely, false}, Claim{"C2", "C4", Found::loosely, false},
                    Claim{"C3", "D3h", Found::loosely, false}, Claim{"T", "Oh", Found::loosely, false},
                    Claim{"C4", "Dinfh", Found::loosely, false}, Claim{"C4", "Cinf", Found::loosely, false},
                    Claim{"D3", "Cinf", Found::missed, false}, Claim{"C2v", "Cinf", Found::missed, false},
                    Claim{"C4v", "Kh", Found::loosely, false}, Claim{"C4v", "K", Found::missed, false},
                    Claim{"C4", "Ci", Found::missed, false}, Claim{"C3", "C5", Found::missed, false}));

class Overlap : public testing::TestWithParam<std::pair<double, Found>> {};

TEST_P(Overlap, IsMeasuredByArea) {
  const auto& [share, expected] = GetParam();
  Scene scene = orbit_scene("C4v", GroupFrame::Identity(), 3);
  Region part = scene.truth.expected.regions.front();
  part.faces = share_of(scene.mesh, part.faces, share);
  const DetectionScore fewer = scene.score(Regions{part});
  EXPECT_EQ(found(fewer), expected) << text(fewer);
  EXPECT_NEAR(fewer.expected_regions[0].iou, share, 2e-3);
  // As many faces too many are as bad.
  std::swap(part.faces, scene.truth.expected.regions.front().faces);
  const DetectionScore more = scene.score(Regions{part});
  EXPECT_EQ(found(more), expected);
  EXPECT_EQ(more.expected_regions[0].iou, fewer.expected_regions[0].iou);
}

INSTANTIATE_TEST_SUITE_P(Shares, Overlap,
                         testing::Values(std::pair{0.81, Found::strictly}, std::pair{0.79, Found::loosely},
                                         std::pair{0.61, Found::loosely}, std::pair{0.59, Found::missed},
                                         std::pair{0.2, Found::missed}),
                         [](const auto& test) {
                           return std::to_string(std::lround(100 * test.param.first)) + "Percent";
                         });

TEST(DetectionScore, AcceptsEveryFaceSetBetweenTheAcceptedOnes) {
  Scene scene = orbit_scene("C4", GroupFrame::Identity(), 3);
  const Region whole = scene.truth.expected.regions.front();
  Region half = whole;
  half.faces = share_of(scene.mesh, whole.faces, 0.5);
  Region between = whole;
  between.faces = share_of(scene.mesh, whole.faces, 0.7);
  Region less = whole;
  less.faces = share_of(scene.mesh, whole.faces, 0.41);
  Region least = whole;
  least.faces = share_of(scene.mesh, whole.faces, 0.39);
  EXPECT_EQ(found(scene.score(Regions{half})), Found::missed);
  scene.truth.also_accepted[whole.id] = {half.faces};
  for (const Region& region : {whole, half, between}) {
    const DetectionScore score = scene.score(Regions{region});
    EXPECT_EQ(found(score), Found::strictly);
    EXPECT_NEAR(score.expected_regions[0].iou, 1, 1e-12);
  }
  // Of what all accepted sets hold a share must be found, as of a single set.
  EXPECT_EQ(found(scene.score(Regions{less})), Found::strictly);
  EXPECT_EQ(found(scene.score(Regions{least})), Found::loosely);
}

TEST(DetectionScore, OptionalRegionsCountAndAreNotMissed) {
  Scene scene = orbit_scene("C4", GroupFrame::Identity());
  const Region whole = scene.truth.expected.regions.front();
  Region invalid = moved_group(whole, {Eigen::Matrix3d::Identity(), Vector3d(1, 0, 0)});
  scene.truth.expected.regions = {invalid};
  scene.truth.optional_regions = {whole};
  const DetectionScore score = scene.score(Regions{whole});
  EXPECT_EQ(score.summary.expected, 1);
  EXPECT_EQ(score.summary.strict_recall, 0);
  EXPECT_EQ(score.summary.precision, 1);
  ASSERT_TRUE(score.regions[0].matches.has_value());
  EXPECT_TRUE(score.regions[0].matches->optional);
  // What is optional may be wrong in itself: it is accepted all the same.
  scene.truth.optional_regions = {invalid};
  scene.truth.expected.regions = {whole};
  EXPECT_EQ(scene.score(Regions{invalid}).summary.precision, 1);
  EXPECT_EQ(scene.score(Regions{}).summary.precision, 0);
}

TEST(DetectionScore, NothingIsRightWhereNothingIsExpected) {
  Scene scene = orbit_scene("C1", GroupFrame::Identity());
  const DetectionScore right = scene.score(scene.nothing());
  EXPECT_EQ(right.summary.expected, 0);
  EXPECT_FALSE(right.summary.strict_recall.has_value());
  EXPECT_EQ(right.summary.precision, 1);
  EXPECT_EQ(right.summary.f1, 1);
  const std::vector<int> all = members_of(scene.mesh);
  const DetectionScore wrong =
      scene.score(Regions{make_region(group_named("Cs"), {0.4, -0.3, 0.2}, GroupFrame::Identity(), all, "")});
  EXPECT_EQ(wrong.summary.precision, 0);
  EXPECT_EQ(wrong.summary.f1, 0);
}

TEST(DetectionScore, RepeatedRegionsCountOnce) {
  const Scene scene = orbit_scene("C4v", GroupFrame::Identity(), 3);
  const Region whole = scene.truth.expected.regions.front();
  const auto turned = [&](double degrees) {
    return moved_group(whole, Motion::rotation(Vector3d::UnitX(), degrees * kDegree, whole.centre));
  };
  const DetectionScore same = scene.score(Regions{whole, turned(0.3)});
  EXPECT_FALSE(same.regions[0].duplicate_of.has_value());
  EXPECT_EQ(same.regions[1].duplicate_of, 0) << text(same);
  EXPECT_FALSE(same.regions[1].counts);
  EXPECT_EQ(same.summary.precision, 0.5);
  EXPECT_FALSE(scene.score(Regions{whole, turned(1.2)}).regions[1].duplicate_of.has_value());

  Region part = whole;
  part.faces = share_of(scene.mesh, whole.faces, 0.8);
  const Region reflection =
      make_region(group_named("Cs"), whole.centre,
                  frame_about(whole.generators[1].linear * Vector3d::UnitX() - Vector3d::UnitX()), whole.faces, "");
  const Region rotations = make_region(group_named("C4"), whole.centre, GroupFrame::Identity(), part.faces, "");
  // Inside a region whose group holds theirs, before or after it.
  const DetectionScore inside = scene.score(Regions{rotations, whole, part, reflection});
  EXPECT_EQ(inside.regions[0].duplicate_of, 1) << text(inside);
  EXPECT_FALSE(inside.regions[1].duplicate_of.has_value());
  EXPECT_EQ(inside.regions[2].duplicate_of, 1);
  // A larger group on fewer faces says more.
  const Region fewer = make_region(group_named("C4"), whole.centre, GroupFrame::Identity(), whole.faces, "");
  const DetectionScore more = scene.score(Regions{fewer, part});
  EXPECT_FALSE(more.regions[0].duplicate_of.has_value());
  EXPECT_FALSE(more.regions[1].duplicate_of.has_value());
}

TEST(DetectionScore, TheBestOfSeveralTakesTheMatch) {
  const Scene scene = orbit_scene("C4v", GroupFrame::Identity());
  const Region whole = scene.truth.expected.regions.front();
  const Region near = moved_group(whole, Motion::rotation(Vector3d::UnitX(), 0.9 * kDegree, whole.centre));
  Region fewer = whole;
  fewer.faces = share_of(scene.mesh, whole.faces, 0.9);
  const DetectionScore score = scene.score(Regions{fewer, whole, near});
  EXPECT_EQ(score.expected_regions[0].by, 1);
  EXPECT_FALSE(score.regions[0].matches.has_value());
  EXPECT_TRUE(score.regions[1].matches.has_value());
  EXPECT_NEAR(score.summary.axis_error.value(), 0, 1e-6);
}

TEST(DetectionScore, TinyRegionsOnlyCountAsMatches) {
  Scene scene = orbit_scene("C2", GroupFrame::Identity());
  const Region large = scene.truth.expected.regions.front();
  const double area = face_areas(scene.mesh).sum();
  const auto with_cube_of = [&](double share) {
    Scene result;
    result.add(scene.mesh);
    Mesh small = orbit_scene("C3", GroupFrame::Identity()).mesh;
    const double scale = std::sqrt(share * area / face_areas(small).sum());
    small.vertices *= scale;
    Region region =
        make_region(group_named("C3"), scale * Vector3d(0.4, -0.3, 0.2), GroupFrame::Identity(), result.add(small), "");
    result.expect({large});
    return std::pair{result, region};
  };
  const auto [tiny, tiny_region] = with_cube_of(0.0019);
  const DetectionScore score = tiny.score(Regions{tiny_region});
  EXPECT_EQ(score.regions[0].trivial, Triviality::tiny);
  EXPECT_EQ(score.regions[0].validity, 1);
  EXPECT_FALSE(score.regions[0].counts);
  Scene expected = tiny;
  expected.expect({tiny_region});
  EXPECT_TRUE(expected.score(Regions{tiny_region}).regions[0].counts);
  const auto [small, small_region] = with_cube_of(0.0021);
  EXPECT_TRUE(small.score(Regions{small_region}).regions[0].counts);
}

TEST(DetectionScore, RefusesWhatIsNotOfThisMesh) {
  const Scene scene = orbit_scene("C2", GroupFrame::Identity());
  const RunContext context;
  SymmetryAnnotation other = scene.truth.expected;
  --other.mesh_faces;
  EXPECT_THROW(scene.score(other), InputError);
  SymmetryAnnotation outside = scene.truth.expected;
  outside.regions[0].faces.push_back(outside.mesh_faces);
  EXPECT_THROW(scene.score(outside), InputError);
  SymmetryAnnotation shuffled = scene.truth.expected;
  std::swap(shuffled.regions[0].faces[3], shuffled.regions[0].faces[4]);
  EXPECT_THROW(scene.score(shuffled), InputError);
  DetectionTruth truth = scene.truth;
  truth.also_accepted[0] = {{-1, 3}};
  EXPECT_THROW(score_detection(scene.mesh, scene.truth.expected, &truth, {}, context), InputError);
  DetectionScoreOptions few;
  few.samples = 99;
  EXPECT_THROW(score_detection(scene.mesh, scene.truth.expected, &scene.truth, few, context), UsageError);
}

}  // namespace
}  // namespace orbifit
