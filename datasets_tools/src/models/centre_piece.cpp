#include <cmath>
#include <numbers>
#include <string>

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

constexpr int kLobes = 8;

// Column and bowl in one, the bowl's rim in eight petals.
Mesh column(double height, double bowl, int detail) {
  const double neck = 0.03;
  return turned({kLobes, 3 * detail, 44 * detail},
                trace_profile({{0, 0, 0, 1},
                               {0.09, 0, 0.01, 1},
                               {0.085, 0.03, 0.02, 1},
                               {neck, 0.09, 0.06, 1},
                               {neck, 0.72 * height, 0.08, 1},
                               {0.55 * bowl, 0.78 * height, 0.08, 1},
                               {bowl, height, 0.006, 1},
                               {0.94 * bowl, height, 0.006, 1},
                               {0.5 * bowl, 0.81 * height, 0.08, 1},
                               {0, 0.79 * height, 0, 1}},
                              16, false),
                [&](double share, double cosine, double sine) {
                  const double petals =
                      smooth_table({{0, 0.02}, {0.3, 0.05}, {0.45, 0.05}, {0.68, 0.13}, {0.9, 0.04}, {1, 0}}, share);
                  return 1 + petals * cosine_of_multiple(kLobes, cosine, sine);
                });
}

Mesh knob(double radius, int detail) {
  return turned({kLobes, 2 * detail, 10 * detail},
                trace_profile({{0, -radius, 0, 1},
                               {radius, -radius, 0.85 * radius, 1},
                               {radius, radius, 0.85 * radius, 1},
                               {0, radius, 0, 1}},
                              24, false),
                [](double, double cosine, double sine) { return 1 + 0.08 * cosine_of_multiple(kLobes, cosine, sine); });
}

// Beads in a row around the column: a ring that swells eight times.
Mesh beads(double radius, double section, int detail) {
  const int around = 2 * kLobes * 3 * detail;
  std::vector<Ring> rings;
  const std::vector<Matrix3d> turns = elements({Family::Cn, around});
  const std::vector<Matrix3d> sides = elements({Family::Cn, 6 * detail});
  for (const Matrix3d& turn : turns) {
    const double thick = section * (1 + 0.3 * cosine_of_multiple(kLobes, turn(0, 0), turn(1, 0)));
    Ring& ring = rings.emplace_back();
    for (const Matrix3d& side : sides) {
      ring.emplace_back(turn * Vector3d(radius + thick * side(0, 0), 0, thick * side(1, 0)));
    }
  }
  return closed_loft(rings);
}

// A cup and a candle in it, both of six lobes.
Mesh candle(double height, int detail) {
  return turned({6, 2 * detail, 20 * detail},
                trace_profile({{0, -0.02, 0, 1},
                               {0.018, -0.02, 0.006, 1},
                               {0.04, 0.015, 0.012, 1},
                               {0.04, 0.05, 0.004, 1},
                               {0.022, 0.05, 0.004, 1},
                               {0.019, height, 0.01, 1},
                               {0.004, height + 0.004, 0.002, 1},
                               {0.003, height + 0.02, 0.002, 1},
                               {0, height + 0.02, 0, 1}},
                              12, false),
                [](double, double cosine, double sine) { return 1 + 0.06 * cosine_of_multiple(6, cosine, sine); });
}

