#include "orbifit/datasets_tools/fit_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.h"
#include "geometry/exposure.h"
#include "geometry/point_index.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"

namespace orbifit {

namespace {

constexpr int kSamples = 20000;
constexpr double kNear = 0.01;  // of the diagonal

// Where each vertex goes under the elements of the whole template's groups, the identity first.
std::vector<std::vector<int>> vertex_maps(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  const Points& vertices = mesh.vertices;
  const double tolerance = 1e-6 * diagonal(vertices);
  const PointIndex index(vertices);
  std::vector<std::vector<int>> maps(1);
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) maps.front().push_back(static_cast<int>(v));
  for (const Region& region : annotation.regions) {
    if (static_cast<Eigen::Index>(region.faces.size()) != mesh.faces.rows() || region.group.continuous()) continue;
    for (const Motion& element : region.elements) {
      std::vector<int> map;
      for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        const PointIndex::Neighbour near = index.nearest(element(vertices.row(v)), 1).front();
        if (near.distance > tolerance) break;
        map.push_back(near.index);
      }
      if (static_cast<Eigen::Index>(map.size()) == vertices.rows()) maps.push_back(std::move(map));
    }
  }
  return maps;
}

double share_near(const SurfaceSamples& samples, const SurfaceIndex& surface, double distance) {
  Eigen::Index near = 0;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    near += surface.within(samples.points.row(i), distance) ? 1 : 0;
  }
  return static_cast<double>(near) / static_cast<double>(samples.points.rows());
}

double mean_or_0(double sum, double count) {
  return count > 0 ? sum / count : 0;
}

// Of the hidden vertices that something could have seen, under the symmetric copy that fits best.
std::optional<double> hidden_correspondence(const Mesh& rest, const SymmetryAnnotation& annotation, const Mesh& truth,
                                            const std::vector<char>& visible, const Exposure& exposed,
                                            const Mesh& fitted) {
  const bool same = truth.vertices.rows() == fitted.vertices.rows() && truth.faces.rows() == fitted.faces.rows() &&
                    truth.faces == fitted.faces;
  if (!same) return std::nullopt;
  std::vector<char> counted;
  for (std::size_t v = 0; v < visible.size(); ++v) {
    counted.push_back(visible[v] == 0 && exposed(truth.vertices.row(static_cast<Eigen::Index>(v))) ? 1 : 0);
  }
  const auto count = static_cast<double>(std::ranges::count(counted, 1));
  if (count == 0) return std::nullopt;
  double best = std::numeric_limits<double>::infinity();
  for (const std::vector<int>& map : vertex_maps(rest, annotation)) {
    double sum = 0;
    for (std::size_t v = 0; v < map.size(); ++v) {
      if (counted[static_cast<std::size_t>(map[v])] == 0) continue;
      sum += (fitted.vertices.row(static_cast<Eigen::Index>(v)) - truth.vertices.row(map[v])).norm();
    }
    best = std::min(best, sum / count);
  }
  return best / diagonal(truth.vertices);
}

}  // namespace

std::vector<char> visible_vertices(const Mesh& truth, const Points& scan) {
  const PointIndex seen(scan);
  const double near = kNear * diagonal(truth.vertices);
  std::vector<char> result;
  for (Eigen::Index v = 0; v < truth.vertices.rows(); ++v) {
    result.push_back(seen.nearest(truth.vertices.row(v), 1).front().distance <= near ? 1 : 0);
  }
  return result;
}

FitScore score_fit(const Mesh& rest, const SymmetryAnnotation& annotation, const Mesh& truth,
                   const std::vector<char>& visible, const Mesh& fitted, const RunContext& context) {
  FitScore score;
  const double size = diagonal(truth.vertices);
  Random random(context.seed, "score of a fit");
  const SurfaceSamples of_truth = sample_surface(truth, kSamples, random);
  const SurfaceSamples of_fitted = sample_surface(fitted, kSamples, random);
  const SurfaceIndex truth_surface(truth);
  const SurfaceIndex fitted_surface(fitted);
  const Exposure exposed(truth);
  double sums[2] = {0, 0};
  double counts[2] = {0, 0};
  for (Eigen::Index i = 0; i < of_truth.points.rows(); ++i) {
    const int face = of_truth.faces[static_cast<std::size_t>(i)];
    int seen = 0;
    for (int k = 0; k < 3; ++k) seen += visible[static_cast<std::size_t>(truth.faces(face, k))];
    const int which = seen >= 2 ? 0 : 1;
    if (which == 1 && !exposed(of_truth.points.row(i))) continue;
    sums[which] += fitted_surface.nearest(of_truth.points.row(i)).distance / size;
    counts[which] += 1;
  }
  score.visible = mean_or_0(sums[0], counts[0]);
  score.hidden = mean_or_0(sums[1], counts[1]);
  const double recall = share_near(of_truth, fitted_surface, kNear * size);
  const double precision = share_near(of_fitted, truth_surface, kNear * size);
  score.f_score = recall + precision > 0 ? 2 * recall * precision / (recall + precision) : 0;
  score.correspondence = hidden_correspondence(rest, annotation, truth, visible, exposed, fitted);
  return score;
}

}  // namespace orbifit
