// Objects with several axes of order three or more.

#include <string>

#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

// From +z towards a direction.
Motion pointing(const Vector3d& direction) {
  return {frame_about(direction.normalized()), Vector3d::Zero()};
}

TruthModel caltrop() {
  SuiteBuilder model;
  model.add(model.kind({"ball", cubic_ball(0.35, 4), group("Kh"), OwnRegion::optional}));
  const int arm = model.kind({"arm", cone(0.2, 0.1, 0.95), group("Cinfv"), OwnRegion::optional});
  model.orbit(arm, pointing({1, 1, 1}) * shift(0, 0, 0.1), group("Td"));
  return model.finish();
}

// A cube with a bar on every side, those of neighbouring sides across each other.
TruthModel barred_cube() {
  SuiteBuilder model;
  model.add(model.kind({"cube", box({0.6, 0.6, 0.6}, {6, 6, 6}, 0.05, 2), group("Oh"), OwnRegion::optional}));
  const int bar = model.kind({"bar", box({0.4, 0.12, 0.15}, {6, 2, 2}, 0.02, 1), group("D2h"), OwnRegion::optional});
  model.orbit(bar, shift(0, 0, 0.62), group("Th"));
  return model.finish();
}

// A cube with four slanting fins on every side.
TruthModel pinwheel_cube() {
  SuiteBuilder model;
  model.add(model.kind({"cube", box({0.6, 0.6, 0.6}, {6, 6, 6}, 0.05, 2), group("Oh"), OwnRegion::optional}));
  const int fin = model.kind({"fin", box({0.2, 0.06, 0.12}, {4, 2, 2}, 0, 0), group("D2h"), OwnRegion::silent});
  model.orbit(fin, shift(0.32, 0.1, 0.65) * turn_z(25), group("O"));
  return model.finish();
}

TruthModel jack() {
  SuiteBuilder model;
  model.add(model.kind({"heart", cubic_ball(0.25), group("Kh"), OwnRegion::silent}));
  const int arm = model.kind({"arm", cone(0.13, 0.11, 0.85), group("Cinfv"), OwnRegion::silent});
  model.orbit(arm, shift(0, 0, 0.05), group("Oh"));
  const int knob = model.kind({"knob", cubic_ball(0.22), group("Kh"), OwnRegion::optional});
  model.orbit(knob, shift(0, 0, 0.95), group("Oh"));
  return model.finish();
}

TruthModel spiked_ball() {
  SuiteBuilder model;
  model.add(model.kind({"ball", icosahedral_ball(0.7, 4), group("Kh"), OwnRegion::optional}));
  const int spike = model.kind({"spike", cone(0.16, 0.08, 0.5, 30), group("Cinfv"), OwnRegion::optional});
  model.orbit(spike, pointing(fivefold_axes().front()) * shift(0, 0, 0.6), group("Ih"));
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> polyhedral_suite() {
  return {
      {"caltrop_Td", "group", caltrop},
      {"barred_cube_Th", "group", barred_cube},
      {"pinwheel_cube_O", "group", pinwheel_cube},
      {"jack_Oh", "group", jack},
      {"spiked_ball_Ih", "group", spiked_ball},
  };
}

}  // namespace orbifit
