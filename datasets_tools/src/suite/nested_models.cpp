// Regions within regions, and groups about several axes.

#include <cmath>
#include <string>

#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

// About z, facing up; a corner at angle 0.
PartKind hexagon_bolt(double radius, double height) {
  const Mesh mesh = tapered(polygon_outline(6, radius, 2), -0.3 * height, height, 0.85, 3);
  return {"bolt", mesh, group("C6v"), OwnRegion::expected, upright().frame};
}

TruthModel road_wheel() {
  SuiteBuilder model;
  model.add(model.kind(
      {"rim",
       lathe(trace_profile(
                 {{1, -0.2, 0.04, 3}, {1.05, 0, 0, 3}, {1, 0.2, 0.04, 2}, {0.82, 0.2, 0.04, 4}, {0.82, -0.2, 0.04, 2}},
                 4, true),
             80, true),
       group("Dinfh")}));
  model.add(model.kind({"hub",
                        turned_part({{0, -0.15, 0, 2},
                                     {0.42, -0.15, 0.03, 3},
                                     {0.4, 0.1, 0.06, 4},
                                     {0.14, 0.12, 0.03, 2},
                                     {0.12, 0.26, 0.06, 2},
                                     {0, 0.26, 0, 1}},
                                    80),
                        group("Cinfv")}));
  const int spoke = model.kind(
      {"spoke", tapered(rectangle_outline(0.07, 0.12, 4), 0.3, 0.86, 0.7, 8), group("C2v"), OwnRegion::silent});
  model.orbit(spoke, shift(0, 0, 0.01) * turn_y(90), group("C5v"), upright());
  model.orbit(model.kind(hexagon_bolt(0.062, 0.1)), shift(0.28, 0, 0.1), group("C10v"), upright());
  const int valve = model.kind({"valve", cone(0.06, 0.04, 0.22), group("Cinfv"), OwnRegion::optional});
  model.add(valve, turn_z(23) * shift(0.85, 0, 0.05) * turn_y(-65));
  return model.finish();
}

TruthModel keyed_shaft() {
  SuiteBuilder model;
  model.add(model.kind({"gear", ring_of(gear_outline(18, 0.82, 1), 0.24, 0.16), group("D18h")}), shift(0, 0, 0.25));
  model.add(model.kind({"shaft",
                        turned_part({{0, -1.1, 0, 2}, {0.3, -1.1, 0.03, 16}, {0.3, 1.1, 0.03, 2}, {0, 1.1, 0, 1}}, 72),
                        group("Dinfh"), OwnRegion::optional}));
  model.add(model.kind({"key", box({0.16, 0.1, 0.3}, {4, 2, 6}, 0.01, 1), group("D2h"), OwnRegion::optional}),
            shift(0.29, 0, -0.6));
  model.expect(group("C18v"), upright());
  model.expect(group("Cs"), across(Vector3d::UnitY()));
  return model.finish();
}

TruthModel blower() {
  SuiteBuilder model;
  // About z, facing up, then turned to face -y.
  const Motion stand_up = turn_x(90);
  const auto facing = [&](const Motion& at) { return stand_up * at; };
  model.add(model.kind({"motor",
                        turned_part({{0, -0.5, 0, 2}, {0.26, -0.5, 0.1, 5}, {0.24, 0.1, 0.1, 3}, {0, 0.22, 0, 1}}, 70),
                        group("Cinfv")}),
            facing({}));
  model.add(model.kind({"guard", torus(1.08, 0.07, 90, 16), group("Dinfh")}), facing({}));
  const LocalFrame axis = image(stand_up, level());
  model.orbit(model.kind({"blade", blade(0.18, 0.95, 0.55, 30, 0.09), {}}), facing(shift(0, 0, -0.02)), group("C5"),
              axis);
  model.add(
      model.kind({"foot",
                  turned_part({{0, -0.06, 0, 4}, {0.6, -0.06, 0.02, 2}, {0.55, 0.06, 0.03, 6}, {0, 0.08, 0, 1}}, 60),
                  group("Cinfv"), OwnRegion::optional}),
      shift(0, 0.2, -1.7));
  model.add(model.kind({"pole", tapered(rectangle_outline(0.08, 0.06, 2), -1.7, -0.1, 0.8, 10), group("C2v"),
                        OwnRegion::silent}),
            shift(0, 0.3, 0));
  model.add(model.kind({"bracket", box({0.05, 0.2, 0.07}, {2, 4, 2}, 0, 0), group("D2h"), OwnRegion::silent}),
            shift(0, 0.13, -1.05));
  model.expect(group("Cs"), across(Vector3d::UnitX()));
  model.expect(group("Cinfv"), axis);
  return model.finish();
}

