#include "border_points.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "vertex_places.h"

namespace orbifit {

namespace {

struct Sides {
  int first = -1, second = -1;  // faces
  int count = 0;
};

}  // namespace

AbuttingPlaces::AbuttingPlaces(const Mesh& mesh, const RegionMap& regions) : regions_(regions) {
  if (regions.places() < 2) return;
  const auto set_of = [&](Eigen::Index face) { return regions.set_of_face(static_cast<int>(face)); };
  const std::vector<int> weld = welded_vertices(mesh.vertices);
  std::map<std::pair<int, int>, Sides> edges;
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (int k = 0; k < 3; ++k) {
      const int a = weld[static_cast<std::size_t>(mesh.faces(face, k))];
      const int b = weld[static_cast<std::size_t>(mesh.faces(face, (k + 1) % 3))];
      if (a == b) continue;
      Sides& sides = edges[std::minmax(a, b)];
      (sides.count++ == 0 ? sides.first : sides.second) = static_cast<int>(face);
    }
  }
  // What is known around each vertex: a corner has places that no face and no line there has together.
  std::vector<std::vector<int>> around(weld.size());
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (const int vertex : mesh.faces.row(face)) around[static_cast<std::size_t>(vertex)].push_back(set_of(face));
  }
  for (const auto& [ends, sides] : edges) {
    if (sides.count != 2 || regions.comparable(set_of(sides.first), set_of(sides.second))) continue;
    const int set = regions.joined(set_of(sides.first), set_of(sides.second));
    lines_.push_back(
        {mesh.vertices.row(ends.first).transpose(), mesh.vertices.row(ends.second).transpose(), sides.first, set});
    for (const int face : {sides.first, sides.second}) {
      for (const int vertex : mesh.faces.row(face)) {
        const int place = weld[static_cast<std::size_t>(vertex)];
        if (place == ends.first || place == ends.second) around[static_cast<std::size_t>(vertex)].push_back(set);
      }
    }
  }
  const std::vector<int> vertex_sets = sets_of_vertices(mesh, regions);
  std::map<std::pair<int, int>, bool> seen;
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (const int vertex : mesh.faces.row(face)) {
      const auto v = static_cast<std::size_t>(vertex);
      const int set = vertex_sets[v];
      if (std::ranges::any_of(around[v], [&](int other) { return regions.contains(other, set); })) continue;
      if (!seen.try_emplace({weld[v], set}, true).second) continue;
      corners_.push_back({mesh.vertices.row(vertex).transpose(), static_cast<int>(face), set});
    }
  }
  for (const BorderPoint& corner : corners_) sets_.push_back(corner.set);
  for (const Line& line : lines_) sets_.push_back(line.set);
  std::ranges::sort(sets_);
  sets_.erase(std::unique(sets_.begin(), sets_.end()), sets_.end());
  std::ranges::stable_sort(sets_, std::greater<>(), [&](int set) { return regions.set_places(set).size(); });
}

std::vector<BorderPoint> AbuttingPlaces::points(double spacing) const {
  std::vector<BorderPoint> result = corners_;
  for (const Line& line : lines_) {
    const int count = std::max(1, static_cast<int>(std::ceil((line.end - line.start).norm() / spacing)));
    for (int k = 0; k < count; ++k) {
      const double share = (k + 0.5) / count;
      result.push_back({line.start + share * (line.end - line.start), line.face, line.set});
    }
  }
  return result;
}

int AbuttingPlaces::set_at(const Eigen::Vector3d& image, int carried, double tolerance) const {
  for (const int set : sets_) {
    if (!regions_.contains(set, carried)) continue;
    const auto here = [&](int place) {
      return regions_.whole(place) || regions_.holds(carried, place) ||
             regions_.distance(image, place, tolerance) <= tolerance;
    };
    if (std::ranges::all_of(regions_.set_places(set), here)) return set;
  }
  return -1;
}

}  // namespace orbifit
