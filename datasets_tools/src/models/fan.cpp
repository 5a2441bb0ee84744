#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// The head is made about z, its front to +z, and then turned so that the front looks to -y and x stays.
Matrix3d head_frame() {
  Matrix3d frame;
  frame << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return frame;
}

Mesh torus(double radius, double height, double section, int facets, int sides) {
  std::vector<Vector2d> circle;
  for (const Matrix3d& turn : elements({Family::Cn, sides})) {
    circle.emplace_back(radius + section * turn(0, 0), height + section * turn(1, 0));
  }
  return lathe(circle, facets, true);
}

// Twisted and swept, along +x from the hub: no mirror maps it to itself.
Mesh thick_blade(double root, double tip, int detail) {
  const int stations = 14 * detail;
  const int points = 12 * detail;
  std::vector<Ring> rings;
  std::vector<Vector3d> middles;
  for (int i = 0; i <= stations; ++i) {
    // Stations crowd towards the rounded tip.
    const double share = std::sin(0.5 * std::numbers::pi * i / (stations + 0.6));
    const double roundness = std::pow(1 - std::pow(share, 7), 0.5);
    const double chord = tip * (0.3 + 0.42 * std::pow(share, 0.8)) * roundness;
    const double thickness = 0.02 * tip * (1.6 - share) * std::max(roundness, 0.2);
    const double pitch = (42 - 20 * share) * std::numbers::pi / 180;
    const double sweep = 0.24 * share * share;
    const Vector3d middle = Vector3d(root + (tip - root) * share, 0, 0);
    Ring& ring = rings.emplace_back();
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < 2 * points; ++k) {
      const double angle = std::numbers::pi * k / points;
      const double along = 0.5 * std::cos(angle);
      const double camber = 0.09 * chord * (1 - 4 * along * along);
      const double lift = 0.5 * thickness * std::sin(angle) * (1.15 - 0.5 * along) + camber;
      const Vector3d flat(0, along * chord, lift);
      const Vector3d pitched = axis_rotation(Vector3d::UnitX(), pitch) * flat;
      ring.push_back(axis_rotation(Vector3d::UnitZ(), sweep) * (middle + pitched));
      sum += ring.back();
    }
    middles.emplace_back(sum / (2 * points));
  }
  return loft(rings, middles.front(), middles.back());
}

Mesh hub_cap(double radius, double front, double back, int facets, int detail) {
  const std::vector<ProfilePoint> corners{{0, front, 0, detail},
                                          {0.55 * radius, front, 0.5 * radius, 1},
                                          {radius, front - 0.55 * radius, 0.3 * radius, detail},
                                          {radius, back, 0, detail},
                                          {0, back, 0, 1}};
  return lathe(trace_profile(corners, 3 * detail, false), facets, false);
}

Mesh motor(double radius, double front, double back, int facets, int detail) {
  const std::vector<ProfilePoint> corners{{0, front, 0, detail},
                                          {0.8 * radius, front, 0.1 * radius, detail},
                                          {radius, front - 0.3 * radius, 0.15 * radius, 2 * detail},
                                          {0.85 * radius, back + 0.4 * radius, 0.5 * radius, detail},
                                          {0.45 * radius, back, 0.25 * radius, detail},
                                          {0, back, 0, 1}};
  return lathe(trace_profile(corners, 3 * detail, false), facets, false);
}

Mesh badge(double radius, double front, double thickness, int facets, int detail) {
  const std::vector<ProfilePoint> corners{{0, front, 0, 2 * detail},
                                          {radius, front - 0.5 * thickness, 0.3 * thickness, 1},
                                          {radius, front - 1.5 * thickness, 0.3 * thickness, 2 * detail},
                                          {0, front - 1.5 * thickness, 0, 1}};
  return lathe(trace_profile(corners, detail, false), facets, false);
}

