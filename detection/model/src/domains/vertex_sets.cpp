#include "domains/vertex_sets.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace orbifit {

namespace {

// Sets are carried along by every motion of every place, vertex by vertex, until nothing changes.
class SetClosure {
 public:
  SetClosure(const Mesh& mesh, const DomainMap& domains, VertexImages& images)
      : mesh_(mesh),
        domains_(domains),
        images_(images),
        of_place_(static_cast<std::size_t>(domains.places())),
        rounding_(kSamePosition * diagonal(mesh.vertices)),
        points_(domains.points()),
        queued_(points_.roots.size(), 0) {}

  PointSets run(const RunContext& context) {
    ask_images(context);
    for (std::size_t v = 0; v < points_.roots.size(); ++v) {
      if (points_.roots[v] != static_cast<int>(v)) continue;
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
  int root_of(int vertex) const { return points_.roots[static_cast<std::size_t>(vertex)]; }
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
    for (int v = 0; v < static_cast<int>(points_.roots.size()); ++v) {
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
    if (image != VertexImages::kSeveral && set_of(image) == carried) return;
    const Motion& motion = domains_.elements(place)[static_cast<std::size_t>(element)];
    const Eigen::Vector3d position = mesh_.vertices.row(vertex).transpose();
    const std::vector<int> near =
        image == VertexImages::kSeveral ? nearest_to(motion(position)) : std::vector<int>{image};
    if (std::ranges::any_of(near, [&](int other) { return set_of(other) == carried; })) return;
    const bool alone_there = lone_point(nearest_to(position), place) && lone_point(near, arrival);
    if (normals_.rows() == 0) normals_ = vertex_normals(mesh_);
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
  Points normals_;                                            // of the vertices, once they are asked for
  double rounding_;
  PointSets points_;
  std::vector<int> queue_;  // roots
  std::vector<char> queued_;
};

}  // namespace

std::vector<int> closed_sets_of_vertices(const Mesh& mesh, const DomainMap& domains, VertexImages& images,
                                         const RunContext& context) {
  bool partial = false;
  for (int place = 0; place < domains.places(); ++place) partial = partial || !domains.whole(place);
  if (!partial) return by_vertex(domains.points());
  return by_vertex(SetClosure(mesh, domains, images).run(context));
}

}  // namespace orbifit
