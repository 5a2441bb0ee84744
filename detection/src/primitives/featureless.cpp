#include "primitives/featureless.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "base/dense.h"
#include "base/random.h"
#include "group/verification.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSlippable = 0.05;  // of the largest eigenvalue
constexpr double kFits = 0.95;
constexpr int kPlanarSamples = 300;

// The motion that the twist (w, v) about `centre` reaches at time 1.
Motion reached(const Vector3d& w, const Vector3d& v, const Vector3d& centre) {
  const double angle = w.norm();
  if (angle < 1e-9) return {Matrix3d::Identity(), v};
  const Vector3d k = w / angle;
  const Matrix3d rotation = axis_rotation(k, angle);
  Matrix3d cross;
  cross << 0, -k.z(), k.y(), k.z(), 0, -k.x(), -k.y(), k.x(), 0;
  const Matrix3d integral =
      Matrix3d::Identity() + (1 - std::cos(angle)) / angle * cross + (angle - std::sin(angle)) / angle * cross * cross;
  Motion motion = Motion::about(rotation, centre);
  motion.translation += integral * v;
  return motion;
}

bool fits(const SurfacePatch& patch, const SurfaceIndex& whole, const SurfaceEnds& ends,
          const std::vector<Motion>& group, const Motion& motion, double tolerance) {
  const Eigen::Index total = patch.samples.points.rows();
  const Eigen::Index count = std::min<Eigen::Index>(total, kPlanarSamples);
  Eigen::Index off = 0;
  Eigen::Index past = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index s = i * total / count;
    const Vector3d image = motion(patch.samples.points.row(s));
    const Vector3d normal = motion.linear * patch.samples.normals.row(s).transpose();
    const bool free = patch.at_crease[static_cast<std::size_t>(s)] != 0;
    const bool on =
        free ? whole.within(image, tolerance) : whole.within_facing(image, normal, kAlikeNormals, tolerance);
    if (on) continue;
    ++(ends.past_broken_end(image, whole, group) ? past : off);
    if (static_cast<double>(off) > (1 - kFits) * static_cast<double>(count)) return false;
  }
  return 2 * past <= count && static_cast<double>(off) <= (1 - kFits) * static_cast<double>(count - past);
}

// Twists that map a continuous group to itself, in units of the patch's size about its centre.
Eigen::MatrixXd claimed_twists(const GroupPlacement& placement, const Vector3d& centre, double size) {
  using Family = PointGroup::Family;
  if (!placement.group.continuous()) return Eigen::MatrixXd(6, 0);
  const Vector3d offset = (placement.centre - centre) / size;
  const auto turn = [&](const Vector3d& axis) {
    Vector6d twist;
    twist << axis, -axis.cross(offset);
    return twist;
  };
  if (placement.group.family == Family::K || placement.group.family == Family::Kh) {
    Eigen::MatrixXd twists(6, 3);
    for (int k = 0; k < 3; ++k) twists.col(k) = turn(Vector3d::Unit(k));
    return twists;
  }
  const bool slides = placement.group.family == Family::Cinf || placement.group.family == Family::Cinfv;
  Eigen::MatrixXd twists(6, slides ? 2 : 1);
  twists.col(0) = turn(placement.frame.col(2));
  if (slides) twists.col(1) << Vector3d::Zero(), placement.frame.col(2);
  return twists;
}

// Gelfand and Guibas 2004, section 3: twists that the samples resist little have small eigenvalues.
Matrix6d slip_matrix(const SurfacePatch& patch, const Vector3d& centre, double size) {
  Matrix6d matrix = Matrix6d::Zero();
  for (Eigen::Index i = 0; i < patch.samples.points.rows(); ++i) {
    const Vector3d point = (patch.samples.points.row(i).transpose() - centre) / size;
    const Vector3d normal = patch.samples.normals.row(i);
    Vector6d row;
    row << point.cross(normal), normal;
    matrix += row * row.transpose();
  }
  return matrix;
}

double spread_about(const SurfacePatch& patch, const Vector3d& centre) {
  return std::sqrt((patch.samples.points.rowwise() - centre.transpose()).rowwise().squaredNorm().mean());
}

// A basis of the slippable twists that the group does not claim.
Eigen::MatrixXd slippable_twists(const SurfacePatch& patch, const GroupPlacement& placement, const Vector3d& centre,
                                 double size) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(slip_matrix(patch, centre, size));
  Eigen::Index count = 0;
  while (count < 6 && solver.eigenvalues()[count] < kSlippable * solver.eigenvalues()[5]) ++count;
  Eigen::MatrixXd slip = solver.eigenvectors().leftCols(count);
  const Eigen::MatrixXd claimed = claimed_twists(placement, centre, size);
  if (claimed.cols() == 0 || count == 0) return slip;
  const Eigen::MatrixXd basis = orthonormal_basis(claimed);
  slip -= basis * (basis.transpose() * slip);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(slip, Eigen::ComputeThinU);
  Eigen::Index kept = 0;
  while (kept < svd.singularValues().size() && svd.singularValues()[kept] > 0.3) ++kept;
  return svd.matrixU().leftCols(kept);
}

}  // namespace

bool featureless(const SurfacePatch& patch, const GroupPlacement& placement, const SurfaceIndex& whole,
                 const SurfaceEnds& ends, double tolerance, const RunContext& context) {
  const Vector3d centre = patch.samples.points.colwise().mean();
  const double size = spread_about(patch, centre);
  if (!(size > 0)) return true;
  const Eigen::MatrixXd slip = slippable_twists(patch, placement, centre, size);
  if (slip.cols() == 0) return false;
  // Pure translations, turns, and mixtures of all.
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(slip.topRows(3), Eigen::ComputeFullV);
  std::vector<Vector6d> ways;
  for (Eigen::Index k = 0; k < slip.cols(); ++k) ways.emplace_back(slip * svd.matrixV().col(k));
  Random random(context.seed, "featureless");
  for (int extra = 0; extra < 4 && slip.cols() > 1; ++extra) {
    Eigen::VectorXd mixture(slip.cols());
    for (double& weight : mixture) weight = random.normal();
    ways.emplace_back(slip * mixture.normalized());
  }
  const std::vector<Motion> group = judged_motions(placement.group, placement.frame, placement.centre);
  constexpr std::array<double, 4> kAmounts{0.31, 0.57, 0.83, 1};
  return std::ranges::any_of(ways, [&](const Vector6d& way) {
    context.check();
    const Vector3d w = way.head<3>();
    const Vector3d v = way.tail<3>() * size;
    const bool turns = w.norm() * size > 0.3 * v.norm();
    // As far as a quarter of a turn or a fifth of the patch.
    const double most = turns ? 1.7 / w.norm() : 0.2 * patch.moments.diagonal / std::max(v.norm(), 1e-12);
    return std::ranges::all_of(kAmounts, [&](double amount) {
      const double k = amount * most;
      return fits(patch, whole, ends, group, reached(k * w, k * v, centre), tolerance);
    });
  });
}

}  // namespace orbifit