GeneratedModel build_centre_piece(const ModelValues& values) {
  const int detail = values.count("detail");
  const double height = values["height"];
  const double bowl = values["bowl"];
  const double reach = values["reach"];
  const double base = values["base"] / 2;
  const auto at = [](double x, double y, double z) { return Motion{Matrix3d::Identity(), Vector3d(x, y, z)}; };
  ModelBuilder builder(0);
  std::vector<PartFaces> all;
  // Feet and plinth.
  const double foot = 0.024;
  const double plinth_half = 0.02;
  const Vector3d plinth_middle(0, 0, 1.7 * foot + plinth_half);
  const PartFaces plinth =
      builder.add(box({base, base, plinth_half}, {14 * detail, 14 * detail, 2 * detail}, 0.6 * plinth_half, detail),
                  {Matrix3d::Identity(), plinth_middle});
  Mesh foot_part = turned(
      {8, detail, 3 * detail},
      trace_profile({{0, -foot, 0, 1}, {foot, -foot, 0.9 * foot, 1}, {foot, foot, 0.9 * foot, 1}, {0, foot, 0, 1}}, 16,
                    false));
  // Claws rather than balls: they narrow downwards and reach out along the diagonal.
  for (auto vertex : foot_part.vertices.rowwise()) {
    const double down = -vertex.z() / foot;
    vertex.x() = (1 - 0.3 * down) * vertex.x() + 0.4 * foot * down;
    vertex.y() = (1 - 0.3 * down) * vertex.y() + 0.4 * foot * down;
  }
  const double corner = base - 0.9 * foot;
  for (const Matrix3d& turn : elements({Family::Cn, 4})) {
    all.push_back(builder.add(moved(foot_part, at(corner, corner, foot)), {turn, Vector3d::Zero()}));
  }
  const double floor = plinth_middle.z() + plinth_half;
  // What is eightfold: column with bowl, knob and beads.
  const PartFaces bowl_faces = builder.add(column(height, bowl, detail), at(0, 0, floor - 0.004));
  const double knob_level = floor + 0.42 * height;
  const PartFaces knob_faces = builder.add(knob(0.06, detail), at(0, 0, knob_level));
  const double beads_level = floor + 0.62 * height;
  const PartFaces beads_faces = builder.add(beads(0.036, 0.012, detail), at(0, 0, beads_level));
  const PartFaces eightfold = joined({bowl_faces, knob_faces, beads_faces});

  // Four arms from the knob, each with a candle.
  const double rise = knob_level + values["rise"];
  const Curve line = smooth_curve({Vector3d(0.045, 0, knob_level), Vector3d(0.4 * reach, 0, knob_level - 0.045),
                                   Vector3d(0.78 * reach, 0, knob_level - 0.02),
                                   Vector3d(1.0 * reach, 0, 0.5 * (knob_level + rise)), Vector3d(reach, 0, rise)});
  const Mesh arm = tube({6, 2 * detail, 32 * detail}, line, Vector3d::UnitY(), [](double share) {
    return smooth_table({{0, 0.02}, {0.3, 0.012}, {0.6, 0.015}, {1, 0.011}}, share);
  });
  const Mesh candle_part = candle(values["candle"], detail);
  std::vector<PartFaces> candles;
  std::vector<Placement> candle_places;
  for (const Matrix3d& turn : elements({Family::Cn, 4})) {
    const Motion motion{turn, Vector3d::Zero()};
    all.push_back(builder.add(arm, motion));
    candle_places.push_back(image(motion, {Matrix3d::Identity(), Vector3d(reach, 0, rise)}));
    candles.push_back(builder.add(candle_part, candle_places.back()));
  }
  all.push_back(plinth);
  all.push_back(eightfold);
  all.push_back(joined(candles));
  builder.declare("centre piece", {Family::Cnv, 4}, {}, joined(all));
  builder.declare("column and bowl", {Family::Cnv, kLobes}, {}, eightfold);
  builder.declare("plinth", {Family::Dnh, 4}, {Matrix3d::Identity(), plinth_middle}, plinth);
  builder.declare("knob", {Family::Dnh, kLobes}, {Matrix3d::Identity(), Vector3d(0, 0, knob_level)}, knob_faces);
  builder.declare("beads", {Family::Dnh, kLobes}, {Matrix3d::Identity(), Vector3d(0, 0, beads_level)}, beads_faces);
  for (std::size_t i = 0; i < candles.size(); ++i) {
    builder.declare("candle " + std::to_string(i + 1), {Family::Cnv, 6}, candle_places[i], candles[i]);
  }
  return builder.finish();
}

}  // namespace

ModelDefinition centre_piece_model() {
  return {{"centre_piece",
           "a table's centre piece: four arms with candles (C4v, each candle C6v) about a bowl on a column (C8v)",
           {{"height", 0.42, 0.3, 0.7, false, "of the column with the bowl, m"},
            {"bowl", 0.15, 0.1, 0.2, false, "radius of the bowl, m"},
            {"reach", 0.26, 0.22, 0.4, false, "of the arms, m"},
            {"rise", 0.08, 0.04, 0.2, false, "of the arms' ends over the knob, m"},
            {"candle", 0.16, 0.08, 0.3, false, "height of a candle, m"},
            {"base", 0.3, 0.2, 0.4, false, "width of the square plinth, m"},
            {"detail", 4, 1, 16, true, "fineness of the mesh"}}},
          build_centre_piece};
}

}  // namespace orbifit
