#include "solver/vertex_rows.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"

#include "base/random.h"
#include "basis/subspace_parts.h"

namespace orbifit {
namespace {

class Rows : public testing::TestWithParam<const char*> {};

TEST_P(Rows, TimesTheCoordinatesAreTheDisplacements) {
  RunContext context;
  const GeneratedModel model = generate(GetParam());
  const Subspace subspace = build_subspace(model.mesh, model.truth, {}, context);
  VertexRows rows(subspace, subspace->basis);
  std::vector<int> vertices(static_cast<std::size_t>(model.mesh.vertices.rows()));
  std::iota(vertices.begin(), vertices.end(), 0);
  rows.prepare({vertices[1], vertices[1], vertices[0]}, context);
  context.threads = 2;
  rows.prepare(vertices, context);
  Random random(3);
  Eigen::VectorXd q(subspace.degrees_of_freedom());
  for (double& value : q) value = random.uniform(-0.1, 0.1);
  const Points expected = vertex_displacements(subspace, q);
  double worst = 0;
  for (const int vertex : vertices) {
    const VertexRows::Way& way = rows.way(vertex);
    const auto at = [&](const VertexRows::Rows& some) {
      EXPECT_TRUE(std::ranges::is_sorted(some.columns));
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int c = 0; c < 3; ++c) {
        some.visit(Eigen::Vector3d::Unit(c), [&](int column, double factor) { sum[c] += q[column] * factor; });
      }
      return sum;
    };
    const Eigen::Vector3d sum = way.along * at(rows.own(way.representative)) + at(rows.shift(way.shift)) + at(way.more);
    worst = std::max(worst, (sum - expected.row(vertex).transpose()).norm());
  }
  EXPECT_LT(worst, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Models, Rows, testing::Values("bar", "chair", "fan"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace orbifit
