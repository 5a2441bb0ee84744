#include "cases/fit_cases.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "orbifit/datasets_tools/virtual_scan.h"

#include "base/random.h"

namespace orbifit {

namespace {

std::string name_of(FitLevel level) {
  switch (level) {
    case FitLevel::three_views:
      return "three views";
    case FitLevel::one_view:
      return "one view";
    case FitLevel::anywhere:
      return "anywhere";
    case FitLevel::other_shape:
      return "other shape";
    default:
      return "several";
  }
}

Points moved(const Points& points, const Similarity& pose) {
  return (pose.scale * (points * pose.linear.transpose())).rowwise() + pose.translation.transpose();
}

void move(PointCloud& scan, const Similarity& pose) {
  scan.points = moved(scan.points, pose);
  scan.viewpoints = moved(scan.viewpoints, pose);
}

// Of each scan that is made.
std::vector<ScanOptions> scan_options(FitLevel level) {
  constexpr int kSeveral = 3;
  ScanOptions options;
  options.width = 400;
  options.height = 300;
  if (level == FitLevel::three_views || level == FitLevel::other_shape) {
    options.views = 3;
    return {options};
  }
  options.noise = 0.002;
  if (level == FitLevel::anywhere) {
    options.views = 2;
    options.elevation = 30;
    options.outliers = 0.05;
    options.clutter = 0.3;
  }
  std::vector<ScanOptions> result{options};
  while (level == FitLevel::several && result.size() < kSeveral) {
    result.push_back(result.back());
    result.back().azimuth += 360.0 / kSeveral;
  }
  return result;
}

}  // namespace

const std::vector<FitFamily>& fit_families() {
  static const std::vector<FitFamily> families{
      {"chair", {{"seat_width", 0.5}, {"seat_depth", 0.5}, {"leg_height", 0.5}, {"back_height", 0.55}}},
      {"table", {{"width", 1.1}, {"height", 0.66}, {"apron_height", 0.12}}},
      {"armchair", {{"seat", 0.66}, {"leg_height", 0.24}, {"back_height", 0.75}}},
      {"car", {{"length", 4.5}, {"wheelbase", 2.7}, {"wheel_radius", 0.36}}},
      {"fan", {{"height", 0.56}, {"radius", 0.23}, {"base_radius", 0.17}}},
      {"centre_piece", {{"height", 0.5}, {"reach", 0.3}, {"candle", 0.2}}},
      {"plane", {{"span", 11.5}, {"length", 8.2}, {"sweep", 0.8}}},
      {"desk_fan", {{"height", 0.4}, {"radius", 0.22}, {"depth", 0.075}}}};
  return families;
}

FitCase fit_case(const FitFamily& family, FitLevel level, RunContext& context, const ShapeChange& change) {
  FitCase result;
  result.name = family.name;
  result.level = level;
  result.model = generate(family.name);
  const GeneratedModel shape = generate(family.name, family.parameters);
  result.truth = shape.mesh;
  if (level == FitLevel::other_shape && change) result.truth.vertices = change(shape, context);
  std::vector<PointCloud> scans;
  result.visible.assign(static_cast<std::size_t>(result.truth.vertices.rows()), 0);
  for (const ScanOptions& options : scan_options(level)) {
    scans.push_back(virtual_scan(result.truth, options, context));
    ScanOptions clean = options;
    clean.noise = clean.outliers = clean.clutter = 0;
    const std::vector<char> seen = visible_vertices(result.truth, virtual_scan(result.truth, clean, context).points);
    std::ranges::transform(result.visible, seen, result.visible.begin(), std::bit_or<>());
  }
  if (level == FitLevel::anywhere || level == FitLevel::several) {
    Random random(context.seed, "pose of " + family.name + ", " + name_of(level));
    const double size = diagonal(result.truth.vertices);
    const auto any_pose = [&]() -> Similarity {
      const Eigen::Matrix3d rotation = random.rotation();
      const double scale = level == FitLevel::several ? 1 : std::pow(10.0, random.uniform(-2, 2));
      return {scale, rotation, 3 * scale * size * random.direction()};
    };
    result.pose = any_pose();
    result.truth.vertices = moved(result.truth.vertices, result.pose);
    move(scans.front(), result.pose);
    for (std::size_t i = 1; i < scans.size(); ++i) move(scans[i], any_pose());
  }
  result.scan = std::move(scans.front());
  result.others.assign(std::make_move_iterator(scans.begin() + 1), std::make_move_iterator(scans.end()));
  return result;
}

FitScore score_fit(const FitCase& truth, const Mesh& fitted, const RunContext& context) {
  return score_fit(truth.model.mesh, truth.model.truth, truth.truth, truth.visible, fitted, context);
}

}  // namespace orbifit
