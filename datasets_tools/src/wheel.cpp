#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "model_builder.h"
#include "models.h"
#include "primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// Profiles of parts that turn about z; the wheel's outer side looks to +z.

std::vector<ProfilePoint> with_mirror_image(std::vector<ProfilePoint> upper) {
  // From the tread's middle over the upper side inwards, then back over the lower side; the first and last corner lie
  // in the mirror plane.
  for (std::size_t i = upper.size() - 2; i > 0; --i) {
    ProfilePoint corner = upper[i];
    corner.height = -corner.height;
    corner.cells = upper[i - 1].cells;
    upper.push_back(corner);
  }
  // The cut of each line belongs to its first corner: on the way back that of the line's other end.
  const std::size_t middle = upper.size() / 2;
  upper[middle].cells = upper[middle - 1].cells;
  return upper;
}

Mesh tyre(double radius, double rim, double width, int facets, int detail) {
  const double half = width / 2;
  const double groove = 0.03 * radius;
  std::vector<ProfilePoint> upper{{radius - groove, 0, 0, 1},
                                  {radius - groove, 0.04 * width, 0, 1},
                                  {radius, 0.06 * width, 0, detail},
                                  {radius, 0.22 * width, 0, 1},
                                  {radius - groove, 0.24 * width, 0, 1},
                                  {radius - groove, 0.3 * width, 0, 1},
                                  {radius, 0.32 * width, 0, detail},
                                  {radius - 0.01 * radius, half, 0.11 * width, detail},
                                  {0.5 * (radius + rim), 1.1 * half, 0.25 * width, 2 * detail},
                                  {rim, 0.86 * half, 0.02 * width, detail},
                                  {rim - 0.02 * radius, 0.72 * half, 0, 1},
                                  {rim - 0.02 * radius, 0, 0, 1}};
  return lathe(trace_profile(with_mirror_image(std::move(upper)), 3 * detail, true), facets, true);
}

Mesh rim_barrel(double rim, double width, int facets, int detail) {
  const double half = 0.47 * width;
  const double lip = 0.05 * rim;
  std::vector<ProfilePoint> upper{{0.9 * rim, 0, 0, 2 * detail},
                                  {0.92 * rim, 0.6 * half, 0.2 * rim, detail},
                                  {rim + 0.4 * lip, 0.84 * half, 0.1 * rim, 1},
                                  {rim + lip, half, 0.3 * lip, 1},
                                  {rim - lip, half, 0.5 * lip, 1},
                                  {0.86 * rim, 0.6 * half, 0.2 * rim, 2 * detail},
                                  {0.85 * rim, 0, 0, 2 * detail}};
  return lathe(trace_profile(with_mirror_image(std::move(upper)), 2 * detail, true), facets, true);
}

Mesh hub_disc(double radius, double front, double back, int facets, int detail) {
  const double cap = 0.42 * radius;
  const std::vector<ProfilePoint> corners{{0, front + 0.35 * cap, 0, detail},
                                          {0.8 * cap, front + 0.3 * cap, 0.2 * cap, 1},
                                          {cap, front, 0.06 * cap, detail},
                                          {radius, front - 0.06 * radius, 0.1 * radius, detail},
                                          {1.02 * radius, back, 0.06 * radius, detail},
                                          {0.5 * radius, back, 0, detail},
                                          {0, back, 0, 1}};
  return lathe(trace_profile(corners, 2 * detail, false), facets, false);
}

// From the hub outwards along +x, mirror-symmetric about the plane y = 0; broad at both ends, arched to the front.
Mesh spoke(double from, double to, double front, double thickness, double breadth, int detail) {
  const int stations = 8 * detail;
  const int points = 8 * detail;
  std::vector<Ring> rings;
  for (int i = 0; i <= stations; ++i) {
    const double share = static_cast<double>(i) / stations;
    const double waist = 1 - 0.42 * std::sin(std::numbers::pi * std::min(1.0, 1.1 * share));
    const double half_breadth = 0.5 * breadth * waist * (1 + 0.35 * share);
    const double half_thickness = 0.5 * thickness * (1 - 0.35 * share);
    const Vector3d middle(from + (to - from) * share, 0,
                          front - half_thickness + 0.05 * (to - from) * std::sin(std::numbers::pi * share));
    Ring& ring = rings.emplace_back();
    for (const Matrix3d& turn : elements({Family::Cn, 2 * points})) {
      // A section between an ellipse and a rectangle.
      const auto squared = [](double value) { return std::copysign(std::pow(std::abs(value), 0.45), value); };
      ring.emplace_back(middle + Vector3d(0, half_breadth * squared(turn(1, 0)), half_thickness * squared(turn(0, 0))));
    }
  }
  const auto mean = [](const Ring& ring) {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& point : ring) sum += point;
    sum /= static_cast<double>(ring.size());
    return Vector3d(sum.x(), 0, sum.z());
  };
  return loft(rings, mean(rings.front()), mean(rings.back()));
}

