#include "basis/gram.h"

#include "kernels/kernels.h"

namespace orbifit {

void lower_gram(const RowMajorMatrix& rows, Eigen::MatrixXd& result) {
  result.resize(rows.cols(), rows.cols());
  if (rows.rows() == 0) {  // whose data is null
    result.setZero();
    return;
  }
  kernels().gram(rows.data(), static_cast<int>(rows.rows()), rows.cols(), result.data());
}

}  // namespace orbifit
