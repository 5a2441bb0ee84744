#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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

// x forwards, y to the left, z up; metres.
constexpr double kTyreWidth = 0.26;
constexpr int kSpokes = 5;
constexpr int kTread = 10;  // blocks around the tyre, a multiple of the spokes

struct Size {
  double half_length, half_width, axle, wheel;  // axle: from the middle of the car
};

// Height of the bodywork's lower edge: over the wheels it rises to arches.
double lower_edge(double x, const Size& size) {
  const double reach = 1.22 * size.wheel;
  const double from = std::min(std::abs(x - size.axle), std::abs(x + size.axle)) / reach;
  const double sill = 0.62 * size.wheel;
  const double arch = 1.95 * size.wheel;
  return from >= 1 ? sill : sill + (arch - sill) * std::pow(1 - from * from * from * from, 1.4);
}

// Bonnet and boot alike, as off-road cars nearly have it: C2v.
Mesh body(const Size& size, int detail) {
  const double nose = size.half_length;
  const Curve outline(trace_profile({{0, -nose, 0, 1},
                                     {0.93 * size.half_width, -nose, 0.3, 1},
                                     {size.half_width, 0, 2, 1},
                                     {0.93 * size.half_width, nose, 0.3, 1},
                                     {0, nose, 0, 1}},
                                    24, false));
  return capped_skin({6, 4 * detail, 44 * detail}, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    const double x = place.z();
    const double in = place.x() / size.half_width;
    const double upper = smooth_table({{0.3, 1.02}, {0.8, 0.94}, {1, 0.8}}, std::abs(x) / nose);
    const double lower = lower_edge(x, size);
    // Towards the caps' middles the section closes on the bumpers' height.
    const double closing = std::min(1.0, 1.25 * in);
    const double middle = (1 - closing) * 0.62 + closing * 0.5 * (upper + lower);
    const double half_height = 0.5 * (upper - lower) * std::min(1.0, in * 1.08);
    const Eigen::Vector2d around = rounded_square(cosine, sine, 4.2);
    return Vector3d(x, place.x() * (1 - 0.06 * around.x() * around.x()) * around.y(),
                    middle + half_height * around.x());
  });
}

Mesh cabin(const Size& size, int detail) {
  const double half = 0.47 * size.half_length;
  const Curve outline(
      trace_profile({{0, -half, 0, 1}, {0.9, -half, 0.4, 1}, {0.9, half, 0.4, 1}, {0, half, 0, 1}}, 24, false));
  return capped_skin({6, 3 * detail, 11 * detail}, [&](double share, double cosine, double sine) {
    const Vector3d place = outline(share);
    const double in = place.x() / 0.9;
    const Eigen::Vector2d around = rounded_square(cosine, sine, 3.3);
    const double up = around.x() * in;
    // Narrower at the roof; windscreen and rear window lean alike.
    const double x = place.z() * (1 - 0.3 * 0.5 * (up + 1));
    return Vector3d(x, (0.87 - 0.17 * (up + 1) * 0.5) * size.half_width * in * around.y(),
                    1.06 + 0.45 * up - 0.06 * x * x);
  });
}

