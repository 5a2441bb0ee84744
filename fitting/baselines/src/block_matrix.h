#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace orbifit {

/// A symmetric sparse matrix of 3 by 3 blocks whose pattern stays while its values change: the pattern is analysed
/// once. Only the lower half is kept.
class BlockMatrix {
 public:
  /// \param pattern  blocks by blocks, its values do not matter; both halves
  explicit BlockMatrix(const Eigen::SparseMatrix<double>& pattern);
  ~BlockMatrix();
  BlockMatrix(BlockMatrix&&) noexcept;

  using Blocks = std::vector<Eigen::Matrix3d>;

  /// All blocks, in an order of this matrix: may be kept and set again.
  const Blocks& blocks() const { return blocks_; }
  void set_blocks(const Blocks& blocks) { blocks_ = blocks; }
  /// \pre row >= column and the pattern has it
  const Eigen::Matrix3d& block(int row, int column) const { return blocks_[place(row, column)]; }
  void set_zero() { blocks_.assign(blocks_.size(), Eigen::Matrix3d::Zero()); }

  /// Adds to block (row, column), and so to its mirror image. \pre the pattern has it; row = column: symmetric
  void add(int row, int column, const Eigen::Matrix3d& block);

  /// Adds scalars (x) factor to the lower half: block (i, j) gains scalars_ij * factor for i >= j.
  /// \param scalars  blocks by blocks, within the pattern; where `both`, the transposed product as well
  void add_product(const Eigen::SparseMatrix<double>& scalars, const Eigen::Matrix3d& factor, bool both);

  /// Cholesky's factor of the values as they are (CHOLMOD, supernodal). \return whether it is positive definite
  bool factorise();

  /// \pre factorise() was true
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

  /// condition_estimate(). \pre factorise() was true
  double condition() const;

 private:
  struct Solver;
  std::size_t place(int row, int column) const;
  void fill();

  std::vector<int> first_;  // of each block column, and the number of blocks at the end
  std::vector<int> rows_;   // ascending in each column, the diagonal first
  Blocks blocks_;
  Eigen::SparseMatrix<double> scalars_;  // lower half
  std::unique_ptr<Solver> solver_;
};

}  // namespace orbifit
