#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "basis/symmetric_basis.h"
#include "basis/vertex_orbits.h"
#include "sampling/symmetric_sampling.h"

namespace orbifit {

/// What the lift adds up: a sample's displacement as seen from where a word starts, or for a continuous group its part
/// along or across the axis, or the displacement of the axis itself. The first #S atoms are the samples.
struct LiftAtom {
  enum class Kind : std::uint8_t { full, axial, across, centre };
  int sample = -1;  ///< -1: the centre of `place`
  int word = 0;     ///< pulled back by it
  Kind kind = Kind::full;
  int place = -1;
};

/// Whether an atom of the kind is a position, and not an offset from an axis.
inline bool is_position(LiftAtom::Kind kind) {
  return kind == LiftAtom::Kind::full || kind == LiftAtom::Kind::centre;
}

/// The lift from samples to vertices, averaged over orbits (docs/method.md 2.3):
///     u(p) = 1/N sum over (p_k, O_k) in orbit(p) of O_k^T u_plain(p_k),
/// so exact in every region, partial, nested and overlapping ones too. Baked for one vertex an orbit, as scalar weights
/// on the atoms' displacements; its images are carried copies.
///
/// Eight representatives next to one another share one list of atoms, so that the weights stream through memory and
/// eight sums go on at once.
struct OrbitLift {
  static constexpr int kLanes = 8;
  std::vector<LiftAtom> atoms;
  std::vector<std::int64_t> first;  ///< of each block's entries, and their number at the end
  std::vector<std::int32_t> atom;   ///< of each entry
  std::vector<float> weight;  ///< kLanes of each entry: multiples of 2^-24, on full atoms and centres summing to 1
  std::int64_t used = 0;      ///< weights that are not zero

  std::size_t bytes() const { return weight.size() * sizeof(float) + atom.size() * sizeof(std::int32_t); }

  /// Calls visit(atom, weight) for each part of a representative.
  template <class Visit>
  void visit(int representative, const Visit& visit) const {
    const auto block = static_cast<std::size_t>(representative / kLanes);
    const auto lane = static_cast<std::size_t>(representative % kLanes);
    for (std::int64_t e = first[block]; e < first[block + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      const float part = weight[kLanes * entry + lane];
      if (part != 0) visit(int{atom[entry]}, double{part});
    }
  }
};

/// O(vertices * samples within reach). \param averaged  false: the paper's plain lift
OrbitLift orbit_lift(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words,
                     const SymmetricBasis& basis, const VertexOrbits& vertices, bool averaged,
                     const RunContext& context);

/// An atom's displacement as a function of its orbit's seed and the carriers. `frame` need not be orthogonal.
struct AtomMap {
  int orbit = -1;  ///< -1: carriers alone
  Eigen::Matrix3d frame = Eigen::Matrix3d::Zero();
  Carried carried;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< at rest; relative to the axis for axial and across
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();    ///< displacement when the seed's and the carriers' are zero
};

AtomMap atom_map(const LiftAtom& atom, const SymmetricSampling& sampling, const RegionMap& regions,
                 const CarriedTransports& transports, bool floating, const std::vector<Eigen::Matrix3d>& rotations);

}  // namespace orbifit
