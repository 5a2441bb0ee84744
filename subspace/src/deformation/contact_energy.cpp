#include "deformation/contact_energy.h"

#include <cmath>
#include <utility>

#include "basis/lift.h"
#include "basis/subspace_parts.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kClosed = 1e-9;  // of the diagonal: gaps below this need no turning

Vector3d moved_point(const Contact::Side& side, const Points& of_vertices) {
  Vector3d result = Vector3d::Zero();
  for (const auto& [vertex, weight] : side.vertices) result += weight * of_vertices.row(vertex).transpose();
  return result;
}

// How the places of the contacts start to move on one side or the other, as points of the part that is there.
MatrixXd turning_of(const std::vector<Contact>& contacts, std::size_t side, const Points& places, const Points& samples,
                    const SmallTurns& small) {
  LiftWeights follows(places.rows(), samples.rows());
  Points missing = places;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const int sample = contacts[i].sides[side].sample;
    follows.insert(static_cast<Index>(i), sample) = 1;
    missing.row(static_cast<Index>(i)) -= samples.row(sample);
  }
  return applied(follows, small.columns) + small.regions.arms(small.turns, follows, missing);
}

}  // namespace

ContactEnergy::ContactEnergy(std::vector<Contact> contacts, const Subspace& subspace, double weight)
    : contacts_(std::move(contacts)), weight_(weight) {
  MatrixXd rows = contact_rows(contacts_, subspace, subspace->basis);
  MatrixXd pull(rows.cols(), rows.rows());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    auto own = rows.middleRows<3>(3 * static_cast<Index>(i));
    own *= scale(i);
    if (contacts_[i].gap.norm() <= kClosed * subspace->diagonal) continue;
    pull.middleCols<3>(3 * static_cast<Index>(gapped_.size())) = scale(i) * own.transpose();
    gapped_.push_back(i);
  }
  rows_ = rows.sparseView();
  pull_ = pull.leftCols(3 * static_cast<Index>(gapped_.size())).sparseView();
}

double ContactEnergy::scale(std::size_t contact) const {
  return std::sqrt(weight_ * contacts_[contact].count);
}

Eigen::SparseMatrix<double> ContactEnergy::gram() const {
  return rows_.transpose() * rows_;
}

ContactRows contact_rows_at(const std::vector<Contact>& contacts, double weight, const Subspace& subspace,
                            const SubspaceState& state, const Points& displacements,
                            const std::vector<Eigen::Matrix3d>& rotations, const SmallTurns* small) {
  const ConjugatedBasis& basis = basis_of(subspace, state);
  const auto count = static_cast<Index>(contacts.size());
  const Index ways = small != nullptr ? small->columns.cols() : 0;
  ContactRows result{MatrixXd(3 * count, basis.columns.cols() + ways), VectorXd(3 * count)};
  if (count == 0) return result;
  result.rows.leftCols(basis.columns.cols()) = contact_rows(contacts, subspace, basis);
  result.right = result.rows.leftCols(basis.columns.cols()) * state.q;
  Points places(count, 3);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& contact = contacts[i];
    const auto& sides = contact.sides;
    const Vector3d first = moved_point(sides[0], displacements);
    const Vector3d second = moved_point(sides[1], displacements);
    const auto row = static_cast<Index>(i);
    result.right.segment<3>(3 * row) -= first - second -
                                        turned_gap(contact, {rotations[static_cast<std::size_t>(sides[0].sample)],
                                                             rotations[static_cast<std::size_t>(sides[1].sample)]});
    places.row(row) = (contact.point + 0.5 * (first + second)).transpose();
  }
  if (ways > 0) {
    const Points samples = subspace->sampling.points + sample_displacements(subspace, state);
    result.rows.rightCols(ways) =
        turning_of(contacts, 0, places, samples, *small) - turning_of(contacts, 1, places, samples, *small);
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double scale = std::sqrt(weight * contacts[i].count);
    result.rows.middleRows<3>(3 * static_cast<Index>(i)) *= scale;
    result.right.segment<3>(3 * static_cast<Index>(i)) *= scale;
  }
  return result;
}

}  // namespace orbifit
