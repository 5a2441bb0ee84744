#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// A vertex and the place, in the template's frame, to which it is pulled.
struct Pull {
  int vertex;
  Eigen::Vector3d target;
  double weight;
};

/// Of the landmarks and handles, as the scan now lies in the template's frame.
/// \param pose template -> scan \param weight of a landmark; a handle's vertices share three
std::vector<Pull> pulls_towards(const FitInput& input, const Similarity& pose, double weight);

}  // namespace orbifit
