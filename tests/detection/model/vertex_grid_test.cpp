#include "geometry/vertex_grid.h"

#include <vector>

#include <gtest/gtest.h>

namespace orbifit {
namespace {

std::vector<int> found(const VertexGrid& grid, const Eigen::Vector3d& place) {
  std::vector<int> result;
  grid.visit(place, [&](int vertex) { result.push_back(vertex); });
  return result;
}

// Cells as wide as the tolerance would be more than a double can count.
TEST(VertexGrid, FindsVerticesFarFromOneAnother) {
  Points vertices(4, 3);
  vertices << 0, 0, 0, 1e-9, 0, 0, 1e12, 0, 0, 1e50, -1e50, 1e50;
  const VertexGrid grid(vertices, 1e-8);
  EXPECT_EQ(found(grid, {0, 0, 0}), (std::vector<int>{0, 1}));
  EXPECT_EQ(found(grid, {1e12, 0, 0}), (std::vector<int>{2}));
  EXPECT_EQ(found(grid, {1e50, -1e50, 1e50}), (std::vector<int>{3}));
  EXPECT_EQ(found(grid, {1e60, 0, 0}), std::vector<int>{});
  EXPECT_EQ(found(grid, {1e300, 1e300, -1e300}), std::vector<int>{});
}

// Places far from any vertex, too.
TEST(VertexGrid, FindsTheSameOncePlacesWereFetched) {
  Points vertices(3, 3);
  vertices << 0, 0, 0, 1, 0, 0, -1, -2, 3;
  const VertexGrid grid(vertices, 1e-3);
  std::vector<std::size_t> slots;
  grid.fetch({{0, 0, 0}, {1e300, 0, 0}, {-1, -2, 3.0005}}, slots);
  EXPECT_EQ(found(grid, {-1, -2, 3.0005}), std::vector<int>{2});
  EXPECT_EQ(found(grid, {-1, -2, 3.0015}), std::vector<int>{});
}

}  // namespace
}  // namespace orbifit
