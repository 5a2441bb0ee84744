#include "sampling/sharp_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "orbifit/model/errors.h"

#include "geometry/topology.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kOneCrease = 1e-7;      // of the diagonal
constexpr double kSameDirection = 1e-6;  // 1 - cosine
constexpr std::size_t kMinOnLoop = 3;

// The sharp edges of a mesh as a graph over its places.
struct SharpGraph {
  std::vector<Edge> edges;
  std::vector<std::vector<int>> edges_of_place;  // by number among the sharp ones
  Points positions;                              // of the places

  int other_end(int edge, int place) const {
    const Edge& here = edges[static_cast<std::size_t>(edge)];
    return here.vertices[0] == place ? here.vertices[1] : here.vertices[0];
  }

  double length(int edge) const {
    const Edge& here = edges[static_cast<std::size_t>(edge)];
    return (positions.row(here.vertices[0]) - positions.row(here.vertices[1])).norm();
  }

  Vector3d direction(int edge, int from) const {
    return (positions.row(other_end(edge, from)) - positions.row(from)).transpose().normalized();
  }
};

// Directions within the faces away from an edge; the same ones counted once.
std::vector<Vector3d> directions_at(const Mesh& mesh, const Edge& edge, const Weld& weld, const Points& positions) {
  const Vector3d begin = positions.row(edge.vertices[0]);
  const Vector3d along = (positions.row(edge.vertices[1]).transpose() - begin).normalized();
  std::vector<Vector3d> directions;
  for (const int face : edge.faces) {
    for (int k = 0; k < 3; ++k) {
      const int place = weld.group_of_vertex[static_cast<std::size_t>(mesh.faces(face, k))];
      if (place == edge.vertices[0] || place == edge.vertices[1]) continue;
      const Vector3d offset = positions.row(place).transpose() - begin;
      const Vector3d away = offset - offset.dot(along) * along;
      if (!(away.norm() > 1e-9 * offset.norm())) continue;  // a face of no area says nothing
      const Vector3d direction = away.normalized();
      const bool known = std::ranges::any_of(
          directions, [&](const Vector3d& other) { return 1 - other.dot(direction) < kSameDirection; });
      if (!known) directions.push_back(direction);
    }
  }
  return directions;
}

SharpGraph sharp_graph(const Mesh& mesh, double cosine) {
  const Weld weld = weld_vertices(mesh.vertices, kOneCrease * diagonal(mesh.vertices));
  SharpGraph graph;
  graph.positions = mesh.vertices(weld.representative, Eigen::all);
  graph.edges_of_place.resize(weld.representative.size());
  for (Edge& edge : welded_edges(mesh, weld)) {
    const std::vector<Vector3d> directions = directions_at(mesh, edge, weld, graph.positions);
    if (directions.empty() || (directions.size() == 2 && -directions[0].dot(directions[1]) >= cosine)) continue;
    for (const int place : edge.vertices) {
      graph.edges_of_place[static_cast<std::size_t>(place)].push_back(static_cast<int>(graph.edges.size()));
    }
    graph.edges.push_back(std::move(edge));
  }
  return graph;
}

class Collector {
 public:
  Collector(const SharpGraph& graph, double cosine, double spacing)
      : graph_(graph), spacing_(spacing), used_(graph.edges.size(), 0), corner_(graph.edges_of_place.size(), 0) {
    for (std::size_t p = 0; p < corner_.size(); ++p) {
      const std::vector<int>& here = graph.edges_of_place[p];
      const int place = static_cast<int>(p);
      if (here.empty()) continue;
      corner_[p] =
          here.size() != 2 || -graph.direction(here[0], place).dot(graph.direction(here[1], place)) < cosine ? 1 : 0;
      if (corner_[p] != 0) add(graph.positions.row(place), here.front());
    }
    for (std::size_t p = 0; p < corner_.size(); ++p) {
      if (corner_[p] == 0) continue;
      for (const int edge : graph.edges_of_place[p]) follow(static_cast<int>(p), edge);
    }
    for (std::size_t e = 0; e < graph.edges.size(); ++e) follow(graph.edges[e].vertices[0], static_cast<int>(e));
  }

  const std::vector<Vector3d>& points() const { return points_; }
  const std::vector<int>& edges() const { return edges_; }

 private:
  void add(const Vector3d& point, int edge) {
    points_.push_back(point);
    edges_.push_back(edge);
  }

  // Walks from a place along sharp edges to a corner, or round a loop, and spreads points between.
  void follow(int place, int edge) {
    if (used_[static_cast<std::size_t>(edge)] != 0) return;
    std::vector<int> places{place};
    std::vector<int> chain;
    double length = 0;
    while (used_[static_cast<std::size_t>(edge)] == 0) {
      used_[static_cast<std::size_t>(edge)] = 1;
      chain.push_back(edge);
      length += graph_.length(edge);
      place = graph_.other_end(edge, place);
      places.push_back(place);
      if (corner_[static_cast<std::size_t>(place)] != 0) break;
      const std::vector<int>& here = graph_.edges_of_place[static_cast<std::size_t>(place)];
      edge = here[0] == edge ? here[1] : here[0];
    }
    const bool loop = corner_[static_cast<std::size_t>(places.front())] == 0;
    std::size_t steps = static_cast<std::size_t>(std::max(1.0, std::round(length / spacing_)));
    if (loop) steps = std::max(steps, kMinOnLoop);
    double passed = 0;
    std::size_t next = loop ? 0 : 1;
    for (std::size_t c = 0; c < chain.size(); ++c) {
      const double here = graph_.length(chain[c]);
      for (; next < steps; ++next) {
        const double at = length * static_cast<double>(next) / static_cast<double>(steps) - passed;
        if (at > here && c + 1 < chain.size()) break;
        const double share = std::min(1.0, at / here);
        add((1 - share) * graph_.positions.row(places[c]) + share * graph_.positions.row(places[c + 1]), chain[c]);
      }
      passed += here;
    }
  }

  const SharpGraph& graph_;
  double spacing_;
  std::vector<char> used_;    // of each sharp edge
  std::vector<char> corner_;  // of each place
  std::vector<Vector3d> points_;
  std::vector<int> edges_;  // on which each point lies
};

}  // namespace

void SharpFeatureOptions::validate() const {
  require(spacing > 0, "spacing", spacing, "positive");
  require(angle > 0 && angle < 180, "angle", angle, "between 0 and 180 degrees");
}

SurfaceSamples sharp_feature_samples(const Mesh& mesh, const SharpFeatureOptions& options) {
  options.validate();
  const double cosine = std::cos(options.angle * std::numbers::pi / 180);
  const SharpGraph graph = sharp_graph(mesh, cosine);
  const Collector collector(graph, cosine, options.spacing);
  const Points normals = face_normals(mesh);
  SurfaceSamples samples;
  const auto count = static_cast<Index>(collector.points().size());
  samples.points.resize(count, 3);
  samples.normals.resize(count, 3);
  for (std::size_t i = 0; i < collector.points().size(); ++i) {
    // A face of some area has a normal.
    const std::vector<int>& faces = graph.edges[static_cast<std::size_t>(collector.edges()[i])].faces;
    const auto solid = std::ranges::find_if(faces, [&](int face) { return normals.row(face).squaredNorm() > 0; });
    const int face = solid == faces.end() ? faces.front() : *solid;
    samples.points.row(static_cast<Index>(i)) = collector.points()[i].transpose();
    samples.normals.row(static_cast<Index>(i)) = normals.row(face);
    samples.faces.push_back(face);
  }
  return samples;
}

}  // namespace orbifit
