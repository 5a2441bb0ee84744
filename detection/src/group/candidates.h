#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// Coarse distances to a patch on a grid around its centroid: cheap answers for screening thousands of motions.
class DistanceGrid {
 public:
  /// \param points on the surface, dense against the cell size 2 reach / cells
  DistanceGrid(const Points& points, const Eigen::Vector3d& centre, double reach, int cells);

  /// Distance from a point to the nearest occupied cell, to about one cell; points outside the grid are moved to its
  /// border.
  float operator()(const Eigen::Vector3d& point) const;
  double cell() const { return cell_; }

 private:
  int cells_;
  double cell_;
  Eigen::Vector3d corner_;
  std::vector<float> distance_;
};

/// Unit directions spread evenly over half a sphere, each with its neighbours (antipodes identified).
struct DirectionSet {
  std::vector<Eigen::Vector3d> directions;
  std::vector<std::vector<int>> neighbours;
  double spacing = 0;  ///< radians
};
DirectionSet hemisphere_directions(int count);

/// Directions that are screened for axes: some three degrees apart.
inline constexpr int kScreenDirections = 2500;

/// Directions through the area centroid about which a patch may be symmetric, best first. The centroid lies in the
/// fixed set of every finite group, so directions are all there is to find.
struct CandidateDirections {
  std::vector<Eigen::Vector3d> principal;  ///< axes of the covariance, the most distinct eigenvalue first
  std::vector<double> variances;           ///< the eigenvalues in that order
  std::vector<Eigen::Vector3d> mirrors;    ///< normals: local maxima of a coarse score
  std::vector<Eigen::Vector3d> twofold;    ///< axes, likewise
  std::vector<Eigen::Vector3d> threefold;
  /// From the vertices farthest from the centroid, which every element permutes: normals of the planes between two of
  /// them, and axes through one, between two, and about three of them. Exact where the mesh is; many are wrong.
  std::vector<Eigen::Vector3d> corner_mirrors, corner_axes;
};

/// \param screen null: principal axes only (enough where no two variances are close)
CandidateDirections find_candidates(const SurfacePatch& patch, const DirectionSet* screen, const RunContext& context);

}  // namespace orbifit
