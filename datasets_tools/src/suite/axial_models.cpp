// Objects with one axis or one plane: Cs, Cn, Cnv, Cnh.

#include <cmath>
#include <numbers>
#include <string>

#include "models/shapes.h"
#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

TruthModel bird() {
  SuiteBuilder model;
  const Curve back = smooth_curve({{-1, 0, 0.25}, {-0.5, 0, 0.05}, {0.2, 0, 0}, {0.55, 0, 0.3}, {0.75, 0, 0.75}});
  model.add(model.kind({"body",
                        tube({6, 6, 30}, back, Vector3d::UnitY(),
                             [](double share) {
                               return smooth_table({{0, 0.1}, {0.4, 0.36}, {0.75, 0.16}, {0.9, 0.2}, {1, 0.17}}, share);
                             }),
                        group("Cs"), OwnRegion::expected, across(Vector3d::UnitY()).frame}));
  const int beak = model.kind({"beak", cone(0.1, 0.04, 0.32), group("Cinfv"), OwnRegion::optional});
  model.add(beak, shift(0.85, 0, 0.85) * turn_y(105));
  const int wing = model.kind({"wing", moved(blade(0.1, 1.1, 0.7, 14, 0.12), turn_z(75)), {}});
  model.orbit(wing, shift(-0.05, 0.18, 0.12), group("Cs"), across(Vector3d::UnitY()));
  return model.finish();
}

TruthModel propeller(int blades) {
  const std::string name = "C" + std::to_string(blades);
  SuiteBuilder model;
  const int facets = blades * ((59 + blades) / blades);
  // Not alike at its ends, and too blunt for a ball.
  model.add(model.kind(
      {"hub",
       turned_part({{0, -0.3, 0, 2}, {0.24, -0.3, 0.03, 3}, {0.3, 0.1, 0.2, 2}, {0.1, 0.42, 0.06, 2}, {0, 0.42, 0, 1}},
                   facets),
       group("Cinfv")}));
  const double chord = std::min(0.6, 3.0 / blades);
  model.orbit(model.kind({"blade", blade(0.17, 1, chord, 32, 0.12), {}}), {}, group(name));
  return model.finish();
}

TruthModel trestle_table() {
  SuiteBuilder model;
  model.add(model.kind({"top", box({0.8, 0.42, 0.05}, {8, 4, 2}, 0.02, 2), group("D2h"), OwnRegion::optional}),
            shift(0, 0, 0.7));
  const int leg =
      model.kind({"leg", tapered(rectangle_outline(0.1, 0.34, 4), -0.67, 0, 0.75, 6), group("C2v"), OwnRegion::silent});
  model.orbit(leg, shift(0.5, 0, 0.67), group("C2v"));
  model.add(model.kind({"stretcher", box({0.5, 0.05, 0.06}, {8, 2, 2}, 0, 0), group("D2h"), OwnRegion::optional}),
            shift(0, 0, 0.3));
  return model.finish();
}

TruthModel stool(int legs, const std::string& symbol) {
  SuiteBuilder model;
  model.add(
      model.kind(
          {"seat",
           turned_part(
               {{0, -0.06, 0, 3}, {0.42, -0.06, 0.03, 2}, {0.46, 0.06, 0.03, 4}, {0.3, 0.04, 0.1, 2}, {0, 0.03, 0, 1}},
               72),
           group("Cinfv")}),
      shift(0, 0, 0.7));
  const int leg = model.kind({"leg", cone(0.035, 0.06, 0.74), group("Cinfv"), OwnRegion::optional});
  model.orbit(leg, shift(0.44, 0, 0) * turn_y(-14), group(symbol), upright());
  const int rung = model.kind({"foot", ball(0.06, 24), group("Kh"), OwnRegion::silent});
  model.orbit(rung, shift(0.44, 0, 0.0), group("C" + std::to_string(legs) + "v"), upright());
  return model.finish();
}

// One skin whose section has n lobes.
TruthModel lobed(int lobes, double depth, const std::vector<Eigen::Vector2d>& profile) {
  SuiteBuilder model;
  const Mesh mesh = turned({lobes, lobes < 5 ? 10 : 6, 24}, profile, [&](double share, double cosine, double sine) {
    return 1 + depth * std::sin(std::numbers::pi * share) * cosine_of_multiple(lobes, cosine, sine);
  });
  const std::string symbol = "C" + std::to_string(lobes) + "v";
  model.add(model.kind({"body", mesh, group(symbol), OwnRegion::expected, upright().frame}));
  return model.finish();
}

