#include "deformation/symmetric_factor.h"

#include <Eigen/Cholesky>

#include "deformation/supernodal_factor.h"
#include "kernels/kernels.h"

namespace orbifit {

namespace {

constexpr double kFull = 0.25;  // of the entries: where so many are not zero, nearly all of the factor's are not

}  // namespace

SymmetricFactor::SymmetricFactor() = default;
SymmetricFactor::~SymmetricFactor() = default;
SymmetricFactor::SymmetricFactor(SymmetricFactor&&) noexcept = default;
SymmetricFactor& SymmetricFactor::operator=(SymmetricFactor&&) noexcept = default;

bool SymmetricFactor::factorise(const Eigen::SparseMatrix<double>& lower) {
  const auto size = static_cast<double>(lower.rows());
  const double dense_entries = size * (size + 1) / 2;
  sparse_.reset();
  dense_.resize(0, 0);
  if (static_cast<double>(lower.nonZeros()) < kFull * dense_entries) {
    auto sparse = std::make_unique<SupernodalFactor>();
    sparse->analyse(lower);
    if (sparse->entries() < dense_entries) {
      if (!sparse->factorise(lower)) return false;
      sparse_ = std::move(sparse);
      return true;
    }
  }
  dense_ = lower;
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(dense_).info() == Eigen::Success;
}

void SymmetricFactor::solve(Eigen::VectorXd& side) const {
  if (sparse_) {
    sparse_->solve(side);
  } else {
    kernels().cholesky_solve(dense_.data(), dense_.rows(), side.data());
  }
}

}  // namespace orbifit
