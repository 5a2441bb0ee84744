#include "for_each_coordinate.h"

#include <vector>

namespace orbifit {

using Sparse = Eigen::SparseMatrix<double>;

Sparse lower_for_each_coordinate(const Sparse& scalar, Eigen::Index unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index k = 0; k < scalar.outerSize(); ++k) {
    for (Sparse::InnerIterator entry(scalar, k); entry; ++entry) {
      if (entry.row() < entry.col()) continue;
      for (int c = 0; c < 3; ++c) entries.emplace_back(3 * entry.row() + c, 3 * entry.col() + c, entry.value());
    }
  }
  Sparse result(unknowns, unknowns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace orbifit
