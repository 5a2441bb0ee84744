#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

namespace orbifit::scoring {

/// Pairs (row, column), each row and column at most once, as many as there can be, whose values have the largest sum
/// (the Hungarian method with potentials, Kuhn 1955, O(rows^2 columns)). By ascending row.
std::vector<std::pair<int, int>> best_assignment(const Eigen::MatrixXd& values);

}  // namespace orbifit::scoring
