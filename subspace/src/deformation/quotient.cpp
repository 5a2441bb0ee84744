#include "deformation/quotient.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "basis/conjugated_regions.h"
#include "basis/subspace_parts.h"
#include "kernels/kernels.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAlike = 1e-9;
constexpr double kTurnAnchor = 1e-6;  // as in local_rotations()
constexpr int kNewtonTrials = 2;

// Laplace coordinates and covariance of a sample under a displacement, as seen from its orbit's seed.
struct Look {
  Matrix3d covariance[kNewtonTrials];
  Vector3d laplace[kNewtonTrials];
  Matrix3d rest;
  Vector3d delta;
};

double difference(const Look& a, const Look& b) {
  double result = (a.rest - b.rest).cwiseAbs().maxCoeff();
  result = std::max(result, (a.delta - b.delta).cwiseAbs().maxCoeff());
  for (int k = 0; k < kNewtonTrials; ++k) {
    result = std::max(result, (a.covariance[k] - b.covariance[k]).cwiseAbs().maxCoeff());
    result = std::max(result, (a.laplace[k] - b.laplace[k]).cwiseAbs().maxCoeff());
  }
  return result;
}

Matrix3d covariance_of(const Corotation& corotation, const Points& moved, int sample) {
  Matrix3d result = Matrix3d::Zero();
  for (const int j : corotation.neighbours[static_cast<std::size_t>(sample)]) {
    const Eigen::RowVector3d rest = corotation.rest.row(j) - corotation.rest.row(sample);
    result += (moved.row(j) - moved.row(sample)).transpose() * rest;
  }
  return result;
}

}  // namespace

Matrix3d nearest_rotation(const Matrix3d& matrix, const Matrix3d& start) {
  constexpr int kMaxSteps = 12;
  constexpr double kDone = 1e-16;  // squared angle after which the next step would be below rounding
  Matrix3d rotation = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    // With R exp[w]: tr = const + w . a - w^T H w / 2; H positive definite at a critical point makes it the maximum.
    const Matrix3d m = rotation.transpose() * matrix;
    const Vector3d a(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
    const double trace = m(0, 0) + m(1, 1) + m(2, 2);
    const double h00 = trace - m(0, 0);
    const double h11 = trace - m(1, 1);
    const double h22 = trace - m(2, 2);
    const double h01 = -0.5 * (m(0, 1) + m(1, 0));
    const double h02 = -0.5 * (m(0, 2) + m(2, 0));
    const double h12 = -0.5 * (m(1, 2) + m(2, 1));
    const double c00 = h11 * h22 - h12 * h12;
    const double c01 = h02 * h12 - h01 * h22;
    const double c02 = h01 * h12 - h02 * h11;
    const double determinant = h00 * c00 + h01 * c01 + h02 * c02;
    if (!(h00 > 0) || !(h00 * h11 - h01 * h01 > 0) || !(determinant > 0)) break;
    const double c11 = h00 * h22 - h02 * h02;
    const double c12 = h01 * h02 - h00 * h12;
    const double c22 = h00 * h11 - h01 * h01;
    // Half the step, for Cayley's form of a rotation.
    const Vector3d w = Vector3d(c00 * a[0] + c01 * a[1] + c02 * a[2], c01 * a[0] + c11 * a[1] + c12 * a[2],
                                c02 * a[0] + c12 * a[1] + c22 * a[2]) *
                       (0.5 / determinant);
    const double squared = w.squaredNorm();
    if (squared == 0) return rotation;
    const double f = 2 / (1 + squared);
    Matrix3d turn;
    turn << 1 - f * (w[1] * w[1] + w[2] * w[2]), f * (w[0] * w[1] - w[2]), f * (w[0] * w[2] + w[1]),
        f * (w[0] * w[1] + w[2]), 1 - f * (w[0] * w[0] + w[2] * w[2]), f * (w[1] * w[2] - w[0]),
        f * (w[0] * w[2] - w[1]), f * (w[1] * w[2] + w[0]), 1 - f * (w[0] * w[0] + w[1] * w[1]);
    rotation = rotation * turn;
    if (squared < kDone) return rotation;
  }
  return blended_rotation(matrix);
}

namespace {

// How samples look under random displacements.
class Looks {
 public:
  Looks(const Subspace& subspace, const Corotation& corotation)
      : transports_(subspace->basis.transports.samples), corotation_(corotation) {
    Random random(5, "quotient");
    for (int k = 0; k < kNewtonTrials; ++k) {
      Eigen::VectorXd q(subspace.degrees_of_freedom());
      for (double& coordinate : q) coordinate = random.normal();
      moved_.push_back(sample_displacements(subspace, q));
      laplace_.push_back(corotation.laplacian * moved_.back());
    }
    for (int sample = 0; sample < static_cast<int>(corotation.rest.rows()); ++sample) {
      scale_ = std::max(scale_, covariance_of(corotation, corotation.rest, sample).norm());
    }
  }

