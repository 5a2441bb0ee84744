#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "models/car_wheel.h"
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

// A superellipsoid about the origin: D2h.
Mesh pebble(const Vector3d& half, double exponent, const SkinCounts& counts) {
  return capped_skin(counts, [&](double share, double cosine, double sine) {
    const double angle = std::numbers::pi * share;
    const Eigen::Vector2d meridian = rounded_square(std::cos(angle), std::sin(angle), exponent);
    const Eigen::Vector2d around = meridian.y() * rounded_square(cosine, sine, exponent);
    return Vector3d(half.x() * around.x(), half.y() * around.y(), -half.z() * meridian.x());
  });
}

// In the order of the elements of C2v: the front left one, its opposite, and the two mirror images.
constexpr std::array<const char*, 4> kWheelNames{"front left wheel", "rear right wheel", "rear left wheel",
                                                 "front right wheel"};

std::vector<CarWheel> add_wheels(ModelBuilder& builder, const Size& size, double camber, int detail) {
  // The front left wheel's z looks out to the left and its x, a spoke, upwards.
  Matrix3d outwards;
  outwards << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  const double track = size.half_width - 0.4 * kCarTyreWidth;
  const Motion front_left{axis_rotation(Vector3d::UnitX(), camber) * outwards, Vector3d(size.axle, track, size.wheel)};
  std::vector<CarWheel> wheels;
  for (const Matrix3d& element : elements({Family::Cnv, 2})) {
    wheels.push_back(add_car_wheel(builder, Motion{element, Vector3d::Zero()} * front_left, size.wheel, detail));
  }
  return wheels;
}

void declare_wheels(ModelBuilder& builder, const std::vector<CarWheel>& wheels, const Size& size) {
  const auto declare_pair = [&](const char* name, double x, const CarWheel& one, const CarWheel& other) {
    builder.declare(name, {Family::Cnv, 2}, {Matrix3d::Identity(), Vector3d(x, 0, size.wheel)},
                    joined({one.all, other.all}));
  };
  declare_pair("front wheels", size.axle, wheels[0], wheels[3]);
  declare_pair("rear wheels", -size.axle, wheels[1], wheels[2]);
  for (std::size_t i = 0; i < wheels.size(); ++i) declare_car_wheel(builder, kWheelNames[i], wheels[i]);
}

// A pebble on the left of the car and its mirror image on the right.
struct Fitting {
  std::string name;
  Vector3d half, place;
  double yaw, pitch;  // of the left one, degrees
  SkinCounts counts;
  double exponent;
};

// Swept back and tilted: a pair in one line would have more symmetries than each of the two.
std::array<Fitting, 4> fittings(const Size& size, int detail) {
  const SkinCounts fine{6, 2 * detail, 2 * detail};
  const SkinCounts small{6, detail, 2 * detail};
  const double nose = size.half_length;
  const double side = size.half_width;
  return {{{"headlight", {0.07, 0.17, 0.075}, {0.985 * nose, 0.55 * side, 0.66}, 22, -20, fine, 2.3},
           {"tail light", {0.05, 0.15, 0.06}, {-0.985 * nose, 0.6 * side, 0.7}, -14, 10, fine, 3},
           {"mirror", {0.06, 0.1, 0.065}, {0.2 * nose, 0.93 * side, 0.88}, 15, -10, small, 2.4},
           {"door handle", {0.1, 0.025, 0.02}, {-0.12 * nose, 0.99 * side, 0.78}, 2, 5, small, 3}}};
}

// Axes in cyclic order, the longest of x and y last: there the skin's poles lie.
Matrix3d axes_with_longest_last(const Vector3d& half) {
  Matrix3d axes;
  if (half.x() > half.y()) {
    axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  } else {
    axes << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  }
  return axes;
}

struct Fitted {
  std::string name;
  PartFaces faces;
  LocalFrame place;
};

std::vector<Fitted> add_fittings(ModelBuilder& builder, const Size& size, int detail) {
  std::vector<Fitted> fitted;
  for (const Fitting& fitting : fittings(size, detail)) {
    const Matrix3d axes = axes_with_longest_last(fitting.half);
    const Vector3d half = axes.transpose() * fitting.half;
    const Matrix3d tilt = axis_rotation(Vector3d::UnitZ(), fitting.yaw * std::numbers::pi / 180) *
                          axis_rotation(Vector3d::UnitY(), fitting.pitch * std::numbers::pi / 180);
    const LocalFrame left{tilt * axes, fitting.place};
    const Mesh part = moved(pebble(half, fitting.exponent, fitting.counts), left);
    for (const double hand : {1.0, -1.0}) {
      const Motion motion{Vector3d(1, hand, 1).asDiagonal(), Vector3d::Zero()};
      fitted.push_back(
          {(hand > 0 ? "left " : "right ") + fitting.name, builder.add(part, motion), image(motion, left)});
    }
  }
  return fitted;
}

GeneratedModel build_car(const ModelValues& values) {
  const int detail = values.count("detail");
  const Size size{values["length"] / 2, values["width"] / 2, values["wheelbase"] / 2, values["wheel_radius"]};
  ModelBuilder builder(0);
  std::vector<PartFaces> shell{builder.add(body(size, detail)), builder.add(cabin(size, detail))};
  const double camber = values["camber"] * std::numbers::pi / 180;
  const std::vector<CarWheel> wheels = add_wheels(builder, size, camber, detail);
  for (const CarWheel& wheel : wheels) shell.push_back(wheel.all);
  std::vector<PartFaces> parts = shell;
  const std::vector<Fitted> fitted = add_fittings(builder, size, detail);
  for (const Fitted& each : fitted) parts.push_back(each.faces);
  const LocalFrame roof{Matrix3d::Identity(), Vector3d(-0.05 * size.half_length, 0, 1.56)};
  const PartFaces roof_box =
      builder.add(box({0.5, 0.36, 0.1}, {6 * detail, 4 * detail, 2 * detail}, 0.08, detail), roof);
  parts.push_back(roof_box);

  builder.declare("car", {Family::Cs, 1}, {frame_about(Vector3d::UnitY()), Vector3d::Zero()}, joined(parts));
  builder.declare("body and wheels", {Family::Cnv, 2}, {Matrix3d::Identity(), Vector3d(0, 0, size.wheel)},
                  joined(shell));
  declare_wheels(builder, wheels, size);
  for (const Fitted& each : fitted) builder.declare(each.name, {Family::Dnh, 2}, each.place, each.faces);
  builder.declare("roof box", {Family::Dnh, 2}, roof, roof_box);
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
