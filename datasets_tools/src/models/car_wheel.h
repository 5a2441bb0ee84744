#pragma once

#include <string>
#include <vector>

#include "models/model_builder.h"

namespace orbifit {

inline constexpr double kCarTyreWidth = 0.26;  // m

/// A wheel of the car model, made about z with its outer side to +z and a spoke along +x.
struct CarWheel {
  Motion place;       ///< the wheel's frame -> the car's
  double radius = 0;  ///< of the tyre, m
  PartFaces all, tyre;
  std::vector<PartFaces> spokes, nuts;
};

CarWheel add_car_wheel(ModelBuilder& builder, const Motion& place, double radius, int detail);

/// Declares the wheel, its tyre, spokes and nuts.
void declare_car_wheel(ModelBuilder& builder, const std::string& name, const CarWheel& wheel);

}  // namespace orbifit
