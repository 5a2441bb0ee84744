#include "domains/vertex_images.h"

#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

namespace orbifit {
namespace {

// A square, of which one corner is there twice.
Points square() {
  Points vertices(5, 3);
  vertices << 1, 1, 0, -1, 1, 0, -1, -1, 0, 1, -1, 0, 1, -1, 0;
  return vertices;
}

constexpr int kSome = 1 << 10;

// By how many images are remembered.
class VertexImagesMemory : public testing::TestWithParam<std::size_t> {};

TEST_P(VertexImagesMemory, AreWhereMotionsTakeVertices) {
  const Points vertices = square();
  VertexImages images(vertices, 1e-6, GetParam());
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  VertexImages::Images& quarter = images.of(Motion::rotation(axis, std::numbers::pi / 2, Eigen::Vector3d::Zero()));
  VertexImages::Images& eighth = images.of(Motion::rotation(axis, std::numbers::pi / 4, Eigen::Vector3d::Zero()));
  for (int round = 0; round < 2; ++round) {  // the second time they are known
    EXPECT_EQ(quarter(0), 1);
    EXPECT_EQ(quarter(1), 2);
    EXPECT_EQ(quarter(2), VertexImages::kSeveral);
    EXPECT_EQ(quarter(3), 0);
    for (int v = 0; v < 5; ++v) EXPECT_EQ(eighth(v), VertexImages::kNone);
  }
}

TEST_P(VertexImagesMemory, AreTheSameWhereManyAreAskedAtOnce) {
  const Points vertices = square();
  VertexImages images(vertices, 1e-6, GetParam());
  const Motion mirror = Motion::reflection(Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
  std::vector<int> all(5);
  std::iota(all.begin(), all.end(), 0);
  RunContext context;
  context.threads = 2;
  images.of(mirror).ask(all, context);
  EXPECT_EQ(images.of(mirror)(0), 1);
  EXPECT_EQ(images.of(mirror)(2), VertexImages::kSeveral);
  EXPECT_EQ(images.of(mirror)(4), 2);
}

INSTANTIATE_TEST_SUITE_P(Remembered, VertexImagesMemory, testing::Values(0, kSome));

}  // namespace
}  // namespace orbifit
