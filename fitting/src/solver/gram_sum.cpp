#include "solver/gram_sum.h"

#include <bit>
#include <cstdint>
#include <utility>

namespace orbifit {

namespace {

// A column's lower half while it is summed; its rows come out ascending.
class ColumnSum {
 public:
  explicit ColumnSum(std::size_t rows) : sums_(rows, 0), touched_((rows + 63) / 64, 0) {}

  void add(const GramPart& part, std::size_t column) {
    const double* from = part.gram.col(static_cast<Eigen::Index>(column)).data();
    for (std::size_t a = column; a < part.columns.size(); ++a) {
      entry(static_cast<std::size_t>(part.columns[a])) += from[a];
    }
  }

  void add(const Eigen::SparseMatrix<double>& matrix, std::size_t column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, static_cast<Eigen::Index>(column)); it; ++it) {
      entry(static_cast<std::size_t>(it.row())) += it.value();
    }
  }

  // Leaves the sum empty. \param first  row from which there may be any
  void take(std::size_t first, std::vector<std::pair<int, double>>& entries) {
    entries.clear();
    for (std::size_t word = first / 64; word < touched_.size(); ++word) {
      for (std::uint64_t bits = std::exchange(touched_[word], 0); bits != 0; bits &= bits - 1) {
        const std::size_t row = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
        // Columns of a part that no row of it touches together.
        if (sums_[row] == 0) continue;
        entries.emplace_back(static_cast<int>(row), std::exchange(sums_[row], 0.0));
      }
    }
  }

 private:
  double& entry(std::size_t row) {
    touched_[row / 64] |= std::uint64_t{1} << (row % 64);
    return sums_[row];
  }

  std::vector<double> sums_;
  std::vector<std::uint64_t> touched_;
};

Eigen::SparseMatrix<double> assembled(const std::vector<std::vector<std::pair<int, double>>>& columns) {
  const auto size = static_cast<Eigen::Index>(columns.size());
  Eigen::SparseMatrix<double> result(size, size);
  std::size_t entries = 0;
  for (const auto& column : columns) entries += column.size();
  result.reserve(static_cast<Eigen::Index>(entries));
  for (Eigen::Index j = 0; j < size; ++j) {
    result.startVec(j);
    for (const auto& [row, value] : columns[static_cast<std::size_t>(j)]) result.insertBack(row, j) = value;
  }
  result.finalize();
  return result;
}

}  // namespace

void add_parts(std::span<const GramPart> parts, const RunContext& context, Eigen::SparseMatrix<double>& matrix,
               Eigen::VectorXd& side) {
  const auto size = static_cast<std::size_t>(matrix.cols());
  std::vector<std::vector<std::pair<const GramPart*, std::size_t>>> of_column(size);  // in the parts' order
  for (const GramPart& part : parts) {
    for (std::size_t b = 0; b < part.columns.size(); ++b) {
      const auto column = static_cast<std::size_t>(part.columns[b]);
      of_column[column].emplace_back(&part, b);
      side[static_cast<Eigen::Index>(column)] += part.side[static_cast<Eigen::Index>(b)];
    }
  }
  std::vector<std::vector<std::pair<int, double>>> columns(size);
  parallel_for(context, size, [&](std::size_t begin, std::size_t end) {
    ColumnSum sum(size);
    for (std::size_t j = begin; j < end; ++j) {
      sum.add(matrix, j);
      for (const auto& [part, b] : of_column[j]) sum.add(*part, b);
      sum.take(j, columns[j]);
    }
  });
  matrix = assembled(columns);
}

}  // namespace orbifit
