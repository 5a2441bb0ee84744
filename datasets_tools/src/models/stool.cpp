#include <cmath>
#include <numbers>

#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// A profile turned about z, its middle at the origin.
Mesh seat_part(double radius, double thickness, int detail, int facets) {
  const double half = thickness / 2;
  const std::vector<Eigen::Vector2d> rim = trace_profile({{0, -half, 0, 4 * detail},
                                                          {radius, -half, 0.7 * half, 2},
                                                          {radius, half, 0.7 * half, 4 * detail},
                                                          {0, half, 0, 1}},
                                                         3, false);
  return lathe(rim, facets, false);
}

// The middle line of the leg in the half-plane of +x, which ends within the seat.
struct LegLine {
  Vector3d lower, upper;
};

LegLine leg_line(const ModelValues& values) {
  const double underside = values["height"] - values["seat_thickness"];
  const Vector3d upper(0.68 * (values["seat_width"] / 2), 0, underside + 0.5 * values["seat_thickness"]);
  return {Vector3d(upper.x() + values["leg_spread"], 0, 0), upper};
}

LocalFrame place_of_leg(const LegLine& line) {
  const Vector3d axis = (line.upper - line.lower).normalized();
  Matrix3d frame;
  frame << Vector3d::UnitY().cross(axis), Vector3d::UnitY(), axis;
  return {frame, (line.upper + line.lower) / 2};
}

// A bar along y from leg to leg, which ends within them, and its place beside the leg of +x.
struct Stretcher {
  Mesh part;
  LocalFrame place;
};

Stretcher stretcher_between_legs(const LegLine& line, const ModelValues& values) {
  const int count = values.count("legs");
  const double thickness = values["leg_thickness"];
  const Vector3d joint = line.lower + (line.upper - line.lower) * values["stretcher_height"];
  const double half_angle = std::numbers::pi / count;
  const double across = 0.28 * thickness;
  const double half_length = joint.x() * std::sin(half_angle) - 0.15 * thickness;
  const Matrix3d frame = elements({Family::Cn, 2 * count})[1];
  return {box({across, half_length, 1.4 * across}, {2, 6 * values.count("detail"), 2}, 0.3 * across, 2),
          {frame, frame * Vector3d(joint.x() * std::cos(half_angle), 0, joint.z())}};
}

struct Underframe {
  PartCopies legs, stretchers;
};

// Leg and stretcher are made once and copied about the axis.
Underframe add_underframe(ModelBuilder& builder, const ModelValues& values) {
  const LegLine line = leg_line(values);
  const LocalFrame leg_place = place_of_leg(line);
  const double length = (line.upper - line.lower).norm();
  const Mesh leg = moved(tapered_leg(values["leg_thickness"], length, 0.7, values.count("detail")), leg_place);
  const Stretcher stretcher = stretcher_between_legs(line, values);
  Underframe result;
  for (const Matrix3d& turn : elements({Family::Cn, values.count("legs")})) {
    const Motion about{turn, Vector3d::Zero()};
    result.legs.faces.push_back(builder.add(leg, about));
    result.legs.places.push_back(image(about, leg_place));
    builder.add_copy(stretcher.part, image(about, stretcher.place), result.stretchers);
  }
  return result;
}

GeneratedModel build_stool(const ModelValues& values) {
  const int detail = values.count("detail");
  const int count = values.count("legs");
  const double thickness = values["seat_thickness"];
  const double underside = values["height"] - thickness;
  const int facets = 8 * count * detail;

  ModelBuilder builder;
  const LocalFrame seat_place{Matrix3d::Identity(), {0, 0, underside + thickness / 2}};
  const PartFaces seat = builder.add(seat_part(values["seat_width"] / 2, thickness, detail, facets), seat_place);
  const Underframe under = add_underframe(builder, values);

  // Leg 1 lies in a mirror plane, which holds y of the group's frame.
  const LocalFrame about_legs{elements({Family::Cn, 4})[1], Vector3d::Zero()};
  builder.declare("stool", {Family::Cnv, count}, about_legs,
                  joined({seat, joined(under.legs.faces), joined(under.stretchers.faces)}));
  builder.declare_turned("seat", true, values.count("continuous") != 0, facets, seat_place, seat);
  builder.declare_each("leg", {Family::Cnv, 4}, under.legs);
  builder.declare_each("stretcher", {Family::Dnh, 2}, under.stretchers);
  return builder.finish();
}

}  // namespace

ModelDefinition stool_model() {
  return {{"stool",
           "a stool whose splayed legs end in the seat, and whose stretchers end in the legs",
           {{"height", 0.46, 0.2, 0.9, false, "to the seat's upper side, m"},
            {"seat_width", 0.36, 0.2, 0.6, false, "of the round seat, m"},
            {"seat_thickness", 0.035, 0.02, 0.06, false, "m"},
            {"legs", 4, 3, 8, true, "and as many stretchers"},
            {"leg_spread", 0.06, 0, 0.15, false, "how far each foot stands outwards of its upper end, m"},
            {"leg_thickness", 0.04, 0.025, 0.06, false, "at the upper end, m"},
            {"stretcher_height", 0.4, 0.15, 0.8, false, "as a fraction of the legs' height"},
            {"continuous", 1, 0, 1, true, "whether to take the seat as turned (Dinfh) or as made of facets"},
            {"detail", 2, 1, 8, true, "fineness of the mesh"}}},
          build_stool};
}

}  // namespace orbifit
