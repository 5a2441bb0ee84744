#include "fit_pictures.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "orbifit/apps/render.h"

#include "geometry/point_index.h"

namespace orbifit {

namespace {

constexpr double kFarthest = 0.02;  // of the diagonal: the distance that is red

// The box of both meshes with a margin, in which the scan is looked at too: two opposite corners.
Points frame_of(const Points& placed, const Points& fitted) {
  constexpr double kMargin = 0.03;  // of the diagonal
  const double margin = kMargin * diagonal(fitted);
  Points corners(2, 3);
  corners.row(0) = placed.colwise().minCoeff().cwiseMin(fitted.colwise().minCoeff()).array() - margin;
  corners.row(1) = placed.colwise().maxCoeff().cwiseMax(fitted.colwise().maxCoeff()).array() + margin;
  return corners;
}

std::vector<Eigen::Index> points_within(const Points& points, const Points& box) {
  std::vector<Eigen::Index> result;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto point = points.row(i).array();
    if ((point >= box.row(0).array()).all() && (point <= box.row(1).array()).all()) result.push_back(i);
  }
  return result;
}

// From the fitted mesh to what saw it: the mean direction to the viewpoints, or to the side that has points; zero where
// that is no side.
Eigen::Vector3d seen_from(const PointCloud& scan, const std::vector<Eigen::Index>& near, const Mesh& fitted) {
  constexpr double kOneSided = 0.05;  // of the diagonal
  const Eigen::Vector3d centre = bounding_box_centre(fitted.vertices);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Index i : near) {
    if (scan.viewpoints.rows() > 0) {
      sum += (scan.viewpoints.row(scan.viewpoints.rows() == 1 ? 0 : i).transpose() - centre).normalized();
    } else {
      sum += scan.points.row(i).transpose() - centre;
    }
  }
  if (near.empty()) return sum;
  const Eigen::Vector3d mean = sum / static_cast<double>(near.size());
  const double least = scan.viewpoints.rows() > 0 ? kOneSided : kOneSided * diagonal(fitted.vertices);
  return mean.norm() > least ? mean : Eigen::Vector3d::Zero();
}

}  // namespace

std::vector<ReportPicture> fit_pictures(const Mesh& mesh, const PointCloud& scan, const FitResult& result,
                                        const Eigen::Vector3d& up, const RunContext& run) {
  constexpr double kAside = 20;  // degrees: depth shows
  Mesh placed = mesh;
  for (auto vertex : placed.vertices.rowwise()) vertex = result.pose(vertex.transpose()).transpose();
  ViewOptions view;
  view.up = (result.pose.linear * up).normalized();
  view.frame = frame_of(placed.vertices, result.fitted.vertices);
  const std::vector<Eigen::Index> near = points_within(scan.points, view.frame);
  look_from(seen_from(scan, near, result.fitted), view);
  view.azimuth += kAside;
  PointLayer points;
  points.points = scan.points(near, Eigen::all);

  std::vector<ReportPicture> pictures;
  const auto add = [&](const Mesh& shape, const std::vector<Colour>& colours, bool with_points,
                       const std::string& caption) {
    Scene scene;
    scene.surfaces.push_back({shape, {}, colours});
    if (with_points) scene.points.push_back(points);
    pictures.push_back({encode_png(render(scene, view, run)), caption});
  };
  add(placed, {}, true, "template where the fit put it, and scan");
  add(result.fitted, {}, true, "fitted template and scan");

  std::vector<Colour> distances, hidden;
  const PointIndex index(scan.points);
  const double scale = kFarthest * diagonal(result.fitted.vertices);
  for (Eigen::Index v = 0; v < result.fitted.vertices.rows(); ++v) {
    const bool seen = result.seen[static_cast<std::size_t>(v)] != 0;
    const double distance = index.nearest(result.fitted.vertices.row(v).transpose(), 1).front().distance;
    distances.push_back(seen ? heat_colour(0.5 + 0.5 * std::min(1.0, distance / scale)) : Colour{0.6F, 0.6F, 0.6F});
    hidden.push_back(seen ? Colour{0.82F, 0.82F, 0.80F} : Colour{0.36F, 0.55F, 0.85F});
  }
  add(result.fitted, distances, false, "distance to the scan, white 0 to red 2 % of the diagonal; grey: not seen");
  add(result.fitted, hidden, false, "blue: completed, not seen by the scan");
  view.azimuth += 180;
  add(result.fitted, hidden, false, "the same from behind");
  return pictures;
}

}  // namespace orbifit
