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

constexpr int kLobes = 8;
constexpr double kFoot = 0.024;   // half the height of a foot, m
constexpr double kPlinth = 0.02;  // half that of the plinth, m

LocalFrame at(double x, double y, double z) {
  return {Matrix3d::Identity(), Vector3d(x, y, z)};
}

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

// A claw rather than a ball: it narrows downwards and reaches out along the diagonal.
Mesh claw(int detail) {
  Mesh part =
      turned({8, detail, 3 * detail},
             trace_profile(
                 {{0, -kFoot, 0, 1}, {kFoot, -kFoot, 0.9 * kFoot, 1}, {kFoot, kFoot, 0.9 * kFoot, 1}, {0, kFoot, 0, 1}},
                 16, false));
  for (auto vertex : part.vertices.rowwise()) {
    const double down = -vertex.z() / kFoot;
    vertex.x() = (1 - 0.3 * down) * vertex.x() + 0.4 * kFoot * down;
    vertex.y() = (1 - 0.3 * down) * vertex.y() + 0.4 * kFoot * down;
  }
  return part;
}

PartFaces add_feet(ModelBuilder& builder, double base, int detail) {
  const double corner = base - 0.9 * kFoot;
  const Mesh foot = moved(claw(detail), at(corner, corner, kFoot));
  std::vector<PartFaces> feet;
  for (const Matrix3d& turn : elements({Family::Cn, 4})) feet.push_back(builder.add(foot, {turn, Vector3d::Zero()}));
  return joined(feet);
}

// Along +x, from the knob's middle to a candle's foot at the end (reach, rise).
Mesh arm(double knob_level, double reach, double rise, int detail) {
  const Curve line = smooth_curve({Vector3d(0.045, 0, knob_level), Vector3d(0.4 * reach, 0, knob_level - 0.045),
                                   Vector3d(0.78 * reach, 0, knob_level - 0.02),
                                   Vector3d(1.0 * reach, 0, 0.5 * (knob_level + rise)), Vector3d(reach, 0, rise)});
  return tube({6, 2 * detail, 32 * detail}, line, Vector3d::UnitY(), [](double share) {
    return smooth_table({{0, 0.02}, {0.3, 0.012}, {0.6, 0.015}, {1, 0.011}}, share);
  });
}

struct Arms {
  PartFaces arms;
  PartCopies candles;
};

// Four arms from the knob, each with a candle.
Arms add_arms(ModelBuilder& builder, const ModelValues& values, double knob_level) {
  const int detail = values.count("detail");
  const double reach = values["reach"];
  const double rise = knob_level + values["rise"];
  const Mesh arm_part = arm(knob_level, reach, rise, detail);
  const Mesh candle_part = candle(values["candle"], detail);
  std::vector<PartFaces> arms;
  Arms result;
  for (const Matrix3d& turn : elements({Family::Cn, 4})) {
    const Motion motion{turn, Vector3d::Zero()};
    arms.push_back(builder.add(arm_part, motion));
    builder.add_copy(candle_part, image(motion, at(reach, 0, rise)), result.candles);
  }
  result.arms = joined(arms);
  return result;
}

GeneratedModel build_centre_piece(const ModelValues& values) {
  const int detail = values.count("detail");
  const double height = values["height"];
  const double base = values["base"] / 2;
  ModelBuilder builder(0);
  const LocalFrame plinth_place = at(0, 0, 1.7 * kFoot + kPlinth);
  const PartFaces plinth = builder.add(
      box({base, base, kPlinth}, {14 * detail, 14 * detail, 2 * detail}, 0.6 * kPlinth, detail), plinth_place);
  const PartFaces feet = add_feet(builder, base, detail);
  // What is eightfold: column with bowl, knob and beads.
  const double floor = plinth_place.origin.z() + kPlinth;
  const PartFaces bowl = builder.add(column(height, values["bowl"], detail), at(0, 0, floor - 0.004));
  const LocalFrame knob_place = at(0, 0, floor + 0.42 * height);
  const PartFaces knob_faces = builder.add(knob(0.06, detail), knob_place);
  const LocalFrame beads_place = at(0, 0, floor + 0.62 * height);
  const PartFaces beads_faces = builder.add(beads(0.036, 0.012, detail), beads_place);
  const PartFaces eightfold = joined({bowl, knob_faces, beads_faces});
  const Arms arms = add_arms(builder, values, knob_place.origin.z());

  builder.declare("centre piece", {Family::Cnv, 4}, {},
                  joined({feet, plinth, eightfold, arms.arms, joined(arms.candles.faces)}));
  builder.declare("column and bowl", {Family::Cnv, kLobes}, {}, eightfold);
  builder.declare("plinth", {Family::Dnh, 4}, plinth_place, plinth);
  builder.declare("knob", {Family::Dnh, kLobes}, knob_place, knob_faces);
  builder.declare("beads", {Family::Dnh, kLobes}, beads_place, beads_faces);
  builder.declare_each("candle", {Family::Cnv, 6}, arms.candles);
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
