#include "basis/symmetric_basis.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "base/dense.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Directions whose squared singular value is below this, relative to matrices of orthogonal entries, are free.
constexpr double kRank = 1e-7;
// What is left of a row of such entries by rounding alone.
constexpr double kRowRounding = 1e-11;

// The constraints of one orbit on its seed and on the carriers that they name: C_s s + C_t t + c = 0.
struct Constraints {
  std::vector<int> carriers;
  MatrixXd seeds;     // rows by 3
  MatrixXd carried;   // rows by 3 * named carriers
  VectorXd constant;  // rows
};

struct SeedSpace {
  MatrixXd free;  // Z, 3 by 0..3, orthonormal: seeds' displacements that the stabiliser keeps
  Matrix3d kept;  // Z Z^T
  std::vector<int> carriers;
  MatrixXd bound;                      // -C_s^+ C_t, 3 by 3 * named carriers
  Vector3d offset = Vector3d::Zero();  // -C_s^+ c
};

// Where a word takes a point, less where it takes it at rest.
Vector3d moved_by(const Transport& now, const Transport& rest, const Vector3d& position) {
  return (now.frame - rest.frame) * position + now.shift - rest.shift;
}

Constraints constraints_of(const std::vector<WordPair>& pairs, const CarriedTransports& transports,
                           const Vector3d& position) {
  Constraints result;
  const std::vector<Transport>& words = transports.words;
  const auto rows = 3 * static_cast<Eigen::Index>(pairs.size());
  result.seeds.resize(rows, 3);
  result.constant.resize(rows);
  std::vector<Carried> carried;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Transport& left = words[static_cast<std::size_t>(pairs[i].left)];
    const Transport& right = words[static_cast<std::size_t>(pairs[i].right)];
    const auto row = 3 * static_cast<Eigen::Index>(i);
    result.seeds.middleRows<3>(row) = left.frame - right.frame;
    result.constant.segment<3>(row).setZero();
    if (transports.turned()) {
      result.constant.segment<3>(row) =
          moved_by(left, transports.rest_words[static_cast<std::size_t>(pairs[i].left)], position) -
          moved_by(right, transports.rest_words[static_cast<std::size_t>(pairs[i].right)], position);
    }
    carried.push_back(carried_sum(left.carried, -Matrix3d::Identity(), right.carried));
    for (const auto& [carrier, matrix] : carried.back()) result.carriers.push_back(carrier);
  }
  std::ranges::sort(result.carriers);
  result.carriers.erase(std::unique(result.carriers.begin(), result.carriers.end()), result.carriers.end());
  result.carried = MatrixXd::Zero(rows, 3 * static_cast<Eigen::Index>(result.carriers.size()));
  for (std::size_t i = 0; i < carried.size(); ++i) {
    for (const auto& [carrier, matrix] : carried[i]) {
      const auto place = std::ranges::lower_bound(result.carriers, carrier) - result.carriers.begin();
      result.carried.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * place) = matrix;
    }
  }
  return result;
}

SeedSpace solve_seed(const Constraints& constraints) {
  SeedSpace space;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(Matrix3d(constraints.seeds.transpose() * constraints.seeds));
  Eigen::Index free = 0;
  while (free < 3 && solver.eigenvalues()[free] < kRank) ++free;
  space.free = solver.eigenvectors().leftCols(free);
  space.kept = space.free * space.free.transpose();
  Matrix3d inverse = Matrix3d::Zero();
  for (Eigen::Index k = free; k < 3; ++k) {
    inverse += solver.eigenvectors().col(k) * solver.eigenvectors().col(k).transpose() / solver.eigenvalues()[k];
  }
  const MatrixXd pseudo_inverse = inverse * constraints.seeds.transpose();
  space.carriers = constraints.carriers;
  space.bound = -pseudo_inverse * constraints.carried;
  space.offset = -pseudo_inverse * constraints.constant;
  return space;
}

// The constraints on carriers alone.
class CarrierSystem {
 public:
  // \param turned  whether groups have turned: else nothing asks the carriers to be elsewhere
  CarrierSystem(int carriers, bool turned)
      : turned_(turned), gram_(MatrixXd::Zero(3 * carriers, 3 * carriers)), side_(VectorXd::Zero(3 * carriers)) {}

