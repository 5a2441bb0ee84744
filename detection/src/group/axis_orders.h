#pragma once

#include <vector>

#include <Eigen/Core>

#include "surface/surface_patch.h"

namespace orbifit {

/// Largest distance of the patch's samples from a line.
double radius_about(const SurfacePatch& patch, const Eigen::Vector3d& axis, const Eigen::Vector3d& centre);

/// Orders n >= 2 such that the rotations by multiples of 2 pi / n about the axis through `centre` keep the patch,
/// descending, judged coarsely (`slack` tolerances, few samples). Orders whose step is too small to tell from none are
/// left out.
std::vector<int> rotation_orders(const SurfacePatch& patch, const Eigen::Vector3d& axis, const Eigen::Vector3d& centre,
                                 double slack);

/// A look while an axis is not refined yet: tolerances, and the share of the samples that must be kept.
inline constexpr double kScreenSlack = 2.5;
inline constexpr double kScreenShare = 0.80;

struct RankedOrder {
  int order = 1;
  double share = 0;  ///< of the samples kept by the worst of the multiples tried
};

/// Of these orders those that fit at the tolerance itself: the nearly perfect ones first, high before low.
std::vector<RankedOrder> rank_orders(const SurfacePatch& patch, const std::vector<int>& orders,
                                     const Eigen::Vector3d& axis, const Eigen::Vector3d& centre);

/// Whether every rotation about the axis keeps the patch, facets allowed for: their sagitta must stay below the
/// continuous tolerance. Judged coarsely, on a few angles.
bool continuous_about(const SurfacePatch& patch, const Eigen::Vector3d& axis, const Eigen::Vector3d& centre);

/// The tolerance at which a continuous group of the patch is judged, a length: tighter for small parts than that of
/// finite groups, so that an octagonal post is not called round because the mesh is large.
double continuous_tolerance(const SurfacePatch& patch);

}  // namespace orbifit
