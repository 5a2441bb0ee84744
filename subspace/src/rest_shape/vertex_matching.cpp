#include "rest_shape/vertex_matching.h"

#include <algorithm>
#include <map>

#include "geometry/point_index.h"
#include "geometry/topology.h"

namespace orbifit {

namespace {

using Eigen::Index;

constexpr double kOnePlace = 1e-7;    // of the diagonal
constexpr double kSurelyClose = 0.1;  // of the distance to the next place
constexpr double kBorneOut = 0.6;     // share of the neighbours that must map onto neighbours
constexpr double kNearlyAll = 0.9;    // share of the places: so many images by edges are not chance

// Which of a region's places are joined by edges, by their numbers within the region.
class Neighbourhoods {
 public:
  Neighbourhoods(const Places& places, const std::vector<int>& inside) : lists_(inside.size()) {
    std::vector<int> number(static_cast<std::size_t>(places.positions.rows()), -1);
    for (std::size_t i = 0; i < inside.size(); ++i) number[static_cast<std::size_t>(inside[i])] = static_cast<int>(i);
    for (std::size_t i = 0; i < inside.size(); ++i) {
      for (const int place : places.neighbours[static_cast<std::size_t>(inside[i])]) {
        const int neighbour = number[static_cast<std::size_t>(place)];
        if (neighbour >= 0) lists_[i].push_back(neighbour);
      }
    }
  }

  /// The share of `place`'s neighbours that `images` takes to neighbours of `image`.
  double agreement(int place, int image, const std::vector<int>& images) const {
    const std::vector<int>& list = of(place);
    int agreeing = 0;
    for (const int neighbour : list) {
      const int its_image = images[static_cast<std::size_t>(neighbour)];
      if (its_image >= 0 && std::ranges::binary_search(of(image), its_image)) ++agreeing;
    }
    return list.empty() ? 0 : static_cast<double>(agreeing) / static_cast<double>(list.size());
  }

  /// The place not taken that most images of `place`'s neighbours have for a neighbour; -1: none, or several.
  int place_between(int place, const std::vector<int>& images, const std::vector<char>& taken) const {
    std::map<int, int> votes;
    for (const int neighbour : of(place)) {
      const int its_image = images[static_cast<std::size_t>(neighbour)];
      if (its_image < 0) continue;
      for (const int candidate : of(its_image)) {
        if (taken[static_cast<std::size_t>(candidate)] == 0) ++votes[candidate];
      }
    }
    int best = -1;
    int most = 0;
    for (const auto& [candidate, count] : votes) {
      if (count == most) best = -1;
      if (count <= most) continue;
      best = candidate;
      most = count;
    }
    return best;
  }

  int count(int place) const { return static_cast<int>(of(place).size()); }
  const std::vector<int>& of(int place) const { return lists_[static_cast<std::size_t>(place)]; }

 private:
  std::vector<std::vector<int>> lists_;  // ascending, as numbers and places ascend together
};

}  // namespace

Places vertex_places(const Mesh& mesh) {
  const Weld weld = weld_vertices(mesh.vertices, kOnePlace * diagonal(mesh.vertices));
  Places places;
  places.of_vertex = weld.group_of_vertex;
  places.positions = mesh.vertices(weld.representative, Eigen::all);
  places.neighbours.resize(weld.representative.size());
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = places.of_vertex[static_cast<std::size_t>(mesh.faces(f, k))];
      const int b = places.of_vertex[static_cast<std::size_t>(mesh.faces(f, (k + 1) % 3))];
      if (a == b) continue;
      places.neighbours[static_cast<std::size_t>(a)].push_back(b);
      places.neighbours[static_cast<std::size_t>(b)].push_back(a);
    }
  }
  for (std::vector<int>& list : places.neighbours) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return places;
}

