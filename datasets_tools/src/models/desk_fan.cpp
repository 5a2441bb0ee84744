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

// The rim waves out to the wires: no rounder than the guard.
Mesh guard_rim(double radius, int detail) {
  std::vector<Ring> rings;
  const std::vector<Matrix3d> sides = elements({Family::Cn, 2 * detail + 4});
  for (const Matrix3d& turn : elements({Family::Cn, 2 * kWires * (detail + 1)})) {
    const double wave = radius * (1 + 0.03 * (cosine_of_multiple(kWires, turn(0, 0), turn(1, 0)) - 1));
    Ring& ring = rings.emplace_back();
    for (const Matrix3d& side : sides)
      ring.emplace_back(turn * Vector3d(wave + 0.008 * side(0, 0), 0, 0.008 * side(1, 0)));
  }
  return closed_loft(rings);
}

// Each wire runs from the front's middle over the rim to the back's: one part, its own mirror image.
Mesh guard_wire(double radius, double depth, int detail) {
  const Curve arc =
      smooth_curve({Vector3d(0.1 * radius, 0, depth), Vector3d(0.7 * radius, 0, 0.9 * depth), Vector3d(radius, 0, 0),
                    Vector3d(0.7 * radius, 0, -0.9 * depth), Vector3d(0.1 * radius, 0, -depth)});
  return tube({4, 1, 8 * detail + 2}, arc, Vector3d::UnitY(), [](double) { return 0.005; });
}

// In the middle of the front, where the wires end.
Mesh guard_plate(double radius, int detail) {
  return turned(
      {kWires, detail, 1},
      trace_profile({{0, 0.01, 0, 1}, {0.2 * radius, 0.004, 0, 1}, {0.2 * radius, -0.004, 0, 1}, {0, -0.01, 0, 1}}, 4,
                    false),
      [](double, double cosine, double sine) { return 1 + 0.06 * cosine_of_multiple(kWires, cosine, sine); });
}

// A screw's hub, so that the blades' rotations are all that the rotor has.
Mesh rotor_hub(int detail) {
  return turned(
      {kBlades, detail, 2 * detail},
      trace_profile({{0, 0.035, 0, 1}, {0.04, 0.03, 0.012, 1}, {0.042, -0.035, 0.01, 1}, {0, -0.035, 0, 1}}, 8, false),
      [](double share, double cosine, double sine) {
        const double angle = std::atan2(sine, cosine) + 1.2 * share;
        return 1 + 0.1 * std::cos(kBlades * angle);
      });
}

// Behind the guard; taller above the axis than below it.
Mesh motor(double depth, int detail) {
  Mesh part = moved(
      turned({6, detail, 3 * detail},
             trace_profile({{0, 0, 0, 1}, {0.055, 0, 0.02, 1}, {0.045, -0.14, 0.03, 1}, {0, -0.14, 0, 1}}, 8, false)),
      {Matrix3d::Identity(), Vector3d(0, 0, -depth - 0.004)});
  for (auto vertex : part.vertices.rowwise()) vertex.y() *= vertex.y() > 0 ? 1.25 : 0.9;
  return part;
}

Mesh neck(double height, double depth, int detail) {
  const Curve line = smooth_curve(
      {Vector3d(0, 0.02, 0.02), Vector3d(0, 0.1 + depth, 0.4 * height), Vector3d(0, 0.075 + depth, height - 0.03)});
  return tube({6, 1, 9 * detail + 1}, line, Vector3d::UnitX(), [](double share) { return 0.024 - 0.008 * share; });
}

Mesh stand(int detail) {
  const Curve outline(
      trace_profile({{0, 0, 0, 1}, {0.13, 0, 0.012, 1}, {0.11, 0.035, 0.02, 1}, {0, 0.04, 0, 1}}, 8, false));
  return capped_skin({6, 2 * detail, 2}, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    const Eigen::Vector2d around = place.x() * rounded_square(cosine, sine, 2.6);
    return Vector3d(around.x(), 0.04 + (around.y() > 0 ? 0.9 : 1.15) * around.y(), place.z());
  });
}

PartFaces add_guard(ModelBuilder& builder, const ModelValues& values, const LocalFrame& head) {
  const int detail = values.count("detail");
  const double radius = values["radius"];
  const double depth = values["depth"];
  std::vector<PartFaces> parts{builder.add(guard_rim(radius, detail), head)};
  const Mesh wire = guard_wire(radius, depth, detail);
  for (const Matrix3d& turn : elements({Family::Cn, kWires})) {
    parts.push_back(builder.add(moved(wire, {turn, Vector3d::Zero()}), head));
  }
  const Mesh plate = guard_plate(radius, detail);
  for (const double side : {1.0, -1.0}) {
    parts.push_back(builder.add(moved(plate, {Vector3d(1, 1, side).asDiagonal(), Vector3d(0, 0, side * depth)}), head));
  }
  return joined(parts);
}

PartFaces add_rotor(ModelBuilder& builder, const ModelValues& values, const LocalFrame& head) {
  const int detail = values.count("detail");
  std::vector<PartFaces> parts{builder.add(rotor_hub(detail), head)};
  const Mesh blade = fan_blade(0.03, 0.88 * values["radius"], detail);
  for (const Matrix3d& turn : elements({Family::Cn, kBlades})) {
    parts.push_back(builder.add(moved(blade, {turn, Vector3d::Zero()}), head));
  }
  return joined(parts);
}

// Motor, neck and stand, which have the mirror plane x = 0.
PartFaces add_support(ModelBuilder& builder, const ModelValues& values, const LocalFrame& head) {
  const int detail = values.count("detail");
  const double depth = values["depth"];
  std::vector<PartFaces> parts{builder.add(motor(depth, detail), head)};
  parts.push_back(builder.add(neck(values["height"], depth, detail)));
  parts.push_back(builder.add(stand(detail)));
  return joined(parts);
}

GeneratedModel build_desk_fan(const ModelValues& values) {
  ModelBuilder builder(0);
  // The head is made about z, its front to +z, then looks to -y.
  Matrix3d frame;
  frame << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const LocalFrame head{frame, Vector3d(0, 0, values["height"])};
  const PartFaces guard = add_guard(builder, values, head);
  const PartFaces rotor = add_rotor(builder, values, head);
  const PartFaces support = add_support(builder, values, head);
  builder.declare("fan without blades", {Family::Cs, 1}, {frame_about(Vector3d::UnitX()), Vector3d::Zero()},
                  joined({guard, support}));
  builder.declare("guard", {Family::Dnh, kWires}, head, guard);
  builder.declare("rotor", {Family::Cn, kBlades}, head, rotor);
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
