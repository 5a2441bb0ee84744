#pragma once

#include <cstddef>
#include <cstdint>

namespace orbifit {

/// The innermost loops of the lift and of the solver, on plain arrays. They are compiled twice, for any processor of
/// the architecture and for those with registers of four doubles; kernels() chooses once, when the program starts.
struct Kernels {
  /// For blocks begin ... end - 1 of eight rows each: the rows' sums over the block's entries e of
  /// weight[8 e + lane] * atoms[4 atom[e] ...], written to result[4 (8 block + lane) ...], the fourth left alone.
  /// \param first of each block's entries
  /// \param atoms four doubles each, the last unused
  void (*blocked_sums)(const std::int64_t* first, const std::int32_t* atom, const float* weight, const double* atoms,
                       std::size_t begin, std::size_t end, double* result);

  /// For i in begin ... end - 1: result[3 i ...] = M source + shift, where follower[3 i] is the source's number and
  /// follower[3 i + 1] that of the copier: 16 doubles, the columns of M and the shift, four each.
  /// \param sources four doubles each, the last unused
  void (*carried_copies)(const int* follower, const double* sources, const double* copiers, std::size_t begin,
                         std::size_t end, double* result);

  /// sum[0 ... 11] = sum over e < count of q[column[e]] * blocks[12 e ...].
  void (*gather_blocks)(const double* blocks, const int* column, int count, const double* q, double* sum);

  /// For e < count, with v the row of four at rows + 4 end[e] and d the one at edges + 4 e, whose fourths are 0: the
  /// sum of v d^T, column-major, its columns four apart: sum[0 ... 11].
  void (*edge_products)(const double* edges, const int* end, int count, const double* rows, double* sum);

  /// Likewise, with M at matrices + 12 end[e], column-major, its columns four apart: sum[0 ... 3] = the sum of M d.
  void (*turned_edges)(const double* edges, const int* end, int count, const double* matrices, double* sum);

  /// Likewise, the sum of |d + row - v - (matrix d + M d) / 2|^2.
  double (*edge_residuals)(const double* edges, const int* end, int count, const double* matrices, const double* rows,
                           const double* matrix, const double* row);

  /// The lower half of A^T A, column-major and `columns` apart, and entries above it: A has `count` rows, row-major.
  /// \param columns  a multiple of four
  void (*gram)(const double* rows, int count, std::ptrdiff_t columns, double* result);

  /// Newton's method for the rotations nearest to four matrices, as nearest_rotation() takes it: entry k of the
  /// column-major matrix of lane l is at [4 k + l]. `rotations` holds where to start and then the results.
  /// \return bit l set: lane l has got no maximum that way; its rotation is to be found by other means
  unsigned (*nearest_rotations)(const double* matrices, double* rotations);

  /// Solves L L^T x = b in place; L lower triangular, column-major.
  void (*cholesky_solve)(const double* lower, std::ptrdiff_t size, double* x);
};

const Kernels& kernels();

extern const Kernels kPlainKernels;
extern const Kernels kWideKernels;  ///< only where ORBIFIT_WIDE_KERNELS is defined

}  // namespace orbifit
