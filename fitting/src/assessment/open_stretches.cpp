#include "assessment/open_stretches.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "assessment/fit_evidence.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct StretchPolicy {
  double least = 0.05;    // the first stretch tried: about as much as fits of noisy scans are off by
  int doublings = 2;      // of it: a fifth is as much as shapes of one kind differ
  double together = 0.1;  // cosine: axes that a group takes to one another by more belong together
};
constexpr StretchPolicy kStretchPolicy;

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

// A stretch that was tried and what the scan says of it.
struct Tried {
  double share = 0;
  Evidence evidence;
};

// Where between one that is as good and one that is not the evidence stops being as good: of small stretches errors are
// squares, and what is missed grows with them.
double last_as_good(const Evidence& own, const Tried& good, const Tried& refused) {
  const auto part = [](double from, double to, double most) {
    return to > most ? std::clamp((most - from) / (to - from), 0.0, 1.0) : 1.0;
  };
  const double by_error = part(good.evidence.error, refused.evidence.error, own.most_error());
  const double by_missed = part(good.evidence.missed, refused.evidence.missed, own.most_missed());
  const double squared = good.share * good.share;
  return std::min(std::sqrt(squared + by_error * (refused.share * refused.share - squared)),
                  good.share + by_missed * (refused.share - good.share));
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
  const FitEvidence probe(scan, seen, options, context, result.fitted, FitEvidence::Asked::explained);
  if (probe.empty()) return {};
  const Evidence own = probe.of(Matrix3d::Identity(), 0);
  // How far it goes one way, tried in steps that double.
  const auto open = [&](const Matrix3d& along, double sign) {
    Tried good{0, own};
    for (int step = 0; step <= kStretchPolicy.doublings; ++step) {
      const double share = kStretchPolicy.least * std::pow(2, step);
      Tried next{share, probe.of(along, sign * share)};
      if (!own.as_good(next.evidence)) return last_as_good(own, good, next);
      good = next;
    }
    return good.share;
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
