#include "kernels/kernels.h"
#include "kernels/kernels_body.h"

namespace orbifit {

const Kernels kWideKernels{blocked_sums,   carried_copies, gather_blocks,     edge_products, turned_edges,
                           edge_residuals, gram,           nearest_rotations, cholesky_solve};

}  // namespace orbifit