// A wire of the guard in the plane y = 0, from radius `from` at height `depth` to the rim at height 0.
std::vector<Vector3d> wire_path(double from, double to, double depth, int pieces) {
  std::vector<Vector3d> path;
  for (int i = 0; i <= pieces; ++i) {
    const double share = static_cast<double>(i) / pieces;
    const double angle = 0.5 * std::numbers::pi * share;
    // A quarter of a superellipse: flat before the blades, then round down to the rim.
    const double out = std::pow(std::sin(angle), 0.9);
    const double up = std::pow(std::max(std::cos(angle), 0.0), 0.8);
    path.emplace_back(from + (to - from) * out, 0, depth * up);
  }
  return path;
}

struct Head {
  std::vector<PartFaces> turned, wires, blades, rings;
  std::vector<LocalFrame> ring_places;
  int facets = 0;
};

Head build_head(ModelBuilder& builder, const ModelValues& values, const Vector3d& middle) {
  const int detail = values.count("detail");
  const int blades = values.count("blades");
  const int wires = values.count("wires");
  const double radius = values["radius"];
  const double depth = values["guard_depth"];
  const Motion place{head_frame(), middle};
  Head head;
  // Facets of the turned parts: a multiple of 4, of the blades' and of the wires' number.
  const int least = std::max(4, std::lcm(4, std::lcm(blades, wires)));
  head.facets = least * std::max(1, (100 + least - 1) / least);

  const auto turned = [&](const Mesh& part) { head.turned.push_back(builder.add(part, place)); };
  const double badge_radius = 0.2 * radius;
  const double wire = 0.009 * radius;
  turned(hub_cap(0.2 * radius, 0.62 * depth, -0.25 * depth, head.facets, detail));
  turned(motor(0.32 * radius, -0.75 * depth, -0.75 * depth - 0.5 * radius, head.facets, detail));
  turned(badge(badge_radius, depth + 3 * wire, 4 * wire, head.facets, detail));
  const auto ring = [&](double ring_radius, double height, double section, int sides) {
    turned(torus(ring_radius, height, section, head.facets, sides));
    head.rings.push_back(head.turned.back());
    head.ring_places.push_back({place.linear, place(Vector3d(0, 0, height))});
  };
  ring(radius, 0, 2.6 * wire, 6 + 4 * detail);
  const int pieces = 8 * detail;
  const std::vector<Vector3d> front = wire_path(0.9 * badge_radius, radius, depth, pieces);
  const std::vector<Vector3d> back = wire_path(0.25 * radius, radius, -0.8 * depth, pieces);
  const auto& front_ring = front[static_cast<std::size_t>(pieces * 5 / 8)];
  const auto& back_ring = back[static_cast<std::size_t>(pieces * 5 / 8)];
  ring(front_ring.x(), front_ring.z(), 1.2 * wire, 6);
  ring(back_ring.x(), back_ring.z(), 1.2 * wire, 6);

  for (const auto& path : {front, back}) {
    const Mesh part = rod(path, Vector3d::UnitY(), wire, 6);
    for (const Matrix3d& turn : elements({Family::Cn, wires})) {
      head.wires.push_back(builder.add(moved(part, {turn, Vector3d::Zero()}), place));
    }
  }
  const Mesh blade_part = thick_blade(0.15 * radius, 0.88 * radius, detail);
  for (const Matrix3d& turn : elements({Family::Cn, blades})) {
    head.blades.push_back(builder.add(moved(blade_part, {turn, Vector3d::Zero()}), place));
  }
  return head;
}

struct Stand {
  std::vector<PartFaces> turned, others;
  PartFaces pole;
  LocalFrame pole_place;
  int facets = 0;
};

