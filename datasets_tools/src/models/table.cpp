#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;

// A square leg about z from 0 down to -height, narrowing to `foot` of its thickness.
Mesh hanging_leg(double thickness, double height, double foot, int detail) {
  Mesh leg = box({thickness / 2, thickness / 2, height / 2}, {2 * detail, 2 * detail, 8 * detail}, thickness * 0.08, 2);
  for (auto vertex : leg.vertices.rowwise()) {
    vertex.z() -= height / 2;
    const double width = 1 + (foot - 1) * -vertex.z() / height;
    vertex.x() *= width;
    vertex.y() *= width;
  }
  return leg;
}

GeneratedModel build_table(const ModelValues& values) {
  const int detail = values.count("detail");
  const double half = values["width"] / 2;
  const double height = values["height"];
  const double thick = values["top_thickness"];
  const double leg = values["leg_thickness"];
  const double inset = values["inset"];
  const Motion lift{Eigen::Matrix3d::Identity(), Vector3d(0, 0, height - thick / 2)};
  const double underside = height - thick;

  ModelBuilder builder;
  const PartFaces top = builder.add(box({half, half, thick / 2}, {8 * detail, 8 * detail, 2}, 0.3 * thick, 3), lift);

  // Made once at one side and copied to the others, so that the whole is exactly symmetric.
  const double reach = half - inset - leg / 2;
  const double apron_height = values["apron_height"];
  const double apron_half = reach - 0.4 * leg;
  const Mesh leg_part = hanging_leg(leg, underside, values["foot"], detail);
  const Mesh apron_part = box({apron_half, 0.14 * leg, apron_height / 2}, {6 * detail, 2, 2 * detail}, 0.03 * leg, 1);
  PartCopies legs;
  PartCopies aprons;
  for (const Eigen::Matrix3d& turn : elements({Family::Cn, 4})) {
    const Motion about_table{turn, Vector3d::Zero()};
    builder.add_copy(leg_part, image(about_table, {Eigen::Matrix3d::Identity(), Vector3d(reach, reach, underside)}),
                     legs);
    builder.add_copy(
        apron_part, image(about_table, {Eigen::Matrix3d::Identity(), Vector3d(0, reach, underside - apron_height / 2)}),
        aprons);
  }
  builder.declare("table", {Family::Cnv, 4}, {}, joined({top, joined(legs.faces), joined(aprons.faces)}));
  builder.declare("top", {Family::Dnh, 4}, {Eigen::Matrix3d::Identity(), lift.translation}, top);
  builder.declare_each("leg", {Family::Cnv, 4}, legs);
  builder.declare_each("apron", {Family::Dnh, 2}, aprons);
  return builder.finish();
}

}  // namespace

ModelDefinition table_model() {
  return {{"table",
           "a square table on four tapered legs with aprons",
           {{"width", 0.9, 0.5, 1.6, false, "of the square top, m"},
            {"height", 0.74, 0.3, 1.2, false, "to the top's upper side, m"},
            {"top_thickness", 0.035, 0.015, 0.08, false, "m"},
            {"leg_thickness", 0.07, 0.03, 0.1, false, "at the upper end, m"},
            {"foot", 0.6, 0.3, 0.9, false, "thickness of a leg at the floor over that at the upper end"},
            {"inset", 0.045, 0, 0.08, false, "of the legs from the edge of the top, m"},
            {"apron_height", 0.09, 0.03, 0.15, false, "m"},
            {"detail", 2, 1, 8, true, "fineness of the mesh"}}},
          build_table};
}

}  // namespace orbifit