// A hexagon-headed bolt along z with a corner at angle 0.
Mesh bolt(double radius, double height, int detail) {
  const std::vector<ProfilePoint> corners{{0, height, 0, 1},
                                          {0.75 * radius, height, 0, 1},
                                          {radius, 0.8 * height, 0, detail},
                                          {radius, -height, 0, 1},
                                          {0, -height, 0, 1}};
  return lathe(trace_profile(corners, 1, false), 6, false);
}

Mesh valve(double length, int detail) {
  const double r = 0.13 * length;
  const std::vector<ProfilePoint> corners{{0, length, 0, 1},
                                          {0.6 * r, length, 0.2 * r, detail},
                                          {0.6 * r, 0.55 * length, 0, 1},
                                          {r, 0.5 * length, 0.2 * r, 2 * detail},
                                          {1.25 * r, 0, 0, 1},
                                          {0, 0, 0, 1}};
  return lathe(trace_profile(corners, detail, false), 12, false);
}

GeneratedModel build_wheel(const ModelValues& values) {
  const int detail = values.count("detail");
  const int facets = 10 * values.count("tens_of_facets");
  const int spokes = 5;
  const int bolts = 10;
  const double radius = values["radius"];
  const double width = values["width"];
  const double rim = radius * values["rim"];
  const double hub = 0.34 * rim;
  const double front = 0.3 * width;

  ModelBuilder builder;
  const PartFaces tyre_faces = builder.add(tyre(radius, rim, width, facets, detail));
  const PartFaces rim_faces = builder.add(rim_barrel(rim, width, facets, detail));
  const PartFaces hub_faces = builder.add(hub_disc(hub, front, -0.1 * width, facets, detail));

  const Mesh spoke_part =
      spoke(0.7 * hub, 0.885 * rim, front - 0.1 * hub, 0.4 * hub, values["spoke_breadth"] * rim, detail);
  std::vector<PartFaces> spoke_faces;
  for (const Matrix3d& turn : elements({Family::Cn, spokes})) {
    spoke_faces.push_back(builder.add(spoke_part, {turn, Vector3d::Zero()}));
  }
  const Motion out{Matrix3d::Identity(), Vector3d(0.7 * hub, 0, front)};
  const Mesh bolt_part = moved(bolt(0.1 * hub, 0.09 * hub, detail), out);
  std::vector<PartFaces> bolt_faces;
  for (const Matrix3d& turn : elements({Family::Cn, bolts})) {
    bolt_faces.push_back(builder.add(bolt_part, {turn, Vector3d::Zero()}));
  }
  const Motion to_side =
      Motion::rotation(Vector3d::UnitZ(), values["valve_angle"] * std::numbers::pi / 180, Vector3d::Zero());
  const Motion inwards = Motion::rotation(Vector3d::UnitY(), -0.35 * std::numbers::pi, Vector3d::Zero());
  const Motion at_rim{Matrix3d::Identity(), Vector3d(0.87 * rim, 0, 0.24 * width)};
  builder.add(valve(0.2 * rim, detail), to_side * at_rim * inwards);

  const Placement middle;
  const PartFaces round = joined({tyre_faces, rim_faces});
  const PartFaces turned = joined({round, hub_faces});
  const PartFaces bolted = joined({turned, joined(bolt_faces)});
  builder.declare("wheel without valve", {Family::Cnv, spokes},
                  {frame_about(Vector3d::UnitZ(), Vector3d::UnitY()), {0, 0, 0}},
                  joined({bolted, joined(spoke_faces)}));
  builder.declare("wheel without spokes", {Family::Cnv, bolts},
                  {frame_about(Vector3d::UnitZ(), Vector3d::UnitY()), {0, 0, 0}}, bolted);
  if (values.count("continuous") != 0) {
    builder.declare("tyre, rim and hub", {Family::Cinfv, 1}, middle, turned);
    builder.declare("tyre and rim", {Family::Dinfh, 1}, middle, round);
  } else {
    builder.declare("tyre, rim and hub", {Family::Cnv, facets}, middle, turned);
    builder.declare("tyre and rim", {Family::Dnh, facets}, middle, round);
  }
  return builder.finish();
}

}  // namespace

ModelDefinition wheel_model() {
  return {
      {"wheel",
       "a car's wheel about z: tyre, rim and hub of many facets, 5 spokes, 10 bolts and a valve that has no partner",
       {{"radius", 0.32, 0.2, 0.5, false, "of the tyre, m"},
        {"width", 0.2, 0.1, 0.3, false, "of the tyre, m"},
        {"rim", 0.7, 0.6, 0.8, false, "radius of the rim over that of the tyre"},
        {"spoke_breadth", 0.26, 0.12, 0.4, false, "at the hub, as a fraction of the rim's radius"},
        {"valve_angle", 20, 5, 31, false, "from the first spoke, degrees; 36 would be midway"},
        {"tens_of_facets", 6, 2, 20, true, "facets of the tyre's circle, divided by ten"},
        {"continuous", 0, 0, 1, true, "1: the truth calls turned parts Cinfv and Dinfh, else by their facets"},
        {"detail", 2, 1, 6, true, "fineness of the mesh across the facets"}}},
      build_wheel};
}

}  // namespace orbifit