TruthModel flange() {
  SuiteBuilder model;
  model.add(model.kind({"flange",
                        turned_part({{0, -0.1, 0, 4},
                                     {1, -0.1, 0.02, 2},
                                     {1, 0.08, 0.02, 5},
                                     {0.34, 0.09, 0.06, 4},
                                     {0.3, 0.6, 0.02, 4},
                                     {0, 0.6, 0, 1}},
                                    72),
                        group("Cinfv")}));
  PartKind small = hexagon_bolt(0.1, 0.12);
  PartKind large = hexagon_bolt(0.13, 0.18);
  small.name = "outer bolt";
  large.name = "inner bolt";
  model.orbit(model.kind(small), shift(0.83, 0, 0.08), group("C6v"), upright());
  model.orbit(model.kind(large), shift(0.53, 0, 0.08), group("C4v"), upright());
  return model.finish();
}

TruthModel clock() {
  SuiteBuilder model;
  model.add(model.kind({"case",
                        turned_part({{0, -0.12, 0, 4},
                                     {0.95, -0.12, 0.04, 2},
                                     {1, 0.12, 0.03, 2},
                                     {0.9, 0.12, 0.02, 1},
                                     {0.88, 0.05, 0.02, 8},
                                     {0, 0.05, 0, 1}},
                                    72),
                        group("Cinfv")}));
  const int quarter =
      model.kind({"quarter", box({0.12, 0.05, 0.06}, {4, 2, 2}, 0, 0), group("D2h"), OwnRegion::optional});
  model.orbit(quarter, shift(0.7, 0, 0.07), group("C4v"), upright());
  const int hour = model.kind({"hour", box({0.06, 0.04, 0.06}, {2, 2, 2}, 0, 0), group("D2h"), OwnRegion::silent});
  for (const double degrees : {30.0, 60.0})
    model.orbit(hour, turn_z(degrees) * shift(0.75, 0, 0.07), group("C4v"), upright());
  const int hand = model.kind(
      {"minute hand", tapered(rectangle_outline(0.05, 0.04), -0.1, 0.65, 0.6, 6), group("C2v"), OwnRegion::silent});
  model.add(hand, turn_z(97) * shift(0, 0, 0.1) * turn_y(90));
  const int short_hand = model.kind(
      {"hour hand", tapered(rectangle_outline(0.05, 0.06), -0.1, 0.42, 0.7, 4), group("C2v"), OwnRegion::silent});
  model.add(short_hand, turn_z(141) * shift(0, 0, 0.11) * turn_y(90));
  model.add(model.kind({"pin", cylinder(0.09, 0.12, 36, 0.02), group("Dinfh"), OwnRegion::silent}), shift(0, 0, 0.08));
  return model.finish();
}

TruthModel chandelier() {
  SuiteBuilder model;
  model.add(model.kind({"stem",
                        turned_part({{0, -0.35, 0, 1},
                                     {0.14, -0.3, 0.05, 2},
                                     {0.2, 0, 0.1, 3},
                                     {0.06, 0.3, 0.05, 4},
                                     {0.06, 0.9, 0, 1},
                                     {0.2, 1, 0.02, 1},
                                     {0, 1.02, 0, 1}},
                                    64),
                        group("Cinfv")}));
  const std::vector<Vector3d> path{{0.1, 0, 0.02}, {0.35, 0, -0.12}, {0.65, 0, -0.15}, {0.9, 0, 0}, {0.95, 0, 0.22}};
  const int arm = model.kind(
      {"arm", rod(path, Vector3d::UnitY(), 0.05, 12), group("Cs"), OwnRegion::silent, across(Vector3d::UnitY()).frame});
  model.orbit(arm, {}, group("C8v"), upright());
  const int candle = model.kind({"candle",
                                 turned_part({{0, 0, 0, 1},
                                              {0.12, 0, 0, 1},
                                              {0.15, 0.06, 0, 1},
                                              {0.06, 0.07, 0, 4},
                                              {0.055, 0.45, 0.01, 1},
                                              {0, 0.47, 0, 1}},
                                             32),
                                 group("Cinfv")});
  model.orbit(candle, shift(0.95, 0, 0.2), group("C8v"), upright());
  return model.finish();
}

