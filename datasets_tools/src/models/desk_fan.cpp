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

constexpr int kWires = 8;
constexpr int kBlades = 5;

// Along +x, pitched and swept.
Mesh fan_blade(double root, double tip, int detail) {
  const Curve outline(trace_profile(
      {{0, root, 0, 1}, {0.028, root, 0.006, 1}, {0.055, 0.72 * tip, 0.05, 1}, {0.048, tip, 0.04, 1}, {0, tip, 0, 1}},
      12, false));
  return capped_skin({4, detail, 5 * detail}, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    const double out = place.z() / tip;
    const Vector3d flat(0, place.x() * cosine, 0.16 * place.x() * sine + 0.006 * (1 - cosine * cosine));
    const Matrix3d pitch = axis_rotation(Vector3d::UnitX(), (38 - 16 * out) * std::numbers::pi / 180);
    return Vector3d(axis_rotation(Vector3d::UnitZ(), 0.4 * out * out) * (Vector3d(place.z(), 0, 0) + pitch * flat));
  });
}

GeneratedModel build_desk_fan(const ModelValues& values) {
  const int detail = values.count("detail");
  const double height = values["height"];
  const double radius = values["radius"];
  const double depth = values["depth"];
  ModelBuilder builder(0);
  // The head is made about z, its front to +z, then looks to -y.
  Matrix3d frame;
  frame << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const Placement head{frame, Vector3d(0, 0, height)};

  std::vector<PartFaces> guard;
  // The rim waves out to the wires: no rounder than the guard.
  std::vector<Ring> rim;
  const std::vector<Matrix3d> sides = elements({Family::Cn, 2 * detail + 4});
  for (const Matrix3d& turn : elements({Family::Cn, 2 * kWires * (detail + 1)})) {
    const double wave = radius * (1 + 0.03 * (cosine_of_multiple(kWires, turn(0, 0), turn(1, 0)) - 1));
    Ring& ring = rim.emplace_back();
    for (const Matrix3d& side : sides)
      ring.emplace_back(turn * Vector3d(wave + 0.008 * side(0, 0), 0, 0.008 * side(1, 0)));
  }
  guard.push_back(builder.add(closed_loft(rim), head));
  // Each wire runs from the front's middle over the rim to the back's: one part, its own mirror image.
  const Curve arc =
      smooth_curve({Vector3d(0.1 * radius, 0, depth), Vector3d(0.7 * radius, 0, 0.9 * depth), Vector3d(radius, 0, 0),
                    Vector3d(0.7 * radius, 0, -0.9 * depth), Vector3d(0.1 * radius, 0, -depth)});
  const Mesh wire = tube({4, 1, 8 * detail + 2}, arc, Vector3d::UnitY(), [](double) { return 0.005; });
  for (const Matrix3d& turn : elements({Family::Cn, kWires})) {
    guard.push_back(builder.add(moved(wire, {turn, Vector3d::Zero()}), head));
  }
  const Mesh plate = turned(
      {kWires, detail, 1},
      trace_profile({{0, 0.01, 0, 1}, {0.2 * radius, 0.004, 0, 1}, {0.2 * radius, -0.004, 0, 1}, {0, -0.01, 0, 1}}, 4,
                    false),
      [](double, double cosine, double sine) { return 1 + 0.06 * cosine_of_multiple(kWires, cosine, sine); });
  for (const double side : {1.0, -1.0}) {
    guard.push_back(builder.add(moved(plate, {Vector3d(1, 1, side).asDiagonal(), Vector3d(0, 0, side * depth)}), head));
  }

  // The rotor: its hub is a screw's, so that the blades' rotations are all it has.
  const Mesh hub = turned(
      {kBlades, detail, 2 * detail},
      trace_profile({{0, 0.035, 0, 1}, {0.04, 0.03, 0.012, 1}, {0.042, -0.035, 0.01, 1}, {0, -0.035, 0, 1}}, 8, false),
      [](double share, double cosine, double sine) {
        const double angle = std::atan2(sine, cosine) + 1.2 * share;
        return 1 + 0.1 * std::cos(kBlades * angle);
      });
  std::vector<PartFaces> rotor{builder.add(hub, head)};
  const Mesh blade_part = fan_blade(0.03, 0.88 * radius, detail);
  for (const Matrix3d& turn : elements({Family::Cn, kBlades})) {
    rotor.push_back(builder.add(moved(blade_part, {turn, Vector3d::Zero()}), head));
  }

  // Motor, neck and foot stand in the mirror plane.
  std::vector<PartFaces> still = guard;
  const Mesh motor =
      turned({6, detail, 3 * detail},
             trace_profile({{0, 0, 0, 1}, {0.055, 0, 0.02, 1}, {0.045, -0.14, 0.03, 1}, {0, -0.14, 0, 1}}, 8, false));
  Mesh motor_part = moved(motor, {Matrix3d::Identity(), Vector3d(0, 0, -depth - 0.004)});
  for (auto vertex : motor_part.vertices.rowwise()) vertex.y() *= vertex.y() > 0 ? 1.25 : 0.9;
  still.push_back(builder.add(motor_part, head));
  const Curve neck = smooth_curve(
      {Vector3d(0, 0.02, 0.02), Vector3d(0, 0.1 + depth, 0.4 * height), Vector3d(0, 0.075 + depth, height - 0.03)});
  still.push_back(builder.add(
      tube({6, 1, 9 * detail + 1}, neck, Vector3d::UnitX(), [](double share) { return 0.024 - 0.008 * share; })));
  still.push_back(builder.add(capped_skin({6, 2 * detail, 2}, [&](double share, double cosine, double sine) {
    const Curve outline(
        trace_profile({{0, 0, 0, 1}, {0.13, 0, 0.012, 1}, {0.11, 0.035, 0.02, 1}, {0, 0.04, 0, 1}}, 8, false));
    const Vector3d place = outline(share);
    const Eigen::Vector2d around = place.x() * rounded_square(cosine, sine, 2.6);
    return Vector3d(around.x(), 0.04 + (around.y() > 0 ? 0.9 : 1.15) * around.y(), place.z());
  })));

  builder.declare("fan without blades", {Family::Cs, 1}, {frame_about(Vector3d::UnitX()), Vector3d::Zero()},
                  joined(still));
  builder.declare("guard", {Family::Dnh, kWires}, head, joined(guard));
  builder.declare("rotor", {Family::Cn, kBlades}, head, joined(rotor));
  return builder.finish();
}

}  // namespace

ModelDefinition desk_fan_model() {
  return {{"desk_fan",
           "a small desk fan of three regions: stand and guard (Cs), guard (D8h), five chiral blades (C5)",
           {{"height", 0.34, 0.28, 0.6, false, "of the head's middle, m"},
            {"radius", 0.19, 0.14, 0.26, false, "of the guard, m"},
            {"depth", 0.06, 0.045, 0.1, false, "of the guard to either side, m"},
            {"detail", 2, 1, 30, true, "fineness of the mesh"}}},
          build_desk_fan};
}

}  // namespace orbifit
