#include "models/orbit_model.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "models/model_builder.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kSeedDirections = 4000;

// Distance from a point to the nearest of its other images, at most 1.
double clearance(const Vector3d& point, const std::vector<Matrix3d>& group) {
  double least = 1;
  for (std::size_t g = 1; g < group.size(); ++g) least = std::min(least, (group[g] * point - point).norm());
  return least;
}

// The roomiest direction, then moved off it: the best one may lie on an axis of a larger group's.
Vector3d generic_direction(const std::vector<Matrix3d>& group) {
  Random random(1, "orbit model");
  Vector3d best = Vector3d::UnitX();
  double room = -1;
  for (int i = 0; i < kSeedDirections; ++i) {
    const Vector3d direction = random.direction();
    const double here = clearance(direction, group);
    if (here > room) {
      room = here;
      best = direction;
    }
  }
  const Vector3d aside = Vector3d(0.31, -0.83, 0.46).cross(best).normalized();
  return (best + 0.12 * room * aside).normalized();
}

}  // namespace

void OrbitOptions::validate() const {
  if (subdivisions < 0 || subdivisions > 5) {
    throw UsageError("subdivisions = " + std::to_string(subdivisions) + ": must be from 0 to 5");
  }
  if (!(radius > 0)) throw UsageError("radius = " + std::to_string(radius) + ": must be above 0");
  if (orthogonality_error(frame) > 1e-9) throw UsageError("frame: must be orthonormal");
}

GeneratedModel generate_orbit(const PointGroup& group, const OrbitOptions& options) {
  options.validate();
  if (group.continuous()) throw UsageError("group = " + group.symbol() + ": must be finite");
  const std::vector<Matrix3d> linear = elements(group, options.frame);
  const Vector3d direction = generic_direction(linear);
  const double size = 0.5 * clearance(direction, linear);
  Mesh part = chiral_blob(options.subdivisions);
  // Each body turns as its own place demands nothing of: a general rotation, the same for every group.
  const Matrix3d turn = Random(2, "orbit model").rotation();
  part.vertices = options.radius * ((size * part.vertices * turn.transpose()).rowwise() + direction.transpose());

  ModelBuilder builder;
  std::vector<PartFaces> copies;
  copies.reserve(linear.size());
  for (const Matrix3d& element : linear) copies.push_back(builder.add(part, {element, options.centre}));
  if (group.order() > 1) {
    builder.declare("whole", group, {options.frame, options.centre}, joined(copies));
  }
  return builder.finish();
}

}  // namespace orbifit