PartKind column(double height, int facets) {
  return {"column",
          turned_part({{0, 0, 0, 1},
                       {0.17, 0, 0, 1},
                       {0.17, 0.22, 0, 1},
                       {0.11, 0.26, 0.02, 6},
                       {0.075, height - 0.14, 0.02, 1},
                       {0.14, height - 0.08, 0, 1},
                       {0.14, height, 0, 1},
                       {0, height, 0, 1}},
                      facets, 3),
          group("Cinfv")};
}

TruthModel rotunda() {
  SuiteBuilder model;
  const Mesh floor = turned_part({{0, -0.2, 0, 4},
                                  {1.35, -0.2, 0, 2},
                                  {1.35, -0.08, 0, 1},
                                  {1.25, -0.07, 0, 2},
                                  {1.24, 0.03, 0, 6},
                                  {0, 0.04, 0, 1}},
                                 80);
  const Mesh roof = turned_part({{0, 0, 0, 6},
                                 {1.22, 0, 0.02, 2},
                                 {1.22, 0.15, 0.02, 2},
                                 {1.0, 0.16, 0.05, 2},
                                 {0.75, 0.8, 0.6, 2},
                                 {0, 0.85, 0, 1}},
                                80);
  model.add(model.kind({"floor", floor, group("Cinfv"), OwnRegion::optional}));
  model.add(model.kind({"roof", roof, group("Cinfv"), OwnRegion::optional}), shift(0, 0, 1.38));
  model.orbit(model.kind(column(1.4, 24)), shift(1.0, 0, 0.02), group("C10v"), upright());
  model.expect(group("Cinfv"));
  model.add(
      model.kind({"porch", tapered(rectangle_outline(0.3, 0.25, 4), 0, 0.8, 0.8, 6), group("C2v"), OwnRegion::silent}),
      shift(1.5, 0, -0.19));
  model.expect(group("Cs"), across(Vector3d::UnitY()));
  return model.finish();
}

TruthModel satellite() {
  SuiteBuilder model;
  model.add(model.kind({"body", box({0.4, 0.4, 0.5}, {6, 6, 8}, 0.04, 2), group("D4h"), OwnRegion::optional}));
  const int panel = model.kind({"panel", box({0.65, 0.3, 0.05}, {12, 6, 2}, 0, 0), group("D2h"), OwnRegion::optional});
  model.orbit(panel, shift(1.15, 0, 0.0), group("C2v"));
  model.orbit(model.kind({"boom", cylinder(0.06, 0.2, 32), group("Dinfh"), OwnRegion::silent}),
              shift(0.45, 0, 0) * turn_y(90), group("C2v"));
  model.add(model.kind({"dish",
                        turned_part({{0, 0, 0, 1},
                                     {0.09, 0, 0.02, 2},
                                     {0.12, 0.12, 0.05, 5},
                                     {0.55, 0.35, 0.01, 1},
                                     {0.5, 0.4, 0.01, 6},
                                     {0.1, 0.2, 0.05, 1},
                                     {0, 0.19, 0, 1}},
                                    64),
                        group("Cinfv")}),
            shift(0, 0, 0.47));
  return model.finish();
}

