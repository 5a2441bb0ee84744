#include "cases/fit_cases.h"

#include <algorithm>
#include <cmath>

#include "orbifit/datasets_tools/virtual_scan.h"

#include "base/random.h"

namespace orbifit {

namespace {

std::string name_of(FitLevel level) {
  if (level == FitLevel::three_views) return "three views";
  return level == FitLevel::one_view ? "one view" : "anywhere";
}

Points moved(const Points& points, const Similarity& pose) {
  return (pose.scale * (points * pose.linear.transpose())).rowwise() + pose.translation.transpose();
}

ScanOptions scan_options(FitLevel level) {
  ScanOptions options;
  options.width = 400;
  options.height = 300;
  if (level == FitLevel::three_views) {
    options.views = 3;
    return options;
  }
  options.noise = 0.002;
  if (level == FitLevel::one_view) return options;
  options.views = 2;
  options.elevation = 30;
  options.outliers = 0.05;
  options.clutter = 0.3;
  return options;
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

FitCase fit_case(const FitFamily& family, FitLevel level, RunContext& context) {
  FitCase result;
  result.name = family.name;
  result.level = level;
  result.model = generate(family.name);
  result.truth = generate(family.name, family.parameters).mesh;
  const ScanOptions options = scan_options(level);
  result.scan = virtual_scan(result.truth, options, context);
  ScanOptions clean = options;
  clean.noise = clean.outliers = clean.clutter = 0;
  result.visible = visible_vertices(result.truth, virtual_scan(result.truth, clean, context).points);
  if (level == FitLevel::anywhere) {
    Random random(context.seed, "pose of " + family.name + ", " + name_of(level));
    const Eigen::Matrix3d rotation = random.rotation();
    const double scale = std::pow(10.0, random.uniform(-2, 2));
    result.pose = {scale, rotation, 3 * scale * diagonal(result.truth.vertices) * random.direction()};
    result.truth.vertices = moved(result.truth.vertices, result.pose);
    result.scan.points = moved(result.scan.points, result.pose);
    result.scan.viewpoints = moved(result.scan.viewpoints, result.pose);
  }
  return result;
}

FitScore score_fit(const FitCase& truth, const Mesh& fitted, const RunContext& context) {
  return score_fit(truth.model.mesh, truth.model.truth, truth.truth, truth.visible, fitted, context);
}

}  // namespace orbifit
