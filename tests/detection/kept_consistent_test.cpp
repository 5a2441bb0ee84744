#include "kept_consistent.h"

#include <gtest/gtest.h>

#include "orbifit/model/consistent_annotation.h"

#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

// A box, and on one of its sides a mirror that is none of its own.
SymmetryAnnotation contradictory(const Mesh& mesh) {
  SymmetryAnnotation result = empty_annotation(mesh, 0.005);
  const std::vector<int> all = test::all_faces(mesh);
  result.regions = {make_region(*PointGroup::parse("Cs"), Vector3d::Zero(), frame_about(Vector3d(1, 1, 0).normalized()),
                                {0, 1}, "one"),
                    make_region(*PointGroup::parse("D2h"), Vector3d::Zero(), GroupFrame::Identity(), all, "whole")};
  for (std::size_t i = 0; i < result.regions.size(); ++i) result.regions[i].id = static_cast<int>(i);
  return result;
}

TEST(KeptWhenRead, LeavesOutWhatReadingWould) {
  const Mesh mesh = test::box(3, 2, 1);
  const SymmetryAnnotation listed = contradictory(mesh);
  ASSERT_FALSE(consistent_annotation(mesh, listed, RunContext{}).left_out.empty());
  Explanation explanation;
  const SymmetryAnnotation kept = kept_when_read(mesh, listed, &explanation, RunContext{});
  EXPECT_TRUE(consistent_annotation(mesh, kept, RunContext{}).left_out.empty());
  ASSERT_EQ(kept.regions.size(), 1U);
  EXPECT_EQ(kept.regions[0].name, "whole");
  EXPECT_EQ(kept.regions[0].id, 0);
  ASSERT_EQ(explanation.notes.size(), 1U);
  EXPECT_FALSE(explanation.notes[0].kept);
}

TEST(KeptWhenRead, LeavesTheRestAsItIs) {
  const Mesh mesh = test::box(3, 2, 1);
  SymmetryAnnotation listed = contradictory(mesh);
  listed.regions.erase(listed.regions.begin());
  listed.regions[0].residual = {0.001, 0.002};
  const SymmetryAnnotation kept = kept_when_read(mesh, listed, nullptr, RunContext{});
  ASSERT_EQ(kept.regions.size(), 1U);
  EXPECT_EQ(kept.regions[0].faces, listed.regions[0].faces);
  EXPECT_EQ(kept.regions[0].residual.max, 0.002);
  EXPECT_EQ(kept.regions[0].elements.size(), 8U);
}

}  // namespace
}  // namespace orbifit
