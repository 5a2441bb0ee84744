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

GeneratedModel build_yard_tool(const ModelValues& values) {
  const int detail = values.count("detail");
  const double length = values["length"];
  const double handle = values["handle"];
  const double spread = values["spread"];
  const double tine = values["tine"];
  ModelBuilder builder(0);
  // The shaft swells at the hub that holds the tines; its four sides are faintly flat.
  const Mesh shaft_part =
      turned({8, 2 * detail, 58 * detail},
             trace_profile({{0, -0.06, 0, 1},
                            {0.036, -0.06, 0.014, 1},
                            {0.034, 0.05, 0.03, 1},
                            {0.017, 0.1, 0.05, 1},
                            {0.017, length, 0.012, 1},
                            {0, length, 0, 1}},
                           16, false),
             [](double, double cosine, double sine) { return 1 - 0.05 * cosine_of_multiple(4, cosine, sine); });
  std::vector<PartFaces> lower{builder.add(shaft_part)};
  // Out from the hub, down, and in again to the point.
  const Curve line =
      smooth_curve({Vector3d(0.012, 0, -0.02), Vector3d(0.55 * spread, 0, 0.012), Vector3d(spread, 0, -0.3 * tine),
                    Vector3d(0.86 * spread, 0, -0.7 * tine), Vector3d(0.5 * spread, 0, -tine)});
  const Mesh tine_part = tube({6, 2 * detail, 30 * detail}, line, Vector3d::UnitY(),
                              [](double share) { return 0.011 * (1 - 0.75 * std::pow(share, 4)); });
  for (const Matrix3d& turn : elements({Family::Cn, 4})) {
    lower.push_back(builder.add(tine_part, {turn, Vector3d::Zero()}));
  }
  // The handle: a bar along x with two swelling grips.
  const Curve bar = smooth_curve({Vector3d(-handle, 0, -0.02), Vector3d(-0.5 * handle, 0, 0.005), Vector3d(0, 0, 0.012),
                                  Vector3d(0.5 * handle, 0, 0.005), Vector3d(handle, 0, -0.02)});
  const Mesh handle_part = tube({6, 3 * detail, 30 * detail}, bar, Vector3d::UnitY(), [](double share) {
    const double out = std::abs(2 * share - 1);
    return smooth_table({{0, 0.021}, {0.2, 0.016}, {0.42, 0.016}, {0.5, 0.019}, {0.75, 0.022}, {1, 0.018}}, out);
  });
  const PartFaces handle_faces = builder.add(handle_part, {Matrix3d::Identity(), Vector3d(0, 0, length)});
  const PartFaces shaft_and_tines = joined(lower);
  builder.declare("yard tool", {Family::Cnv, 2}, {}, joined({shaft_and_tines, handle_faces}));
  builder.declare("shaft and tines", {Family::Cnv, 4}, {}, shaft_and_tines);
  return builder.finish();
}

}  // namespace

ModelDefinition yard_tool_model() {
  return {{"yard_tool",
           "a garden claw: four tines at a shaft (C4v) with a cross handle (C2v)",
           {{"length", 0.85, 0.5, 1.4, false, "of the shaft, m"},
            {"handle", 0.2, 0.12, 0.3, false, "half the length of the handle, m"},
            {"spread", 0.11, 0.07, 0.18, false, "how far the tines reach out, m"},
            {"tine", 0.2, 0.12, 0.3, false, "height of the tines, m"},
            {"detail", 4, 1, 20, true, "fineness of the mesh"}}},
          build_yard_tool};
}

}  // namespace orbifit
