#include "vertex_rows.h"

#include <numeric>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/random.h"

namespace orbifit {
namespace {

class Rows : public testing::TestWithParam<const char*> {};

TEST_P(Rows, TimesTheCoordinatesAreTheDisplacements) {
  RunContext context;
  const GeneratedModel model = generate(GetParam());
  const Subspace subspace = build_subspace(model.mesh, model.truth, {}, context);
  VertexRows rows(subspace, subspace.basis);
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
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int last = -1;
    for (const VertexRows::Entry& entry : rows.of(vertex)) {
      EXPECT_GT(entry.column, last);
      last = entry.column;
      sum += q[entry.column] * entry.factor;
    }
    worst = std::max(worst, (sum - expected.row(vertex).transpose()).norm());
  }
  EXPECT_LT(worst, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Models, Rows, testing::Values("bar", "chair", "fan"),
                         [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace orbifit
