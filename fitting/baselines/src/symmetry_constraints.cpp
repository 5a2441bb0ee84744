#include "orbifit/baselines/symmetry_constraints.h"

#include <utility>
#include <vector>

#include "basis/subspace_parts.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;

// Rows of C as they come, three at a time.
class Rows {
 public:
  explicit Rows(const Subspace& subspace) : translations_(3 * subspace->sampling.points.rows()) {}

  void add_sample(int sample, const Matrix3d& block) { add(Eigen::Index{3} * sample, block); }

  void add_carried(const Carried& carried, double factor) {
    for (const auto& [carrier, matrix] : carried) add(translations_ + Eigen::Index{3} * carrier, factor * matrix);
  }

  void next() { row_ += 3; }

  Eigen::SparseMatrix<double> take(Eigen::Index columns) const {
    Eigen::SparseMatrix<double> result(row_, columns);
    result.setFromTriplets(entries_.begin(), entries_.end());
    return result;
  }

 private:
  void add(Eigen::Index column, const Matrix3d& block) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (block(i, j) != 0) entries_.emplace_back(row_ + i, column + j, block(i, j));
      }
    }
  }

  Eigen::Index translations_;
  Eigen::Index row_ = 0;
  std::vector<Eigen::Triplet<double>> entries_;
};

void add_orbits(const Subspace& subspace, Rows& rows) {
  const SymmetricSampling& sampling = subspace->sampling;
  for (int orbit = 0; orbit < sampling.orbits(); ++orbit) {
    const int seed = sampling.first_sample[static_cast<std::size_t>(orbit)];
    for (int k = seed + 1; k < sampling.first_sample[static_cast<std::size_t>(orbit) + 1]; ++k) {
      const Transport& transport = subspace->basis.transports.samples[static_cast<std::size_t>(k)];
      rows.add_sample(k, Matrix3d::Identity());
      rows.add_sample(seed, -transport.frame);
      rows.add_carried(transport.carried, -1);
      rows.next();
    }
  }
}

void add_stabilisers(const Subspace& subspace, Rows& rows) {
  const std::vector<Transport>& words = subspace->basis.transports.words;
  for (const auto& [orbit, left_word, right_word] : subspace->sampling.constraints) {
    const Transport& left = words[static_cast<std::size_t>(left_word)];
    const Transport& right = words[static_cast<std::size_t>(right_word)];
    rows.add_sample(subspace->sampling.first_sample[static_cast<std::size_t>(orbit)], left.frame - right.frame);
    rows.add_carried(left.carried, 1);
    rows.add_carried(right.carried, -1);
    rows.next();
  }
}

// A vertex is to have some displacement that meets its constraints: what they ask of t once that is eliminated.
void add_bound_vertices(const Subspace& subspace, Rows& rows) {
  const CarriedTransports& transports = subspace->basis.transports;
  for (const BoundPoint& point : subspace->orbits.bindings) {
    const Binding binding = binding_of(point.words, transports);
    for (const WordPair& pair : point.words) {
      const Transport& left = transports.words[static_cast<std::size_t>(pair.left)];
      const Transport& right = transports.words[static_cast<std::size_t>(pair.right)];
      Carried pure = carried_sum(left.carried, -Matrix3d::Identity(), right.carried);
      pure = carried_sum(pure, left.frame - right.frame, binding.bound);
      double largest = 0;
      for (const auto& [carrier, matrix] : pure) largest = std::max(largest, matrix.cwiseAbs().maxCoeff());
      if (largest < 1e-10) continue;
      rows.add_carried(pure, 1);
      rows.next();
    }
  }
}

}  // namespace

Eigen::SparseMatrix<double> symmetry_constraints(const Subspace& subspace) {
  Rows rows(subspace);
  add_orbits(subspace, rows);
  add_stabilisers(subspace, rows);
  if (subspace->basis.carried.rows() > 0) add_bound_vertices(subspace, rows);
  return rows.take(3 * subspace->sampling.points.rows() + subspace->basis.carried.rows());
}

}  // namespace orbifit
