// Objects with a main axis and twofold axes across it: Dn, Dnh, Dnd.

#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Geometry>

#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

TruthModel single(const std::string& name, const Mesh& mesh, const std::string& symbol,
                  const GroupFrame& frame = GroupFrame::Identity()) {
  SuiteBuilder model;
  model.add(model.kind({name, mesh, group(symbol), OwnRegion::expected, frame}));
  return model.finish();
}

// Flat triangles between a corner ring below and one above that stands half a step on.
Mesh antiprism(int corners, double height) {
  return subdivided(twisted(polygon_outline(corners, 1), height, -180.0 / corners, 1), 3);
}

TruthModel crossed_bars() {
  SuiteBuilder model;
  const int bar = model.kind({"bar", box({0.9, 0.16, 0.12}, {12, 2, 2}, 0.03, 2), group("D2h"), OwnRegion::optional});
  LocalFrame diagonal{frame_about(Vector3d::UnitZ(), Vector3d(1, 1, 0)), Vector3d::Zero()};
  model.orbit(bar, shift(0, 0, 0.3), group("D2d"), diagonal);
  model.add(model.kind({"post", box({0.1, 0.1, 0.27}, {2, 2, 4}, 0, 0), group("D4h"), OwnRegion::silent}));
  return model.finish();
}

// Arms on a post, those below half a step on.
TruthModel staggered_arms(int arms, const std::string& symbol) {
  SuiteBuilder model;
  model.add(model.kind({"post", cylinder(0.16, 0.7, 2 * arms * 6, 0.03), group("Dinfh"), OwnRegion::optional}));
  const int arm = model.kind({"arm", cone(0.12, 0.07, 0.9), group("Cinfv"), OwnRegion::optional});
  const double half_step = std::numbers::pi / (2 * arms);
  const LocalFrame about{frame_about(Vector3d::UnitZ(), Vector3d(std::cos(half_step), std::sin(half_step), 0)),
                         Vector3d::Zero()};
  model.orbit(arm, shift(0.02, 0, 0.45) * turn_y(90), group(symbol), about);
  return model.finish();
}

TruthModel dumbbell_star() {
  SuiteBuilder model;
  model.add(model.kind({"axle", cylinder(0.12, 0.6, 60, 0.02), group("Dinfh"), OwnRegion::optional}));
  const int plate =
      model.kind({"star", extruded(star_outline(5, 0.75, 0.36, 4), -0.1, 0.1, 2), group("D5h"), OwnRegion::optional});
  model.orbit(plate, shift(0, 0, 0.5), group("D5h"), level());
  return model.finish();
}

TruthModel gear_wheel() {
  SuiteBuilder model;
  model.add(model.kind({"gear", ring_of(gear_outline(12, 0.8, 1), 0.3, 0.15), group("D12h"), OwnRegion::expected}));
  model.add(model.kind(
      {"boss", turned_part({{0, -0.28, 0, 1}, {0.38, -0.28, 0.03, 3}, {0.38, 0.28, 0.03, 3}, {0, 0.28, 0, 1}}, 72),
       group("Dinfh")}));
  return model.finish();
}

TruthModel hand_wheel() {
  SuiteBuilder model;
  model.add(model.kind({"rim", torus(1, 0.1, 72), group("Dinfh")}));
  model.add(model.kind({"hub", cylinder(0.24, 0.16, 72, 0.04), group("Dinfh")}));
  const int spoke = model.kind({"spoke", cone(0.08, 0.06, 0.85), group("Cinfv"), OwnRegion::optional});
  model.orbit(spoke, shift(0.12, 0, 0) * turn_y(90), group("D8h"), level());
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> dihedral_suite() {
  const auto rope = [] {
    return twisted(round_outline(72, [](double angle) { return 0.32 + 0.07 * std::cos(6 * angle); }), 2.2, 100, 40);
  };
  return {
      {"twisted_bar_D2", "group",
       [] { return single("bar", twisted(rectangle_outline(0.5, 0.16, 8), 2, 100, 36), "D2"); }},
      {"twisted_prism_D3", "group",
       [] { return single("prism", twisted(polygon_outline(3, 0.6, 10), 1.8, 50, 30), "D3"); }},
      {"twisted_star_D5", "group",
       [] { return single("column", twisted(star_outline(5, 0.6, 0.32, 6), 1.7, 60, 30), "D5"); }},
      {"rope_D6", "group", [rope] { return single("rope", rope(), "D6"); }},
      {"brick_D2h", "group",
       [] {
         return single("brick", box({1, 0.6, 0.35}, {12, 8, 4}, 0.04, 3), "D2h");
       }},
      {"prism_D3h", "group",
       [] { return single("prism", extruded(polygon_outline(3, 0.6, 9), -0.8, 0.8, 12), "D3h"); }},
      {"slab_D4h", "group",
       [] {
         return single("slab", box({0.8, 0.8, 0.3}, {10, 10, 4}, 0.05, 3), "D4h");
       }},
      {"weights_D5h", "group", dumbbell_star},
      {"nut_D6h", "group",
       [] { return single("nut", subdivided(ring_of(polygon_outline(6, 1, 10), 0.55, 0.4)), "D6h"); }},
      {"heptagon_D7h", "group",
       [] { return single("dish", extruded(polygon_outline(7, 1, 8), -0.25, 0.25, 6), "D7h"); }},
      {"hand_wheel_D8h", "group", hand_wheel},
      {"gear_D12h", "group", gear_wheel},
      {"crossed_bars_D2d", "group", crossed_bars},
      {"antiprism_D3d", "group", [] { return single("body", antiprism(3, 0.8), "D3d"); }},
      {"staggered_arms_D4d", "group", [] { return staggered_arms(4, "D4d"); }},
      {"antiprism_D6d", "group", [] { return single("body", antiprism(6, 0.7), "D6d"); }},
  };
}

}  // namespace orbifit
