#include "measures/carried_motion.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/dense.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMaxSteps = 100;
constexpr double kRounding = 4e-15;  // of the scale, rms: what is left of exact symmetries

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

Vector3d sample_mean(const RegionSample& region) {
  Vector3d sum = Vector3d::Zero();
  for (const ElementSample& sample : region.elements) sum += sample.p.colwise().mean();
  return region.elements.empty() ? region.centre : Vector3d(sum / static_cast<double>(region.elements.size()));
}

// The unknowns: a rotation and the image of a pivot, each shared by as many regions as the mode says.
struct Unknowns {
  std::vector<Matrix3d> rotations;
  std::vector<Vector3d> images;  // of the pivots
};

class Problem {
 public:
  Problem(const std::vector<RegionSample>& regions, CarriedMotions mode, double scale)
      : regions_(regions),
        scale_(scale),
        one_rotation_(mode != CarriedMotions::moving),
        one_translation_(mode == CarriedMotions::posed) {
    for (const RegionSample& region : regions) pivots_.push_back(sample_mean(region));
    if (one_translation_) pivots_.assign(regions.size(), pivots_.front());
  }

  Unknowns initial(const Motion& start) const {
    Unknowns result;
    result.rotations.assign(one_rotation_ ? 1 : regions_.size(), start.linear);
    for (std::size_t r = 0; r < (one_translation_ ? 1 : regions_.size()); ++r) {
      result.images.push_back(start(pivots_[r]));
    }
    return result;
  }

  CarriedFrame frame(const Unknowns& at, std::size_t region) const {
    return {at.rotations[rotation_of(region)], pivots_[region],
            at.images[translation_of(region)] - regions_[region].centre};
  }

  double energy(const Unknowns& at) const {
    double sum = 0;
    for (std::size_t r = 0; r < regions_.size(); ++r) {
      const CarriedFrame carried = frame(at, r);
      for (const ElementSample& sample : regions_[r].elements) {
        for (Index i = 0; i < sample.p.rows(); ++i) {
          sum += (sample.element(carried(sample.p.row(i))) - carried(sample.q.row(i))).squaredNorm();
        }
      }
    }
    return sum;
  }

  // The energy that rounding leaves.
  double rounding() const {
    double points = 0;
    for (const RegionSample& region : regions_) {
      for (const ElementSample& sample : region.elements) points += static_cast<double>(sample.p.rows());
    }
    return points * (kRounding * scale_) * (kRounding * scale_);
  }

  // Normal equations of the linearised energy; a rotation is updated by exp(w) from the left.
  void linearise(const Unknowns& at, Eigen::MatrixXd& hessian, Eigen::VectorXd& gradient) const {
    const Index size = static_cast<Index>(3 * (at.rotations.size() + at.images.size()));
    hessian.setZero(size, size);
    gradient.setZero(size);
    for (std::size_t r = 0; r < regions_.size(); ++r) {
      const CarriedFrame carried = frame(at, r);
      const Index w = static_cast<Index>(3 * rotation_of(r));
      const Index t = static_cast<Index>(3 * (at.rotations.size() + translation_of(r)));
      for (const ElementSample& sample : regions_[r].elements) {
        const Matrix3d& linear = sample.element.linear;
        const Matrix3d by_shift = scale_ * (linear - Matrix3d::Identity());
        Matrix3d turn_turn = Matrix3d::Zero();
        Matrix3d turn_sum = Matrix3d::Zero();
        Vector3d turn_error = Vector3d::Zero();
        Vector3d error_sum = Vector3d::Zero();
        for (Index i = 0; i < sample.p.rows(); ++i) {
          const Vector3d p = carried(sample.p.row(i));
          const Vector3d q = carried(sample.q.row(i));
          const Vector3d error = sample.element(p) - q;
          const Matrix3d by_turn = cross_matrix(q - carried.offset) - linear * cross_matrix(p - carried.offset);
          turn_turn += by_turn.transpose() * by_turn;
          turn_sum += by_turn;
          turn_error += by_turn.transpose() * error;
          error_sum += error;
        }
        hessian.block<3, 3>(w, w) += turn_turn;
        hessian.block<3, 3>(w, t) += turn_sum.transpose() * by_shift;
        hessian.block<3, 3>(t, w) += by_shift.transpose() * turn_sum;
        hessian.block<3, 3>(t, t) += static_cast<double>(sample.p.rows()) * by_shift.transpose() * by_shift;
        gradient.segment<3>(w) += turn_error;
        gradient.segment<3>(t) += by_shift.transpose() * error_sum;
      }
    }
  }

