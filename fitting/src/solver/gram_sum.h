#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/run_context.h"

namespace orbifit {

/// A part of normal equations: some rows multiplied out, on the columns that they touch.
struct GramPart {
  std::vector<int> columns;  ///< ascending
  Eigen::MatrixXd gram;      ///< lower half, in that order, perhaps with more rows and columns after those
  Eigen::VectorXd side;      ///< likewise
};

/// Adds parts, each column's in their order, whatever the number of threads.
/// \param matrix  lower half \param side  of as many entries as the matrix has columns
/// Cost O(entries of the parts + entries of the matrix).
void add_parts(std::span<const GramPart> parts, const RunContext& context, Eigen::SparseMatrix<double>& matrix,
               Eigen::VectorXd& side);

}  // namespace orbifit
