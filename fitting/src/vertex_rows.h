#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// Displacements of vertices as linear forms in a basis' coordinates, kept once they were asked for: a fit asks for
/// those of much the same vertices in each iteration.
class VertexRows {
 public:
  /// References are kept.
  VertexRows(const Subspace& subspace, const CarriedBasis& basis)
      : subspace_(subspace), basis_(basis), rows_(subspace.orbits.followers.size()), known_(rows_.size(), 0) {}

  /// u(vertex) = sum over the entries of q[column] * factor.
  struct Entry {
    int column;
    Eigen::Vector3d factor;
  };

  /// Makes the rows of these vertices, in parallel. \param vertices  any order, repeated ones too
  void prepare(const std::vector<int>& vertices, const RunContext& context);

  /// Adds columns after those there are to a row, once. \pre prepared
  void extend(int vertex, int first_column, const Eigen::Matrix<double, 3, Eigen::Dynamic>& factors) {
    for (Eigen::Index k = 0; k < factors.cols(); ++k) {
      rows_[static_cast<std::size_t>(vertex)].push_back({first_column + static_cast<int>(k), factors.col(k)});
    }
  }

  /// Entries by ascending column. \pre prepared
  const std::vector<Entry>& of(int vertex) const { return rows_[static_cast<std::size_t>(vertex)]; }

 private:
  const Subspace& subspace_;
  const CarriedBasis& basis_;
  std::vector<std::vector<Entry>> rows_;
  std::vector<char> known_;
};

}  // namespace orbifit
