#include "detection_score/triviality.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "base/dense.h"

namespace orbifit::scoring {

namespace {

using Kind = Pattern::Kind;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Family = PointGroup::Family;
using Twist = Eigen::Matrix<double, 6, 1>;  // turn, then shift; lengths in units of the part's size

constexpr int kRegionSamples = 400;
constexpr int kPatternSamples = 300;
constexpr double kSlippable = 0.05;  // of the largest eigenvalue
constexpr double kShift = 0.2;       // turn of a unit twist below which it is a translation
constexpr int kMixtures = 4;
constexpr double kMaxTurn = 1.7;   // radians
constexpr double kMaxShift = 0.2;  // of the part's diagonal
constexpr double kAmounts[] = {0.31, 0.57, 0.83, 1.0};
constexpr double kStepShares[] = {0.23, 0.37, 0.51, 0.64, 0.79};
constexpr int kSharesThatFit = 3;

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d result;
  result << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return result;
}

// The motion that turning by `turn` about `centre` while moving by `shift` has reached at time 1.
Motion reached(const Vector3d& turn, const Vector3d& shift, const Vector3d& centre) {
  const double angle = turn.norm();
  if (angle < 1e-9) return {Matrix3d::Identity(), shift};
  const Vector3d axis = turn / angle;
  const Matrix3d k = cross_matrix(axis);
  const Matrix3d integral =
      Matrix3d::Identity() + (1 - std::cos(angle)) / angle * k + (angle - std::sin(angle)) / angle * k * k;
  Motion motion = Motion::about(axis_rotation(axis, angle), centre);
  motion.translation += integral * shift;
  return motion;
}

// Twists that map the region's continuous group to itself, as columns.
MatrixXd twists_of_group(const Region& region, const Vector3d& centre, double size) {
  if (!region.group.continuous()) return MatrixXd(6, 0);
  const Vector3d offset = (region.centre - centre) / size;
  const auto turn = [&](const Vector3d& axis) {
    Twist twist;
    twist << axis, -axis.cross(offset);
    return twist;
  };
  const Family family = region.group.family;
  if (family == Family::K || family == Family::Kh) {
    MatrixXd result(6, 3);
    for (int k = 0; k < 3; ++k) result.col(k) = turn(Vector3d::Unit(k));
    return result;
  }
  const bool slides = family == Family::Cinf || family == Family::Cinfv;
  MatrixXd result(6, slides ? 2 : 1);
  result.col(0) = turn(region.axis);
  if (slides) result.col(1) << Vector3d::Zero(), region.axis;
  return result;
}

// A basis of the slippable twists that the group does not hold.
MatrixXd slippable_twists(const SurfaceSamples& samples, const Region& region, const Vector3d& centre, double size) {
  Matrix6d moment = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Vector3d arm = (samples.points.row(i).transpose() - centre) / size;
    const Vector3d normal = samples.normals.row(i);
    Twist row;
    row << arm.cross(normal), normal;
    moment += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(moment);
  const auto slips = [&](double value) { return value < kSlippable * solver.eigenvalues()[5]; };
  MatrixXd slip = solver.eigenvectors().leftCols(std::ranges::count_if(solver.eigenvalues(), slips));
  const MatrixXd own = twists_of_group(region, centre, size);
  if (own.cols() == 0 || slip.cols() == 0) return slip;
  const MatrixXd basis = orthonormal_basis(own);
  slip -= basis * (basis.transpose() * slip);
  const Eigen::JacobiSVD<MatrixXd> svd(slip, Eigen::ComputeThinU);
  return svd.matrixU().leftCols(std::ranges::count_if(svd.singularValues(), [](double s) { return s > 0.3; }));
}

// Pure translations, turns without the pitch that a translation could give them, and mixtures of all.
std::vector<Twist> directions(const MatrixXd& slip, Random& random) {
  const Eigen::JacobiSVD<MatrixXd> svd(slip.topRows(3), Eigen::ComputeFullV);
  std::vector<Twist> shifts, turns;
  for (Eigen::Index k = 0; k < slip.cols(); ++k) {
    const double turn = k < svd.singularValues().size() ? svd.singularValues()[k] : 0;
    (turn < kShift ? shifts : turns).emplace_back(slip * svd.matrixV().col(k));
  }
  for (int i = 0; i < kMixtures; ++i) {
    Eigen::VectorXd weights(slip.cols());
    for (double& weight : weights) weight = random.normal();
    turns.emplace_back(slip * weights);
  }
  if (!shifts.empty()) {
    MatrixXd along(3, shifts.size());
    for (std::size_t k = 0; k < shifts.size(); ++k) along.col(static_cast<Eigen::Index>(k)) = shifts[k].tail<3>();
    const MatrixXd free = orthonormal_basis(along);
    for (Twist& twist : turns) {
      const Vector3d axis = twist.head<3>() / std::max(twist.head<3>().norm(), 1e-9);
      if ((free.transpose() * axis).norm() > 0.95) twist.tail<3>() -= axis * axis.dot(twist.tail<3>());
    }
  }
  shifts.insert(shifts.end(), turns.begin(), turns.end());
  return shifts;
}

}  // namespace

bool featureless(const ScoredSurface& part, double part_diagonal, const Region& region, const ScoredSurface& whole,
                 Random& random, const RunContext& context) {
  const ScoreSamples samples = part.sample(kRegionSamples, random, context);
  const Points& points = samples.surface.points;
  const Vector3d centre = points.colwise().mean();
  const double size = std::sqrt((points.rowwise() - centre.transpose()).rowwise().squaredNorm().mean());
  const MatrixXd slip = slippable_twists(samples.surface, region, centre, std::max(size, 1e-300));
  if (slip.cols() == 0) return false;
  return std::ranges::any_of(directions(slip, random), [&](const Twist& twist) {
    const Vector3d turn = twist.head<3>();
    const Vector3d shift = twist.tail<3>() * size;
    // As far as a quarter of a turn or a fifth of the part.
    const bool turns = turn.norm() * size > 0.3 * shift.norm();
    const double reach = turns ? kMaxTurn / turn.norm() : kMaxShift * part_diagonal / std::max(shift.norm(), 1e-9);
    return std::ranges::all_of(kAmounts, [&](double amount) {
      const double way = amount * reach;
      return whole.fit(samples, reached(way * turn, way * shift, centre), context) >= kFits;
    });
  });
}

bool featureless(const ScoredSurface& part, const Pattern& pattern, const ScoredSurface& whole, Random& random,
                 const RunContext& context) {
  if (pattern.kind == Kind::congruent || pattern.kind == Kind::screw) return false;
  const ScoreSamples samples = part.sample(kPatternSamples, random, context);
  int fitting = 0;
  for (const double share : kStepShares) {
    Motion motion;
    if (pattern.kind == Kind::rotation) {
      const Motion& step = pattern.generators.front();
      const AxisAngle turn = axis_angle(step.linear);
      const Vector3d centre = shortest_solution(Matrix3d::Identity() - step.linear, step.translation, 1e-8);
      motion = Motion::about(axis_rotation(turn.axis, share * turn.angle), centre);
    } else {
      for (const Motion& step : pattern.generators) motion.translation += share * step.translation;
    }
    if (whole.fit(samples, motion, context) >= kFits) ++fitting;
  }
  return fitting >= kSharesThatFit;
}

}  // namespace orbifit::scoring
