#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"

namespace orbifit {

/// A finite group of motions with its table; all elements fix `centre`.
struct FiniteGroup {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::vector<Motion> elements{Motion{}};       ///< the identity first
  std::vector<std::vector<int>> products{{0}};  ///< products[a][b]: first b, then a
  std::vector<int> inverses{0};

  int order() const { return static_cast<int>(elements.size()); }
};

/// The group that some motions generate, in closed form.
/// \param about   a point of the shape that they keep
/// \param extent  of that shape, mesh units: motions that differ by less than 1e-5 of it on it are one
/// \return nothing where it has more than 512 elements or is no point group, as where translations arise
std::optional<FiniteGroup> generated_group(const std::vector<Motion>& generators, const Eigen::Vector3d& about,
                                           double extent);

}  // namespace orbifit
