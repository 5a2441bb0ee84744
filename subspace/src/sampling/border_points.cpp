#include "sampling/border_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "geometry/side_order.h"

namespace orbifit {

namespace {

// A face's side: its welded ends, ascending.
struct BorderSide {
  std::array<int, 2> ends;
  int face;
};

// Sides with the same ends follow one another, in the order of the faces.
std::vector<BorderSide> sorted_sides(const Mesh& mesh, const std::vector<int>& weld) {
  std::vector<BorderSide> sides;
  sides.reserve(static_cast<std::size_t>(3 * mesh.faces.rows()));
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax<int>({weld[static_cast<std::size_t>(mesh.faces(face, k))],
                                            weld[static_cast<std::size_t>(mesh.faces(face, (k + 1) % 3))]});
      if (a != b) sides.push_back({{a, b}, static_cast<int>(face)});
    }
  }
  sort_by_ends(sides, weld.size(), &BorderSide::ends);
  return sides;
}

}  // namespace

AbuttingPlaces::AbuttingPlaces(const Mesh& mesh, const RegionMap& regions) : regions_(regions) {
  if (regions.places() < 2) return;
  const std::vector<int>& weld = regions.points().weld;
  const std::vector<int> vertex_sets = by_vertex(regions.points());
  // Whether a face or a line there has all places of the vertex; corners are the others.
  std::vector<char> covered(weld.size(), 0);
  const auto cover = [&](int vertex, int set) {
    const auto v = static_cast<std::size_t>(vertex);
    if (covered[v] == 0 && regions.contains(set, vertex_sets[v])) covered[v] = 1;
  };
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (const int vertex : mesh.faces.row(face)) cover(vertex, regions.set_of_face(static_cast<int>(face)));
  }
  const std::vector<BorderSide> sides = sorted_sides(mesh, weld);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    const std::array<int, 2> faces{sides[i].face, sides[end - 1].face};
    const std::array<int, 2> sets{regions.set_of_face(faces[0]), regions.set_of_face(faces[1])};
    const std::array<int, 2> ends = sides[i].ends;
    const bool two = end == i + 2;
    i = end;
    if (!two || regions.comparable(sets[0], sets[1])) continue;
    const int set = regions.joined(sets[0], sets[1]);
    lines_.push_back({mesh.vertices.row(ends[0]).transpose(), mesh.vertices.row(ends[1]).transpose(), faces[0], set});
    for (const int face : faces) {
      for (const int vertex : mesh.faces.row(face)) {
        const int place = weld[static_cast<std::size_t>(vertex)];
        if (place == ends[0] || place == ends[1]) cover(vertex, set);
      }
    }
  }
  std::set<std::pair<int, int>> seen;
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (const int vertex : mesh.faces.row(face)) {
      const auto v = static_cast<std::size_t>(vertex);
      if (covered[v] != 0 || !seen.emplace(weld[v], vertex_sets[v]).second) continue;
      corners_.push_back({mesh.vertices.row(vertex).transpose(), static_cast<int>(face), vertex_sets[v]});
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
  enum class Answer : char { unknown, no, yes };
  std::vector<Answer> answers(static_cast<std::size_t>(regions_.places()), Answer::unknown);  // many sets ask the same
  const auto here = [&](int place) {
    Answer& answer = answers[static_cast<std::size_t>(place)];
    if (answer == Answer::unknown) {
      const bool yes = regions_.whole(place) || regions_.holds(carried, place) ||
                       regions_.distance(image, place, tolerance) <= tolerance;
      answer = yes ? Answer::yes : Answer::no;
    }
    return answer == Answer::yes;
  };
  for (const int set : sets_) {
    if (std::ranges::all_of(regions_.set_places(set), here) && regions_.contains(set, carried)) return set;
  }
  return -1;
}

}  // namespace orbifit
