#include "support/border_vote.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numbers>

#include <gtest/gtest.h>

#include "group/verification.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector3d;

constexpr int kSheetCells = 40;          // along each side of a sheet
constexpr double kVoteTolerance = 0.01;  // of the diagonal
constexpr double kRadius = 0.3;          // of the disc on it

// A sheet of side 1 about the origin, flat unless told otherwise.
struct Sheet {
  explicit Sheet(const std::function<double(double, double)>& height = [](double, double) { return 0.0; })
      : mesh(test::sheet(kSheetCells, height)), prepared(prepare(mesh)) {}

  // About the vertical axis through its middle, in the prepared mesh's frame.
  std::vector<Motion> motions(const char* symbol) const {
    return judged_motions(*PointGroup::parse(symbol), GroupFrame::Identity(),
                          inverse(prepared.input_of_normalised)(Vector3d::Zero()));
  }

  // Those within a disc, about a place at x.
  std::vector<int> disc(double x) const {
    std::vector<int> result;
    for (int face = 0; face < mesh.faces.rows(); ++face) {
      if ((centroid(face) - Vector3d(x, 0, 0)).norm() < kRadius) result.push_back(face);
    }
    return result;
  }

  Vector3d centroid(int face) const { return mesh.vertices(mesh.faces.row(face), Eigen::all).colwise().mean(); }

  Mesh mesh;
  PreparedMesh prepared;
};

double residual_of(const Sheet& sheet, const std::vector<int>& faces, const std::vector<Motion>& motions) {
  const SurfacePatch patch = make_patch(sheet.prepared, faces, 2000, kVoteTolerance, RunContext{}, "residual");
  return measure_residual(patch, motions, RunContext{}).max;
}

class BorderVote : public testing::TestWithParam<const char*> {};

TEST_P(BorderVote, BringsImagesOfABorderTogether) {
  const Sheet sheet;
  const std::vector<Motion> motions = sheet.motions(GetParam());
  const std::vector<int> shifted = sheet.disc(1.5 / kSheetCells);
  const std::vector<int> voted =
      voted_border(sheet.prepared, kVoteTolerance, motions, shifted, BorderMoves::both_ways, RunContext{});
  EXPECT_LT(residual_of(sheet, voted, motions), 0.8 * residual_of(sheet, shifted, motions));
  // Nothing goes or comes but at the rim.
  std::vector<int> changed;
  std::ranges::set_symmetric_difference(shifted, voted, std::back_inserter(changed));
  EXPECT_FALSE(changed.empty());
  for (const int face : changed) EXPECT_LT(std::abs(sheet.centroid(face).norm() - kRadius), 3.0 / kSheetCells);
}

TEST_P(BorderVote, KeepsTheBorderThatItDrew) {
  const Sheet sheet;
  const std::vector<Motion> motions = sheet.motions(GetParam());
  const std::vector<int> once =
      voted_border(sheet.prepared, kVoteTolerance, motions, sheet.disc(0), BorderMoves::both_ways, RunContext{});
  EXPECT_EQ(voted_border(sheet.prepared, kVoteTolerance, motions, once, BorderMoves::both_ways, RunContext{}), once);
}

TEST_P(BorderVote, GoesInwardsOnlyWhereItMayNotGrow) {
  const Sheet sheet;
  const std::vector<Motion> motions = sheet.motions(GetParam());
  const std::vector<int> shifted = sheet.disc(1.5 / kSheetCells);
  const std::vector<int> voted =
      voted_border(sheet.prepared, kVoteTolerance, motions, shifted, BorderMoves::inwards, RunContext{});
  EXPECT_LT(voted.size(), shifted.size());
  EXPECT_TRUE(std::ranges::includes(shifted, voted));
}

INSTANTIATE_TEST_SUITE_P(Groups, BorderVote, testing::Values("C3", "C4", "C5v", "D6"));

// A face of the rim that is missing comes back where its images are in, unless one of them is not on the surface.
class MissingFace : public testing::TestWithParam<bool> {};

TEST_P(MissingFace, ComesBackWhereAllItsImagesAreOnTheSurface) {
  const bool raised = GetParam();
  const Motion turn = Motion::rotation(Vector3d::UnitZ(), std::numbers::pi / 3, Vector3d::Zero());
  const Vector3d at(kRadius - 1.5 / kSheetCells, 0, 0);
  const Sheet sheet(
      [&](double x, double y) { return raised && (turn(at) - Vector3d(x, y, 0)).norm() < 0.05 ? 0.1 : 0.0; });
  std::vector<int> faces = sheet.disc(0);
  const int missing =
      *std::ranges::min_element(faces, {}, [&](int face) { return (sheet.centroid(face) - at).norm(); });
  std::erase(faces, missing);
  const std::vector<int> voted =
      voted_border(sheet.prepared, kVoteTolerance, sheet.motions("C6"), faces, BorderMoves::both_ways, RunContext{});
  EXPECT_EQ(std::ranges::binary_search(voted, missing), !raised);
}

INSTANTIATE_TEST_SUITE_P(Raised, MissingFace, testing::Bool());

}  // namespace
}  // namespace orbifit
