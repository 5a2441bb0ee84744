#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

// Profiles of parts that turn about z; the wheel's outer side looks to +z. The corners of `upper` run from one point of
// the mirror plane z = 0 to another.
std::vector<ProfilePoint> with_mirror_image(std::vector<ProfilePoint> upper) {
  for (std::size_t i = upper.size() - 2; i > 0; --i) {
    ProfilePoint corner = upper[i];
    corner.height = -corner.height;
    corner.cells = upper[i - 1].cells;  // a line's cut belongs to its first corner: on the way back the other end
    upper.push_back(corner);
  }
  const std::size_t middle = upper.size() / 2;
  upper[middle].cells = upper[middle - 1].cells;
  return upper;
}

// Half a period of the tread, from the middle of a lug to the middle of the gap, as shares of the period; whether the
// tread is high there.
struct Station {
  double share;
  bool high;
};
constexpr std::array<Station, 4> kHalfLug{{{0, true}, {0.29, true}, {0.35, false}, {0.5, false}}};

Mesh tyre(double radius, double rim, double width, int lugs, int detail) {
  const double half = width / 2;
  const double depth = 0.045 * radius;
  const auto section = [&](bool high) {
    const double tread = high ? radius : radius - depth;
    const std::vector<ProfilePoint> upper{{radius - depth, 0, 0, 1},
                                          {radius - depth, 0.035 * width, 0, 1},
                                          {tread, 0.055 * width, 0, 3 * detail},
                                          {tread - 0.01 * radius, 0.97 * half, 0, 1},
                                          {tread - 0.035 * radius, 1.04 * half, 0, detail},
                                          {0.92 * radius - 0.5 * (radius - tread), 1.07 * half, 0, detail},
                                          {0.5 * (radius + rim), 1.1 * half, 0.25 * width, 2 * detail},
                                          {rim, 0.86 * half, 0.02 * width, detail},
                                          {rim - 0.02 * radius, 0.72 * half, 0, 1},
                                          {rim - 0.02 * radius, 0, 0, 1}};
    return trace_profile(with_mirror_image(upper), 2 * detail, true);
  };
  const std::vector<Eigen::Vector2d> high = section(true);
  const std::vector<Eigen::Vector2d> low = section(false);
  // One period from the gap's middle on, without its end: that is the next one's beginning.
  std::vector<Station> period;
  for (std::size_t i = kHalfLug.size() - 1; i > 0; --i) period.push_back({-kHalfLug[i].share, kHalfLug[i].high});
  for (std::size_t i = 0; i + 1 < kHalfLug.size(); ++i) period.push_back(kHalfLug[i]);
  std::vector<Ring> rings;
  for (const Matrix3d& turn : elements({Family::Cn, lugs})) {
    for (const Station& station : period) {
      const double angle = 2 * std::numbers::pi * station.share / lugs;
      const Matrix3d within = axis_rotation(Vector3d::UnitZ(), angle);
      Ring& ring = rings.emplace_back();
      for (const Eigen::Vector2d& point : station.high ? high : low) {
        ring.emplace_back(turn * (within * Vector3d(point.x(), 0, point.y())));
      }
    }
  }
  // The quadrangles between high and low are not flat: their diagonals are mirrored where the tread is.
  const int stations = static_cast<int>(period.size());
  const int points = static_cast<int>(high.size());
  return closed_loft(rings,
                     [&](int ring, int point) { return (ring % stations < stations / 2) == (point < points / 2); });
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
                                          {0.7 * radius, height, 0, 1},
                                          {radius, height - 0.25 * radius, 0, 2 * detail},
                                          {radius, -0.2 * height, 0, 1},
                                          {0, -0.2 * height, 0, 1}};
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

// About z; the wheel then stands on the floor with its outer side to -y.
LocalFrame standing(double radius) {
  Matrix3d frame;
  frame << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return {frame, Vector3d(0, 0, radius)};
}

