#include "assessment/fit_evidence.h"

#include <algorithm>
#include <utility>

#include <Eigen/Eigenvalues>

#include "base/random.h"
#include "registration/pose_system.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct FitEvidencePolicy {
  int points = 600;           // of the scan: the mean error of as many is known to a twentieth
  int samples = 6000;         // of the surface: legs of a tenth of its area have 600
  int rounds = 8;             // of ICP: what follows a stretch is a small motion
  double worse = 0.1;         // of the mean error: two of its standard errors
  double uncovered = 0.005;   // of the samples: thirty, as may change sides at silhouettes
  double least_error = 1e-3;  // of the diagonal: a scan without noise is not more exact than the fit
};
constexpr FitEvidencePolicy kPolicy;

// The fitted surface stretched about a point: what is asked of it is asked of the surface as it is.
class Stretched {
 public:
  // \param along  a projection onto what is stretched by the share, more than -1
  Stretched(const MatchSurface& surface, const Vector3d& centre, const Matrix3d& along, double share)
      : surface_(surface),
        centre_(centre),
        there_(Matrix3d::Identity() + share * along),
        back_(Matrix3d::Identity() - share / (1 + share) * along) {}

  Vector3d place(const Vector3d& point) const { return centre_ + there_ * (point - centre_); }
  Vector3d normal(const Vector3d& normal) const { return (back_.transpose() * normal).normalized(); }

  // The place of the nearest point of the surface as it is, and the normal there.
  std::pair<Vector3d, Vector3d> nearest(const Vector3d& point) const {
    const auto near = surface_.index.nearest(centre_ + back_ * (point - centre_));
    return {place(near.point), normal(surface_.normal(near.face))};
  }

  bool occluded(const Vector3d& origin, const Vector3d& direction, double least, double most) const {
    const Vector3d way = back_ * direction;
    const double length = way.norm();
    return surface_.index.occluded(centre_ + back_ * (origin - centre_), way / length, least * length, most * length);
  }

 private:
  const MatchSurface& surface_;
  Vector3d centre_;
  Matrix3d there_, back_;
};

}  // namespace

double Evidence::most_error() const {
  return error * (1 + kPolicy.worse) + kPolicy.least_error * kPolicy.least_error;
}

double Evidence::most_missed() const {
  return missed + kPolicy.uncovered;
}

bool Evidence::as_good(const Evidence& other) const {
  return other.error <= most_error() && other.missed <= most_missed();
}

FitEvidence::FitEvidence(const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options,
                         const RunContext& context, const Mesh& fitted, Asked asked)
    : scan_(scan), seen_(seen), surface_(fitted), areas_(face_areas(fitted)), size_(diagonal(fitted.vertices)) {
  const auto count = static_cast<int>(scan.points.rows());
  const int step = std::max(1, count / kPolicy.points);
  for (int i = 0; i < count; i += step) {
    if (asked == Asked::all || surface_.index.within(scan.points.row(i), 2 * options.inlier_distance * size_)) {
      points_.push_back(i);
    }
  }
  reach_ = std::max(2 * options.inlier_distance * size_, 2 * scan.spacing);
  Random random(context.seed, "stretches of a fit");
  samples_ = sample_surface(fitted, kPolicy.samples, random);
  centre_.setZero();
  for (Index f = 0; f < areas_.size(); ++f) {
    centre_ += areas_[f] * fitted.vertices(fitted.faces.row(f), Eigen::all).colwise().mean().transpose();
  }
  centre_ /= areas_.sum();
}

Matrix3d FitEvidence::axes() const {
  const Mesh& mesh = surface_.mesh();
  Matrix3d moments = Matrix3d::Zero();
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const Matrix3d corners = mesh.vertices(mesh.faces.row(f), Eigen::all).transpose().colwise() - centre_;
    const Vector3d sum = corners.rowwise().sum();
    moments += areas_[f] * (corners * corners.transpose() + sum * sum.transpose());
  }
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(moments).eigenvectors();
}

Evidence FitEvidence::of(const Matrix3d& along, double share, const Similarity& start) const {
  const Stretched surface(surface_, centre_, along, share);
  Similarity move = start;
  for (int round = 0; round < kPolicy.rounds; ++round) {
    PoseSystem system(size_, centre_);
    for (const int i : points_) {
      const Vector3d point = move(scan_.points.row(i).transpose());
      const auto [place, normal] = surface.nearest(point);
      system.add(point, normal, normal.dot(place - point), robust_weight((place - point).norm(), kLastRobust * size_));
    }
    move = system.rigid().scan * move;
  }
  Evidence result;
  result.move = move;
  for (const int i : points_) {
    const Vector3d point = move(scan_.points.row(i).transpose());
    result.error += robust_error((surface.nearest(point).first - point).norm() / size_, kLastRobust);
  }
  result.error /= static_cast<double>(points_.size());
  if (!seen_.knows_viewpoints()) return result;
  SurfaceSamples samples = samples_;
  for (Index i = 0; i < samples.points.rows(); ++i) {
    samples.points.row(i) = surface.place(samples_.points.row(i).transpose()).transpose();
    samples.normals.row(i) = surface.normal(samples_.normals.row(i).transpose()).transpose();
  }
  const SeenSurface::Coverage found = seen_.coverage(samples, surface, inverse(move), reach_).without_cut_off();
  result.missed = static_cast<double>(found.through + found.nothing) / kPolicy.samples;
  return result;
}

}  // namespace orbifit
