// The bodies of the kernels, compiled by kernels_plain.cpp and kernels_wide.cpp. No headers of the standard library:
// their inline functions, compiled for wide registers, could end up in the program where plain ones belong.

namespace {

// A smaller alignment than the type's own is to Clang one of the name alone, and to GCC one of the type, lest it be lost
// where the type is deduced; Clang loses it there, so no `auto` for pointers to these.
#ifdef __clang__
using Four __attribute__((vector_size(32), aligned(8), may_alias)) = double;
using FourFloats __attribute__((vector_size(16), aligned(4), may_alias)) = float;
#else
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
using FourFloats = float __attribute__((vector_size(16), aligned(4), may_alias));
#endif

void blocked_sums(const std::int64_t* first, const std::int32_t* atom, const float* weight, const double* atoms,
                  std::size_t begin, std::size_t end, double* result) {
  for (std::size_t block = begin; block < end; ++block) {
    Four x[2] = {};
    Four y[2] = {};
    Four z[2] = {};
    for (std::int64_t e = first[block]; e < first[block + 1]; ++e) {
      const double* at = atoms + std::ptrdiff_t{4} * atom[e];
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
    const Four* copier = reinterpret_cast<const Four*>(copiers + 16 * static_cast<std::size_t>(follower[3 * i + 1]));
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

void edge_products(const double* edges, const int* end, int count, const double* rows, double* sum) {
  Four a{};
  Four b{};
  Four c{};
  for (int e = 0; e < count; ++e, edges += 4) {
    const Four row = *reinterpret_cast<const Four*>(rows + std::ptrdiff_t{4} * end[e]);
    a += edges[0] * row;
    b += edges[1] * row;
    c += edges[2] * row;
  }
  *reinterpret_cast<Four*>(sum) = a;
  *reinterpret_cast<Four*>(sum + 4) = b;
  *reinterpret_cast<Four*>(sum + 8) = c;
}

void turned_edges(const double* edges, const int* end, int count, const double* matrices, double* sum) {
  Four a{};
  Four b{};
  Four c{};
  for (int e = 0; e < count; ++e, edges += 4) {
    const Four* matrix = reinterpret_cast<const Four*>(matrices + std::ptrdiff_t{12} * end[e]);
    a += edges[0] * matrix[0];
    b += edges[1] * matrix[1];
    c += edges[2] * matrix[2];
  }
  *reinterpret_cast<Four*>(sum) = a + b + c;
}

double edge_residuals(const double* edges, const int* end, int count, const double* matrices, const double* rows,
                      const double* matrix, const double* row) {
  const Four* here = reinterpret_cast<const Four*>(matrix);
  const Four own = *reinterpret_cast<const Four*>(row);
  Four sum{};
  for (int e = 0; e < count; ++e, edges += 4) {
    const Four* there = reinterpret_cast<const Four*>(matrices + std::ptrdiff_t{12} * end[e]);
    const Four turned =
        edges[0] * (here[0] + there[0]) + edges[1] * (here[1] + there[1]) + edges[2] * (here[2] + there[2]);
    const Four now = *reinterpret_cast<const Four*>(edges) +
                     (own - *reinterpret_cast<const Four*>(rows + std::ptrdiff_t{4} * end[e]));
    const Four residual = now - 0.5 * turned;
    sum += residual * residual;
  }
  return sum[0] + sum[1] + sum[2];
}

// kFours times four rows of the product from row a on, in the four columns from b on. Unrolled, its sums stay in
// registers.
template <int kFours>
void gram_block(const double* rows, int count, std::ptrdiff_t columns, std::ptrdiff_t a, std::ptrdiff_t b,
                double* result) {
  Four sum[4][kFours] = {};
  const double* left = rows + a;
  const double* right = rows + b;
  for (int r = 0; r < count; ++r, left += columns, right += columns) {
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
#pragma GCC unroll 3
      for (int f = 0; f < kFours; ++f) sum[k][f] += right[k] * *reinterpret_cast<const Four*>(left + 4 * f);
    }
  }
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
#pragma GCC unroll 3
    for (int f = 0; f < kFours; ++f) *reinterpret_cast<Four*>(result + (b + k) * columns + a + 4 * f) = sum[k][f];
  }
}

void gram(const double* rows, int count, std::ptrdiff_t columns, double* result) {
  for (std::ptrdiff_t b = 0; b < columns; b += 4) {
    std::ptrdiff_t a = b;
    for (; a + 12 <= columns; a += 12) gram_block<3>(rows, count, columns, a, b, result);
    if (a + 8 <= columns) {
      gram_block<2>(rows, count, columns, a, b, result);
    } else if (a + 4 <= columns) {
      gram_block<1>(rows, count, columns, a, b, result);
    }
  }
}

using FourMasks = long long __attribute__((vector_size(32)));  // what comparing Fours gives

unsigned nearest_rotations(const double* matrices, double* rotations) {
  constexpr int kMaxSteps = 12;
  constexpr double kDone = 1e-16;  // squared half angle after which the next step would be below rounding
  const Four one = {1, 1, 1, 1};
  const Four zero{};
  Four c[9];
  Four r[9];
  for (int k = 0; k < 9; ++k) {
    c[k] = *reinterpret_cast<const Four*>(matrices + 4 * k);
    r[k] = *reinterpret_cast<const Four*>(rotations + 4 * k);
  }
  FourMasks failed{};
  FourMasks done{};
  for (int step = 0; step < kMaxSteps; ++step) {
    // With R exp[w]: tr = const + w . a - w^T H w / 2; H positive definite at a critical point makes it the maximum.
    Four m[9];
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        m[3 * j + i] = r[3 * i] * c[3 * j] + r[3 * i + 1] * c[3 * j + 1] + r[3 * i + 2] * c[3 * j + 2];
      }
    }
    const Four a0 = m[5] - m[7];
    const Four a1 = m[6] - m[2];
    const Four a2 = m[1] - m[3];
    const Four h00 = m[4] + m[8];
    const Four h11 = m[0] + m[8];
    const Four h22 = m[0] + m[4];
    const Four h01 = -0.5 * (m[3] + m[1]);
    const Four h02 = -0.5 * (m[6] + m[2]);
    const Four h12 = -0.5 * (m[7] + m[5]);
    const Four c00 = h11 * h22 - h12 * h12;
    const Four c01 = h02 * h12 - h01 * h22;
    const Four c02 = h01 * h12 - h02 * h11;
    const Four c11 = h00 * h22 - h02 * h02;
    const Four c12 = h01 * h02 - h00 * h12;
    const Four c22 = h00 * h11 - h01 * h01;
    const Four determinant = h00 * c00 + h01 * c01 + h02 * c02;
    const FourMasks fine = (h00 > zero) & (c22 > zero) & (determinant > zero);
    failed |= ~fine & ~done;
    const FourMasks moving = ~failed & ~done;
    // Half the step, for Cayley's form of a rotation.
    const Four scale = moving ? 0.5 / (fine ? determinant : one) : zero;
    const Four w0 = (c00 * a0 + c01 * a1 + c02 * a2) * scale;
    const Four w1 = (c01 * a0 + c11 * a1 + c12 * a2) * scale;
    const Four w2 = (c02 * a0 + c12 * a1 + c22 * a2) * scale;
    const Four squared = w0 * w0 + w1 * w1 + w2 * w2;
    const Four f = 2 / (1 + squared);
    const Four t[9] = {1 - f * (w1 * w1 + w2 * w2), f * (w0 * w1 + w2),          f * (w0 * w2 - w1),
                       f * (w0 * w1 - w2),          1 - f * (w0 * w0 + w2 * w2), f * (w1 * w2 + w0),
                       f * (w0 * w2 + w1),          f * (w1 * w2 - w0),          1 - f * (w0 * w0 + w1 * w1)};
    for (int i = 0; i < 3; ++i) {
      const Four row[3] = {r[i], r[3 + i], r[6 + i]};
      for (int j = 0; j < 3; ++j) {
        const Four turned = row[0] * t[3 * j] + row[1] * t[3 * j + 1] + row[2] * t[3 * j + 2];
        r[3 * j + i] = moving ? turned : row[j];
      }
    }
    done |= moving & (squared < kDone);
    const FourMasks over = done | failed;
    if (over[0] && over[1] && over[2] && over[3]) break;
  }
  for (int k = 0; k < 9; ++k) *reinterpret_cast<Four*>(rotations + 4 * k) = r[k];
  unsigned result = 0;
  for (int lane = 0; lane < 4; ++lane) result |= done[lane] ? 0U : 1U << static_cast<unsigned>(lane);
  return result;
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