GeneratedModel build_wheel(const ModelValues& values) {
  const int detail = values.count("detail");
  const int lugs = 5 * (2 * values.count("tread") + 1);  // no multiple of 10: the bolts' C10v is not the tyre's
  const int facets = 2 * lugs;
  const double radius = values["radius"];
  const double width = values["width"];
  const double rim = radius * values["rim"];
  const double hub = 0.44 * rim;
  const double front = 0.22 * width;
  const LocalFrame place = standing(radius);

  ModelBuilder builder;
  const PartFaces tyre_faces = builder.add(tyre(radius, rim, width, lugs, detail), place);
  const PartFaces rim_faces = builder.add(rim_barrel(rim, width, facets, detail), place);
  const PartFaces hub_faces = builder.add(hub_disc(hub, front, -0.1 * width, facets, detail), place);
  const auto copies = [&](const Mesh& part, int count) {
    std::vector<PartFaces> faces;
    for (const Matrix3d& turn : elements({Family::Cn, count})) {
      faces.push_back(builder.add(moved(part, {turn, Vector3d::Zero()}), place));
    }
    return joined(faces);
  };
  const PartFaces spokes =
      copies(spoke(0.8 * hub, 0.885 * rim, front - 0.1 * hub, 0.42 * hub, values["spoke_breadth"] * rim, detail), 5);
  const Motion out{Matrix3d::Identity(), Vector3d(0.72 * hub, 0, front)};
  const PartFaces bolts = copies(moved(bolt(0.185 * hub, 0.6 * hub, detail), out), 10);
  const Motion aside =
      Motion::rotation(Vector3d::UnitZ(), values["valve_angle"] * std::numbers::pi / 180, Vector3d::Zero());
  const Motion at_rim{Matrix3d::Identity(), Vector3d(0.87 * rim, 0, 0.24 * width)};
  const Motion inwards = Motion::rotation(Vector3d::UnitY(), -0.35 * std::numbers::pi, Vector3d::Zero());
  builder.add(moved(valve(0.22 * rim, detail), aside * at_rim * inwards), place);

  // Column 0 is the normal of the mirror through the first spoke, bolt and lug; for Dnh it lies along a twofold axis.
  const LocalFrame mirrored{frame_about(place.frame.col(2), Vector3d(place.frame.col(1))), place.origin};
  const PartFaces turned = joined({rim_faces, hub_faces});
  builder.declare("wheel without valve", {Family::Cnv, 5}, mirrored, joined({tyre_faces, turned, spokes, bolts}));
  builder.declare("tyre, rim and hub", {Family::Cnv, lugs}, mirrored, joined({tyre_faces, turned}));
  builder.declare("tyre and rim", {Family::Dnh, lugs}, place, joined({tyre_faces, rim_faces}));
  builder.declare("rim, hub and bolts", {Family::Cnv, 10}, mirrored, joined({turned, bolts}));
  const bool continuous = values.count("continuous") != 0;
  builder.declare_turned("rim and hub", false, continuous, facets, place, turned);
  builder.declare_turned("rim", true, continuous, facets, place, rim_faces);
  return builder.finish();
}

}  // namespace

ModelDefinition wheel_model() {
  return {
      {"wheel",
       "a standing wheel: tyre with a tread, rim, hub, 5 spokes, 10 bolts and a valve that has no partner",
       {{"radius", 0.34, 0.2, 0.5, false, "of the tyre, m"},
        {"width", 0.16, 0.1, 0.3, false, "of the tyre, m"},
        {"rim", 0.68, 0.6, 0.8, false, "radius of the rim over that of the tyre"},
        {"spoke_breadth", 0.26, 0.12, 0.4, false, "at the hub, as a fraction of the rim's radius"},
        {"valve_angle", 20, 5, 31, false, "from the first spoke, degrees; 36 would be midway"},
        {"tread", 3, 1, 8, true, "lugs around the tyre: 5 (2 tread + 1), so that the tyre has not the bolts' symmetry"},
        {"continuous", 1, 0, 1, true,
         "1: the truth calls turned parts Cinfv and Dinfh, 0: by their facets, Cnv and Dnh"},
        {"detail", 2, 1, 6, true, "fineness of the mesh across the facets"}}},
      build_wheel};
}

}  // namespace orbifit
