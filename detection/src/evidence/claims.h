#pragma once

#include <cstddef>
#include <vector>

#include "orbifit/model/annotation.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// What a region or a pattern says: which motions take which faces onto others that it names.
struct SymmetryClaim {
  const Region* region = nullptr;  ///< one of the two
  const Pattern* pattern = nullptr;
  std::vector<const std::vector<int>*> pieces;  ///< faces of the region, or of each instance
  std::vector<std::vector<Motion>> motions;     ///< by piece: all but the identity; of continuous groups those of a
                                                ///< finite subgroup that divides an orbit finely
  std::vector<std::vector<Motion>> generators;  ///< by piece: motions of which those are products
};

/// The regions, then the patterns; the annotation is kept by reference.
std::vector<SymmetryClaim> claims_of(const SymmetryAnnotation& annotation);

/// The mesh's faces by the claims that name them: an atom is all faces that the same claims name.
class ClaimAtoms {
 public:
  ClaimAtoms(const PreparedMesh& prepared, const std::vector<SymmetryClaim>& claims);

  std::size_t count() const { return faces_.size(); }
  int of_face(int face) const { return atom_of_face_[static_cast<std::size_t>(face)]; }
  const std::vector<int>& faces(std::size_t atom) const { return faces_[atom]; }
  /// Which piece of the claim the atom lies in; -1: none.
  int piece(std::size_t claim, int atom) const {
    return atom < 0 ? -1 : pieces_[static_cast<std::size_t>(atom)][claim];
  }

 private:
  std::vector<int> atom_of_face_;
  std::vector<std::vector<int>> faces_;   // by atom
  std::vector<std::vector<int>> pieces_;  // by atom and claim
};

/// Claims that are images of one another under the motions of others, by number, each family ascending, families in the
/// order of their first. Listed together, or not at all, they leave a consistent annotation consistent.
std::vector<std::vector<std::size_t>> families_of(const PreparedMesh& prepared,
                                                  const std::vector<SymmetryClaim>& claims, const ClaimAtoms& atoms,
                                                  double tolerance);

}  // namespace orbifit
