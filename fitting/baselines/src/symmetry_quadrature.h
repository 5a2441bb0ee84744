#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

#include "symmetry/region_map.h"

namespace orbifit {

/// One symmetry g of the template, at quadrature points x of the surface that has it. Of a deformed shape f,
///   f(g x) = T f(x),  T y = M y + (1 - M) centre + shift of the carried translations   (a region, M = R O R^T),
///                     T y = O y + translation + shift                                  (a pattern's instance).
struct SymmetryDemand {
  int region = -1;  ///< whose group it is; -1: a pattern's
  Motion motion;    ///< g
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Carried shift;          ///< of a region with R = 1
  Points points, images;  ///< x and g x, #Q by 3
  double weight = 0;      ///< area of each point, as a share of the mesh's
};

struct SymmetryDemands {
  std::vector<SymmetryDemand> demands;
  std::vector<int> carrier_of_region;         ///< -1: none
  std::vector<int> first_carrier_of_pattern;  ///< -1: none
  int carriers = 0;                           ///< translations
};

/// The generators of each region, at points drawn uniformly by area, and the instances of each pattern: `points` on the
/// whole mesh and as many on each part as its area's share, but not less than 64.
/// \param mode  fixed: nothing is carried
SymmetryDemands symmetry_demands(const Mesh& mesh, const SymmetryAnnotation& annotation, int points, GroupMode mode,
                                 const RunContext& context);

/// The linear part of T. \param rotations R of each region
Eigen::Matrix3d carried_linear(const SymmetryDemand& demand, const std::vector<Eigen::Matrix3d>& rotations);

/// How the translations that carry the groups enter T.
Carried carried_shift(const SymmetryDemand& demand, const Eigen::Matrix3d& linear);

/// T's translation where the carriers are zero.
Eigen::Vector3d uncarried_translation(const SymmetryDemand& demand, const Eigen::Matrix3d& linear);

/// T f(x) - f(g x) at each point. \param from, to f at the points and at their images, #Q by 3
Points symmetry_differences(const SymmetryDemand& demand, const std::vector<Eigen::Matrix3d>& rotations,
                            const Points& carriers, const Points& from, const Points& to);

}  // namespace orbifit
