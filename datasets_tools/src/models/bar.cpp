#include "models/model_builder.h"
#include "models/models.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Family = PointGroup::Family;

GeneratedModel build_bar(const ModelValues& values) {
  const int detail = values.count("detail");
  const Eigen::Vector3d size(values["width"], values["height"], values["length"]);
  ModelBuilder builder;
  const PartFaces bar = builder.add(box(size / 2, {10 * detail, 10 * detail, 96 * detail}, 0, 0));
  builder.declare("bar", {Family::Dnh, size.x() == size.y() ? 4 : 2}, {}, bar);
  return builder.finish();
}

}  // namespace

ModelDefinition bar_model() {
  return {{"bar",
           "a straight beam along z, finely meshed so that it can be bent",
           {{"length", 8, 3, 20, false, "along z"},
            {"width", 1, 0.2, 2, false, "along x"},
            {"height", 1, 0.2, 2, false, "along y; D4h where it equals the width, else D2h"},
            {"detail", 1, 1, 6, true, "fineness of the mesh: ten times so many cells across"}}},
          build_bar};
}

}  // namespace orbifit
