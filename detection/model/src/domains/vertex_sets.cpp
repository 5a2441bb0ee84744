#include "domains/vertex_sets.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

namespace orbifit {

namespace {

constexpr double kWeld = 1e-9;  // of the diagonal

int root(std::vector<int>& parents, int v) {
  while (parents[static_cast<std::size_t>(v)] != v) {
    int& parent = parents[static_cast<std::size_t>(v)];
    parent = parents[static_cast<std::size_t>(parent)];
    v = parent;
  }
  return v;
}

// A side of a face: the welded ends, ascending, and the vertices there.
struct Side {
  std::array<int, 2> ends;
  std::array<int, 2> vertices;
};

// Joins vertices at one position whose faces meet in an edge of two faces.
std::vector<int> linked(const Mesh& mesh, const std::vector<int>& weld) {
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(3 * mesh.faces.rows()));
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (int k = 0; k < 3; ++k) {
      std::array<int, 2> vertices{mesh.faces(face, k), mesh.faces(face, (k + 1) % 3)};
      std::array<int, 2> ends{weld[static_cast<std::size_t>(vertices[0])], weld[static_cast<std::size_t>(vertices[1])]};
      if (ends[0] == ends[1]) continue;
      if (ends[0] > ends[1]) {
        std::swap(ends[0], ends[1]);
        std::swap(vertices[0], vertices[1]);
      }
      sides.push_back({ends, vertices});
    }
  }
  std::ranges::sort(sides, {}, &Side::ends);
  std::vector<int> parents(weld.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    if (end == i + 2) {
      for (std::size_t k = 0; k < 2; ++k) {
        const int a = root(parents, sides[i].vertices[k]);
        const int b = root(parents, sides[i + 1].vertices[k]);
        parents[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
    i = end;
  }
  return parents;
}

}  // namespace

std::vector<int> welded_vertices(const Points& vertices) {
  const double tolerance = kWeld * diagonal(vertices);
  std::vector<int> result(static_cast<std::size_t>(vertices.rows()));
  std::iota(result.begin(), result.end(), 0);
  if (!(tolerance > 0)) return result;
  const VertexGrid grid(vertices, tolerance);
  for (std::size_t v = 0; v < result.size(); ++v) {
    grid.visit(vertices.row(static_cast<Eigen::Index>(v)).transpose(),
               [&](int other) { result[v] = std::min(result[v], other); });
  }
  return result;
}

namespace {

// Sets of places by group of vertices that are one point of one part: those of all faces around.
struct PointSets {
  std::vector<int> root;  // of each vertex, the vertex that stands for its point
  std::vector<int> sets;  // of each root
};

PointSets point_sets(const Mesh& mesh, const DomainMap& domains) {
  PointSets result;
  result.sets.assign(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  result.root.resize(result.sets.size());
  std::iota(result.root.begin(), result.root.end(), 0);
  if (domains.places() > 0) {
    const std::vector<int> weld = welded_vertices(mesh.vertices);
    bool doubled = false;
    for (std::size_t v = 0; v < weld.size(); ++v) doubled = doubled || weld[v] != static_cast<int>(v);
    if (doubled) {
      std::vector<int> parents = linked(mesh, weld);
      for (int v = 0; v < static_cast<int>(weld.size()); ++v)
        result.root[static_cast<std::size_t>(v)] = root(parents, v);
    }
  }
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (const int vertex : mesh.faces.row(face)) {
      int& here = result.sets[static_cast<std::size_t>(result.root[static_cast<std::size_t>(vertex)])];
      const int set = domains.set_of_face(static_cast<int>(face));
      if (here != set) here = domains.joined(here, set);
    }
  }
  return result;
}

std::vector<int> by_vertex(const PointSets& points) {
  std::vector<int> result;
  result.reserve(points.root.size());
  for (const int root : points.root) result.push_back(points.sets[static_cast<std::size_t>(root)]);
  return result;
}

}  // namespace

std::vector<int> sets_of_vertices(const Mesh& mesh, const DomainMap& domains) {
  return by_vertex(point_sets(mesh, domains));
}

namespace {

// Sets are carried along by every motion of every place, vertex by vertex, until nothing changes.
class SetClosure {
 public:
  SetClosure(const Mesh& mesh, const DomainMap& domains, VertexImages& images, PointSets points)
      : mesh_(mesh),
        domains_(domains),
        images_(images),
        of_place_(static_cast<std::size_t>(domains.places())),
        normals_(vertex_normals(mesh)),
        rounding_(kWeld * diagonal(mesh.vertices)),
        points_(std::move(points)),
        queued_(points_.root.size(), 0) {}

  PointSets run(const RunContext& context) {
    ask_images(context);
    for (std::size_t v = 0; v < points_.root.size(); ++v) {
      if (points_.root[v] != static_cast<int>(v)) continue;
      queue_.push_back(static_cast<int>(v));
      queued_[v] = 1;
    }
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const int vertex = queue_[head];
      queued_[static_cast<std::size_t>(vertex)] = 0;
      const std::vector<int> places = domains_.set_places(set_of(vertex));
      for (const int place : places) {
        for (int element = 0; element < static_cast<int>(domains_.elements(place).size()); ++element) {
          carry(vertex, place, element);
        }
      }
    }
    return std::move(points_);
  }

 private:
  int root_of(int vertex) const { return points_.root[static_cast<std::size_t>(vertex)]; }
  int& set_of(int vertex) { return points_.sets[static_cast<std::size_t>(root_of(vertex))]; }

  void join(int vertex, int set) {
    const int joined = domains_.joined(set_of(vertex), set);
    if (joined == set_of(vertex)) return;
    set_of(vertex) = joined;
    const int root = root_of(vertex);
    if (std::exchange(queued_[static_cast<std::size_t>(root)], 1) == 0) queue_.push_back(root);
  }

  // Asks at once, on all threads, where the motions of each place take its vertices.
  void ask_images(const RunContext& context) {
    std::vector<std::vector<int>> vertices(of_place_.size());
    for (int v = 0; v < static_cast<int>(points_.root.size()); ++v) {
      if (root_of(v) != v) continue;
      for (const int place : domains_.set_places(set_of(v))) vertices[static_cast<std::size_t>(place)].push_back(v);
    }
    for (int place = 0; place < domains_.places(); ++place) {
      for (const Motion& motion : domains_.elements(place)) {
        VertexImages::Images& images = images_.of(motion);
        images.ask(vertices[static_cast<std::size_t>(place)], context);
        of_place_[static_cast<std::size_t>(place)].push_back(&images);
      }
    }
  }

  int image(int vertex, int place, int element) {
    return (*of_place_[static_cast<std::size_t>(place)][static_cast<std::size_t>(element)])(vertex);
  }

  // The vertices nearest to a position; others near it are there for themselves.
  std::vector<int> nearest_to(const Eigen::Vector3d& position) const {
    const auto distance = [&](int other) { return (mesh_.vertices.row(other).transpose() - position).norm(); };
    std::vector<int> near;
    double least = std::numeric_limits<double>::infinity();
    images_.grid().visit(position, [&](int other) {
      near.push_back(other);
      least = std::min(least, distance(other));
    });
    std::erase_if(near, [&](int other) { return distance(other) > least + rounding_; });
    return near;
  }

  // Where a place has one point alone at a position, that is meant, whichever way the surface faces there.
  bool lone_point(const std::vector<int>& vertices, int place) {
    constexpr int kNone = -1;
    int found = kNone;
    for (const int other : vertices) {
      if (found == root_of(other) || !domains_.holds(set_of(other), place)) continue;
      if (found != kNone) return false;
      found = root_of(other);
    }
    return found != kNone;
  }

  void carry(int vertex, int place, int element) {
    // Parts that touch have vertices at one place; their surfaces face different ways there.
    constexpr double kSameSide = 0.7;  // cosine: the corners of a part and of what it stands on are farther apart
    const int image = this->image(vertex, place, element);
    if (image == VertexImages::kNone) return;
    const int arrival = domains_.arrival(place, element);
    const int carried = domains_.carried_set(set_of(vertex), place, element);
    const Motion& motion = domains_.elements(place)[static_cast<std::size_t>(element)];
    const Eigen::Vector3d position = mesh_.vertices.row(vertex).transpose();
    const std::vector<int> near =
        image == VertexImages::kSeveral ? nearest_to(motion(position)) : std::vector<int>{image};
    if (std::ranges::any_of(near, [&](int other) { return set_of(other) == carried; })) return;
    const bool alone_there = lone_point(nearest_to(position), place) && lone_point(near, arrival);
    const Eigen::Vector3d turned = motion.linear * normals_.row(vertex).transpose();
    std::vector<int> met;
    for (const int other : near) {
      const bool meant = alone_there ? domains_.holds(set_of(other), arrival)
                                     : turned.dot(normals_.row(other).transpose()) > kSameSide;
      if (meant && domains_.comparable(set_of(other), carried)) met.push_back(other);
    }
    for (const int other : met) {
      join(other, carried);
      // The two are images of one another, also where the other's image has more vertices than this one.
      join(vertex, domains_.carried_set(set_of(other), arrival, domains_.inverse_element(place, element)));
    }
  }

  const Mesh& mesh_;
  const DomainMap& domains_;
  VertexImages& images_;
  std::vector<std::vector<VertexImages::Images*>> of_place_;  // by place and element
  Points normals_;
  double rounding_;
  PointSets points_;
  std::vector<int> queue_;  // roots
  std::vector<char> queued_;
};

}  // namespace

std::vector<int> closed_sets_of_vertices(const Mesh& mesh, const DomainMap& domains, VertexImages& images,
                                         const RunContext& context) {
  PointSets points = point_sets(mesh, domains);
  bool partial = false;
  for (int place = 0; place < domains.places(); ++place) partial = partial || !domains.whole(place);
  if (!partial) return by_vertex(points);
  return by_vertex(SetClosure(mesh, domains, images, std::move(points)).run(context));
}

}  // namespace orbifit