  // \param known  whether rows of the same pairs of words were added before: then only their constants are new
  void add(const Constraints& constraints, const SeedSpace& space, bool known) {
    const MatrixXd pure = constraints.carried + constraints.seeds * space.bound;
    const VectorXd constant = constraints.constant + constraints.seeds * space.offset;
    if (constant.size() > 0 && constant.cwiseAbs().maxCoeff() > 0)
      rows_.push_back({constraints.carriers, pure, constant});
    if (pure.size() == 0 || pure.cwiseAbs().maxCoeff() < kRowRounding) return;
    if (!known) add_rows(constraints.carriers, few_rows(pure));
    if (!turned_) return;
    const MatrixXd gram = pure.transpose() * pure;
    const VectorXd side = pure.transpose() * constant;
    for (std::size_t i = 0; i < constraints.carriers.size(); ++i) {
      side_.segment<3>(3 * constraints.carriers[i]) += side.segment<3>(3 * static_cast<Eigen::Index>(i));
      for (std::size_t j = 0; j < constraints.carriers.size(); ++j) {
        gram_.block<3, 3>(3 * constraints.carriers[i], 3 * constraints.carriers[j]) +=
            gram.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j));
      }
    }
  }

  // Columns that span the carriers' free directions, few entries each. Of the rows themselves: of their squares, axes
  // that are off each other by little would seem free.
  MatrixXd free() {
    const Eigen::Index size = gram_.cols();
    if (size == 0) return MatrixXd::Zero(0, 0);
    compress();
    if (used_ == 0) return MatrixXd::Identity(size, size);
    Eigen::FullPivLU<MatrixXd> lu(stacked_.topRows(used_));
    lu.setThreshold(kRowRounding);
    if (lu.rank() == 0) return MatrixXd::Identity(size, size);
    if (lu.rank() == size) return MatrixXd::Zero(size, 0);
    MatrixXd kernel = lu.kernel();
    // Elimination leaves rounding's crumbs where zeros belong.
    kernel = kernel.unaryExpr([](double entry) { return std::abs(entry) < 1e-13 ? 0.0 : entry; });
    return kernel;
  }

  VectorXd particular() const {
    if (gram_.size() == 0 || side_.cwiseAbs().maxCoeff() == 0) return VectorXd::Zero(side_.size());
    return -shortest_solution(gram_, side_, kRank);
  }

  // The largest constant that the carriers leave unmet.
  double conflict(const VectorXd& carriers) const {
    double result = 0;
    for (const Row& row : rows_) {
      VectorXd missed = row.constant;
      for (std::size_t i = 0; i < row.carriers.size(); ++i) {
        missed += row.pure.middleCols<3>(3 * static_cast<Eigen::Index>(i)) * carriers.segment<3>(3 * row.carriers[i]);
      }
      result = std::max(result, missed.cwiseAbs().maxCoeff());
    }
    return result;
  }

 private:
  struct Row {
    std::vector<int> carriers;
    MatrixXd pure;
    VectorXd constant;
  };

  void add_rows(const std::vector<int>& carriers, const MatrixXd& rows) {
    const Eigen::Index size = gram_.cols();
    if (stacked_.rows() < 2 * size + rows.rows()) stacked_.conservativeResize(2 * size + rows.rows(), size);
    if (used_ + rows.rows() > stacked_.rows()) compress();
    stacked_.middleRows(used_, rows.rows()).setZero();
    for (std::size_t i = 0; i < carriers.size(); ++i) {
      stacked_.block(used_, 3 * carriers[i], rows.rows(), 3) = rows.middleCols<3>(3 * static_cast<Eigen::Index>(i));
    }
    used_ += rows.rows();
  }

  // At most as many rows as columns, with the same squares; rounding stays that of the largest.
  static MatrixXd few_rows(const MatrixXd& rows) {
    if (rows.rows() <= rows.cols()) return rows;
    const Eigen::HouseholderQR<MatrixXd> qr(rows);
    return qr.matrixQR().topRows(rows.cols()).triangularView<Eigen::Upper>();
  }

  void compress() {
    const Eigen::Index size = gram_.cols();
    if (used_ <= size) return;
    stacked_.topRows(size) = few_rows(stacked_.topRows(used_));
    used_ = size;
  }

  bool turned_;
  MatrixXd stacked_;       // rows of all constraints
  Eigen::Index used_ = 0;  // of these
  MatrixXd gram_;
  VectorXd side_;
  std::vector<Row> rows_;  // those with a constant
};