Stand build_stand(ModelBuilder& builder, const ModelValues& values, double top, double back) {
  const int detail = values.count("detail");
  const double base = values["base_radius"];
  const double thick = 0.16 * base;
  const double pole = 0.085 * base;
  Stand stand;
  stand.facets = 40 + 20 * (detail - 1);
  const Motion place{Matrix3d::Identity(), Vector3d(0, back, 0)};
  const std::vector<ProfilePoint> base_corners{{0, 0, 0, 2 * detail},
                                               {0.96 * base, 0, 0.02 * base, 1},
                                               {base, 0.35 * thick, 0.05 * base, 1},
                                               {0.9 * base, 0.85 * thick, 0.25 * base, 2 * detail},
                                               {0.24 * base, 1.25 * thick, 0.1 * base, 1},
                                               {0.17 * base, 2.4 * thick, 0.06 * base, detail},
                                               {0, 2.4 * thick, 0, 1}};
  stand.turned.push_back(
      builder.add(lathe(trace_profile(base_corners, 3 * detail, false), stand.facets, false), place));
  const double half = (top - thick) / 2;
  const std::vector<ProfilePoint> pole_corners{
      {0, -half, 0, 1}, {pole, -half, 0, 10 * detail}, {pole, half, 0, 1}, {0, half, 0, 1}};
  stand.pole_place = {Matrix3d::Identity(), Vector3d(0, back, thick + half)};
  stand.pole = builder.add(lathe(trace_profile(pole_corners, 1, false), stand.facets, false), stand.pole_place);
  stand.turned.push_back(stand.pole);
  // A switch at the front, lying in the mirror plane.
  const Vector3d at(0, back - 0.62 * base, thick);
  const Matrix3d slope = axis_rotation(Vector3d::UnitX(), 0.12);
  stand.others.push_back(builder.add(
      box({0.2 * base, 0.07 * base, 0.12 * thick + 0.03 * base}, {4 * detail, 2, 2}, 0.025 * base, 2), {slope, at}));
  return stand;
}

GeneratedModel build_fan(const ModelValues& values) {
  ModelBuilder builder;
  const double radius = values["radius"];
  const Vector3d middle(0, 0, values["height"]);
  const Head head = build_head(builder, values, middle);
  // The pole stands under the motor.
  const double back = 0.75 * values["guard_depth"] + 0.22 * radius;
  const Stand stand = build_stand(builder, values, middle.z() - 0.16 * radius, back);

  const LocalFrame about_head{head_frame(), middle};
  const PartFaces turned = joined(head.turned);
  const PartFaces guard = joined({turned, joined(head.wires)});
  const PartFaces stand_turned = joined(stand.turned);
  builder.declare("all but the blades", {Family::Cs, 1}, {frame_about(Vector3d::UnitX()), Vector3d::Zero()},
                  joined({guard, stand_turned, joined(stand.others)}));
  builder.declare("rotor", {Family::Cn, values.count("blades")}, about_head, joined({turned, joined(head.blades)}));
  // The first wire lies in the plane of the head's x and z: its normal is column 0 of the group's frame.
  const LocalFrame about_wire{frame_about(about_head.frame.col(2), Vector3d(about_head.frame.col(1))), middle};
  builder.declare("guard", {Family::Cnv, values.count("wires")}, about_wire, guard);
  const bool continuous = values.count("continuous") != 0;
  const auto round = [&](const std::string& name, bool alike, int facets, const LocalFrame& about,
                         const PartFaces& faces) {
    builder.declare_turned(name, alike, continuous, facets, about, faces);
  };
  round("turned parts of the head", false, head.facets, about_head, turned);
  const std::array<std::string, 3> ring_names{"rim of the guard", "front ring", "back ring"};
  for (std::size_t i = 0; i < head.rings.size(); ++i) {
    round(ring_names[i], true, head.facets, head.ring_places[i], head.rings[i]);
  }
  round("base and pole", false, stand.facets, stand.pole_place, stand_turned);
  round("pole", true, stand.facets, stand.pole_place, stand.pole);
  return builder.finish();
}

}  // namespace

ModelDefinition fan_model() {
  return {{"fan",
           "a fan with chiral blades in a wire guard, on a stand",
           {{"radius", 0.2, 0.1, 0.4, false, "of the guard, m"},
            {"guard_depth", 0.075, 0.06, 0.12, false, "from the rim to the front, m"},
            {"height", 0.46, 0.45, 1.4, false, "of the head's middle, m"},
            {"base_radius", 0.14, 0.1, 0.3, false, "m"},
            {"blades", 5, 3, 6, true, "of the rotor"},
            {"wires", 24, 12, 40, true, "of the guard's front, and as many at its back"},
            {"continuous", 1, 0, 1, true,
             "1: the truth calls turned parts Cinfv and Dinfh, 0: by their facets, Cnv and Dnh"},
            {"detail", 1, 1, 4, true, "fineness of the mesh"}}},
          build_fan};
}

}  // namespace orbifit
