// What a session says of points of the surface: picking, orbits, marks, and the shapes between the mesh and its
// symmetric one.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "orbifit/model/scan_io.h"
#include "orbifit/subspace/symmetrize.h"

#include "session.h"

namespace orbifit::editor {

std::optional<SurfacePoint> Session::pick(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const DisplayMesh& shown = need(kSymmetric).display;
  if (!picker_) picker_.emplace(mesh_);
  if (picker_stale_) picker_->move(need(kSymmetric).vertices, context);
  picker_stale_ = false;
  return picker_->pick(shown.centre() + shown.scale() * origin, direction);
}

Eigen::Vector3d Session::shown(const SurfacePoint& point) const {
  const Edited& edited = need(kSymmetric);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    position += point.barycentric[k] * edited.vertices.row(mesh_.faces(point.face, k)).transpose();
  }
  return (position - edited.display.centre()) / edited.display.scale();
}

const std::vector<SurfacePoint>& Session::orbit(const SurfacePoint& point, double radius) {
  SurfacePoint at_rest = point;
  at_rest.point.setZero();
  for (int k = 0; k < 3; ++k) {
    at_rest.point += point.barycentric[k] * mesh_.vertices.row(mesh_.faces(point.face, k)).transpose();
  }
  orbit_ = images().orbit(at_rest);
  if (!index_) index_.emplace(mesh_.vertices);
  clear_marks(kOrbit);
  std::vector<int> near;
  for (const SurfacePoint& image : orbit_) {
    for (const PointIndex::Neighbour& neighbour : index_->within(image.point, radius)) near.push_back(neighbour.index);
  }
  mark_vertices(kOrbit, near);
  return orbit_;
}

std::vector<int> Session::regions_of(int face) {
  return images().regions_of(face);
}

void Session::clear_marks(Mark mark) {
  for (std::size_t i = mark; i < marks_.size(); i += 4) marks_[i] = 0;
}

void Session::mark_vertices(Mark mark, const std::vector<int>& vertices) {
  marked_.assign(static_cast<std::size_t>(mesh_.vertices.rows()), 0);
  for (const int vertex : vertices) marked_[static_cast<std::size_t>(vertex)] = 255;
  const std::vector<std::uint32_t>& sources = symmetric_side_.display.sources();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (marked_[sources[i]] != 0) marks_[4 * i + static_cast<std::size_t>(mark)] = 255;
  }
}

void Session::mark_region(int region) {
  clear_marks(kRegion);
  if (region < 0) return;
  const std::vector<std::uint32_t>& triangles = symmetric_side_.display.triangles();
  for (const int face : annotation_.regions.at(static_cast<std::size_t>(region)).faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      marks_[4 * static_cast<std::size_t>(triangles[3 * static_cast<std::size_t>(face) + k]) + kRegion] = 255;
    }
  }
}

std::string Session::symmetrize() {
  SymmetrizeReport report;
  symmetric_ = symmetrized(mesh_, annotation_, context, &report).vertices;
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (const SymmetrizeReport::RegionChange& change : report.regions) {
    regions.push_back({{"id", change.id},
                       {"before", {change.before.rms, change.before.max}},
                       {"after", {change.after.rms, change.after.max}}});
  }
  return nlohmann::ordered_json{{"largest_movement", report.largest_movement}, {"regions", regions}}.dump();
}

void Session::blend(double share) {
  Edited& edited = symmetric_side_;
  if (symmetric_.rows() != mesh_.vertices.rows()) return;
  take_vertices(edited, (1 - share) * mesh_.vertices + share * symmetric_);
}

void Session::keep_blend(double share) {
  if (symmetric_.rows() != mesh_.vertices.rows()) return;
  mesh_.vertices = (1 - share) * mesh_.vertices + share * symmetric_;
  annotation_.mesh_diagonal = diagonal(mesh_.vertices);
  forget_shape();
  take_vertices(symmetric_side_, mesh_.vertices);
}

FitResult Session::fit(const std::string& scan, bool place, const FitStep& step) {
  const PointCloud cloud = read_scan(scan);
  FitInput input{mesh_, annotation_, cloud, {}};
  FitOptions options;
  options.place = place;
  int number = 0;
  input.watch = [&](const FitIteration& iteration, const Similarity& pose, const Points& vertices) {
    Points posed(vertices.rows(), 3);
    for (Eigen::Index i = 0; i < vertices.rows(); ++i) posed.row(i) = pose(vertices.row(i).transpose()).transpose();
    take_vertices(symmetric_side_, std::move(posed));
    step(iteration, number++);
  };
  FitResult result = orbifit::fit(input, options, context);
  take_vertices(symmetric_side_, result.fitted.vertices);
  return result;
}

}  // namespace orbifit::editor
