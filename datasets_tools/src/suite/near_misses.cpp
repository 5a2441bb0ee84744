// Shapes that just miss a larger group: what breaks it is 1.5 to 3 % of the diagonal.

#include <string>

#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

// A quarter turn brings its sides 1.5 % of the diagonal off.
TruthModel nearly_square_box() {
  SuiteBuilder model;
  model.add(model.kind({"box", box({1, 0.92, 0.5}, {10, 10, 6}, 0.05, 3), group("D2h")}));
  return model.finish();
}

// One tooth stands 8 degrees aside.
TruthModel shifted_tooth() {
  SuiteBuilder model;
  model.add(model.kind({"disc", cylinder(0.8, 0.2, 72, 0.03), group("Dinfh")}));
  const Mesh tooth = moved(tapered(rectangle_outline(0.15, 0.1, 3), 0.7, 1.12, 0.8, 6), turn_y(90));
  const int kind = model.kind(
      {"tooth", tooth, group("C2v"), OwnRegion::silent, frame_about(Vector3d::UnitX(), Vector3d(Vector3d::UnitY()))});
  std::vector<std::vector<int>> teeth;
  for (int i = 1; i < 12; ++i) teeth.push_back({model.add(kind, turn_z(30.0 * i))});
  model.add(kind, turn_z(8));
  model.expect(group("C2v"), {frame_about(Vector3d::UnitX(), Vector3d(Vector3d::UnitY())), Vector3d::Zero()});
  model.expect(group("Cs"), across(Vector3d::UnitZ()));
  model.expect_pattern("teeth", Pattern::Kind::rotation, {turn_z(30)}, teeth);
  return model.finish();
}

TruthModel missing_bolt() {
  SuiteBuilder model;
  model.add(model.kind({"flange",
                        turned_part({{0, -0.12, 0, 4},
                                     {1, -0.12, 0.02, 2},
                                     {1, 0.1, 0.02, 5},
                                     {0.4, 0.11, 0.05, 3},
                                     {0.36, 0.5, 0.03, 4},
                                     {0, 0.5, 0, 1}},
                                    72),
                        group("Cinfv")}));
  const int bolt = model.kind({"bolt", tapered(polygon_outline(6, 0.14, 2), -0.05, 0.2, 0.85, 3), group("C6v"),
                               OwnRegion::expected, upright().frame});
  std::vector<std::vector<int>> bolts;
  for (int i = 1; i < 8; ++i) bolts.push_back({model.add(bolt, turn_z(45.0 * i) * shift(0.72, 0, 0.1))});
  model.expect(group("Cs"), across(Vector3d::UnitY()));
  model.expect_pattern("bolts", Pattern::Kind::rotation, {turn_z(45)}, bolts);
  return model.finish();
}

// Every other merlon is higher by 2 % of the diagonal.
TruthModel crown() {
  SuiteBuilder model;
  model.add(model.kind(
      {"ring",
       lathe(trace_profile({{1, -0.2, 0.02, 3}, {1.02, 0.25, 0.02, 2}, {0.82, 0.25, 0.02, 3}, {0.8, -0.2, 0.02, 2}}, 3,
                           true),
             72, true),
       group("Cinfv")}));
  const auto merlon = [&](double height) {
    return model.kind(
        {"merlon", extruded(rectangle_outline(0.14, 0.12, 3), 0, height, 4), group("D2h"), OwnRegion::silent});
  };
  model.orbit(merlon(0.5), shift(0.92, 0, 0.16), group("C6v"), upright());
  model.orbit(merlon(0.57), turn_z(30) * shift(0.92, 0, 0.16), group("C6v"), upright());
  return model.finish();
}

TruthModel unequal_cross() {
  SuiteBuilder model;
  model.add(model.kind({"long bar", box({1, 0.2, 0.19}, {14, 4, 4}, 0.03, 2), group("D2h"), OwnRegion::optional}));
  model.add(model.kind({"bar", box({0.2, 0.93, 0.2}, {4, 14, 4}, 0.03, 2), group("D2h"), OwnRegion::optional}));
  model.expect(group("D2h"));
  return model.finish();
}

// Twelve degrees of twist leave no mirror.
TruthModel nearly_straight_prism() {
  SuiteBuilder model;
  model.add(model.kind({"prism", twisted(rectangle_outline(0.5, 0.5, 8), 1.8, 12, 24), group("D4")}));
  return model.finish();
}

TruthModel unequal_handles() {
  SuiteBuilder model;
  model.add(model.kind({"urn",
                        turned_part({{0, 0, 0, 3},
                                     {0.4, 0, 0.05, 3},
                                     {0.6, 0.7, 0.5, 5},
                                     {0.35, 1.2, 0.1, 2},
                                     {0.42, 1.3, 0.02, 3},
                                     {0, 1.25, 0, 1}},
                                    72, 8),
                        group("Cinfv")}));
  const auto handle = [&](double reach, const std::string& name) {
    const std::vector<Vector3d> path{
        {0.35, 0, 0.4}, {reach, 0, 0.45}, {reach + 0.1, 0, 0.8}, {reach - 0.05, 0, 1.05}, {0.32, 0, 1.05}};
    return model.kind({name, rod(path, Vector3d::UnitY(), 0.07, 16), group("Cs"), OwnRegion::silent,
                       across(Vector3d::UnitY()).frame});
  };
  model.add(handle(0.78, "handle"));
  model.add(handle(0.86, "larger handle"), turn_z(180));
  model.expect(group("Cs"), across(Vector3d::UnitY()));
  return model.finish();
}

// One tip of five is longer.
TruthModel long_tip() {
  SuiteBuilder model;
  Outline outline = star_outline(5, 1, 0.48, 7);
  for (Eigen::Vector2d& point : outline) {
    if (point.x() > 0.5) point.x() = 0.5 + 1.16 * (point.x() - 0.5);
  }
  model.add(model.kind({"star", extruded(outline, -0.15, 0.15, 3), group("C2v"), OwnRegion::expected,
                        frame_about(Vector3d::UnitX(), Vector3d(Vector3d::UnitY()))}));
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> near_miss_suite() {
  return {{"nearly_square_box", "near miss", nearly_square_box},
          {"shifted_tooth", "near miss", shifted_tooth},
          {"missing_bolt", "near miss", missing_bolt},
          {"crown_C6v", "near miss", crown},
          {"unequal_cross", "near miss", unequal_cross},
          {"nearly_straight_prism", "near miss", nearly_straight_prism},
          {"unequal_handles", "near miss", unequal_handles},
          {"long_tip", "near miss", long_tip}};
}

}  // namespace orbifit
