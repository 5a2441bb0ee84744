// A template's parts that touch go on touching as it is fitted.

#include "deformation/contacts.h"

#include <algorithm>
#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/fitting/fit.h"

namespace orbifit {
namespace {

class FittedStool : public testing::TestWithParam<GroupMode> {};

// Legs splayed and stretchers set lower than the template: what pulls a stretcher from its legs. Floating groups cannot
// splay.
TEST_P(FittedStool, KeepsItsContacts) {
  RunContext context;
  const GeneratedModel model = generate("stool", {{"detail", 1}});
  const GeneratedModel truth = generate(
      "stool",
      {{"detail", 1}, {"leg_spread", 0.11}, {"stretcher_height", 0.33}, {"height", 0.5}, {"seat_width", 0.33}});
  ScanOptions scanner;
  scanner.views = 3;
  const PointCloud scan = virtual_scan(truth.mesh, scanner, context);
  SubspaceOptions space;
  space.mode = GetParam();
  space.radius = 0.05 * diagonal(model.mesh.vertices);
  FitInput input{model.mesh, model.truth, scan, Similarity{}};
  const auto subspace = std::make_shared<Subspace>(build_subspace(model.mesh, model.truth, space, context));
  input.subspace = subspace;
  ContactOptions all;
  all.representatives = false;
  const std::vector<Contact> contacts = find_contacts(*subspace, model.mesh, all, context);
  ASSERT_FALSE(contacts.empty());

  std::array<double, 2> opened{};
  for (const bool with : {false, true}) {
    FitOptions options;
    options.subspace = space;
    options.align = false;
    options.contacts = with;
    const FitResult result = fit(input, options, context);
    EXPECT_TRUE(result.converged) << result.stopped_because;
    EXPECT_GT(result.inlier_ratio, GetParam() == GroupMode::moving ? 0.9 : 0.7);
    EXPECT_LT(result.field_residual, 1e-12);
    for (const Contact& contact : contacts) {
      Eigen::RowVector3d gap = Eigen::RowVector3d::Zero();
      for (const auto& [vertex, weight] : contact.sides[0].vertices) gap += weight * result.fitted.vertices.row(vertex);
      for (const auto& [vertex, weight] : contact.sides[1].vertices) gap -= weight * result.fitted.vertices.row(vertex);
      opened[with ? 1 : 0] = std::max(opened[with ? 1 : 0], gap.norm() / diagonal(result.fitted.vertices));
    }
  }
  EXPECT_LT(opened[1], 1e-3);
  EXPECT_GT(opened[0], 3 * opened[1]);
}

INSTANTIATE_TEST_SUITE_P(Modes, FittedStool, testing::Values(GroupMode::floating, GroupMode::moving),
                         [](const auto& test) { return to_string(test.param); });

}  // namespace
}  // namespace orbifit
