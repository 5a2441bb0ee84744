#include "support/yielding_borders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include "consistency/consistency_search.h"
#include "shapes.h"

namespace orbifit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSheetCells = 80;              // along each side of a sheet of side 1
constexpr double kPeg = 4.0 / 80;            // half of a side of its top
constexpr double kFoot = 5.0 / 80;           // and of its foot
const Vector2d kPegAt(24.0 / 80, 8.0 / 80);  // so far from mirrors that its images are apart

double from_peg(const Vector2d& point, const Vector2d& peg) {
  return (point - peg).cwiseAbs().maxCoeff();
}

std::vector<Vector2d> images_of_peg(const PointGroup& group) {
  std::vector<Vector2d> result;
  for (const Eigen::Matrix3d& element : elements(group, GroupFrame::Identity())) {
    result.emplace_back(element.topLeftCorner<2, 2>() * kPegAt);
  }
  return result;
}

// A sheet with pegs.
Mesh pegged(const std::vector<Vector2d>& pegs) {
  return test::sheet(kSheetCells, [&](double x, double y) {
    return std::ranges::any_of(pegs,
                               [&](const Vector2d& peg) {
                                 return from_peg({x, y}, peg) < kPeg + 1e-9;
                               })
               ? 0.1
               : 0.0;
  });
}

template <class In>
std::vector<int> faces_where(const Mesh& mesh, const In& in) {
  std::vector<int> result;
  for (int face = 0; face < mesh.faces.rows(); ++face) {
    const Vector3d centroid = mesh.vertices(mesh.faces.row(face), Eigen::all).colwise().mean();
    if (in(centroid.head<2>())) result.push_back(face);
  }
  return result;
}

// A disc of the sheet under the group, without where pegs would be; and the pegs that there are.
SymmetryAnnotation annotated(const Mesh& mesh, const PointGroup& group, const std::vector<Vector2d>& pegs) {
  SymmetryAnnotation result = empty_annotation(mesh, 0.005);
  const std::vector<Vector2d> gaps = images_of_peg(group);
  result.regions.push_back(make_region(group, Vector3d::Zero(), GroupFrame::Identity(),
                                       faces_where(mesh,
                                                   [&](const Vector2d& point) {
                                                     return point.norm() < 0.45 &&
                                                            std::ranges::all_of(gaps, [&](const Vector2d& gap) {
                                                              return from_peg(point, gap) > kFoot;
                                                            });
                                                   }),
                                       "disc"));
  for (const Vector2d& peg : pegs) {
    result.regions.push_back(
        make_region(*PointGroup::parse("C4v"), {peg.x(), peg.y(), 0}, GroupFrame::Identity(),
                    faces_where(mesh, [&](const Vector2d& point) { return from_peg(point, peg) < kFoot; }), "peg"));
  }
  for (std::size_t i = 0; i < result.regions.size(); ++i) result.regions[i].id = static_cast<int>(i);
  return result;
}

void yield(const Mesh& mesh, SymmetryAnnotation& annotation, Explanation* explanation = nullptr) {
  const RunContext context;
  const ShapeSurface surface = ConsistencySearch::surface_of(mesh, annotation.tolerance, context);
  const std::vector<BorderPlace> borders =
      border_places(prepare(mesh), annotation.regions, annotation.tolerance, context);
  EXPECT_EQ(borders.front(), BorderPlace::kWithinSmooth);  // the disc
  for (std::size_t i = 1; i < borders.size(); ++i) EXPECT_EQ(borders[i], BorderPlace::kOfPart);
  yield_to_parts(surface, borders, annotation, explanation, context);
}

class YieldingBorders : public testing::TestWithParam<const char*> {
 protected:
  PointGroup group_ = *PointGroup::parse(GetParam());
};

