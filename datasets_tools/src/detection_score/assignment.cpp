#include "detection_score/assignment.h"

#include <algorithm>
#include <limits>

namespace orbifit::scoring {

namespace {

// Smallest sum of costs, rows <= columns: the column of each row. Row 0 and column 0 are outside of the matrix.
std::vector<int> cheapest_columns(const Eigen::MatrixXd& costs) {
  const auto rows = static_cast<std::size_t>(costs.rows());
  const auto columns = static_cast<std::size_t>(costs.cols());
  std::vector<double> row_potential(rows + 1, 0.0);
  std::vector<double> column_potential(columns + 1, 0.0);
  std::vector<std::size_t> row_of(columns + 1, 0);
  for (std::size_t row = 1; row <= rows; ++row) {
    // The cheapest path from this row over alternating edges to a column that is free.
    std::vector<double> reduced(columns + 1, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(columns + 1, 0);
    std::vector<char> done(columns + 1, 0);
    row_of[0] = row;
    std::size_t column = 0;
    do {
      done[column] = 1;
      const std::size_t here = row_of[column];
      double step = std::numeric_limits<double>::infinity();
      std::size_t next = 0;
      for (std::size_t j = 1; j <= columns; ++j) {
        if (done[j] != 0) continue;
        const double cost = costs(static_cast<Eigen::Index>(here) - 1, static_cast<Eigen::Index>(j) - 1) -
                            row_potential[here] - column_potential[j];
        if (cost < reduced[j]) {
          reduced[j] = cost;
          before[j] = column;
        }
        if (reduced[j] < step) {
          step = reduced[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j <= columns; ++j) {
        if (done[j] != 0) {
          row_potential[row_of[j]] += step;
          column_potential[j] -= step;
        } else {
          reduced[j] -= step;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = before[column]) row_of[column] = row_of[before[column]];
  }
  std::vector<int> result(rows, -1);
  for (std::size_t j = 1; j <= columns; ++j) {
    if (row_of[j] != 0) result[row_of[j] - 1] = static_cast<int>(j) - 1;
  }
  return result;
}

}  // namespace

std::vector<std::pair<int, int>> best_assignment(const Eigen::MatrixXd& values) {
  const bool wide = values.rows() <= values.cols();
  const std::vector<int> columns =
      cheapest_columns(wide ? Eigen::MatrixXd(-values) : Eigen::MatrixXd(-values.transpose()));
  std::vector<std::pair<int, int>> pairs;
  for (int row = 0; row < static_cast<int>(columns.size()); ++row) {
    const int column = columns[static_cast<std::size_t>(row)];
    pairs.push_back(wide ? std::pair{row, column} : std::pair{column, row});
  }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace orbifit::scoring