  Unknowns moved(const Unknowns& at, const Eigen::VectorXd& step) const {
    Unknowns result = at;
    Index row = 0;
    for (Matrix3d& rotation : result.rotations) {
      const Vector3d turn = step.segment<3>(row);
      const double angle = turn.norm();
      if (angle > 0) rotation = Eigen::Quaterniond(axis_rotation(turn / angle, angle) * rotation).normalized();
      row += 3;
    }
    for (Vector3d& image : result.images) {
      image += scale_ * step.segment<3>(row);
      row += 3;
    }
    return result;
  }

 private:
  std::size_t rotation_of(std::size_t region) const { return one_rotation_ ? 0 : region; }
  std::size_t translation_of(std::size_t region) const { return one_translation_ ? 0 : region; }

  const std::vector<RegionSample>& regions_;
  double scale_;
  bool one_rotation_;
  bool one_translation_;
  std::vector<Vector3d> pivots_;
};

}  // namespace

CarriedFit fit_carried_frames(const std::vector<RegionSample>& regions, CarriedMotions mode, double scale,
                              const Motion& start) {
  const Problem problem(regions, mode, scale);
  Unknowns at = problem.initial(start);
  double energy = problem.energy(at);
  const double enough = problem.rounding();
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  if (energy > enough) problem.linearise(at, hessian, gradient);
  // Directions that no element constrains (along a mirror plane, about an axis) are held by the damping alone.
  double damping = 1e-9;
  int stalled = 0;
  for (int i = 0; i < kMaxSteps && damping < 10 && stalled < 3 && energy > enough; ++i) {
    Eigen::MatrixXd damped = hessian;
    damped.diagonal().array() += damping * (hessian.trace() / static_cast<double>(hessian.rows()) + 1e-300);
    const Unknowns next = problem.moved(at, solve_semidefinite(damped, -gradient));
    const double next_energy = problem.energy(next);
    if (next_energy < energy) {
      stalled = energy - next_energy < 1e-9 * energy ? stalled + 1 : 0;
      at = next;
      energy = next_energy;
      damping = std::max(damping * 0.1, 1e-12);
      if (energy > enough) problem.linearise(at, hessian, gradient);
    } else {
      damping = std::max(damping * 100, 1e-7);
    }
  }
  CarriedFit result;
  for (std::size_t r = 0; r < regions.size(); ++r) result.frames.push_back(problem.frame(at, r));
  result.energy = energy;
  result.exact = energy <= enough;
  return result;
}

Motion best_rigid_motion(const Points& from, const Points& to) {
  const Eigen::RowVector3d from_mean = from.colwise().mean();
  const Eigen::RowVector3d to_mean = to.colwise().mean();
  const Matrix3d covariance = (from.rowwise() - from_mean).transpose() * (to.rowwise() - to_mean);
  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d product = svd.matrixV() * svd.matrixU().transpose();
  const Matrix3d rotation =
      svd.matrixV() * Vector3d(1, 1, product.determinant() < 0 ? -1 : 1).asDiagonal() * svd.matrixU().transpose();
  return {rotation, to_mean.transpose() - rotation * from_mean.transpose()};
}

}  // namespace orbifit
