#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"
#include "orbifit/subspace/region_map.h"

namespace orbifit {

/// How a displacement at one place depends on the orbit's seed s and on the translations t_i that carry the regions'
/// groups (method notes 2.2): u = frame s + sum over i of carried_i t_i.
struct Transport {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  std::vector<std::pair<int, Eigen::Matrix3d>> carried;  ///< by ascending region; empty when groups are fixed
};

/// Transport on from a place by an element of region `region`: u(g p) = O u(p) + (I - O) t_region.
Transport transported(const Transport& from, const Eigen::Matrix3d& linear, int region, bool floating);

/// Largest entry of the difference of two transports.
double transport_difference(const Transport& a, const Transport& b);

struct OrbitPoint {
  Eigen::Vector3d position;
  Motion motion;  ///< from the seed to here
  Transport transport;
  std::vector<int> regions;  ///< that hold the point, ascending
};

/// A point reached by two ways whose transports differ: transport(point) == other restricts the displacements.
struct OrbitConstraint {
  int point;
  Transport other;
};

/// The transitive closure of a point under the groups of the regions in which it and its images lie
/// (paper, section 5, "Partial, overlapping, and nested symmetry").
struct Orbit {
  std::vector<OrbitPoint> points;  ///< the seed first
  std::vector<OrbitConstraint> constraints;
  std::vector<Motion> stabilisers;  ///< motions found that bring the seed back to within `snap`
};

struct ClosureOptions {
  bool floating = true;     ///< carry the groups by translations
  double doublet = 1e-9;    ///< points closer than this are one, mesh units, > 0
  double snap = 0;          ///< motions that move the seed by less count as its stabilisers, mesh units
  int most_points = 20000;  ///< an orbit with more never closes
  /// Regions to follow, by number; null: all. Not owned.
  const std::vector<char>* followed = nullptr;
};

/// \param face the face on which the seed lies: it says in which regions the seed is
/// \throw InputError naming two regions when the orbit does not close
Orbit orbit_of(const Eigen::Vector3d& seed, int face, const RegionMap& regions, const ClosureOptions& options);

/// The point nearest to `seed` that all its stabilisers fix.
Eigen::Vector3d fixed_point(const Eigen::Vector3d& seed, const std::vector<Motion>& stabilisers);

}  // namespace orbifit
