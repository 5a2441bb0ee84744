#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/subspace/subspace.h"

#include "basis/conjugated_regions.h"
#include "deformation/contacts.h"

namespace orbifit {

/// The contacts' energy in the coordinates of a basis at rest: weight times the sum over the contacts of
/// count |C q - (R - 1) gap|^2. All but the gaps' turn is constant.
class ContactEnergy {
 public:
  ContactEnergy() = default;
  ContactEnergy(std::vector<Contact> contacts, const Subspace& subspace, double weight);

  const std::vector<Contact>& contacts() const { return contacts_; }

  /// Its quadratic part, weight C^T C, DoF by DoF, both halves. A contact touches the few coordinates that move it.
  Eigen::SparseMatrix<double> gram() const;

  /// Adds half its linear part to a right-hand side, DoF. \param turned  of a sample's number: its rotation. Asked for
  /// contacts that have a gap at rest alone
  template <class Turned>
  void add_pull(const Turned& turned, Eigen::VectorXd& side) const {
    if (gapped_.empty()) return;
    side.noalias() += pull_ * targets(turned);
  }

  /// Its value at coordinates q.
  template <class Turned>
  double value(const Eigen::VectorXd& q, const Turned& turned) const {
    if (contacts_.empty()) return 0;
    Eigen::VectorXd off = rows_ * q;
    const Eigen::VectorXd wanted = targets(turned);
    for (std::size_t g = 0; g < gapped_.size(); ++g) {
      off.segment<3>(3 * static_cast<Eigen::Index>(gapped_[g])) -=
          scale(gapped_[g]) * wanted.segment<3>(3 * static_cast<Eigen::Index>(g));
    }
    return off.squaredNorm();
  }

 private:
  double scale(std::size_t contact) const;  // square root of what a contact weighs

  template <class Turned>
  Eigen::VectorXd targets(const Turned& turned) const {
    Eigen::VectorXd result(3 * static_cast<Eigen::Index>(gapped_.size()));
    for (std::size_t g = 0; g < gapped_.size(); ++g) {
      const Contact& contact = contacts_[gapped_[g]];
      result.segment<3>(3 * static_cast<Eigen::Index>(g)) =
          turned_gap(contact, {turned(contact.sides[0].sample), turned(contact.sides[1].sample)});
    }
    return result;
  }

  std::vector<Contact> contacts_;
  double weight_ = 0;
  Eigen::SparseMatrix<double, Eigen::RowMajor> rows_;  // 3 #contacts by DoF, each times its scale()
  std::vector<std::size_t> gapped_;                    // contacts with a gap at rest
  Eigen::SparseMatrix<double> pull_;                   // DoF by 3 #gapped_
};

/// The contacts' energy about a state of any mode is |rows x - right|^2, x being the coordinates themselves, followed
/// by small angles in the ways in which the groups may turn, to first order in these.
struct ContactRows {
  Eigen::MatrixXd rows;
  Eigen::VectorXd right;
};

/// How groups start to turn, see ConjugatedRegions.
struct SmallTurns {
  const ConjugatedRegions& regions;
  const ConjugatedRegions::Turns& turns;  ///< where they stand
  const Eigen::MatrixXd& columns;         ///< of the samples where they are now, 3#S by ways
};

/// \param weight        as of ContactEnergy
/// \param displacements of the vertices at the state, #V by 3
/// \param rotations     of the samples, #S
/// \param small         null: the groups stay as they stand, x holds the coordinates alone
ContactRows contact_rows_at(const std::vector<Contact>& contacts, double weight, const Subspace& subspace,
                            const SubspaceState& state, const Points& displacements,
                            const std::vector<Eigen::Matrix3d>& rotations, const SmallTurns* small = nullptr);

/// Weight of a contact against the mean diagonal of the energy that it is added to: firm, so that a joint gives far
/// less than the parts that it joins, and yet no more than what a factorisation bears with ease.
constexpr double kContactWeight = 100;

}  // namespace orbifit