  const Matrix3d& frame(int sample) const { return transports_[static_cast<std::size_t>(sample)].frame; }

  Look of(int sample) const {
    const Matrix3d& turned = frame(sample);
    Look result;
    result.rest = turned.transpose() * covariance_of(corotation_, corotation_.rest, sample) * turned;
    result.delta = turned.transpose() * corotation_.delta.row(sample).transpose();
    for (std::size_t k = 0; k < kNewtonTrials; ++k) {
      result.covariance[k] = turned.transpose() * covariance_of(corotation_, moved_[k], sample) * turned;
      result.laplace[k] = turned.transpose() * laplace_[k].row(sample).transpose();
    }
    return result;
  }

  bool alike(const Look& a, const Look& b) const {
    return difference(a, b) <= kAlike * std::max({1.0, scale_, b.laplace[0].norm(), b.covariance[0].norm()});
  }

 private:
  const std::vector<Transport>& transports_;
  const Corotation& corotation_;
  std::vector<Points> moved_, laplace_;
  double scale_ = 0;
};

}  // namespace

Quotient::Quotient(const Subspace& subspace, const Corotation& corotation) : freedom_(subspace.degrees_of_freedom()) {
  add_columns(subspace, corotation, find_classes(subspace, corotation));
}

// Frames at samples that stabilisers fix are one of several; neighbourhoods that are images all the same look alike.
std::vector<int> Quotient::find_classes(const Subspace& subspace, const Corotation& corotation) {
  const Looks looks(subspace, corotation);
  std::vector<int> representatives;
  for (int orbit = 0; orbit < subspace->sampling.orbits(); ++orbit) {
    std::vector<std::pair<int, Look>> known;
    const auto at = static_cast<std::size_t>(orbit);
    const std::size_t first = counts_.size();
    for (int k = subspace->sampling.first_sample[at]; k < subspace->sampling.first_sample[at + 1]; ++k) {
      const Look seen = looks.of(k);
      const auto same = std::ranges::find_if(known, [&](const auto& other) { return looks.alike(other.second, seen); });
      const auto number = first + static_cast<std::size_t>(same - known.begin());
      const int representative = same != known.end() ? same->first : k;
      class_of_sample_.push_back(static_cast<int>(number));
      frame_.emplace_back(looks.frame(k) * looks.frame(representative).transpose());
      if (same != known.end()) {
        counts_[number] += 1;
        continue;
      }
      known.emplace_back(k, seen);
      representatives.push_back(k);
      counts_.push_back(1);
    }
  }
  return representatives;
}

void Quotient::add_columns(const Subspace& subspace, const Corotation& corotation,
                           const std::vector<int>& representatives) {
  const Eigen::SparseMatrix<double, Eigen::RowMajor> columns(subspace->basis.columns);
  const Eigen::SparseMatrix<double, Eigen::RowMajor> laplacian(corotation.laplacian);
  using Row = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
  Eigen::Matrix<double, 12, Eigen::Dynamic> covariance = Eigen::Matrix<double, 12, Eigen::Dynamic>::Zero(12, freedom_);
  Eigen::Matrix<double, 4, Eigen::Dynamic> coordinates = Eigen::Matrix<double, 4, Eigen::Dynamic>::Zero(4, freedom_);
  std::vector<char> touched(static_cast<std::size_t>(freedom_), 0);
  first_.push_back(0);
  for (const int sample : representatives) {
    std::vector<int> used;
    const auto use = [&](Eigen::Index column) {
      if (std::exchange(touched[static_cast<std::size_t>(column)], 1) == 0) used.push_back(static_cast<int>(column));
    };
    double size = 0;
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    const auto add = [&](int j, const Eigen::RowVector3d& edge) {  // u_j edge^T, column-major
      for (int c = 0; c < 3; ++c) {
        for (Row entry(columns, 3 * Eigen::Index{j} + c); entry; ++entry) {
          use(entry.col());
          for (int d = 0; d < 3; ++d) covariance(3 * d + c, entry.col()) += entry.value() * edge[d];
        }
      }
    };
    for (const int j : corotation.neighbours[static_cast<std::size_t>(sample)]) {
      const Eigen::RowVector3d edge = corotation.rest.row(j) - corotation.rest.row(sample);
      size += edge.squaredNorm();
      sum += edge;
      add(j, edge);
    }
    add(sample, -sum);
    for (Row entry(laplacian, sample); entry; ++entry) {
      for (int c = 0; c < 3; ++c) {
        for (Row coordinate(columns, 3 * entry.col() + c); coordinate; ++coordinate) {
          use(coordinate.col());
          coordinates(c, coordinate.col()) += entry.value() * coordinate.value();
        }
      }
    }
    std::ranges::sort(used);
    for (const int column : used) {
      if (covariance.col(column).cwiseAbs().maxCoeff() > 1e-14 * size ||
          coordinates.col(column).cwiseAbs().maxCoeff() > 1e-14) {
        column_.push_back(column);
        covariance_.insert(covariance_.end(), covariance.col(column).begin(), covariance.col(column).end());
        laplace_.insert(laplace_.end(), coordinates.col(column).begin(), coordinates.col(column).end());
      }
      covariance.col(column).setZero();
      coordinates.col(column).setZero();
      touched[static_cast<std::size_t>(column)] = 0;
    }
    first_.push_back(static_cast<int>(column_.size()));
    if (size > 0) held_.push_back(sizes_.size());
    sizes_.push_back(size);
    rest_.push_back(covariance_of(corotation, corotation.rest, sample));
    delta_.emplace_back(corotation.delta.row(sample).transpose());
  }
}

