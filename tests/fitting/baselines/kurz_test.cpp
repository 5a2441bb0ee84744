#include "orbifit/baselines/kurz.h"
#include <gtest/gtest.h>
#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
namespace orbifit { namespace {
TEST(Kurz, Runs) {
  RunContext context;
  const GeneratedModel model = generate("table");
  const GeneratedModel truth = generate("table", {{"width", 1.0}});
  const PointCloud scan = virtual_scan(truth.mesh, {}, context);
  const FitResult result = fit_kurz({model.mesh, model.truth, scan, Similarity{}, {}, {}}, {}, context);
  EXPECT_TRUE(result.converged);
}
}}