TruthModel pyramid() {
  SuiteBuilder model;
  const auto step = [&](const std::string& name, double half, double low, double high) {
    const Outline square = rectangle_outline(half, half, 6);
    model.add(model.kind({name, tapered(square, low, high, 0.9, 2), group("C4v"), OwnRegion::silent}));
  };
  step("base", 1, 0, 0.25);
  step("middle", 0.75, 0.2, 0.55);
  step("upper", 0.5, 0.5, 0.85);
  step("top", 0.25, 0.8, 1.15);
  model.expect(group("C4v"));
  return model.finish();
}

TruthModel daisy() {
  SuiteBuilder model;
  model.add(model.kind({"heart",
                        turned_part({{0, -0.1, 0, 2}, {0.3, -0.1, 0.06, 2}, {0.3, 0.12, 0.1, 4}, {0, 0.16, 0, 1}}, 60),
                        group("Cinfv")}));
  const Mesh petal =
      moved(capped_skin({6, 4, 8},
                        [](double share, double cosine, double sine) {
                          const double wide = std::sin(std::numbers::pi * share);
                          return Vector3d(0.22 + 0.78 * share, 0.15 * wide * cosine * (0.7 + 0.6 * share),
                                          0.06 * wide * sine + 0.1 * share * share);
                        }),
            {});
  model.orbit(model.kind({"petal", petal, group("Cs"), OwnRegion::silent, across(Vector3d::UnitY()).frame}), {},
              group("C10v"), upright());
  model.add(model.kind({"stalk", cone(0.09, 0.06, 0.9, 30), group("Cinfv"), OwnRegion::silent}),
            shift(0, 0, -0.05) * turn_x(180));
  return model.finish();
}

TruthModel z_bracket() {
  SuiteBuilder model;
  model.add(model.kind({"bar", box({0.6, 0.14, 0.12}, {8, 2, 2}, 0, 0), group("D2h"), OwnRegion::optional}));
  const Mesh hook = tapered(rectangle_outline(0.15, 0.1, 4), 0, 0.55, 0.7, 8);
  model.orbit(model.kind({"hook", hook, group("C2v"), OwnRegion::silent}), shift(0.5, 0.05, 0) * turn_x(-90),
              group("C2h"));
  return model.finish();
}

TruthModel triskelion() {
  SuiteBuilder model;
  model.add(model.kind({"hub", cylinder(0.3, 0.14, 60, 0.03), group("Dinfh")}));
  const Curve bend = smooth_curve({{0.15, 0, 0}, {0.55, 0.05, 0}, {0.9, 0.3, 0}, {0.95, 0.65, 0}});
  const Mesh arm = tube({6, 5, 20}, bend, Vector3d::UnitZ(), [](double share) { return 0.11 - 0.05 * share; });
  model.orbit(model.kind({"arm", arm, group("Cs"), OwnRegion::silent}), {}, group("C3h"));
  return model.finish();
}

TruthModel saw_blade() {
  SuiteBuilder model;
  model.add(model.kind({"blade", subdivided(ring_of(saw_outline(12, 0.85, 1), 0.25, 0.06)), group("C12h")}));
  model.add(model.kind({"collar", cylinder(0.4, 0.1, 60, 0.02), group("Dinfh")}));
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> axial_suite() {
  return {
      {"bird", "group", bird},
      {"propeller_C2", "group", [] { return propeller(2); }},
      {"propeller_C3", "group", [] { return propeller(3); }},
      {"propeller_C4", "group", [] { return propeller(4); }},
      {"impeller_C9", "group", [] { return propeller(9); }},
      {"impeller_C12", "group", [] { return propeller(12); }},
      {"trestle_table_C2v", "group", trestle_table},
      {"stool_C3v", "group", [] { return stool(3, "C3v"); }},
      {"pyramid_C4v", "group", pyramid},
      {"cup_C5v", "group",
       [] {
         return lobed(5, 0.16,
                      trace_profile({{0, 0, 0, 1},
                                     {0.45, 0, 0.1, 1},
                                     {0.8, 1, 0.05, 1},
                                     {0.7, 1, 0.05, 1},
                                     {0.35, 0.12, 0.1, 1},
                                     {0, 0.12, 0, 1}},
                                    6, false));
       }},
      {"pumpkin_C8v", "group",
       [] {
         return lobed(8, 0.12,
                      trace_profile({{0, 0, 0, 1},
                                     {0.9, -0.05, 0.4, 1},
                                     {0.95, 0.9, 0.5, 1},
                                     {0.15, 0.75, 0.1, 1},
                                     {0.1, 1.1, 0.06, 1},
                                     {0, 1.1, 0, 1}},
                                    8, false));
       }},
      {"daisy_C10v", "group", daisy},
      {"bracket_C2h", "group", z_bracket},
      {"triskelion_C3h", "group", triskelion},
      {"saw_blade_C12h", "group", saw_blade},
  };
}

}  // namespace orbifit
