// Some of a row, of an arc and of a chain, beside what only looks like it.

#include "patterns/partial_rows.h"

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "placements.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kCount = 6;

// A block at each place, parts in that order.
Mesh blocks(const std::vector<Motion>& places) {
  std::vector<Mesh> parts;
  parts.reserve(places.size());
  for (const Motion& place : places) parts.push_back(test::moved(test::box(0.5, 0.6, 0.7), place));
  return test::joined(parts);
}

// At x = 0, 1, 2, ...
Mesh row() {
  std::vector<Motion> places;
  for (int k = 0; k < kCount; ++k) places.push_back(test::shift(k, 0, 0));
  return blocks(places);
}

// Every second one turned by a right angle about the row: its mirrors and half-turns are not the row's.
Mesh chain() {
  std::vector<Motion> places;
  for (int k = 0; k < kCount; ++k) {
    places.push_back(test::shift(k, 0, 0) *
                     Motion::rotation(Vector3d::UnitX(), 0.5 * std::numbers::pi * (k % 2), Vector3d::Zero()));
  }
  return blocks(places);
}

Motion turn(double degrees) {
  return Motion::rotation(Vector3d::UnitZ(), degrees * std::numbers::pi / 180, Vector3d::Zero());
}

// At 4 from the axis z, from the axis x on.
Mesh arc(double step) {
  std::vector<Motion> places;
  for (int k = 0; k < kCount; ++k) places.push_back(turn(k * step) * test::shift(4, 0, 0));
  return blocks(places);
}

class PartialRows : public testing::Test {
 protected:
  // A group on the parts `first` to `last`, in the mesh's own frame.
  static FoundRegion region(const PreparedMesh& prepared, const char* symbol, const GroupFrame& frame,
                            const Vector3d& centre, int first, int last) {
    FoundRegion result{test::normalised(prepared, {*PointGroup::parse(symbol), frame, centre}), {}, 0, ""};
    for (int c = first; c <= last; ++c) {
      const std::vector<int>& faces = prepared.components.faces[static_cast<std::size_t>(c)];
      result.faces.insert(result.faces.end(), faces.begin(), faces.end());
    }
    std::ranges::sort(result.faces);
    result.area = area_of(prepared, result.faces);
    result.name = std::to_string(first) + "-" + std::to_string(last);
    return result;
  }

  static std::vector<std::string> kept(const PreparedMesh& prepared, std::vector<FoundRegion> regions,
                                       Explanation* explanation = nullptr) {
    drop_some_of_rows(prepared, test::kTolerance, {}, regions, explanation);
    std::vector<std::string> names;
    for (const FoundRegion& each : regions) names.push_back(each.name);
    return names;
  }

  using Names = std::vector<std::string>;
};

TEST_F(PartialRows, OfARowOnlyTheWholeAndSingleBlocksStay) {
  const PreparedMesh prepared = prepare(row());
  const GroupFrame frame = frame_about(Vector3d::UnitX(), Vector3d::UnitY());
  const auto some = [&](int first, int last) {
    return region(prepared, "D2h", frame, {0.5 * (first + last), 0, 0}, first, last);
  };
  Explanation explanation;
  EXPECT_EQ(kept(prepared, {some(0, 5), some(0, 4), some(1, 5), some(1, 4), some(0, 3), some(3, 3), some(5, 5)},
                 &explanation),
            (Names{"0-5", "3-3", "5-5"}));
  ASSERT_EQ(explanation.notes.size(), 4U);
  EXPECT_EQ(explanation.notes.front().subject, "D2h on 0-4");
  EXPECT_FALSE(explanation.notes.front().kept);
}

// Of the two halves of a row neither overlaps its image: they are a pair.
TEST_F(PartialRows, HalvesStay) {
  const PreparedMesh prepared = prepare(row());
  const GroupFrame frame = frame_about(Vector3d::UnitX(), Vector3d::UnitY());
  EXPECT_EQ(
      kept(prepared, {region(prepared, "D2h", frame, {2.5, 0, 0}, 0, 5), region(prepared, "Cs", frame, {1, 0, 0}, 0, 2),
                      region(prepared, "Cs", frame, {4, 0, 0}, 3, 5)}),
      (Names{"0-5", "0-2", "3-5"}));
}

// The chain has no mirror across itself, some of its links have.
TEST_F(PartialRows, LinksThatHaveAnotherGroupThanTheChainStay) {
  const PreparedMesh prepared = prepare(chain());
  const GroupFrame frame = frame_about(Vector3d::UnitX(), Vector3d::UnitY());
  const GroupFrame between = frame_about(Vector3d::UnitX(), Vector3d(0, 1, 1).normalized());
  EXPECT_EQ(kept(prepared,
                 {region(prepared, "D2", between, {2.5, 0, 0}, 0, 5), region(prepared, "D2h", frame, {2, 0, 0}, 0, 4),
                  region(prepared, "D2h", frame, {3, 0, 0}, 1, 5)}),
            (Names{"0-5", "0-4", "1-5"}));
}

TEST_F(PartialRows, OfAnArcOnlyTheWholeStays) {
  const double step = 20;
  const PreparedMesh prepared = prepare(arc(step));
  const auto some = [&](int first, int last) {
    const Vector3d normal = turn(0.5 * step * (first + last)).linear * Vector3d::UnitY();
    return region(prepared, "Cs", frame_about(normal), {0, 0, 0}, first, last);
  };
  EXPECT_EQ(kept(prepared, {some(0, 5), some(0, 4), some(1, 5), some(2, 5), some(2, 2)}), (Names{"0-5", "2-2"}));
}

// Products of mirrors that turn into themselves carry nothing away.
TEST_F(PartialRows, OfARingAllStay) {
  const double step = 360.0 / kCount;
  const PreparedMesh prepared = prepare(arc(step));
  const auto across = [&](double degrees) { return frame_about(turn(degrees).linear * Vector3d::UnitY()); };
  EXPECT_EQ(kept(prepared, {region(prepared, "Cs", across(2.5 * step), {0, 0, 0}, 0, 5),
                            region(prepared, "Cs", across(2 * step), {0, 0, 0}, 0, 4)}),
            (Names{"0-5", "0-4"}));
}

// The arc stands on a plate that turns with everything: the blocks decide.
TEST_F(PartialRows, ATurnedHostDoesNotHideThatAnArcEnds) {
  const double step = 20;
  const Mesh plate = test::moved(test::prism(72, 5, 0.7), test::shift(0, 0, -0.7));
  const PreparedMesh prepared = prepare(test::joined({arc(step), plate}));
  const auto some = [&](int first, int last) {
    const Vector3d normal = turn(0.5 * step * (first + last)).linear * Vector3d::UnitY();
    FoundRegion result = region(prepared, "Cs", frame_about(normal), {0, 0, 0}, first, last);
    const std::vector<int>& host = prepared.components.faces[kCount];
    result.faces.insert(result.faces.end(), host.begin(), host.end());
    std::ranges::sort(result.faces);
    result.area = area_of(prepared, result.faces);
    return result;
  };
  FoundRegion host = region(prepared, "Cinfv", GroupFrame::Identity(), {0, 0, 0}, kCount, kCount);
  EXPECT_EQ(kept(prepared, {some(0, 5), some(0, 4), some(1, 5), host}), (Names{"0-5", "6-6"}));
}

TEST_F(PartialRows, OfNothingNothingIsDropped) {
  EXPECT_TRUE(kept(prepare(row()), {}).empty());
}

}  // namespace
}  // namespace orbifit
