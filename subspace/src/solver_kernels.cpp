#include "solver_kernels.h"

namespace orbifit {

namespace {

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

}  // namespace

// Each kernel has a clone for processors with wide registers, chosen when the program starts.
__attribute__((target_clones("arch=haswell", "default"))) void gather_blocks(const double* blocks, const int* column,
                                                                             int count, const double* q, double* sum) {
  const auto* rows = reinterpret_cast<const Four*>(blocks);
  Four a{};
  Four b{};
  Four c{};
  for (int e = 0; e < count; ++e, rows += 3) {
    const double factor = q[column[e]];
    a += factor * rows[0];
    b += factor * rows[1];
    c += factor * rows[2];
  }
  auto* result = reinterpret_cast<Four*>(sum);
  result[0] = a;
  result[1] = b;
  result[2] = c;
}

__attribute__((target_clones("arch=haswell", "default"))) void cholesky_solve(const Eigen::MatrixXd& lower,
                                                                              Eigen::VectorXd& x) {
  const auto size = lower.rows();
  const double* matrix = lower.data();
  double* value = x.data();
  for (Eigen::Index j = 0; j < size; ++j) {
    const double* column = matrix + j * size;
    const double at = value[j] /= column[j];
    Eigen::Index i = j + 1;
    for (; i + 3 < size; i += 4) {
      *reinterpret_cast<Four*>(value + i) -= at * *reinterpret_cast<const Four*>(column + i);
    }
    for (; i < size; ++i) value[i] -= at * column[i];
  }
  for (Eigen::Index j = size - 1; j >= 0; --j) {
    const double* column = matrix + j * size;
    Four sum{};
    Four more{};
    Eigen::Index i = j + 1;
    for (; i + 7 < size; i += 8) {
      sum += *reinterpret_cast<const Four*>(column + i) * *reinterpret_cast<const Four*>(value + i);
      more += *reinterpret_cast<const Four*>(column + i + 4) * *reinterpret_cast<const Four*>(value + i + 4);
    }
    sum += more;
    double rest = sum[0] + sum[1] + sum[2] + sum[3];
    for (; i < size; ++i) rest += column[i] * value[i];
    value[j] = (value[j] - rest) / column[j];
  }
}

}  // namespace orbifit
