// Shapes of the lathe.

#include <string>

#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

TruthModel turned_model(const std::string& name, const Mesh& mesh, const std::string& symbol) {
  SuiteBuilder model;
  model.add(model.kind({name, mesh, group(symbol)}));
  return model.finish();
}

TruthModel vase() {
  return turned_model("vase",
                      turned_part({{0, 0, 0, 3},
                                   {0.35, 0, 0.06, 6},
                                   {0.62, 0.7, 0.6, 6},
                                   {0.2, 1.3, 0.3, 4},
                                   {0.34, 1.6, 0.02, 2},
                                   {0.26, 1.6, 0.02, 4},
                                   {0.13, 1.3, 0.3, 6},
                                   {0.5, 0.7, 0.5, 6},
                                   {0.28, 0.12, 0.08, 3},
                                   {0, 0.1, 0, 1}},
                                  72),
                      "Cinfv");
}

TruthModel bowl() {
  return turned_model("bowl",
                      turned_part({{0, 0, 0, 3},
                                   {0.4, 0, 0.04, 3},
                                   {0.42, 0.08, 0.05, 6},
                                   {1, 0.6, 0.04, 2},
                                   {0.9, 0.62, 0.04, 8},
                                   {0.35, 0.16, 0.3, 4},
                                   {0, 0.13, 0, 1}},
                                  80),
                      "Cinfv");
}

TruthModel goblet() {
  SuiteBuilder model;
  model.add(model.kind({"foot",
                        turned_part({{0, 0, 0, 4},
                                     {0.45, 0, 0.02, 1},
                                     {0.44, 0.07, 0.02, 5},
                                     {0.1, 0.14, 0.1, 5},
                                     {0.08, 0.75, 0, 2},
                                     {0, 0.75, 0, 1}},
                                    72),
                        group("Cinfv")}));
  model.add(model.kind(
      {"knob", turned_part({{0, 0.38, 0, 2}, {0.16, 0.42, 0.05, 2}, {0.14, 0.52, 0.05, 2}, {0, 0.56, 0, 1}}, 72),
       group("Cinfv")}));
  model.add(model.kind({"cup",
                        turned_part({{0, 0.7, 0, 2},
                                     {0.25, 0.72, 0.1, 5},
                                     {0.45, 1.5, 0.02, 2},
                                     {0.37, 1.5, 0.02, 6},
                                     {0.18, 0.82, 0.1, 2},
                                     {0, 0.8, 0, 1}},
                                    72),
                        group("Cinfv")}));
  return model.finish();
}

TruthModel dumb_bell() {
  SuiteBuilder model;
  const int end = model.kind({"ball", ball(0.4, 72), group("Kh"), OwnRegion::optional});
  model.add(end, shift(0, 0, 0.85));
  model.add(end, shift(0, 0, -0.85));
  model.expect(group("Dinfh"));
  model.add(model.kind({"grip", cylinder(0.16, 0.6, 72), group("Dinfh"), OwnRegion::optional}));
  return model.finish();
}

TruthModel spool() {
  return turned_model("spool",
                      turned_part({{0, -0.5, 0, 4},
                                   {0.6, -0.5, 0.05, 3},
                                   {0.6, -0.35, 0.05, 3},
                                   {0.3, -0.25, 0.08, 6},
                                   {0.3, 0.25, 0.08, 3},
                                   {0.6, 0.35, 0.05, 3},
                                   {0.6, 0.5, 0.05, 4},
                                   {0, 0.5, 0, 1}},
                                  72),
                      "Dinfh");
}

TruthModel mug() {
  SuiteBuilder model;
  model.add(model.kind({"body",
                        turned_part({{0, 0, 0, 4},
                                     {0.42, 0, 0.06, 8},
                                     {0.45, 1, 0.03, 2},
                                     {0.37, 1, 0.03, 8},
                                     {0.35, 0.1, 0.06, 4},
                                     {0, 0.08, 0, 1}},
                                    72),
                        group("Cinfv")}));
  std::vector<Eigen::Vector3d> path;
  for (int k = 0; k <= 20; ++k) {
    const Motion turn = turn_y(-85 + 170.0 * k / 20);
    path.push_back(Eigen::Vector3d(0.42, 0, 0.5) + turn(Eigen::Vector3d(0.36, 0, 0)));
  }
  model.add(model.kind({"handle",
                        rod(path, Eigen::Vector3d::UnitY(), 0.07, 16),
                        group("C2v"),
                        OwnRegion::silent,
                        frame_about(Eigen::Vector3d::UnitX(), Eigen::Vector3d(Eigen::Vector3d::UnitY())),
                        {0.42, 0, 0.5}}));
  model.expect(group("Cs"), across(Eigen::Vector3d::UnitY()));
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> turned_suite() {
  return {
      {"vase", "continuous", vase},
      {"bowl", "continuous", bowl},
      {"goblet", "continuous", goblet},
      {"torus", "continuous", [] { return turned_model("ring", torus(1, 0.28, 80, 28), "Dinfh"); }},
      {"dumb_bell", "continuous", dumb_bell},
      {"spool", "continuous", spool},
      {"ball", "continuous", [] { return turned_model("ball", icosahedral_ball(1, 4), "Kh"); }},
      {"mug", "continuous", mug},
  };
}

}  // namespace orbifit
