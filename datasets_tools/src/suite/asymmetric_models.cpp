// No symmetry at all.

#include <cmath>
#include <numbers>

#include "models/shapes.h"
#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

TruthModel boulder() {
  SuiteBuilder model;
  model.add(model.kind({"boulder", lump(3, 24), {}}));
  return model.finish();
}

// Along a line in space, its section an irregular oval that grows and turns.
Mesh horn() {
  const Curve line = smooth_curve({{0, 0, 0}, {0.5, 0.1, 0.5}, {0.6, 0.7, 0.9}, {0.1, 1.1, 1.1}, {-0.5, 0.9, 1.6}});
  return capped_skin({6, 6, 40}, [&](double share, double cosine, double sine) {
    const double inside = std::clamp((share - 0.08) / 0.84, 0.0, 1.0);
    const double cap = std::sqrt(std::max(0.0, 1 - std::pow((share - std::clamp(share, 0.08, 0.92)) / 0.08, 2)));
    const Vector3d tangent = line.tangent(inside);
    const Vector3d u = tangent.cross(Vector3d(0.3, -0.5, 0.9)).normalized();
    const Vector3d v = tangent.cross(u);
    const double angle = std::atan2(sine, cosine);
    const double radius =
        (0.34 - 0.24 * inside) * cap * (1 + 0.22 * std::cos(2 * angle + 2 * inside) + 0.12 * std::cos(3 * angle + 1));
    const double beyond = (share - std::clamp(share, 0.08, 0.92)) / 0.08 * (inside > 0.5 ? 0.1 : 0.3);
    return Vector3d(line(inside) + beyond * tangent + radius * (cosine * u + sine * v));
  });
}

TruthModel driftwood() {
  SuiteBuilder model;
  model.add(model.kind({"branch", horn(), {}}));
  Mesh knot = lump(8);
  knot.vertices *= 0.33;
  model.add(model.kind({"knot", knot, {}}), shift(0.45, 0.15, 0.5));
  return model.finish();
}

TruthModel cairn() {
  SuiteBuilder model;
  const auto stone = [&](int number, double size, const Motion& at) {
    Mesh mesh = lump(number);
    mesh.vertices *= size;
    model.add(model.kind({"stone", mesh, {}}), at);
  };
  stone(11, 0.7, turn_z(20));
  stone(12, 0.55, shift(0.9, 0.2, 0.1) * turn_x(35));
  stone(13, 0.45, shift(0.35, 0.3, 0.65) * turn_y(70));
  stone(14, 0.4, shift(-0.5, -0.45, 0.35) * turn_z(110));
  stone(15, 0.3, shift(0.3, 0.2, 1.1) * turn_x(100));
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> asymmetric_suite() {
  return {{"boulder", "none", boulder}, {"driftwood", "none", driftwood}, {"cairn", "none", cairn}};
}

}  // namespace orbifit
