#include <cmath>
#include <numbers>
#include <string>

#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// A square leg about z, narrowing to `foot` of its thickness at the lower end.
Mesh tapered_rod(double thickness, double length, double foot, int detail) {
  Mesh leg = box({thickness / 2, thickness / 2, length / 2}, {2 * detail, 2 * detail, 8 * detail}, thickness * 0.14, 2);
  for (auto vertex : leg.vertices.rowwise()) {
    const double width = 1 + (foot - 1) * (0.5 - vertex.z() / length);
    vertex.x() *= width;
    vertex.y() *= width;
  }
  return leg;
}

GeneratedModel build_stool(const ModelValues& values) {
  const int detail = values.count("detail");
  const int count = values.count("legs");
  const double height = values["height"];
  const double thickness = values["leg_thickness"];
  const double seat_thickness = values["seat_thickness"];
  const double seat_radius = values["seat_width"] / 2;
  const double underside = height - seat_thickness;

  ModelBuilder builder;
  const Placement seat_place{Matrix3d::Identity(), {0, 0, underside + seat_thickness / 2}};
  const double half = seat_thickness / 2;
  const std::vector<Eigen::Vector2d> rim = trace_profile({{0, -half, 0, 4 * detail},
                                                          {seat_radius, -half, 0.7 * half, 2},
                                                          {seat_radius, half, 0.7 * half, 4 * detail},
                                                          {0, half, 0, 1}},
                                                         3, false);
  const int facets = 8 * count * detail;
  const PartFaces seat = builder.add(lathe(rim, facets, false), seat_place);

  // Made once and copied about the axis. A leg ends within the seat, a stretcher within the legs.
  const std::vector<Matrix3d> turns = elements({Family::Cn, count});
  const Vector3d upper(0.68 * seat_radius, 0, underside + 0.5 * seat_thickness);
  const Vector3d lower(upper.x() + values["leg_spread"], 0, 0);
  const Vector3d along = upper - lower;
  const Vector3d axis = along.normalized();
  Matrix3d frame;
  frame << Vector3d::UnitY().cross(axis), Vector3d::UnitY(), axis;
  const Placement leg_place{frame, (upper + lower) / 2};
  const Mesh leg = moved(tapered_rod(thickness, along.norm(), 0.7, detail), leg_place);

  const Vector3d joint = lower + along * values["stretcher_height"];
  const double half_angle = std::numbers::pi / count;
  const double across = 0.28 * thickness;
  const Placement stretcher_place{elements({Family::Cn, 2 * count})[1], Vector3d::Zero()};
  const Vector3d middle = stretcher_place.frame * Vector3d(joint.x() * std::cos(half_angle), 0, joint.z());
  const double half_length = joint.x() * std::sin(half_angle) - 0.15 * thickness;
  const Mesh stretcher = box({across, half_length, 1.4 * across}, {2, 6 * detail, 2}, 0.3 * across, 2);

  std::vector<PartFaces> legs;
  std::vector<PartFaces> stretchers;
  std::vector<Placement> leg_places;
  std::vector<Placement> stretcher_places;
  for (const Matrix3d& turn : turns) {
    const Motion about{turn, Vector3d::Zero()};
    legs.push_back(builder.add(leg, about));
    leg_places.push_back(image(about, leg_place));
    stretcher_places.push_back(image(about, {stretcher_place.frame, middle}));
    stretchers.push_back(builder.add(stretcher, stretcher_places.back()));
  }

  // Leg 1 lies in a mirror plane, which holds y of the group's frame.
  const Placement about_legs{elements({Family::Cn, 4})[1], Vector3d::Zero()};
  builder.declare("stool", {Family::Cnv, count}, about_legs, joined({seat, joined(legs), joined(stretchers)}));
  builder.declare_turned("seat", true, values.count("continuous") != 0, facets, seat_place, seat);
  for (std::size_t i = 0; i < legs.size(); ++i) {
    builder.declare("leg " + std::to_string(i + 1), {Family::Cnv, 4}, leg_places[i], legs[i]);
  }
  for (std::size_t i = 0; i < stretchers.size(); ++i) {
    builder.declare("stretcher " + std::to_string(i + 1), {Family::Dnh, 2}, stretcher_places[i], stretchers[i]);
  }
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