Eigen::SparseMatrix<double> Quotient::stiffness() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < counts_.size(); ++k) {
    for (int e = first_[k]; e < first_[k + 1]; ++e) {
      for (int c = 0; c < 3; ++c) {
        const double value = laplace_[static_cast<std::size_t>(4 * e + c)];
        if (value == 0) continue;
        entries.emplace_back(column_[static_cast<std::size_t>(e)], 3 * static_cast<int>(k) + c,
                             std::sqrt(counts_[k]) * value);
      }
    }
  }
  Eigen::SparseMatrix<double> rows(freedom_, 3 * classes());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows * Eigen::SparseMatrix<double>(rows.transpose());
}

void Quotient::rotate(const Eigen::VectorXd& q, std::vector<Matrix3d>& rotations) const {
  // Four at a time; the last few fill up with repetitions.
  constexpr std::size_t kLanes = 4;
  for (std::size_t begin = 0; begin < held_.size(); begin += kLanes) {
    double matrices[9 * kLanes];
    double found[9 * kLanes];
    Matrix3d covariances[kLanes];
    std::size_t number[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t k = number[lane] = held_[std::min(begin + lane, held_.size() - 1)];
      double sum[12];
      kernels().gather_blocks(covariance_.data() + 12 * static_cast<std::ptrdiff_t>(first_[k]),
                              column_.data() + first_[k], first_[k + 1] - first_[k], q.data(), sum);
      const double anchor = kTurnAnchor * sizes_[k];
      for (std::size_t e = 0; e < 9; ++e) {
        const double before = rotations[k].data()[e];
        covariances[lane].data()[e] = matrices[kLanes * e + lane] = rest_[k].data()[e] + sum[e] + anchor * before;
        found[kLanes * e + lane] = before;
      }
    }
    const unsigned missed = kernels().nearest_rotations(matrices, found);
    for (std::size_t lane = 0; lane < kLanes && begin + lane < held_.size(); ++lane) {
      Matrix3d& rotation = rotations[number[lane]];
      if ((missed >> lane & 1U) != 0) {
        rotation = nearest_rotation(covariances[lane], rotation);
        continue;
      }
      for (std::size_t e = 0; e < 9; ++e) rotation.data()[e] = found[kLanes * e + lane];
    }
  }
}

Matrix3d Quotient::rotation_of(int sample, const std::vector<Matrix3d>& rotations) const {
  const auto k = static_cast<std::size_t>(sample);
  return frame_[k] * rotations[static_cast<std::size_t>(class_of_sample_[k])] * frame_[k].transpose();
}

void Quotient::pull(const std::vector<Matrix3d>& rotations, Eigen::VectorXd& result) const {
  result.setZero(freedom_);
  for (std::size_t k = 0; k < counts_.size(); ++k) {
    const Matrix3d& r = rotations[k];
    const Vector3d& delta = delta_[k];
    double turned[3];  // written out: a product of this size is called, not inlined
    for (int c = 0; c < 3; ++c) {
      turned[c] = counts_[k] * (r(c, 0) * delta[0] + r(c, 1) * delta[1] + r(c, 2) * delta[2] - delta[c]);
    }
    const double* row = laplace_.data() + 4 * static_cast<std::ptrdiff_t>(first_[k]);
    for (int e = first_[k]; e < first_[k + 1]; ++e, row += 4) {
      result[column_[static_cast<std::size_t>(e)]] += row[0] * turned[0] + row[1] * turned[1] + row[2] * turned[2];
    }
  }
}

double Quotient::energy(const Eigen::VectorXd& q, const std::vector<Matrix3d>& rotations) const {
  double result = 0;
  for (std::size_t k = 0; k < counts_.size(); ++k) {
    Vector3d difference = delta_[k] - rotations[k] * delta_[k];
    for (int e = first_[k]; e < first_[k + 1]; ++e) {
      const double coordinate = q[column_[static_cast<std::size_t>(e)]];
      for (int c = 0; c < 3; ++c) difference[c] += coordinate * laplace_[static_cast<std::size_t>(4 * e + c)];
    }
    result += counts_[k] * difference.squaredNorm();
  }
  return result;
}

}  // namespace orbifit
