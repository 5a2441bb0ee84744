#include "deformation/symmetric_factor.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include "kernels/kernels.h"

namespace orbifit {

namespace {

// What an entry of a sparse factor costs in a solve, in entries of a dense one, which come in order: measured on
// Laplace matrices of 200 to 2000 unknowns.
constexpr double kSparseCost = 4;

}  // namespace

class SymmetricFactor::Sparse : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> {
 public:
  double entries() const { return static_cast<double>(m_matrix.nonZeros()); }  // known once its pattern is analysed
  bool is_positive() const { return info() == Eigen::Success && m_diag.minCoeff() > 0; }
};

SymmetricFactor::SymmetricFactor() = default;
SymmetricFactor::~SymmetricFactor() = default;
SymmetricFactor::SymmetricFactor(SymmetricFactor&&) noexcept = default;
SymmetricFactor& SymmetricFactor::operator=(SymmetricFactor&&) noexcept = default;

bool SymmetricFactor::factorise(const Eigen::SparseMatrix<double>& lower) {
  const auto size = static_cast<double>(lower.rows());
  const double dense_entries = size * (size + 1) / 2;
  sparse_.reset();
  dense_.resize(0, 0);
  if (kSparseCost * static_cast<double>(lower.nonZeros()) < dense_entries) {
    auto sparse = std::make_unique<Sparse>();
    sparse->analyzePattern(lower);
    if (kSparseCost * sparse->entries() < dense_entries) {
      sparse->factorize(lower);
      if (!sparse->is_positive()) return false;
      sparse_ = std::move(sparse);
      return true;
    }
  }
  dense_ = lower;
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(dense_).info() == Eigen::Success;
}

void SymmetricFactor::solve(Eigen::VectorXd& side) const {
  if (sparse_) {
    side = sparse_->solve(side);
  } else {
    kernels().cholesky_solve(dense_.data(), dense_.rows(), side.data());
  }
}

}  // namespace orbifit
