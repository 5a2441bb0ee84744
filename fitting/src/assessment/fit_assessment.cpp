#include "assessment/fit_assessment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "geometry/point_index.h"
#include "geometry/sampling.h"
#include "solver/pulls.h"

namespace orbifit {

namespace {

// Fills `unexplained_part` and `unexplained_at`. Points hang together over three spacings.
void find_unexplained_part(const std::vector<int>& unexplained, const PreparedScan& scan, FitResult& result) {
  constexpr double kReach = 3;
  if (unexplained.empty()) return;
  const Points points = scan.points(unexplained, Eigen::all);
  const PointIndex index(points);
  std::vector<char> reached(unexplained.size(), 0);
  std::size_t most = 0;
  for (std::size_t first = 0; first < unexplained.size(); ++first) {
    if (reached[first] != 0) continue;
    reached[first] = 1;
    std::vector<int> part{static_cast<int>(first)};
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (const auto& near : index.within(points.row(part[i]).transpose(), kReach * scan.spacing)) {
        char& known = reached[static_cast<std::size_t>(near.index)];
        if (known == 0) part.push_back(near.index);
        known = 1;
      }
    }
    if (part.size() <= most) continue;
    most = part.size();
    result.unexplained_at = points(part, Eigen::all).colwise().mean().transpose();
  }
  result.unexplained_part = static_cast<double>(most) / static_cast<double>(scan.points.rows());
}

}  // namespace

double pulls_rms(const FitInput& input, const FitResult& result) {
  const auto pulls = pulls_towards(input, result.pose, 1);
  if (pulls.empty()) return 0;
  double squares = 0;
  for (const Pull& pull : pulls) {
    squares += (result.fitted.vertices.row(pull.vertex).transpose() - result.pose(pull.target)).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(pulls.size())) / diagonal(result.fitted.vertices);
}

void assess_fit(const FitInput& input, const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options,
                const RunContext& context, FitResult& result) {
  assess_fit(input, scan, seen, MovingSurface(result.fitted), options, context, result);
}

void assess_fit(const FitInput& input, const PreparedScan& scan, const SeenSurface& seen, const MovingSurface& surface,
                const FitOptions& options, const RunContext& context, FitResult& result) {
  const double size = diagonal(result.fitted.vertices);
  std::vector<double> distances(static_cast<std::size_t>(scan.points.rows()));
  parallel_for(context, distances.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      distances[i] = surface.nearest(scan.points.row(static_cast<Eigen::Index>(i)).transpose()).distance / size;
    }
  });
  double squares = 0;
  int inliers = 0;
  std::vector<int> unexplained;
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    const double distance = distances[static_cast<std::size_t>(i)];
    if (distance > options.inlier_distance) {
      unexplained.push_back(static_cast<int>(i));
      continue;
    }
    ++inliers;
    squares += distance * distance;
  }
  result.inlier_ratio = double(inliers) / static_cast<double>(scan.points.rows());
  result.rms = inliers > 0 ? std::sqrt(squares / inliers) : 0;
  find_unexplained_part(unexplained, scan, result);

  if (seen.knows_viewpoints()) {
    constexpr int kSamples = 1500;
    Random random(context.seed, "coverage of a fit");
    const double reach = std::max(2 * options.inlier_distance * size, 2 * scan.spacing);
    const SeenSurface::Coverage coverage =
        seen.coverage(sample_surface(result.fitted, kSamples, random), surface, Similarity{}, reach);
    result.cut_off = coverage.cut_off();
    result.visible_coverage = coverage.without_cut_off().share();
  }
  const double whole = result.overlap / (result.overlap + result.torn_off);
  result.confidence = result.inlier_ratio * result.visible_coverage * whole * (1 - result.unexplained_part);

  const double near = std::max(2 * scan.spacing, options.inlier_distance * size);
  result.seen.resize(static_cast<std::size_t>(result.fitted.vertices.rows()));
  parallel_for(context, result.seen.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Eigen::Vector3d vertex = result.fitted.vertices.row(static_cast<Eigen::Index>(v));
      result.seen[v] = seen.points().any_within(vertex, near) ? 1 : 0;
    }
  });
  const Eigen::VectorXd areas = face_areas(result.fitted);
  double hidden = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (result.seen[static_cast<std::size_t>(result.fitted.faces(f, k))] == 0) hidden += areas[f] / 3;
    }
  }
  result.hidden_fraction = hidden / areas.sum();

  result.landmark_rms = pulls_rms(input, result);
}

double explained_share(const FitResult& result) {
  return result.inlier_ratio * result.overlap;
}

bool explains_scan(const FitResult& result, bool placed, const FitOptions& options) {
  // Of the points used: a scan of something else, onto which the template was put as well as can be, leaves more.
  constexpr double kMinOfPlaced = 0.8;
  return explained_share(result) >= options.min_inlier_ratio && (!placed || result.inlier_ratio >= kMinOfPlaced);
}

}  // namespace orbifit
