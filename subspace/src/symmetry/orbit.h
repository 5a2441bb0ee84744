#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "symmetry/group_words.h"
#include "symmetry/region_map.h"

namespace orbifit {

struct OrbitPoint {
  Eigen::Vector3d position;
  int word = 0;  ///< from the seed's canonical place to here
  int set = 0;   ///< places that hold the point
};

/// A point reached by two ways whose transports differ: both words must give the same displacement.
struct OrbitConstraint {
  int point;
  int word;
};

/// The transitive closure of a point under the groups of the places in which it and its images lie (paper, section 5,
/// "Partial, overlapping, and nested symmetry"). Where a continuous group acts, a point stands for its whole circle or
/// sphere by its canonical place there.
struct Orbit {
  std::vector<OrbitPoint> points;  ///< the seed's canonical place first
  std::vector<OrbitConstraint> constraints;
  std::vector<Motion> stabilisers;  ///< motions found that bring the seed back to within `snap`
  int turned_by = -1;               ///< place whose continuum took the seed to its canonical place; -1: none
  Motion turn;                      ///< from the canonical place back to the seed
};

struct ClosureOptions {
  double doublet = 1e-9;    ///< points closer than this are one, mesh units, > 0
  double snap = 0;          ///< motions that move the seed by less count as its stabilisers, mesh units
  int most_points = 20000;  ///< an orbit with more never closes
  /// The set of places of a known point at (nearly) this position, which the second set is to be part of; -1: no point
  /// is known there, and the second set is it.
  std::function<int(const Eigen::Vector3d&, int)> set_at;
  const RunContext* context = nullptr;  ///< asked at each point whether to stop; null: never. Not owned
};

/// \param set the places that hold the seed
/// \throw InputError naming two places when the orbit does not close
Orbit orbit_of(const Eigen::Vector3d& seed, int set, const RegionMap& regions, GroupWords& words,
               const ClosureOptions& options);

/// orbit_of() of the point nearest to the seed that all motions fix which move the seed by less than the doublet
/// distance: what is on a mirror or an axis but for that has the displacements of what is on it exactly.
Orbit snapped_orbit_of(const Eigen::Vector3d& seed, int set, const RegionMap& regions, GroupWords& words,
                       const ClosureOptions& options);

/// The point nearest to `seed` that all its stabilisers fix.
Eigen::Vector3d fixed_point(const Eigen::Vector3d& seed, const std::vector<Motion>& stabilisers);

}  // namespace orbifit