std::vector<int> places_of(const Places& places, const Mesh& mesh, const Region& region) {
  std::vector<int> result;
  result.reserve(3 * region.faces.size());
  for (const int face : region.faces) {
    for (int k = 0; k < 3; ++k) {
      result.push_back(places.of_vertex[static_cast<std::size_t>(mesh.faces(face, k))]);
    }
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

namespace {

std::vector<int> matched_at(const Points& positions, const Neighbourhoods& around, const Motion& motion, double reach,
                            const RunContext& context) {
  const auto count = static_cast<std::size_t>(positions.rows());
  const PointIndex index(positions);
  const Motion back = inverse(motion);
  std::vector<int> forward(count, -1);
  std::vector<int> backward(count, -1);
  std::vector<double> distance(count, 0);
  std::vector<double> spacing(count, 0);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d position = positions.row(static_cast<Index>(i));
      const auto image = index.nearest(motion(position));
      forward[i] = image.index;
      distance[i] = image.distance;
      backward[i] = index.nearest(back(position)).index;
      const auto near = index.nearest(position, 2);
      spacing[i] = near.back().distance;
    }
  });
  std::vector<int> result(count, -1);
  std::vector<char> taken(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const int image = forward[i];
    const bool mutual = backward[static_cast<std::size_t>(image)] == static_cast<int>(i) && distance[i] <= reach;
    const bool close = distance[i] <= kSurelyClose * spacing[static_cast<std::size_t>(image)];
    if (!mutual || (!close && around.agreement(static_cast<int>(i), image, forward) < kBorneOut)) continue;
    result[i] = image;
    taken[static_cast<std::size_t>(image)] = 1;
  }
  // Where noise is as large as the triangles the nearest place may be the wrong one: the neighbours know.
  bool grown = true;
  while (grown) {
    grown = false;
    for (std::size_t i = 0; i < count; ++i) {
      if (result[i] >= 0) continue;
      const int image = around.place_between(static_cast<int>(i), result, taken);
      if (image < 0 || around.agreement(static_cast<int>(i), image, result) < kBorneOut) continue;
      const Eigen::Vector3d due = motion(positions.row(static_cast<Index>(i)).transpose());
      if ((positions.row(image).transpose() - due).norm() > reach) continue;
      result[i] = image;
      taken[static_cast<std::size_t>(image)] = 1;
      grown = true;
    }
  }
  return result;
}

// What is noise is gone from the mean of many neighbours; what edges join alike stays alike.
Points smoothed(const Points& positions, const Neighbourhoods& around) {
  Points result = positions;
  for (Index place = 0; place < positions.rows(); ++place) {
    for (const int neighbour : around.of(static_cast<int>(place))) result.row(place) += positions.row(neighbour);
    result.row(place) /= 1 + around.count(static_cast<int>(place));
  }
  return result;
}

// How many places have an image, and how near those are to it in the mean.
std::pair<int, double> worth(const std::vector<int>& images, const Points& positions, const Motion& motion) {
  int count = 0;
  double sum = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] < 0) continue;
    ++count;
    sum += (positions.row(images[i]).transpose() - motion(positions.row(static_cast<Index>(i)).transpose())).norm();
  }
  return {count, count > 0 ? -sum / count : 0};
}

}  // namespace

std::vector<int> matched_places(const Places& places, const std::vector<int>& inside, const Motion& motion,
                                double reach, const RunContext& context) {
  constexpr int kMostSmoothings = 16;  // which leave a tenth of the noise
  const Neighbourhoods around(places, inside);
  Points positions = places.positions(inside, Eigen::all);
  std::vector<int> best = matched_at(positions, around, motion, reach, context);
  int done = 0;
  for (int smoothings = 2; smoothings <= kMostSmoothings && std::ranges::find(best, -1) != best.end();
       smoothings *= 2) {
    for (; done < smoothings; ++done) positions = smoothed(positions, around);
    std::vector<int> images = matched_at(positions, around, motion, reach, context);
    const auto found = worth(images, positions, motion);
    if (found.first < kNearlyAll * static_cast<double>(inside.size())) continue;
    if (found > worth(best, positions, motion)) best = std::move(images);
  }
  return best;
}

}  // namespace orbifit
