// The bodies of the kernels, compiled by kernels_plain.cpp and kernels_wide.cpp. No headers of the standard library:
// their inline functions, compiled for wide registers, could end up in the program where plain ones belong.

namespace {

using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
using FourFloats = float __attribute__((vector_size(16), aligned(4), may_alias));

void blocked_sums(const std::int64_t* first, const std::uint16_t* atom, const float* weight, const double* atoms,
                  std::size_t begin, std::size_t end, double* result) {
  for (std::size_t block = begin; block < end; ++block) {
    Four x[2] = {};
    Four y[2] = {};
    Four z[2] = {};
    for (std::int64_t e = first[block]; e < first[block + 1]; ++e) {
      const double* at = atoms + std::size_t{4} * atom[e];
      const Four low = __builtin_convertvector(*reinterpret_cast<const FourFloats*>(weight + 8 * e), Four);
      const Four high = __builtin_convertvector(*reinterpret_cast<const FourFloats*>(weight + 8 * e + 4), Four);
      x[0] += at[0] * low;
      x[1] += at[0] * high;
      y[0] += at[1] * low;
      y[1] += at[1] * high;
      z[0] += at[2] * low;
      z[1] += at[2] * high;
    }
    double* to = result + 32 * block;
    for (int half = 0; half < 2; ++half) {
      for (int lane = 0; lane < 4; ++lane, to += 4) {
        to[0] = x[half][lane];
        to[1] = y[half][lane];
        to[2] = z[half][lane];
      }
    }
  }
}

void carried_copies(const int* follower, const double* sources, const double* copiers, std::size_t begin,
                    std::size_t end, double* result) {
  if (begin >= end) return;
  const auto copy = [&](std::size_t i, double* to) {
    const double* source = sources + 4 * static_cast<std::size_t>(follower[3 * i]);
    const auto* copier = reinterpret_cast<const Four*>(copiers + 16 * static_cast<std::size_t>(follower[3 * i + 1]));
    *reinterpret_cast<Four*>(to) = source[0] * copier[0] + source[1] * copier[1] + (source[2] * copier[2] + copier[3]);
  };
  // A vector of four spills into the next row, which is written after; not so the last.
  for (std::size_t i = begin; i + 1 < end; ++i) copy(i, result + 3 * i);
  double last[4];
  copy(end - 1, last);
  for (std::size_t c = 0; c < 3; ++c) result[3 * (end - 1) + c] = last[c];
}

void gather_blocks(const double* blocks, const int* column, int count, const double* q, double* sum) {
  Four a{};
  Four b{};
  Four c{};
  for (int e = 0; e < count; ++e, blocks += 12) {
    const double factor = q[column[e]];
    a += factor * *reinterpret_cast<const Four*>(blocks);
    b += factor * *reinterpret_cast<const Four*>(blocks + 4);
    c += factor * *reinterpret_cast<const Four*>(blocks + 8);
  }
  *reinterpret_cast<Four*>(sum) = a;
  *reinterpret_cast<Four*>(sum + 4) = b;
  *reinterpret_cast<Four*>(sum + 8) = c;
}

void cholesky_solve(const double* lower, std::ptrdiff_t size, double* x) {
  // Forwards two columns at a time, backwards by dots.
  std::ptrdiff_t j = 0;
  for (; j + 1 < size; j += 2) {
    const double* one = lower + j * size;
    const double* two = one + size;
    const double at = x[j] /= one[j];
    const double next = x[j + 1] = (x[j + 1] - at * one[j + 1]) / two[j + 1];
    std::ptrdiff_t i = j + 2;
    for (; i + 3 < size; i += 4) {
      *reinterpret_cast<Four*>(x + i) -=
          at * *reinterpret_cast<const Four*>(one + i) + next * *reinterpret_cast<const Four*>(two + i);
    }
    for (; i < size; ++i) x[i] -= at * one[i] + next * two[i];
  }
  if (j < size) x[j] /= lower[j * size + j];
  for (j = size - 1; j >= 0; --j) {
    const double* column = lower + j * size;
    Four sum{};
    Four more{};
    std::ptrdiff_t i = j + 1;
    for (; i + 7 < size; i += 8) {
      sum += *reinterpret_cast<const Four*>(column + i) * *reinterpret_cast<const Four*>(x + i);
      more += *reinterpret_cast<const Four*>(column + i + 4) * *reinterpret_cast<const Four*>(x + i + 4);
    }
    sum += more;
    double rest = sum[0] + sum[1] + sum[2] + sum[3];
    for (; i < size; ++i) rest += column[i] * x[i];
    x[j] = (x[j] - rest) / column[j];
  }
}

}  // namespace
