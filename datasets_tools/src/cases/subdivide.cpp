#include <algorithm>
#include <array>
#include <numeric>
#include <queue>
#include <sstream>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "orbifit/model/errors.h"

#include "cases/spoil.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Corners = std::array<int, 3>;

// Vertices and faces that grow while edges are halved.
class Bisection {
 public:
  Bisection(const Mesh& mesh, double longest) : squared_limit_(longest * longest) {
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) vertices_.emplace_back(mesh.vertices.row(v));
    for (int f = 0; f < mesh.faces.rows(); ++f) {
      add_face({mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)}, f);
    }
  }

  Derived operator()() {
    while (!longest_.empty()) {
      const Edge edge = longest_.top();
      longest_.pop();
      halve(edge.low, edge.high);
    }
    return result();
  }

 private:
  struct Edge {
    double squared_length;
    int low, high;  // vertices

    bool operator<(const Edge& other) const {
      return std::tie(squared_length, other.low, other.high) < std::tie(other.squared_length, low, high);
    }
  };

  static std::uint64_t key(int low, int high) {
    return (static_cast<std::uint64_t>(low) << 32U) | static_cast<std::uint64_t>(high);
  }

  Vector3d& at(int vertex) { return vertices_[static_cast<std::size_t>(vertex)]; }

  // Lists the face at its edge from corner k to k + 1; the edge waits to be halved if it is too long.
  void list_edge(int face, std::size_t k) {
    const Corners& corners = faces_[static_cast<std::size_t>(face)];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
    const double squared_length = (at(high) - at(low)).squaredNorm();
    if (!(squared_length > squared_limit_)) return;
    std::vector<int>& faces = faces_of_edge_[key(low, high)];
    if (faces.empty()) longest_.push({squared_length, low, high});
    faces.push_back(face);
  }

  int add_face(const Corners& corners, int source) {
    faces_.push_back(corners);
    source_.push_back(source);
    const int face = static_cast<int>(faces_.size()) - 1;
    for (std::size_t k = 0; k < 3; ++k) list_edge(face, k);
    return face;
  }

  void halve(int low, int high) {
    const auto found = faces_of_edge_.find(key(low, high));
    const std::vector<int> faces = std::move(found->second);
    faces_of_edge_.erase(found);
    const int middle = static_cast<int>(vertices_.size());
    vertices_.emplace_back(0.5 * (at(low) + at(high)));
    for (const int face : faces) {
      const Corners corners = faces_[static_cast<std::size_t>(face)];
      const auto is_on_edge = [&](int v) { return v == low || v == high; };
      std::size_t k = 0;
      while (!is_on_edge(corners[k]) || !is_on_edge(corners[(k + 1) % 3])) ++k;
      const int from = corners[k];
      const int to = corners[(k + 1) % 3];
      const int tip = corners[(k + 2) % 3];
      // The first half takes the face's place; the second is a face of its own.
      faces_[static_cast<std::size_t>(face)] = {from, middle, tip};
      list_edge(face, 0);
      list_edge(face, 1);
      const auto outer = faces_of_edge_.find(key(std::min(to, tip), std::max(to, tip)));
      if (outer != faces_of_edge_.end()) std::erase(outer->second, face);
      add_half({middle, to, tip}, source_[static_cast<std::size_t>(face)]);
    }
  }

  // Like add_face, but an edge that is already waiting must not be queued again where its last face was just taken off.
  void add_half(const Corners& corners, int source) {
    faces_.push_back(corners);
    source_.push_back(source);
    const int face = static_cast<int>(faces_.size()) - 1;
    list_edge(face, 0);
    const auto [low, high] = std::minmax(corners[1], corners[2]);
    const auto outer = faces_of_edge_.find(key(low, high));
    if (outer != faces_of_edge_.end()) outer->second.push_back(face);
    list_edge(face, 2);
  }

  Derived result() const {
    std::vector<int> order(faces_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](int f) { return source_[static_cast<std::size_t>(f)]; });
    Derived derived;
    derived.mesh.vertices.resize(static_cast<Eigen::Index>(vertices_.size()), 3);
    derived.mesh.faces.resize(static_cast<Eigen::Index>(faces_.size()), 3);
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      derived.mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices_[v];
    }
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Corners& corners = faces_[static_cast<std::size_t>(order[i])];
      derived.mesh.faces.row(static_cast<Eigen::Index>(i)) << corners[0], corners[1], corners[2];
      derived.source_face.push_back(source_[static_cast<std::size_t>(order[i])]);
    }
    return derived;
  }

  double squared_limit_;
  std::vector<Vector3d> vertices_;
  std::vector<Corners> faces_;
  std::vector<int> source_;
  std::unordered_map<std::uint64_t, std::vector<int>> faces_of_edge_;  // of the edges that are too long
  std::priority_queue<Edge> longest_;
};

}  // namespace

Derived subdivided(const Mesh& mesh, double longest_edge) {
  if (!(longest_edge >= 1e-3 && longest_edge <= 1)) {
    std::ostringstream text;
    text << "subdivided: longest_edge is " << longest_edge << "; it must be in [0.001, 1] of the diagonal";
    throw UsageError(text.str());
  }
  return Bisection(mesh, longest_edge * diagonal(mesh.vertices))();
}

}  // namespace orbifit
