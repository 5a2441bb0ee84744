#include "lift_kernel.h"

namespace orbifit {

namespace {

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

}  // namespace

std::vector<double> padded_by_four(const Eigen::VectorXd& stacked) {
  const auto count = static_cast<std::size_t>(stacked.size() / 3);
  std::vector<double> padded(4 * count, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t c = 0; c < 3; ++c) padded[4 * k + c] = stacked[static_cast<Eigen::Index>(3 * k + c)];
  }
  return padded;
}

// One clone for processors with wide registers, chosen when the program starts.
__attribute__((target_clones("arch=haswell", "default"))) void weighted_sums(const OrbitLift& lift,
                                                                             const std::vector<double>& atoms,
                                                                             std::size_t begin, std::size_t end,
                                                                             double* result) {
  const auto* rows = reinterpret_cast<const Four*>(atoms.data());
  const float* weight = lift.weight.data();
  const std::uint16_t* atom = lift.atom.data();
  for (std::size_t r = begin; r < end; ++r) {
    Four even{};
    Four odd{};
    std::int64_t e = lift.first[r];
    const std::int64_t last = lift.first[r + 1];
    for (; e + 1 < last; e += 2) {
      even += double{weight[e]} * rows[atom[e]];
      odd += double{weight[e + 1]} * rows[atom[e + 1]];
    }
    if (e < last) even += double{weight[e]} * rows[atom[e]];
    const Four sum = even + odd;
    for (int c = 0; c < 3; ++c) result[3 * r + static_cast<std::size_t>(c)] = sum[c];
  }
}

}  // namespace orbifit