// A largest set of columns that move the samples independently of one another (pivoted Cholesky of E^T E).
std::vector<Eigen::Index> independent(const Eigen::SparseMatrix<double>& effect) {
  MatrixXd gram(effect.transpose() * effect);
  std::vector<Eigen::Index> chosen;
  const double scale = std::max(1.0, gram.size() > 0 ? gram.diagonal().maxCoeff() : 1.0);
  for (Eigen::Index step = 0; step < gram.cols(); ++step) {
    Eigen::Index pivot = 0;
    const double largest = gram.diagonal().maxCoeff(&pivot);
    if (largest < kRank * scale) break;
    chosen.push_back(pivot);
    const VectorXd column = gram.col(pivot) / std::sqrt(largest);
    gram -= column * column.transpose();
    gram.row(pivot).setZero();
    gram.col(pivot).setZero();
  }
  std::ranges::sort(chosen);
  return chosen;
}

// Of each orbit the pairs of words that must take its seed to one place, each pair once.
std::vector<std::vector<WordPair>> word_pairs(const SymmetricSampling& sampling) {
  std::vector<std::vector<WordPair>> pairs(static_cast<std::size_t>(sampling.orbits()));
  for (const auto& [orbit, left, right] : sampling.constraints) {
    pairs[static_cast<std::size_t>(orbit)].push_back({left, right});
  }
  for (std::vector<WordPair>& each : pairs) {
    std::ranges::sort(each);
    each.erase(std::unique(each.begin(), each.end()), each.end());
  }
  return pairs;
}

// What each orbit leaves free of its seed. What orbits and points elsewhere ask of carriers goes to the system.
std::vector<SeedSpace> seed_spaces(const SymmetricSampling& sampling, const CarriedTransports& transports,
                                   const std::vector<BoundPoint>& elsewhere, CarrierSystem& system) {
  const std::vector<std::vector<WordPair>> pairs = word_pairs(sampling);
  std::set<std::vector<WordPair>> known;
  std::vector<SeedSpace> seeds(pairs.size());
  for (std::size_t orbit = 0; orbit < pairs.size(); ++orbit) {
    const Vector3d position = sampling.points.row(sampling.first_sample[orbit]).transpose();
    const Constraints constraints = constraints_of(pairs[orbit], transports, position);
    seeds[orbit] = solve_seed(constraints);
    system.add(constraints, seeds[orbit], !known.insert(pairs[orbit]).second);
  }
  for (const BoundPoint& point : elsewhere) {
    const Constraints constraints = constraints_of(point.words, transports, point.position);
    system.add(constraints, solve_seed(constraints), !known.insert(point.words).second);
  }
  return seeds;
}

// A block's entries above a size.
void add_entries(const MatrixXd& block, Eigen::Index row, Eigen::Index column, double size,
                 std::vector<Eigen::Triplet<double>>& entries) {
  for (Eigen::Index j = 0; j < block.cols(); ++j) {
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      if (std::abs(block(i, j)) > size) entries.emplace_back(row + i, column + j, block(i, j));
    }
  }
}