// About z, its treads' blocks mirrored across its middle plane.
Mesh tyre(double radius, int detail) {
  const double half = kTyreWidth / 2;
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

// Wheels are made once, about z with their outer side to +z, and placed four times.
struct Wheel {
  PartFaces tyre, all;
  std::vector<PartFaces> spokes, nuts;
};

// Places in the wheel's frame.
Placement spoke_place(int i, double radius, const std::vector<Matrix3d>& turns) {
  // Column 2 along the spoke, which leans outwards from the hub's front; column 1 across it in the wheel's plane.
  const Vector3d along = Vector3d(1, 0, -0.22).normalized();
  Matrix3d frame;
  frame << Vector3d::UnitY().cross(along), Vector3d::UnitY(), along;
  const Matrix3d& turn = turns[static_cast<std::size_t>(i)];
  return {turn * frame, turn * Vector3d(0.13 * radius, 0, 0.075)};
}

Wheel add_wheel(ModelBuilder& builder, const Motion& place, double radius, int detail) {
  const std::vector<Matrix3d> turns = elements({Family::Cn, kSpokes});
  const Mesh spoke_mesh = spoke(0.5 * radius, detail);
  const Mesh nut_mesh = nut(0.03, 0.035, detail);
  Wheel wheel;
  wheel.tyre = builder.add(tyre(radius, detail), place);
  std::vector<PartFaces> parts{wheel.tyre};
  parts.push_back(builder.add(moved(hub(0.27 * radius, detail), {Matrix3d::Identity(), Vector3d(0, 0, 0.05)}), place));
  for (int i = 0; i < kSpokes; ++i) {
    wheel.spokes.push_back(builder.add(moved(spoke_mesh, spoke_place(i, radius, turns)), place));
    // Nuts stand between the spokes, a corner outwards.
    const Matrix3d between =
        turns[static_cast<std::size_t>(i)] * axis_rotation(Vector3d::UnitZ(), std::numbers::pi / kSpokes);
    wheel.nuts.push_back(builder.add(moved(nut_mesh, {between, between * Vector3d(0.17 * radius, 0, 0.085)}), place));
  }
  parts.insert(parts.end(), wheel.spokes.begin(), wheel.spokes.end());
  parts.insert(parts.end(), wheel.nuts.begin(), wheel.nuts.end());
  wheel.all = joined(parts);
  return wheel;
}

void declare_wheel(ModelBuilder& builder, const std::string& name, const Wheel& wheel, const Motion& place,
                   double radius) {
  const std::vector<Matrix3d> turns = elements({Family::Cn, kSpokes});
  // Columns of a placement are right-handed: a mirrored one's second column turns over, and no group minds.
  const auto placed = [&](const Placement& local) { return image(place, local); };
  const Placement axle{frame_about(Vector3d::UnitZ(), Vector3d::UnitY()), Vector3d::Zero()};
  builder.declare(name, {Family::Cnv, kSpokes}, placed(axle), wheel.all);
  builder.declare(name + " tyre", {Family::Dnh, kTread}, placed({}), wheel.tyre);
  for (int i = 0; i < kSpokes; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const std::string number = std::to_string(i + 1);
    builder.declare(name + " spoke " + number, {Family::Cnv, 2}, placed(spoke_place(i, radius, turns)),
                    wheel.spokes[k]);
    const Matrix3d between = turns[k] * axis_rotation(Vector3d::UnitZ(), std::numbers::pi / kSpokes);
    builder.declare(name + " nut " + number, {Family::Cnv, 6},
                    placed({between, between * Vector3d(0.17 * radius, 0, 0)}), wheel.nuts[k]);
  }
}

// A superellipsoid about the origin: D2h.
Mesh pebble(const Vector3d& half, double exponent, const SkinCounts& counts) {
  return capped_skin(counts, [&](double share, double cosine, double sine) {
    const double angle = std::numbers::pi * share;
    const Eigen::Vector2d meridian = rounded_square(std::cos(angle), std::sin(angle), exponent);
    const Eigen::Vector2d around = meridian.y() * rounded_square(cosine, sine, exponent);
    return Vector3d(half.x() * around.x(), half.y() * around.y(), -half.z() * meridian.x());
  });
}

GeneratedModel build_car(const ModelValues& values) {
  const int detail = values.count("detail");
  const Size size{values["length"] / 2, values["width"] / 2, values["wheelbase"] / 2, values["wheel_radius"]};
  const double camber = values["camber"] * std::numbers::pi / 180;
  ModelBuilder builder(0);
  std::vector<PartFaces> shell{builder.add(body(size, detail)), builder.add(cabin(size, detail))};

  // The front left wheel's z looks out to the left and its x, a spoke, upwards.
  Matrix3d outwards;
  outwards << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  const double track = size.half_width - 0.4 * kTyreWidth;
  const Motion front_left{axis_rotation(Vector3d::UnitX(), camber) * outwards, Vector3d(size.axle, track, size.wheel)};
  const std::array<std::string, 4> wheel_names{"front left wheel", "rear right wheel", "rear left wheel",
                                               "front right wheel"};
  std::vector<Wheel> wheels;
  std::vector<Motion> wheel_places;
  std::vector<PartFaces> all_wheels;
  for (const Matrix3d& element : elements({Family::Cnv, 2})) {
    wheel_places.push_back(Motion{element, Vector3d::Zero()} * front_left);
    wheels.push_back(add_wheel(builder, wheel_places.back(), size.wheel, detail));
    all_wheels.push_back(wheels.back().all);
  }
  shell.insert(shell.end(), all_wheels.begin(), all_wheels.end());
  std::vector<PartFaces> parts = shell;

  struct Fitting {
    std::string name;
    Vector3d half, place;
    double yaw, pitch;  // of the left one, degrees
    SkinCounts counts;
    double exponent;
  };
  const SkinCounts fine{6, 2 * detail, 2 * detail};
  const SkinCounts small{6, detail, 2 * detail};
  const double nose = size.half_length;
  const double side = size.half_width;
  // Swept back and tilted: a pair in one line would have more symmetries than each of the two.
  const std::array<Fitting, 4> fittings{
      {{"headlight", {0.07, 0.17, 0.075}, {0.985 * nose, 0.55 * side, 0.66}, 22, -20, fine, 2.3},
       {"tail light", {0.05, 0.15, 0.06}, {-0.985 * nose, 0.6 * side, 0.7}, -14, 10, fine, 3},
       {"mirror", {0.06, 0.1, 0.065}, {0.2 * nose, 0.93 * side, 0.88}, 15, -10, small, 2.4},
       {"door handle", {0.1, 0.025, 0.02}, {-0.12 * nose, 0.99 * side, 0.78}, 2, 5, small, 3}}};
  std::vector<std::pair<std::string, PartFaces>> fitted;
  std::vector<Placement> fitted_places;
  for (const Fitting& fitting : fittings) {
    // The skin's poles lie on the longest axis.
    Matrix3d frame = Matrix3d::Identity();
    Vector3d half = fitting.half;
    if (half.x() > half.y()) {
      frame << 0, 0, 1, 1, 0, 0, 0, 1, 0;
      half = {fitting.half.y(), fitting.half.z(), fitting.half.x()};
    } else {
      frame << 0, 1, 0, 0, 0, 1, 1, 0, 0;
      half = {fitting.half.z(), fitting.half.x(), fitting.half.y()};
    }
    const Matrix3d tilt = axis_rotation(Vector3d::UnitZ(), fitting.yaw * std::numbers::pi / 180) *
                          axis_rotation(Vector3d::UnitY(), fitting.pitch * std::numbers::pi / 180);
    const Placement left{tilt * frame, fitting.place};
    const Mesh part = moved(pebble(half, fitting.exponent, fitting.counts), left);
    for (const double hand : {1.0, -1.0}) {
      const Motion motion{Vector3d(1, hand, 1).asDiagonal(), Vector3d::Zero()};
      fitted.emplace_back((hand > 0 ? "left " : "right ") + fitting.name, builder.add(part, motion));
      fitted_places.push_back(image(motion, left));
      parts.push_back(fitted.back().second);
    }
  }
  const Vector3d roof(-0.05 * nose, 0, 1.56);
  const PartFaces roof_box = builder.add(box({0.5, 0.36, 0.1}, {6 * detail, 4 * detail, 2 * detail}, 0.08, detail),
                                         {Matrix3d::Identity(), roof});
  parts.push_back(roof_box);

  builder.declare("car", {Family::Cs, 1}, {frame_about(Vector3d::UnitY()), Vector3d::Zero()}, joined(parts));
  builder.declare("body and wheels", {Family::Cnv, 2}, {Matrix3d::Identity(), Vector3d(0, 0, size.wheel)},
                  joined(shell));
  // elements() of C2v: the wheel itself, its opposite, and the two mirror images.
  for (const auto& [name, x, first, second] :
       {std::tuple{"front wheels", size.axle, 0, 3}, {"rear wheels", -size.axle, 1, 2}}) {
    builder.declare(
        name, {Family::Cnv, 2}, {Matrix3d::Identity(), Vector3d(x, 0, size.wheel)},
        joined({all_wheels[static_cast<std::size_t>(first)], all_wheels[static_cast<std::size_t>(second)]}));
  }
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    declare_wheel(builder, wheel_names[i], wheels[i], wheel_places[i], size.wheel);
  }
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    builder.declare(fitted[i].first, {Family::Dnh, 2}, fitted_places[i], fitted[i].second);
  }
  builder.declare("roof box", {Family::Dnh, 2}, {Matrix3d::Identity(), roof}, roof_box);
  return builder.finish();
}

}  // namespace

ModelDefinition car_model() {
  return {
      {"car",
       "a car with 61 symmetric regions: a mirror plane, a body alike in front and behind, four cambered wheels with "
       "tyres, spokes and nuts, fittings",
       {{"length", 4.0, 3.5, 6, false, "m"},
        {"width", 1.65, 1.4, 2.2, false, "m"},
        {"wheelbase", 2.4, 2.1, 3.2, false, "from the front to the rear axle, m"},
        {"wheel_radius", 0.40, 0.3, 0.44, false, "of the tyres, m"},
        {"camber", 2, 1, 6, false, "how far each wheel leans inwards, degrees; upright ones would share their axles"},
        {"detail", 3, 1, 20, true, "fineness of the mesh"}}},
      build_car};
}

}  // namespace orbifit
