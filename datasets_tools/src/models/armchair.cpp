#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"
#include "models/shapes.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// The cushion bulges; seat and legs are as square as each other.
Mesh cushion(double half, double thickness, int detail) {
  Mesh part = box({half, half, thickness / 2}, {14 * detail, 14 * detail, 2 * detail}, 0.055, 2 * detail);
  for (auto vertex : part.vertices.rowwise()) {
    const double x = vertex.x() / half;
    const double y = vertex.y() / half;
    if (vertex.z() > 0) vertex.z() += 0.04 * (1 - x * x) * (1 - y * y);
  }
  return part;
}

// A leg stands on the seat's diagonal, a mirror plane.
Mesh diagonal_leg(double inset, double spread, double height, int detail) {
  const Vector3d diagonal = Vector3d(1, 1, 0).normalized();
  const Vector3d across = Vector3d(-1, 1, 0).normalized();
  const Curve line =
      smooth_curve({std::numbers::sqrt2 * inset * diagonal + Vector3d(0, 0, height + 0.02),
                    std::numbers::sqrt2 * (inset + 0.3 * spread) * diagonal + Vector3d(0, 0, 0.5 * height),
                    std::numbers::sqrt2 * (inset + spread) * diagonal + Vector3d(0, 0, 0.014)});
  return tube({6, detail, 24 * detail}, line, across, [](double share) { return 0.034 - 0.02 * share; });
}

PartFaces add_seat_and_legs(ModelBuilder& builder, const ModelValues& values) {
  const int detail = values.count("detail");
  const double half = values["seat"] / 2;
  const double height = values["leg_height"];
  const double thickness = 0.13;
  std::vector<PartFaces> parts{
      builder.add(cushion(half, thickness, detail), {Matrix3d::Identity(), Vector3d(0, 0, height + thickness / 2)})};
  const Mesh leg = diagonal_leg(half - 0.06, values["leg_spread"], height, detail);
  for (const Matrix3d& turn : elements({Family::Cn, 4})) {
    parts.push_back(builder.add(leg, {turn, Vector3d::Zero()}));
  }
  return joined(parts);
}

// The shell's middle line seen from above: over the one arm, around the back and over the other arm; -y is the front.
Curve shell_plan(double half) {
  const double out = half + 0.05;
  return smooth_curve({Vector3d(-out, -0.9 * half, 0), Vector3d(-out, -0.1 * half, 0),
                       Vector3d(-0.86 * out, 0.75 * half, 0), Vector3d(0, half + 0.07, 0),
                       Vector3d(0.86 * out, 0.75 * half, 0), Vector3d(out, -0.1 * half, 0),
                       Vector3d(out, -0.9 * half, 0)});
}

// The point of a section, rounded in thickness (x) and height (z), for one of a square of half width 1.
Vector3d section_point(double x, double z) {
  const Vector3d direction(x, 0, z);
  const double square = std::max(std::abs(x), std::abs(z));
  if (!(square > 0)) return Vector3d::Zero();
  const Eigen::Vector2d round = rounded_square(direction.x() / direction.norm(), direction.z() / direction.norm(), 4);
  return square * Vector3d(round.x(), 0, round.y());
}

// One padded shell: a box bent along its plan, y along it, x across and z upwards.
Mesh padded_shell(const ModelValues& values) {
  const int detail = values.count("detail");
  const double height = values["leg_height"];
  const double back = values["back_height"];
  const double arm = values["arm_height"];
  const Curve plan = shell_plan(values["seat"] / 2);
  Mesh shell = box({1, 1, 1}, {4 * detail, 46 * detail, 16 * detail}, 0, 0);
  for (auto vertex : shell.vertices.rowwise()) {
    const double share = 0.5 * (1 + vertex.y());
    const double middle = vertex.y() * vertex.y();
    const double top = height + smooth_table({{0, back}, {0.12, back}, {0.5, arm}, {1, 0.92 * arm}}, middle);
    const Vector3d section = section_point(vertex.x(), vertex.z());
    // The ends of the arms are rounded too.
    const double square = std::max(std::abs(vertex.x()), std::abs(vertex.z()));
    const double end = 0.05 * (std::abs(vertex.y()) > 1 - 1e-9 ? std::sqrt(std::max(0.0, 1 - square * square)) : 0);
    const double at = share + std::copysign(end / plan.length(), vertex.y());
    const Vector3d tangent = plan.tangent(std::clamp(at, 0.0, 1.0));
    const Vector3d outwards(-tangent.y(), tangent.x(), 0);
    const double low = height + 0.02;
    const double rise = 0.5 * (top - low) * section.z() + 0.5 * (top + low);
    const double lean = 0.28 * std::max(0.0, rise - height - arm) * (1 - middle);
    vertex = plan(at) + outwards * (0.05 * section.x() + lean) + Vector3d(0, 0, rise);
  }
  if (signed_volume(shell) < 0) shell.faces.col(1).swap(shell.faces.col(2));
  return shell;
}

GeneratedModel build_armchair(const ModelValues& values) {
  ModelBuilder builder(0);
  const PartFaces seat_and_legs = add_seat_and_legs(builder, values);
  const PartFaces shell = builder.add(padded_shell(values));
  builder.declare("armchair", {Family::Cs, 1}, {frame_about(Vector3d::UnitX()), Vector3d::Zero()},
                  joined({seat_and_legs, shell}));
  builder.declare("seat and legs", {Family::Cnv, 4}, {}, seat_and_legs);
  if (values.count("two_sided") != 0) builder.double_faces();
  return builder.finish();
}

}  // namespace

ModelDefinition armchair_model() {
  return {
      {"armchair",
       "an armchair of two regions: the whole (Cs), its seat and legs (C4v)",
       {{"seat", 0.56, 0.4, 0.9, false, "width and depth of the seat, m"},
        {"leg_height", 0.3, 0.15, 0.5, false, "floor to seat, m"},
        {"leg_spread", 0.05, 0, 0.12, false, "how far each foot stands outwards of its upper end, in x and in y, m"},
        {"back_height", 0.62, 0.4, 1, false, "of the back over the seat's underside, m"},
        {"arm_height", 0.32, 0.2, 0.38, false, "of the arms over the seat's underside, m"},
        {"two_sided", 0, 0, 1, true, "1: every face has a second one that looks the other way"},
        {"detail", 2, 1, 20, true, "fineness of the mesh"}}},
      build_armchair};
}

}  // namespace orbifit
