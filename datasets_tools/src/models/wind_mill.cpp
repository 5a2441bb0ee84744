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

// The factor that makes a circle an octagon, a corner at angle 0; rounded towards `round` = 1.
double octagon(double cosine, double sine, double round) {
  const double eighth = std::numbers::pi / 8;
  const double off = std::remainder(std::atan2(sine, cosine) - eighth, 2 * eighth);
  return (1 - round) * std::cos(eighth) / std::cos(off) + round;
}

double top_radius(double foot) {
  return 0.56 * foot;
}

Mesh tower(double height, double foot, int detail) {
  const double top = top_radius(foot);
  return turned({8, 2 * detail, 28 * detail},
                trace_profile({{0, 0, 0, 1},
                               {foot, 0, 0.1, 1},
                               {0.7 * foot, 0.6 * height, 4 * height, 1},
                               {top, height, 0.1, 1},
                               {0, height, 0, 1}},
                              24, false),
                [](double, double cosine, double sine) { return octagon(cosine, sine, 0.1); });
}

// A stage around the tower, and the cap's dome: octagons like the tower.
Mesh gallery(double radius, int detail) {
  return turned(
      {8, 4 * detail, 2 * detail},
      trace_profile({{0, -0.12, 0, 1}, {radius, -0.12, 0.05, 1}, {radius, 0.12, 0.05, 1}, {0, 0.12, 0, 1}}, 8, false),
      [](double, double cosine, double sine) { return octagon(cosine, sine, 0); });
}

Mesh dome(double radius, int detail) {
  return turned({8, 2 * detail, 6 * detail},
                trace_profile({{0, -0.2, 0, 1},
                               {radius, -0.2, 0.1, 1},
                               {radius, 0.9 * radius, 0.75 * radius, 1},
                               {0.1 * radius, 1.25 * radius, 0.08 * radius, 1},
                               {0, 1.25 * radius, 0, 1}},
                              24, false),
                [](double, double cosine, double sine) { return octagon(cosine, sine, 0.3); });
}

// The shaft of the sails: square and twisted, like the cross that it carries.
Mesh sail_shaft(int detail) {
  return turned({4, 2 * detail, 4 * detail},
                trace_profile({{0, 0.45, 0, 1}, {0.3, 0.45, 0.1, 1}, {0.3, -1.9, 0.1, 1}, {0, -1.9, 0, 1}}, 8, false),
                [](double share, double cosine, double sine) {
                  return 1 + 0.15 * std::cos(4 * (std::atan2(sine, cosine) + share));
                });
}

// A square beam along x or along y; `cells` pieces along it.
Mesh beam(const Vector3d& from, const Vector3d& to, double thickness, int cells) {
  const Vector3d along = to - from;
  const bool lengthwise = along.x() > along.y();
  Mesh part = box({along.x() / 2 + thickness, along.y() / 2 + thickness, thickness},
                  {lengthwise ? cells : 2, lengthwise ? 2 : cells, 2}, 0, 0);
  return moved(part, {Matrix3d::Identity(), (from + to) / 2});
}

// One sail along +x: a tapering stock, laths along it on its one side, and bars across.
std::vector<Mesh> sail_parts(double sail, double width, int detail) {
  constexpr int kBars = 14;
  std::vector<Mesh> parts;
  const double inner = 0.16 * sail;
  Mesh stock = beam({0, 0, 0}, {sail, 0, 0}, 0.13, 40 * detail);
  for (auto vertex : stock.vertices.rowwise()) {
    const double thin = 1 - 0.5 * vertex.x() / sail;
    vertex.y() *= thin;
    vertex.z() *= thin;
  }
  parts.push_back(std::move(stock));
  for (const double side : {1.0, 0.5, -0.22}) {
    parts.push_back(beam({inner, side * width, 0}, {0.985 * sail, side * width, 0}, 0.04, 32 * detail));
  }
  // A little thinner than the laths, so that they share no corners.
  for (int i = 0; i < kBars; ++i) {
    const double x = inner + (0.985 * sail - inner) * i / (kBars - 1);
    parts.push_back(beam({x, -0.22 * width, 0}, {x, width, 0}, 0.035, 8 * detail));
  }
  return parts;
}

PartFaces add_house(ModelBuilder& builder, const ModelValues& values) {
  const int detail = values.count("detail");
  const double height = values["height"];
  const double foot = values["foot"];
  const auto at = [](double z) { return Motion{Matrix3d::Identity(), Vector3d(0, 0, z)}; };
  std::vector<PartFaces> parts{builder.add(tower(height, foot, detail))};
  parts.push_back(builder.add(gallery(1.25 * foot, detail), at(0.3 * height)));
  parts.push_back(builder.add(dome(1.12 * top_radius(foot), detail), at(height)));
  return joined(parts);
}

// About z with the front to +z, then turned: the shaft rises a little to the front, -y.
LocalFrame hub_place(const ModelValues& values) {
  const double rise = values["shaft_rise"] * std::numbers::pi / 180;
  const double top = top_radius(values["foot"]);
  Matrix3d frame;
  frame << 1, 0, 0, 0, -std::sin(rise), -std::cos(rise), 0, std::cos(rise), -std::sin(rise);
  frame.col(2) = Vector3d(0, -std::cos(rise), std::sin(rise));
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return {frame, Vector3d(0, 0, values["height"] + 0.5 * top) + frame.col(2) * (1.12 * top + 0.7)};
}

PartFaces add_sails(ModelBuilder& builder, const ModelValues& values, const LocalFrame& hub) {
  const int detail = values.count("detail");
  std::vector<PartFaces> parts{builder.add(sail_shaft(detail), hub)};
  const std::vector<Mesh> sail = sail_parts(values["sail"], values["sail_width"], detail);
  const Matrix3d pitch = axis_rotation(Vector3d::UnitX(), values["pitch"] * std::numbers::pi / 180);
  for (const Matrix3d& turn : elements({Family::Cn, 4})) {
    for (const Mesh& part : sail) parts.push_back(builder.add(moved(part, {turn * pitch, Vector3d::Zero()}), hub));
  }
  return joined(parts);
}

GeneratedModel build_wind_mill(const ModelValues& values) {
  ModelBuilder builder(0);
  const LocalFrame hub = hub_place(values);
  const PartFaces house = add_house(builder, values);
  const PartFaces sails = add_sails(builder, values, hub);
  builder.declare("tower", {Family::Cnv, 8}, {}, house);
  builder.declare("sails", {Family::Cn, 4}, hub, sails);
  return builder.finish();
}

}  // namespace

ModelDefinition wind_mill_model() {
  return {{"wind_mill",
           "a windmill: an eight-sided tower with gallery and dome, and four sails that no mirror maps to themselves",
           {{"height", 9, 6, 14, false, "of the tower, m"},
            {"foot", 2.6, 2, 4, false, "radius of the tower at the ground, m"},
            {"sail", 6, 4, 9, false, "length of a sail, m"},
            {"sail_width", 1.2, 0.8, 1.8, false, "from the stock to the outer edge, m"},
            {"pitch", 12, 4, 30, false, "of the sails, degrees"},
            {"shaft_rise", 8, 2, 15, false, "of the sails' shaft, degrees"},
            {"detail", 2, 1, 16, true, "fineness of the mesh"}}},
          build_wind_mill};
}

}  // namespace orbifit
