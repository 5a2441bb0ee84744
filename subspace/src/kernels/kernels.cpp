#include "kernels/kernels.h"

namespace orbifit {

const Kernels& kernels() {
#ifdef ORBIFIT_WIDE_KERNELS
  static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return wide ? kWideKernels : kPlainKernels;
#else
  return kPlainKernels;
#endif
}

}  // namespace orbifit
