#include "deformation/elimination_fronts.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <Eigen/OrderingMethods>

namespace orbifit {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kMostZeros = 0.15;  // of a front's entries: 0 takes twice as long, 0.5 half as long again
constexpr int kNone = -1;

// A symmetric matrix, its rows and columns in an order of elimination.
struct OrderedMatrix {
  const Sparse& full;
  std::vector<int> row;    // the column'th to be eliminated
  std::vector<int> place;  // of each row in that order

  OrderedMatrix(const Sparse& matrix, std::vector<int> order) : full(matrix), row(std::move(order)), place(row.size()) {
    for (std::size_t k = 0; k < row.size(); ++k) place[static_cast<std::size_t>(row[k])] = static_cast<int>(k);
  }

  // In which rows a column has entries, the diagonal's among them.
  template <typename Visit>
  void for_each_row(int column, const Visit& visit) const {
    for (Sparse::InnerIterator entry(full, row[static_cast<std::size_t>(column)]); entry; ++entry) {
      visit(place[static_cast<std::size_t>(entry.index())]);
    }
  }

  int size() const { return static_cast<int>(row.size()); }
};

std::vector<int> order_of_little_fill(const Sparse& full) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(full, order);
  return {order.indices().begin(), order.indices().end()};
}

// The elimination tree (Liu 1990): of each column the first row in which the factor has an entry below the diagonal.
std::vector<int> elimination_tree(const OrderedMatrix& matrix) {
  std::vector<int> parent(matrix.row.size(), kNone);
  std::vector<int> highest(matrix.row.size(), kNone);  // known of what is above each column, for short ways
  for (int i = 0; i < matrix.size(); ++i) {
    matrix.for_each_row(i, [&](int j) {
      while (j != kNone && j < i) {
        const int next = std::exchange(highest[static_cast<std::size_t>(j)], i);
        if (next == kNone) parent[static_cast<std::size_t>(j)] = i;
        j = next;
      }
    });
  }
  return parent;
}

std::vector<std::vector<int>> children_of(const std::vector<int>& parent) {
  std::vector<std::vector<int>> result(parent.size());
  for (std::size_t j = 0; j < parent.size(); ++j) {
    if (parent[j] != kNone) result[static_cast<std::size_t>(parent[j])].push_back(static_cast<int>(j));
  }
  return result;
}

// The columns in an order in which all that is below one in the tree comes just before it.
std::vector<int> postorder(const std::vector<int>& parent) {
  const std::vector<std::vector<int>> children = children_of(parent);
  std::vector<int> result;
  std::vector<int> open;
  for (std::size_t j = 0; j < parent.size(); ++j) {
    if (parent[j] == kNone) open.push_back(static_cast<int>(j));
  }
  while (!open.empty()) {  // from the last to the first
    const auto j = static_cast<std::size_t>(open.back());
    open.pop_back();
    result.push_back(static_cast<int>(j));
    open.insert(open.end(), children[j].begin(), children[j].end());
  }
  std::ranges::reverse(result);
  return result;
}

// In which rows below its diagonal each column of the factor has entries, one column after the other.
class ColumnRows {
 public:
  ColumnRows(const OrderedMatrix& matrix, const std::vector<int>& parent)
      : matrix_(matrix), children_(children_of(parent)), rows_(parent.size()), seen_(parent.size(), kNone) {}

  // \return in any order; good until that of the column's parent is asked for
  const std::vector<int>& of(int column) {
    std::vector<int>& result = rows_[static_cast<std::size_t>(column)];
    const auto add = [&](int row) {
      if (row > column && std::exchange(seen_[static_cast<std::size_t>(row)], column) != column) result.push_back(row);
    };
    matrix_.for_each_row(column, add);
    for (const int child : children_[static_cast<std::size_t>(column)]) {
      std::vector<int>& below = rows_[static_cast<std::size_t>(child)];
      for (const int row : below) add(row);
      below = {};
    }
    return result;
  }

 private:
  const OrderedMatrix& matrix_;
  std::vector<std::vector<int>> children_, rows_;
  std::vector<int> seen_;  // in which column last
};

// Whether a front may have one more column, with as many rows below it, for so many zeros that it then has.
bool may_grow(const EliminationFront& front, std::size_t rows, double& zeros) {
  const double height = static_cast<double>(rows) + 1;
  const double more = zeros + (height - static_cast<double>(front.rows.size())) * front.width;
  const double width = front.width + 1;
  if (more > kMostZeros * width * (height + width / 2)) return false;
  zeros = more;
  return true;
}

}  // namespace

EliminationFronts elimination_fronts(const Sparse& lower) {
  EliminationFronts result;
  if (lower.cols() == 0) return result;
  const Sparse full = lower.selfadjointView<Eigen::Lower>();
  const std::vector<int> little_fill = order_of_little_fill(full);
  std::vector<int> order;
  for (const int column : postorder(elimination_tree({full, little_fill}))) {
    order.push_back(little_fill[static_cast<std::size_t>(column)]);
  }
  const OrderedMatrix matrix(full, std::move(order));
  result.order.indices() = Eigen::Map<const Eigen::VectorXi>(matrix.place.data(), matrix.size());
  const std::vector<int> parent = elimination_tree(matrix);
  std::vector<int> front_of(matrix.row.size());
  ColumnRows rows(matrix, parent);
  double zeros = 0;
  for (int j = 0; j < matrix.size(); ++j) {
    const std::vector<int>& below = rows.of(j);
    const bool follows = j > 0 && parent[static_cast<std::size_t>(j) - 1] == j;
    if (!follows || !may_grow(result.fronts.back(), below.size(), zeros)) {
      result.fronts.push_back({j, 0, {}, {}});
      zeros = 0;
    }
    ++result.fronts.back().width;
    result.fronts.back().rows = below;
    front_of[static_cast<std::size_t>(j)] = static_cast<int>(result.fronts.size()) - 1;
  }
  for (std::size_t f = 0; f < result.fronts.size(); ++f) {
    std::vector<int>& below = result.fronts[f].rows;
    if (below.empty()) continue;
    std::ranges::sort(below);
    const int above = front_of[static_cast<std::size_t>(below.front())];
    result.fronts[static_cast<std::size_t>(above)].children.push_back(static_cast<int>(f));
  }
  return result;
}

}  // namespace orbifit
