#pragma once

#include <vector>

#include <Eigen/SparseCore>

namespace orbifit {

/// Columns that are eliminated one after the other and have their entries in nearly the same rows.
struct EliminationFront {
  int first = 0;              ///< of its columns, in the order of elimination
  int width = 0;              ///< how many columns
  std::vector<int> rows;      ///< below its columns in which one of them may have an entry, ascending
  std::vector<int> children;  ///< fronts before it whose first row is one of its columns, ascending
};

/// How a sparse symmetric matrix is eliminated.
struct EliminationFronts {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;  ///< indices()[i]: when row i is eliminated
  std::vector<EliminationFront> fronts;  ///< children before parents, the last child just before its parent
};

/// In an order of little fill (Amestoy, Davis and Duff 1996). Columns are joined to fronts where few of a front's
/// entries stay zero (Ashcraft and Grimes 1989). O(entries of the factor)
/// \param lower  a matrix' lower half with all of its diagonal, #N by #N
EliminationFronts elimination_fronts(const Eigen::SparseMatrix<double>& lower);

}  // namespace orbifit
