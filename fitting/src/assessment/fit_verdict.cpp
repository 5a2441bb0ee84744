#include "orbifit/fitting/fit_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

namespace orbifit {

namespace {

// What is worth a sentence.
struct VerdictPolicy {
  double well = 0.9;      // confidence: a tenth of the evidence is against it, as much as noise and outliers make of it
  double mostly = 0.7;    // confidence: below this a person would not call it a fit
  double part = 0.02;     // share of the scan: a handle, where an outlier is a point
  double unseen = 0.3;    // share of the surface: more than the underside that no scanner sees
  double stretch = 0.05;  // of a length: less is what fits of noisy scans are off by
  double growth = 0.01;   // of the size: what a tape measure shows
  std::size_t places = 3;  // of where poses differ: nobody looks at more
};
constexpr VerdictPolicy kVerdictPolicy;

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * share);
  return text;
}

std::string place(const Eigen::Vector3d& point) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.3g, %.3g, %.3g)", point.x(), point.y(), point.z());
  return text;
}

// What lowers the confidence most, as FitResult::confidence has it.
std::string weakest_point(const FitResult& result) {
  const std::pair<double, const char*> losses[] = {
      {1 - result.inlier_ratio, "points that do not lie on it"},
      {1 - result.visible_coverage, "surface that should have been seen and was not"},
      {result.torn_off > 0 ? result.torn_off / (result.overlap + result.torn_off) : 0, "what was left out of the scan"},
      {result.open_stretch(), "its size, which the scan leaves open"},
      {result.open_distance(), "its pose, of which the scan allows others"}};
  return std::ranges::max_element(losses, {}, &std::pair<double, const char*>::first)->second;
}

std::string of_the_whole(const FitResult& result) {
  if (!result.converged) return "The fit failed: " + result.stopped_because + ".";
  const std::string explained = percent(result.inlier_ratio) + " of the points that were used lie on it";
  if (result.confidence >= kVerdictPolicy.well) return "The fit explains the scan: " + explained + ".";
  const std::string doubt = explained + ". The confidence is " + percent(result.confidence) + ", lowered most by " +
                            weakest_point(result) + ".";
  if (result.confidence >= kVerdictPolicy.mostly) return "The fit explains most of the scan: " + doubt;
  return "The fit is doubtful: " + doubt;
}

// What people call a dimension of a shape: by its rank among those across it.
std::string dimension(const Mesh& shape, const Eigen::Vector3d& axis) {
  constexpr int kDirections = 12;  // across it: a box's other two sides to 4 % of their ratio
  const auto extent = [&](const Eigen::Vector3d& direction) {
    const Eigen::VectorXd along = shape.vertices * direction;
    return along.maxCoeff() - along.minCoeff();
  };
  const Eigen::Vector3d side = axis.unitOrthogonal();
  const double own = extent(axis);
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double across = extent(axis_rotation(axis, std::numbers::pi * k / kDirections) * side);
    least = std::min(least, across);
    most = std::max(most, across);
  }
  return own >= most ? "length" : own <= least ? "thickness" : "width";
}

// "its length, along (0, 0, 1), from 5 % smaller to 10 % larger".
std::string open_stretch(const Mesh& fitted, const OpenStretch& open) {
  const int directions = static_cast<int>(std::lround(open.along.trace()));
  std::string way = "all of it";
  if (directions < 3) {
    const Eigen::Matrix3d projection =
        directions == 1 ? open.along : Eigen::Matrix3d(Eigen::Matrix3d::Identity() - open.along);
    Eigen::Index column = 0;
    projection.colwise().squaredNorm().maxCoeff(&column);
    const Eigen::Vector3d axis = projection.col(column).normalized();
    way = directions == 1 ? "its " + dimension(fitted, axis) + ", along " + place(axis) + ","
                          : "its girth about " + place(axis) + ",";
  }
  if (open.shorter < kVerdictPolicy.stretch) return way + " up to " + percent(open.longer) + " larger";
  if (open.longer < kVerdictPolicy.stretch) return way + " up to " + percent(open.shorter) + " smaller";
  return way + " from " + percent(open.shorter) + " smaller to " + percent(open.longer) + " larger";
}

void add_open_size(const FitResult& result, std::vector<std::string>& told) {
  std::string ways;
  for (const OpenStretch& open : result.open_stretches) {
    if (open.most() < kVerdictPolicy.stretch) continue;
    ways += (ways.empty() ? " " : "; ") + open_stretch(result.fitted, open);
  }
  if (!ways.empty())
    told.push_back("The scan leaves the size open:" + ways + ". Stretched so, it explains the scan as well.");
}

void add_own_size(const FitResult& result, std::vector<std::string>& told) {
  if (!result.own_size) return;
  const double growth = std::abs(result.growth);
  told.push_back(growth < kVerdictPolicy.growth
                     ? "The template has kept its own size: the scan asks for no other."
                     : "The template has kept its scale, but its deformed shape is " + percent(growth) +
                           (result.growth > 0 ? " larger: " : " smaller: ") +
                           "if the object is known to be as large as the template, the fit is wrong by that.");
}

void add_open_poses(const FitResult& result, std::vector<std::string>& told) {
  const std::size_t count = result.open_poses.size();
  if (count == 0) return;
  std::string places;
  for (std::size_t i = 0; i < std::min(count, kVerdictPolicy.places); ++i) {
    places += (i == 0 ? "" : ", ") + place(result.open_poses[i].at);
  }
  told.push_back((count == 1 ? "Another pose explains" : std::to_string(count) + " other poses explain") +
                 " the scan as well. A view of where they differ most would tell them apart: around " + places + ".");
}

}  // namespace

std::vector<std::string> fit_verdict(const FitResult& result) {
  std::vector<std::string> told{of_the_whole(result)};
  if (result.unexplained_part > kVerdictPolicy.part) {
    told.push_back("A connected part of the scan, " + percent(result.unexplained_part) +
                   " of it, does not lie on the fit: around " + place(result.unexplained_at) +
                   " there is something that the template lacks, or has elsewhere.");
  }
  if (result.torn_off > kVerdictPolicy.part) {
    told.push_back(percent(result.torn_off) +
                   " of the scan were left out as other things, although they hang together with what was used.");
  }
  if (result.visible_coverage < 1 - kVerdictPolicy.unseen / 2) {
    told.push_back("Of the surface that should have been in view the scan lacks " +
                   percent(1 - result.visible_coverage) + ".");
  }
  if (result.hidden_fraction > kVerdictPolicy.unseen) {
    told.push_back(percent(result.hidden_fraction) +
                   " of the surface was not seen: there symmetry and the template's shape decide.");
  }
  add_own_size(result, told);
  add_open_size(result, told);
  add_open_poses(result, told);
  for (const GroupAgreement& group : result.groups) {
    if (!group.disagrees) continue;
    const auto& regions = result.rest_annotation.regions;
    const auto region = std::ranges::find(regions, group.region, &Region::id);
    const std::string name = region != regions.end() && !region->name.empty() ? " (" + region->name + ")" : "";
    const bool left_out = std::ranges::find(result.dropped, group.region) != result.dropped.end();
    told.push_back("The scan contradicts the symmetry of region " + std::to_string(group.region) + name +
                   ": fitted without it, places that are images of one another differ by " +
                   percent(group.disagreement) + " of the diagonal, and the scan lies " + percent(group.free) +
                   " from the fit in place of " + percent(group.held) + (left_out ? "; it was dropped." : "."));
  }
  return told;
}

}  // namespace orbifit