TruthModel teapot() {
  SuiteBuilder model;
  model.add(model.kind({"pot",
                        turned_part({{0, 0, 0, 3},
                                     {0.4, 0, 0.06, 2},
                                     {0.75, 0.4, 0.4, 4},
                                     {0.35, 0.85, 0.1, 2},
                                     {0.33, 0.9, 0.02, 2},
                                     {0.1, 0.95, 0.03, 1},
                                     {0.12, 1.1, 0.05, 1},
                                     {0, 1.12, 0, 1}},
                                    72, 8),
                        group("Cinfv")}));
  const std::vector<Vector3d> spout{{0.4, 0, 0.3}, {0.7, 0, 0.4}, {0.9, 0, 0.65}, {1.1, 0, 0.85}};
  const std::vector<Vector3d> handle{{-0.45, 0, 0.25}, {-0.75, 0, 0.25}, {-0.95, 0, 0.45},
                                     {-0.9, 0, 0.7},   {-0.65, 0, 0.8},  {-0.35, 0, 0.72}};
  const GroupFrame plane = across(Vector3d::UnitY()).frame;
  model.add(model.kind({"spout", rod(spout, Vector3d::UnitY(), 0.11, 20), group("Cs"), OwnRegion::silent, plane}));
  model.add(model.kind({"handle", rod(handle, Vector3d::UnitY(), 0.07, 16), group("Cs"), OwnRegion::silent, plane}));
  model.expect(group("Cs"), across(Vector3d::UnitY()));
  return model.finish();
}

TruthModel two_gears() {
  SuiteBuilder model;
  model.add(model.kind({"plate", box({1.9, 1.05, 0.1}, {16, 10, 2}, 0.03, 1), group("D2h"), OwnRegion::optional}),
            shift(0.15, 0, -0.4));
  const auto train = [&](const std::string& name, int teeth, double root, double tip, const Motion& at,
                         double thickness) {
    const std::string n = std::to_string(teeth);
    model.add(model.kind({name, ring_of(gear_outline(teeth, root, tip), 0.15, thickness), group("D" + n + "h"),
                          OwnRegion::expected}),
              at);
    model.add(model.kind({"pin of the " + name, cylinder(0.19, 0.45, 80, 0.02), group("Dinfh"), OwnRegion::silent}),
              shift(0, 0, -0.02) * at);
    model.expect(group("C" + n + "v"), image(at, upright()));
  };
  train("wheel", 16, 0.83, 0.98, shift(-0.65, 0, 0), 0.14);
  train("pinion", 10, 0.52, 0.7, shift(0.9, 0, 0) * turn_z(11), 0.2);
  return model.finish();
}

TruthModel round_table() {
  SuiteBuilder model;
  model.add(model.kind({"carpet", cylinder(1.6, 0.06, 96, 0.02), group("Dinfh"), OwnRegion::optional}));
  model.add(
      model.kind({"top", turned_part({{0, 0, 0, 4}, {0.8, 0, 0.02, 2}, {0.85, 0.1, 0.02, 6}, {0, 0.11, 0, 1}}, 72),
                  group("Cinfv"), OwnRegion::optional}),
      shift(0, 0, 0.85));
  const int leg =
      model.kind({"leg", tapered(rectangle_outline(0.07, 0.07, 2), 0, 0.85, 1.3, 8), group("C4v"), OwnRegion::silent});
  model.orbit(leg, shift(0.5, 0, 0.02), group("C4v"), upright());
  const int stool = model.kind({"stool",
                                turned_part({{0, 0, 0, 2},
                                             {0.24, 0, 0.02, 1},
                                             {0.22, 0.06, 0.02, 1},
                                             {0.08, 0.12, 0.05, 3},
                                             {0.08, 0.4, 0.04, 1},
                                             {0.26, 0.48, 0.02, 1},
                                             {0.24, 0.56, 0.03, 3},
                                             {0, 0.57, 0, 1}},
                                            36, 2),
                                group("Cinfv")});
  model.orbit(stool, shift(1.25, 0, 0.04), group("C6v"), upright());
  model.expect(group("Cinfv"));
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> nested_suite() {
  return {{"road_wheel", "nested", road_wheel},
          {"keyed_shaft", "nested", keyed_shaft},
          {"blower", "nested", blower},
          {"flange_4_6", "nested", flange},
          {"clock", "nested", clock},
          {"chandelier", "nested", chandelier},
          {"rotunda", "nested", rotunda},
          {"satellite", "nested", satellite},
          {"teapot", "nested", teapot},
          {"two_gears", "nested", two_gears},
          {"round_table", "nested", round_table}};
}

}  // namespace orbifit