// What the carriers do to a sample: B_k + O_k bound. \return of their allowed directions, 3#S by as many; what their
// offsets do goes to the basis
Eigen::SparseMatrix<double> carried_effect(const SymmetricSampling& sampling, const CarriedTransports& transports,
                                           const std::vector<SeedSpace>& seeds, const MatrixXd& allowed,
                                           SymmetricBasis& basis) {
  constexpr double kCrumb = 1e-14;
  const Eigen::Index count = sampling.points.rows();
  std::vector<Eigen::Triplet<double>> entries;
  basis.offset.resize(3 * count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto sample = static_cast<std::size_t>(k);
    const auto orbit = static_cast<std::size_t>(sampling.orbit_of_sample[sample]);
    const SeedSpace& seed = seeds[orbit];
    const Transport& transport = transports.samples[sample];
    Carried bound;
    for (std::size_t i = 0; i < seed.carriers.size(); ++i) {
      bound.emplace_back(seed.carriers[i], seed.bound.middleCols<3>(3 * static_cast<Eigen::Index>(i)));
    }
    const Vector3d start = sampling.points.row(sampling.first_sample[orbit]).transpose();
    basis.offset.segment<3>(3 * k) = transport.frame * seed.offset;
    if (transports.turned()) {
      basis.offset.segment<3>(3 * k) += moved_by(transport, transports.rest_samples[sample], start);
    }
    for (const auto& [carrier, matrix] : carried_sum(transport.carried, transport.frame, bound)) {
      basis.offset.segment<3>(3 * k) += matrix * basis.carried_offset.segment<3>(3 * carrier);
      add_entries(matrix * allowed.middleRows<3>(3 * carrier), 3 * k, 0, kCrumb, entries);
    }
  }
  Eigen::SparseMatrix<double> effect(3 * count, allowed.cols());
  effect.setFromTriplets(entries.begin(), entries.end());
  return effect;
}

// The basis' columns: first the free directions of each orbit's seed. \return how many
Eigen::Index add_seeds(const SymmetricSampling& sampling, const CarriedTransports& transports,
                       const std::vector<SeedSpace>& seeds, std::vector<Eigen::Triplet<double>>& entries) {
  Eigen::Index column = 0;
  for (std::size_t orbit = 0; orbit < seeds.size(); ++orbit) {
    const MatrixXd& free = seeds[orbit].free;
    for (int k = sampling.first_sample[orbit]; k < sampling.first_sample[orbit + 1]; ++k) {
      add_entries(transports.samples[static_cast<std::size_t>(k)].frame * free, 3 * k, column, 0, entries);
    }
    column += free.cols();
  }
  return column;
}

}  // namespace

Binding binding_of(const std::vector<WordPair>& pairs, const CarriedTransports& transports) {
  const SeedSpace space = solve_seed(constraints_of(pairs, transports, Vector3d::Zero()));
  Binding binding;
  binding.kept = space.kept;
  binding.offset = space.offset;
  for (int k = 0; k < 3 && transports.turned(); ++k) {
    binding.slope.col(k) = solve_seed(constraints_of(pairs, transports, Vector3d::Unit(k))).offset - space.offset;
  }
  for (std::size_t i = 0; i < space.carriers.size(); ++i) {
    binding.bound.emplace_back(space.carriers[i], space.bound.middleCols<3>(3 * static_cast<Eigen::Index>(i)));
  }
  return binding;
}

SymmetricBasis symmetric_basis(const SymmetricSampling& sampling, const CarriedTransports& transports, int carriers,
                               const std::vector<BoundPoint>& elsewhere) {
  CarrierSystem system(carriers, transports.turned());
  const std::vector<SeedSpace> seeds = seed_spaces(sampling, transports, elsewhere, system);
  const MatrixXd allowed = system.free();
  SymmetricBasis basis;
  basis.carried_offset = system.particular();
  basis.conflict = system.conflict(basis.carried_offset);
  const Eigen::SparseMatrix<double> effect = carried_effect(sampling, transports, seeds, allowed, basis);
  const std::vector<Eigen::Index> moving = independent(effect);  // what moves no sample is no freedom

  std::vector<Eigen::Triplet<double>> entries;
  const Eigen::Index of_seeds = add_seeds(sampling, transports, seeds, entries);
  const Eigen::Index freedom = of_seeds + static_cast<Eigen::Index>(moving.size());
  basis.carried = MatrixXd::Zero(3 * carriers, freedom);
  for (std::size_t j = 0; j < moving.size(); ++j) {
    const Eigen::Index column = of_seeds + static_cast<Eigen::Index>(j);
    for (Eigen::SparseMatrix<double>::InnerIterator entry(effect, moving[j]); entry; ++entry) {
      entries.emplace_back(entry.row(), column, entry.value());
    }
    basis.carried.col(column) = allowed.col(moving[j]);
  }
  basis.columns.resize(effect.rows(), freedom);
  basis.columns.setFromTriplets(entries.begin(), entries.end());
  return basis;
}

}  // namespace orbifit
