// Rows on one surface: of faces that repeat, the part that they belong to.

#include "patterns/row_growth.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace orbifit {
namespace {

constexpr int kCells = 100;  // of a sheet, along each side
constexpr int kStep = 15;    // cells from ridge to ridge
constexpr int kRidges = 5;
constexpr int kFirst = 20;  // cells from the sheet's side to the middle of the first ridge
constexpr int kTop = 1;     // cells from the middle of a ridge to the end of its top

// Five ridges on a sheet, which end before the sheet does.
Mesh ridges() {
  return test::sheet(kCells, [](double x, double y) {
    const int column = static_cast<int>(std::lround((x + 0.5) * kCells));
    for (int ridge = 0; ridge < kRidges; ++ridge) {
      if (std::abs(column - kFirst - kStep * ridge) <= kTop && std::abs(y) < 0.305) return 0.08;
    }
    return 0.0;
  });
}

// The faces of a ridge's top.
std::vector<int> top_of(const Mesh& mesh, int ridge) {
  std::vector<int> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    const int column = f / (2 * kCells);  // of the cell
    const bool of_ridge = std::abs(column - kFirst - kStep * ridge) <= kTop;
    bool high = true;
    for (const int vertex : mesh.faces.row(f)) high = high && mesh.vertices(vertex, 2) > 0.07;
    if (of_ridge && high) faces.push_back(f);
  }
  return faces;
}

// Which of the tops are given.
struct Given {
  const char* name;
  std::vector<int> tops;
  int steps;  // of the generator, from ridge to ridge

  friend void PrintTo(const Given& given, std::ostream* out) { *out << given.name; }
};

class RowOf : public testing::TestWithParam<Given> {
 protected:
  RowOf() {
    const Mesh flat = ridges();
    mesh_ = test::moved(flat, pose_);
    pattern_.kind = Pattern::Kind::translation_1d;
    const double length = static_cast<double>(kStep) / kCells;
    const std::vector<int>& tops = GetParam().tops;
    pattern_.generators = {conjugate(pose_, test::shift(GetParam().steps * length, 0, 0))};
    for (const int ridge : tops) {
      const Motion motion = test::shift((ridge - tops.front()) * length, 0, 0);
      pattern_.instances.push_back({conjugate(pose_, motion), top_of(flat, ridge)});
    }
  }

  Motion pose_{axis_rotation(Eigen::Vector3d(1, 2, -1).normalized(), 0.7), {3, -1, 2}};
  Mesh mesh_;
  Pattern pattern_;
};

TEST_P(RowOf, IsOfWholeRidgesAtAllPlaces) {
  const PreparedMesh prepared = prepare(mesh_);
  const auto grown = grown_row(prepared, pattern_, test::kTolerance, {});
  ASSERT_TRUE(grown);
  ASSERT_EQ(grown->instances.size(), static_cast<std::size_t>(kRidges));
  EXPECT_LT(grown->residual.max, 1e-9);
  const std::vector<int>& first = grown->instances[0].faces;
  const std::vector<int> top = top_of(ridges(), 0);
  EXPECT_TRUE(std::ranges::includes(first, top));
  EXPECT_GT(area_of(prepared, first), 2 * area_of(prepared, top));  // with the sides
  for (std::size_t k = 0; k < grown->instances.size(); ++k) {
    const PatternInstance& instance = grown->instances[k];
    const Motion motion = conjugate(inverse(pose_), instance.motion);
    EXPECT_LT((motion.translation - Eigen::Vector3d(0.15 * static_cast<double>(k), 0, 0)).norm(), 1e-9);
    std::vector<int> expected = first;
    for (int& face : expected) face += 2 * kCells * kStep * static_cast<int>(k);
    EXPECT_EQ(instance.faces, expected) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Tops, RowOf,
                         testing::Values(Given{"all", {0, 1, 2, 3, 4}, 1}, Given{"but_the_last", {0, 1, 2, 3}, 1},
                                         Given{"but_the_first", {1, 2, 3, 4}, 1}, Given{"some", {3, 0, 2}, 1}),
                         [](const testing::TestParamInfo<Given>& of) { return of.param.name; });

TEST(Row, IsFoundByAStepThatIsALittleOff) {
  // By what would be more than the tolerance at the last place.
  const Mesh mesh = ridges();
  const PreparedMesh prepared = prepare(mesh);
  Pattern pattern;
  pattern.kind = Pattern::Kind::translation_1d;
  const double step = 0.15 + 0.4 * test::kTolerance * prepared.input_of_normalised.scale;
  pattern.generators = {test::shift(step, 0, 0)};
  for (int ridge = 0; ridge < 3; ++ridge) {
    pattern.instances.push_back({test::shift(step * ridge, 0, 0), top_of(mesh, ridge)});
  }
  const auto grown = grown_row(prepared, pattern, test::kTolerance, {});
  ASSERT_TRUE(grown);
  EXPECT_EQ(grown->instances.size(), static_cast<std::size_t>(kRidges));
  EXPECT_LT((grown->generators[0].translation - Eigen::Vector3d(0.15, 0, 0)).norm(), 1e-6);
  EXPECT_LT(grown->residual.max, 1e-5);
}

TEST(Row, StaysWhereNothingMoreRepeats) {
  const Mesh mesh = ridges();
  const PreparedMesh prepared = prepare(mesh);
  Pattern pattern;
  pattern.kind = Pattern::Kind::translation_1d;
  pattern.generators = {test::shift(0.15, 0, 0)};
  for (int ridge = 0; ridge < 3; ++ridge) {
    pattern.instances.push_back({test::shift(0.15 * ridge, 0, 0), top_of(mesh, ridge)});
  }
  const auto grown = grown_row(prepared, pattern, test::kTolerance, {});
  ASSERT_TRUE(grown);
  EXPECT_FALSE(grown_row(prepared, *grown, test::kTolerance, {}));
  Pattern grid = pattern;
  grid.generators.push_back(test::shift(0, 0.1, 0));
  EXPECT_FALSE(grown_row(prepared, grid, test::kTolerance, {}));
  Pattern elsewhere = pattern;
  elsewhere.generators = {test::shift(0.11, 0.07, 0)};
  EXPECT_FALSE(grown_row(prepared, elsewhere, test::kTolerance, {}));
}

TEST(Row, IsNotOfSurfaceAlongWhichTheStepSlides) {
  const Mesh mesh = test::sheet(40, [](double, double) { return 0.0; });
  const PreparedMesh prepared = prepare(mesh);
  Pattern pattern;
  pattern.kind = Pattern::Kind::translation_1d;
  pattern.generators = {test::shift(0.1, 0, 0)};
  for (int k = 0; k < 4; ++k) {
    pattern.instances.push_back({test::shift(0.1 * k, 0, 0), {2 * 40 * 4 * k, 2 * 40 * 4 * k + 1}});
  }
  EXPECT_FALSE(grown_row(prepared, pattern, test::kTolerance, {}));
}

}  // namespace
}  // namespace orbifit
