#include "assessment/open_stretches.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <Eigen/Eigenvalues>

#include "base/random.h"
#include "registration/correspondences.h"
#include "registration/pose_system.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct StretchPolicy {
  int points = 600;           // of the scan: the mean error of as many is known to a twentieth
  int samples = 6000;         // of the surface: legs of a tenth of its area have 600
  int rounds = 8;             // of ICP: what follows a stretch is a small motion
  double least = 0.05;        // stretch: less is what fits of noisy scans are off by
  int doublings = 2;          // of it: a fifth is as much as shapes of one kind differ
  double worse = 0.1;         // of the mean error: two of its standard errors
  double uncovered = 0.005;   // of the samples: thirty, as may change sides at silhouettes
  double least_error = 1e-3;  // of the diagonal: a scan without noise is not more exact than the fit
  double together = 0.1;      // cosine: axes that a group takes to one another by more belong together
};
constexpr StretchPolicy kStretchPolicy;

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

// How well a surface explains the scan where it lies best.
struct Evidence {
  double error = 0;   // mean of robust_error(), squared diagonals
  double missed = 0;  // share of the surface that should have been seen and was not
};

class Probe {
 public:
  Probe(const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options, const RunContext& context,
        const Mesh& fitted)
      : scan_(scan), seen_(seen), surface_(fitted), areas_(face_areas(fitted)), size_(diagonal(fitted.vertices)) {
    const Index step = std::max<Index>(1, scan.points.rows() / kStretchPolicy.points);
    for (Index i = 0; i < scan.points.rows(); i += step) {
      if (surface_.index.within(scan.points.row(i), 2 * options.inlier_distance * size_)) points_.push_back(i);
    }
    reach_ = std::max(2 * options.inlier_distance * size_, 2 * scan.spacing);
    Random random(context.seed, "stretches of a fit");
    samples_ = sample_surface(fitted, kStretchPolicy.samples, random);
    centre_.setZero();
    for (Index f = 0; f < areas_.size(); ++f) {
      centre_ += areas_[f] * fitted.vertices(fitted.faces.row(f), Eigen::all).colwise().mean().transpose();
    }
    centre_ /= areas_.sum();
  }

  // Those of the surface's moments of inertia.
  Matrix3d axes() const {
    const Mesh& mesh = surface_.mesh();
    Matrix3d moments = Matrix3d::Zero();
    for (Index f = 0; f < mesh.faces.rows(); ++f) {
      const Matrix3d corners = mesh.vertices(mesh.faces.row(f), Eigen::all).transpose().colwise() - centre_;
      const Vector3d sum = corners.rowwise().sum();
      moments += areas_[f] * (corners * corners.transpose() + sum * sum.transpose());
    }
    return Eigen::SelfAdjointEigenSolver<Matrix3d>(moments).eigenvectors();
  }

  Evidence evidence(const Matrix3d& along, double share) const {
    const Stretched surface(surface_, centre_, along, share);
    Similarity move;  // of the scan
    for (int round = 0; round < kStretchPolicy.rounds; ++round) {
      PoseSystem system(size_, centre_);
      for (const Index i : points_) {
        const Vector3d point = move(scan_.points.row(i).transpose());
        const auto [place, normal] = surface.nearest(point);
        system.add(point, normal, normal.dot(place - point),
                   robust_weight((place - point).norm(), kLastRobust * size_));
      }
      move = system.rigid().scan * move;
    }
    Evidence result;
    for (const Index i : points_) {
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
    result.missed = static_cast<double>(found.through + found.nothing) / kStretchPolicy.samples;
    return result;
  }

  bool empty() const { return points_.empty(); }

 private:
  const PreparedScan& scan_;
  const SeenSurface& seen_;
  MatchSurface surface_;
  Eigen::VectorXd areas_;  // of the faces
  double size_, reach_ = 0;
  std::vector<Index> points_;
  SurfaceSamples samples_;
  Vector3d centre_;
};

// Whether the groups of the whole take one direction to the other, in part.
bool belong_together(const SymmetryAnnotation& annotation, Index faces, const Vector3d& a, const Vector3d& b) {
  return std::ranges::any_of(annotation.regions, [&](const Region& region) {
    if (static_cast<Index>(region.faces.size()) != faces) return false;
    if (region.group.continuous()) {
      // Directions off the axis turn about it; a sphere's all turn into one another.
      const double most = std::max(std::abs(region.axis.dot(a)), std::abs(region.axis.dot(b)));
      return !region.group.has_axis() || most < 1 - kStretchPolicy.together;
    }
    return std::ranges::any_of(region.elements, [&](const Motion& element) {
      return std::abs(b.dot(element.linear * a)) > kStretchPolicy.together;
    });
  });
}

// Projections onto the directions that must be stretched alike.
std::vector<Matrix3d> directions(const SymmetryAnnotation& annotation, Index faces, const Matrix3d& axes) {
  int set[3] = {0, 1, 2};
  for (int i = 0; i < 3; ++i) {
    for (int k = i + 1; k < 3; ++k) {
      if (!belong_together(annotation, faces, axes.col(i), axes.col(k))) continue;
      const int joined = set[k];
      for (int& each : set) {
        if (each == joined) each = set[i];
      }
    }
  }
  std::vector<Matrix3d> result;
  for (int s = 0; s < 3; ++s) {
    Matrix3d along = Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      if (set[i] == s) along += axes.col(i) * axes.col(i).transpose();
    }
    if (along.trace() > 0.5 && along.trace() < 2.5) result.push_back(along);
  }
  return result;
}

}  // namespace

std::vector<OpenStretch> open_stretches(const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options,
                                        const RunContext& context, const FitResult& result) {
  const Probe probe(scan, seen, options, context, result.fitted);
  if (probe.empty()) return {};
  const Evidence own = probe.evidence(Matrix3d::Identity(), 0);
  const double most = own.error * (1 + kStretchPolicy.worse) + kStretchPolicy.least_error * kStretchPolicy.least_error;
  // How far it goes one way, in steps that double; 0: not at all.
  const auto open = [&](const Matrix3d& along, double sign) {
    double reached = 0;
    for (int step = 0; step <= kStretchPolicy.doublings; ++step) {
      const double share = kStretchPolicy.least * std::pow(2, step);
      const Evidence evidence = probe.evidence(along, sign * share);
      if (evidence.error > most || evidence.missed > own.missed + kStretchPolicy.uncovered) break;
      reached = share;
    }
    return reached;
  };
  std::vector<Matrix3d> ways = directions(result.annotation, result.fitted.faces.rows(), probe.axes());
  if (!options.fixed_scale) ways.emplace_back(Matrix3d::Identity());
  std::vector<OpenStretch> found;
  for (const Matrix3d& along : ways) found.push_back({along});
  parallel_for(context, 2 * found.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      OpenStretch& stretch = found[i / 2];
      (i % 2 == 0 ? stretch.shorter : stretch.longer) = open(stretch.along, i % 2 == 0 ? -1 : 1);
    }
  });
  std::erase_if(found, [](const OpenStretch& stretch) { return stretch.most() == 0; });
  std::ranges::stable_sort(found, std::greater<>(), &OpenStretch::most);
  return found;
}

}  // namespace orbifit
