#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "domains/domain_map.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// How a displacement depends on the translations that carry the groups (docs/method.md 2.2): the sum over the pairs of
/// matrix * t_carrier, ascending by carrier.
using Carried = std::vector<std::pair<int, Eigen::Matrix3d>>;

/// a + factor * b, term by term.
Carried carried_sum(const Carried& a, const Eigen::Matrix3d& factor, const Carried& b);

struct Lattice;

/// The regions S_i and the patterns of an annotated mesh as the subspace needs them: which motions act where, what lies
/// in what, how displacements are carried along, and how far a place's surface is.
class RegionMap : public DomainMap {
 public:
  /// \param context hears of patterns whose instances follow no lattice and are kept as congruent copies
  RegionMap(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context);

  int carriers() const { return carriers_; }  ///< translations that carry regions, then patterns

  /// What a motion of `place` adds to a displacement besides turning it: (1 - O) t for a region.
  Carried carried(int place, int element, const Eigen::Matrix3d& linear) const;

  /// The translation of a pattern's instance in terms of the carriers; empty for a region.
  const Carried& instance_shift(int place) const { return shifts_[static_cast<std::size_t>(place)]; }
  /// What a pattern's generator gains in translation, likewise; empty for copies without lattice.
  Carried generator_shift(int pattern, int generator) const;

  /// Elements to test a region by: all of a finite group; of a continuous one, rotations by odd angles with each
  /// component.
  std::vector<Motion> test_elements(int region) const;

  /// Distance to the place's surface, at most `most` (infinity beyond). For use by several threads after prepare().
  /// \param likely  where the nearest face may well be, as for the point before; brought up to date. May be null
  double distance(const Eigen::Vector3d& point, int place, double most, int* likely = nullptr) const;

  /// Builds the places' trees now rather than when one is first needed.
  void prepare(const RunContext& context) const;

 private:
  RegionMap(const Mesh& mesh, const SymmetryAnnotation& annotation, const std::vector<Lattice>& lattices);
  const MovingSurface& surface(int place) const;

  Mesh mesh_;
  std::vector<Carried> shifts_;  // of each place
  std::vector<int> first_step_;  // carrier of each pattern's first generator; -1: no lattice
  int carriers_ = 0;
  mutable std::vector<std::unique_ptr<MovingSurface>> surfaces_;  // of mesh_
};

}  // namespace orbifit
