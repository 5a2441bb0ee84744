#include "models/car_wheel.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "models/primitives.h"
#include "models/shapes.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kSpokes = 5;
constexpr int kTread = 10;  // blocks around the tyre, a multiple of the spokes

// About z, its treads' blocks mirrored across its middle plane.
Mesh tyre(double radius, int detail) {
  const double half = kCarTyreWidth / 2;
  const double rim = 0.62 * radius;
  const auto section = [&](double depth) {
    return trace_profile({{radius - depth, 0, 0, 2 * detail},
                          {radius - depth, half, 0.22 * half, detail},
                          {0.8 * radius, 1.08 * half, 0, detail},
                          {rim, 0.9 * half, 0.1 * half, detail},
                          {0.93 * rim, 0.6 * half, 0, 1},
                          {0.93 * rim, 0, 0, 1},
                          {0.93 * rim, -0.6 * half, 0, detail},
                          {rim, -0.9 * half, 0.1 * half, detail},
                          {0.8 * radius, -1.08 * half, 0, detail},
                          {radius - depth, -half, 0.22 * half, 2 * detail}},
                         detail, true);
  };
  const auto high = section(0);
  const auto low = section(0.05 * radius);
  const int pieces = 4 * detail;  // of a block and its gap
  std::vector<Ring> rings;
  for (const Matrix3d& turn : elements({Family::Cn, kTread})) {
    for (int k = 0; k < pieces; ++k) {
      // The gap is in the middle of the period.
      const bool gap = std::abs(2 * k - pieces) <= pieces / 4;
      const Matrix3d within = axis_rotation(Vector3d::UnitZ(), 2 * std::numbers::pi * k / (pieces * kTread));
      Ring& ring = rings.emplace_back();
      for (const Eigen::Vector2d& point : gap ? low : high) {
        ring.emplace_back(turn * (within * Vector3d(point.x(), 0, point.y())));
      }
    }
  }
  const int points = static_cast<int>(high.size());
  return closed_loft(rings,
                     [&](int ring, int point) { return (2 * (ring % pieces) < pieces) == (2 * point < points); });
}

// Five lobes: no rounder than the wheel.
Mesh hub(double radius, int detail) {
  return turned(
      {kSpokes, 2 * detail, 2 * detail},
      trace_profile({{0, 0.055, 0, 1}, {radius, 0.03, 0.02, 1}, {0.9 * radius, -0.06, 0.02, 1}, {0, -0.06, 0, 1}}, 12,
                    false),
      [](double, double cosine, double sine) { return 1 + 0.09 * cosine_of_multiple(kSpokes, cosine, sine); });
}

// Along z from the hub's end, narrowing; mirror-symmetric about both planes through its axis.
Mesh spoke(double length, int detail) {
  const Curve outline(
      trace_profile({{0, 0, 0, 1}, {0.042, 0, 0.012, 1}, {0.026, length, 0.012, 1}, {0, length, 0, 1}}, 12, false));
  return capped_skin({4, detail, 6 * detail}, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    const Eigen::Vector2d around = place.x() * rounded_square(cosine, sine, 2.8);
    return Vector3d(0.6 * around.x(), around.y(), place.z());
  });
}

Mesh nut(double radius, double height, int detail) {
  // Half the angle between the flats is pi / 6: a hexagon's edge by its distance from the axis.
  return turned({6, detail, detail},
                trace_profile({{0, height, 0, 1},
                               {0.75 * radius, height, 0.2 * radius, 1},
                               {radius, 0.6 * height, 0.1 * radius, 1},
                               {radius, -0.2 * height, 0, 1},
                               {0, -0.2 * height, 0, 1}},
                              12, false),
                [](double, double cosine, double sine) {
                  const double angle = std::atan2(sine, cosine);
                  const double off = std::remainder(angle - std::numbers::pi / 6, std::numbers::pi / 3);
                  return std::cos(std::numbers::pi / 6) / std::cos(off);
                });
}

// Places in the wheel's frame.
LocalFrame spoke_place(int i, double radius, const std::vector<Matrix3d>& turns) {
  // Column 2 along the spoke, which leans outwards from the hub's front; column 1 across it in the wheel's plane.
  const Vector3d along = Vector3d(1, 0, -0.22).normalized();
  Matrix3d frame;
  frame << Vector3d::UnitY().cross(along), Vector3d::UnitY(), along;
  const Matrix3d& turn = turns[static_cast<std::size_t>(i)];
  return {turn * frame, turn * Vector3d(0.13 * radius, 0, 0.075)};
}

// Nuts stand between the spokes, a corner outwards.
Matrix3d frame_of_nut(int i, const std::vector<Matrix3d>& turns) {
  return turns[static_cast<std::size_t>(i)] * axis_rotation(Vector3d::UnitZ(), std::numbers::pi / kSpokes);
}

}  // namespace

CarWheel add_car_wheel(ModelBuilder& builder, const Motion& place, double radius, int detail) {
  const std::vector<Matrix3d> turns = elements({Family::Cn, kSpokes});
  const Mesh spoke_mesh = spoke(0.5 * radius, detail);
  const Mesh nut_mesh = nut(0.03, 0.035, detail);
  CarWheel wheel;
  wheel.place = place;
  wheel.radius = radius;
  wheel.tyre = builder.add(tyre(radius, detail), place);
  std::vector<PartFaces> parts{wheel.tyre};
  parts.push_back(builder.add(moved(hub(0.27 * radius, detail), {Matrix3d::Identity(), Vector3d(0, 0, 0.05)}), place));
  for (int i = 0; i < kSpokes; ++i) {
    wheel.spokes.push_back(builder.add(moved(spoke_mesh, spoke_place(i, radius, turns)), place));
    const Matrix3d frame = frame_of_nut(i, turns);
    wheel.nuts.push_back(builder.add(moved(nut_mesh, {frame, frame * Vector3d(0.17 * radius, 0, 0.085)}), place));
  }
  parts.insert(parts.end(), wheel.spokes.begin(), wheel.spokes.end());
  parts.insert(parts.end(), wheel.nuts.begin(), wheel.nuts.end());
  wheel.all = joined(parts);
  return wheel;
}

void declare_car_wheel(ModelBuilder& builder, const std::string& name, const CarWheel& wheel) {
  const std::vector<Matrix3d> turns = elements({Family::Cn, kSpokes});
  // Columns of a placement are right-handed: a mirrored one's second column turns over, and no group minds.
  const auto placed = [&](const LocalFrame& local) { return image(wheel.place, local); };
  const LocalFrame axle{frame_about(Vector3d::UnitZ(), Vector3d::UnitY()), Vector3d::Zero()};
  builder.declare(name, {Family::Cnv, kSpokes}, placed(axle), wheel.all);
  builder.declare(name + " tyre", {Family::Dnh, kTread}, placed({}), wheel.tyre);
  for (int i = 0; i < kSpokes; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const std::string number = std::to_string(i + 1);
    builder.declare(name + " spoke " + number, {Family::Cnv, 2}, placed(spoke_place(i, wheel.radius, turns)),
                    wheel.spokes[k]);
    const Matrix3d frame = frame_of_nut(i, turns);
    builder.declare(name + " nut " + number, {Family::Cnv, 6},
                    placed({frame, frame * Vector3d(0.17 * wheel.radius, 0, 0)}), wheel.nuts[k]);
  }
}

}  // namespace orbifit