TEST_P(YieldingBorders, GoAroundAPartWithoutImages) {
  const Mesh mesh = pegged({kPegAt});
  const SymmetryAnnotation before = annotated(mesh, group_, {kPegAt});
  SymmetryAnnotation after = before;
  Explanation explanation;
  yield(mesh, after, &explanation);
  EXPECT_EQ(after.regions[1].faces, before.regions[1].faces);
  EXPECT_EQ(explanation.notes.size(), 1U);
  const std::vector<int> of_disc = vertices_of_faces(mesh, after.regions[0].faces);
  for (const int vertex : vertices_of_faces(mesh, after.regions[1].faces)) {
    EXPECT_FALSE(std::ranges::binary_search(of_disc, vertex));
  }
  // What goes lies about the peg, or one of its images, and about each of them.
  std::vector<int> gone;
  std::ranges::set_difference(before.regions[0].faces, after.regions[0].faces, std::back_inserter(gone));
  const std::vector<Vector2d> images = images_of_peg(group_);
  std::vector<int> about(images.size(), 0);
  for (const int face : gone) {
    const Vector3d centroid = mesh.vertices(mesh.faces.row(face), Eigen::all).colwise().mean();
    const auto nearest =
        std::ranges::min_element(images, {}, [&](const Vector2d& peg) { return from_peg(centroid.head<2>(), peg); });
    EXPECT_LT(from_peg(centroid.head<2>(), *nearest), kFoot + 2.0 / kSheetCells);
    ++about[static_cast<std::size_t>(nearest - images.begin())];
  }
  EXPECT_GT(*std::ranges::min_element(about), 0);
}

TEST_P(YieldingBorders, StayWhereTheRegionHoldsTheParts) {
  const std::vector<Vector2d> pegs = images_of_peg(group_);
  const Mesh mesh = pegged(pegs);
  SymmetryAnnotation annotation = annotated(mesh, group_, pegs);
  annotation.regions[0].faces = faces_where(mesh, [](const Vector2d& point) { return point.norm() < 0.45; });
  const std::vector<int> before = annotation.regions[0].faces;
  yield(mesh, annotation);
  EXPECT_EQ(annotation.regions[0].faces, before);
}

INSTANTIATE_TEST_SUITE_P(Groups, YieldingBorders, testing::Values("C2", "C4", "C4v"));

// A sheet goes on to one side of a mirror only, and the region ends where the other side's end has its image.
class BeforeAnEnd : public testing::TestWithParam<const char*> {};

TEST_P(BeforeAnEnd, YieldsToPartsThatSaveMore) {
  const double mirror = 0.1;
  const Vector2d peg(-0.1, 0.1);
  const Mesh mesh = pegged({peg});
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  GroupFrame across;  // its third axis is the mirror's normal
  across << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  annotation.regions.push_back(make_region(
      *PointGroup::parse("Cs"), Vector3d(mirror, 0, 0), across,
      faces_where(mesh,
                  [&](const Vector2d& point) { return point.x() > 2 * mirror - 0.5 && from_peg(point, peg) > kFoot; }),
      "two sides"));
  annotation.regions.push_back(
      make_region(*PointGroup::parse(GetParam()), {peg.x(), peg.y(), 0}, GroupFrame::Identity(),
                  faces_where(mesh, [&](const Vector2d& point) { return from_peg(point, peg) < kFoot; }), "peg"));
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) annotation.regions[i].id = static_cast<int>(i);
  const RunContext context;
  const std::vector<BorderPlace> borders =
      border_places(prepare(mesh), annotation.regions, annotation.tolerance, context);
  EXPECT_EQ(borders[0], BorderPlace::kBeforeEnds);
  EXPECT_EQ(borders[1], BorderPlace::kOfPart);
  const std::vector<int> before = annotation.regions[0].faces;
  yield_to_parts(ConsistencySearch::surface_of(mesh, annotation.tolerance, context), borders, annotation, nullptr,
                 context);
  const bool saves = annotation.regions[1].group.order() > 1;
  EXPECT_EQ(annotation.regions[0].faces.size() < before.size(), saves);
}

INSTANTIATE_TEST_SUITE_P(Groups, BeforeAnEnd, testing::Values("C1", "C4v"));

TEST(YieldToParts, LeavesAloneWhatWouldLoseHalf) {
  const Mesh mesh = pegged({kPegAt});
  const PointGroup group = *PointGroup::parse("C4");
  SymmetryAnnotation annotation = annotated(mesh, group, {kPegAt});
  // Rings of a face around where pegs would be are nearly all that the region has.
  const std::vector<Vector2d> gaps = images_of_peg(group);
  annotation.regions[0].faces = faces_where(mesh, [&](const Vector2d& point) {
    return std::ranges::any_of(gaps, [&](const Vector2d& gap) {
      return from_peg(point, gap) > kFoot && from_peg(point, gap) < kFoot + 1.0 / kSheetCells;
    });
  });
  const std::vector<int> before = annotation.regions[0].faces;
  yield(mesh, annotation);
  EXPECT_EQ(annotation.regions[0].faces, before);
}

}  // namespace
}  // namespace orbifit
