#include "basis/vertex_orbits.h"

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <optional>

#include "domains/vertex_sets.h"
#include "geometry/space_order.h"
#include "geometry/vertex_grid.h"

namespace orbifit {

namespace {

// Of many points the first, and those that stand out most from it, from the line through both, and from the plane
// through the three: what is affine in the position and holds there holds at all of them.
std::vector<Eigen::Vector3d> spanning_points(const std::vector<Eigen::Vector3d>& points, double tolerance) {
  std::vector<Eigen::Vector3d> result{points.front()};
  Eigen::Matrix3d across = Eigen::Matrix3d::Identity();  // takes away the directions that are spanned
  while (result.size() < 4) {
    const auto height = [&](const Eigen::Vector3d& point) { return (across * (point - points.front())).norm(); };
    const auto farthest = std::ranges::max_element(points, {}, height);
    if (!(height(*farthest) > tolerance)) break;
    const Eigen::Vector3d direction = (across * (*farthest - points.front())).normalized();
    across -= direction * direction.transpose() * across;
    result.push_back(*farthest);
  }
  return result;
}

// Representatives next to one another share samples, which makes the lift's lists short.
VertexOrbits in_space_order(VertexOrbits orbits) {
  const auto count = static_cast<std::size_t>(orbits.representatives());
  if (count == 0) return orbits;
  const std::vector<int> order = space_order(orbits.positions);
  VertexOrbits result;
  result.tolerance = orbits.tolerance;
  result.turns = std::move(orbits.turns);
  result.bindings = std::move(orbits.bindings);
  result.images_are_vertices = orbits.images_are_vertices;
  result.positions.resize(static_cast<Eigen::Index>(count), 3);
  result.point_words.reserve(orbits.point_words.size());
  result.point_sets.reserve(orbits.point_sets.size());
  std::vector<int> place(count);
  for (std::size_t r = 0; r < count; ++r) {
    const auto from = static_cast<std::size_t>(order[r]);
    place[from] = static_cast<int>(r);
    result.positions.row(static_cast<Eigen::Index>(r)) = orbits.positions.row(order[r]);
    result.bound.push_back(orbits.bound[from]);
    result.first_point.push_back(static_cast<std::int64_t>(result.point_words.size()));
    for (auto k = orbits.first_point[from]; k < orbits.first_point[from + 1]; ++k) {
      result.point_words.push_back(orbits.point_words[static_cast<std::size_t>(k)]);
      result.point_sets.push_back(orbits.point_sets[static_cast<std::size_t>(k)]);
    }
  }
  result.first_point.push_back(static_cast<std::int64_t>(result.point_words.size()));
  result.followers = std::move(orbits.followers);
  for (VertexOrbits::Follower& follower : result.followers) {
    follower.representative = place[static_cast<std::size_t>(follower.representative)];
  }
  return result;
}

class OrbitBuilder {
 public:
  OrbitBuilder(const Mesh& mesh, const RegionMap& regions, GroupWords& words, const VertexGrid& grid,
               const std::vector<int>& sets, double tolerance)
      : mesh_(mesh), regions_(regions), words_(words), grid_(grid), sets_(sets) {
    closure_.doublet = tolerance;
    result_.tolerance = tolerance;
    result_.followers.assign(sets_.size(), {-1, 0, -1});
    for (std::size_t v = 0; v < sets_.size(); ++v) {
      continuous_ = continuous_ || continuum_of(sets_[v]) >= 0;
      if (continuous_) break;
    }
  }

  VertexOrbits run(const RunContext& context) {
    closure_.context = &context;
    if (continuous_) find_canonical_places();
    std::size_t done = 0;
    for (const int v : in_order()) {
      if (done % 4096 == 0) context.progress("vertex orbits", double(done) / double(sets_.size()));
      if (result_.followers[static_cast<std::size_t>(v)].representative < 0) add_orbit(v);
      ++done;
    }
    add_bound_points();
    result_.first_point.push_back(static_cast<std::int64_t>(result_.point_words.size()));
    result_.positions.resize(static_cast<Eigen::Index>(positions_.size()), 3);
    for (std::size_t i = 0; i < positions_.size(); ++i)
      result_.positions.row(static_cast<Eigen::Index>(i)) = positions_[i];
    return in_space_order(std::move(result_));
  }

 private:
  // Vertices of one circle may lie in more places and in fewer: those in more come first, since what they keep keeps
  // the others' groups as well.
  std::vector<int> in_order() const {
    std::vector<int> order(sets_.size());
    std::iota(order.begin(), order.end(), 0);
    if (continuous_) {
      std::ranges::stable_sort(order, std::greater<>(),
                               [&](int v) { return regions_.set_places(sets_[static_cast<std::size_t>(v)]).size(); });
    }
    return order;
  }

  int continuum_of(int set) const {
    int chosen = -1;
    for (const int place : regions_.set_places(set)) {
      const Continuum* continuum = regions_.continuum(place);
      if (continuum != nullptr && (chosen < 0 || continuum->spherical)) chosen = place;
    }
    return chosen;
  }

  // Vertices under continuous groups are looked for by their canonical places.
  void find_canonical_places() {
    canonical_.vertices = mesh_.vertices;
    turn_of_vertex_.assign(sets_.size(), -1);
    for (std::size_t v = 0; v < sets_.size(); ++v) {
      const int place = continuum_of(sets_[v]);
      if (place < 0) continue;
      const Continuum& continuum = *regions_.continuum(place);
      const Eigen::Vector3d position = mesh_.vertices.row(static_cast<Eigen::Index>(v)).transpose();
      const Motion turn = continuum.turn_to(position);
      Eigen::Vector3d there = inverse(turn)(position);
      if (continuum.distance(there) < closure_.doublet) there = continuum.foot(there);
      canonical_.vertices.row(static_cast<Eigen::Index>(v)) = there;
      turn_of_vertex_[v] = static_cast<int>(result_.turns.size());
      result_.turns.push_back({place, turn});
    }
    canonical_grid_.emplace(canonical_.vertices, result_.tolerance);
  }

  void add_orbit(int vertex) {
    const auto v = static_cast<std::size_t>(vertex);
    const int number = static_cast<int>(positions_.size());
    const Orbit orbit = snapped_orbit_of(mesh_.vertices.row(vertex).transpose(), sets_[v], regions_, words_, closure_);
    result_.first_point.push_back(static_cast<std::int64_t>(result_.point_words.size()));
    positions_.push_back(orbit.points.front().position);
    for (const OrbitPoint& point : orbit.points) {
      result_.point_words.push_back(point.word);
      result_.point_sets.push_back(point.set);
      const bool turned = continuum_of(point.set) >= 0;
      bool met = false;
      const VertexGrid& grid = turned ? *canonical_grid_ : grid_;
      bool same_only = !turned;  // on a circle vertices may lie in more places than the point
      grid.visit(point.position,
                 [&](int other) { same_only = same_only || sets_[static_cast<std::size_t>(other)] == point.set; });
      const auto follow = [&](int other) {
        const auto w = static_cast<std::size_t>(other);
        if (continuous_ && (turn_of_vertex_[w] >= 0) != turned) return;
        if (sets_[w] != point.set && (same_only || !regions_.comparable(sets_[w], point.set))) return;
        met = true;
        if (result_.followers[w].representative >= 0) return;
        result_.followers[w] = {number, point.word, continuous_ ? turn_of_vertex_[w] : -1};
      };
      grid.visit(point.position, follow);
      result_.images_are_vertices = result_.images_are_vertices && met;
    }
    if (result_.followers[v].representative < 0) {  // a rounding's width off its own canonical place
      result_.followers[v] = {number, 0, continuous_ ? turn_of_vertex_[v] : -1};
    }
    result_.bound.push_back(binding(orbit));
  }

  int binding(const Orbit& orbit) {
    if (orbit.constraints.empty()) return -1;
    std::vector<WordPair> pairs;
    for (const OrbitConstraint& constraint : orbit.constraints) {
      pairs.push_back({orbit.points[static_cast<std::size_t>(constraint.point)].word, constraint.word});
    }
    std::ranges::sort(pairs);
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    const auto [entry, added] = bindings_.try_emplace(pairs, static_cast<int>(result_.bindings.size()));
    if (added) {
      result_.bindings.push_back({orbit.points.front().position, pairs});
      bound_points_.emplace_back();
    }
    bound_points_[static_cast<std::size_t>(entry->second)].push_back(orbit.points.front().position);
    return entry->second;
  }

  // Groups that turn ask something else of each point; what they ask is affine in its position.
  void add_bound_points() {
    for (std::size_t i = 0; i < bound_points_.size(); ++i) {
      const std::vector<Eigen::Vector3d> points = spanning_points(bound_points_[i], closure_.doublet);
      for (std::size_t k = 1; k < points.size(); ++k) {
        result_.bindings.push_back({points[k], result_.bindings[i].words});
      }
    }
  }

  const Mesh& mesh_;
  const RegionMap& regions_;
  GroupWords& words_;
  const VertexGrid& grid_;
  const std::vector<int>& sets_;
  ClosureOptions closure_;
  VertexOrbits result_;
  bool continuous_ = false;
  Mesh canonical_;
  std::optional<VertexGrid> canonical_grid_;
  std::vector<int> turn_of_vertex_;
  std::vector<Eigen::Vector3d> positions_;
  std::map<std::vector<WordPair>, int> bindings_;
  std::vector<std::vector<Eigen::Vector3d>> bound_points_;  // of each binding
};

}  // namespace

VertexOrbits vertex_orbits(const Mesh& mesh, const RegionMap& regions, GroupWords& words, double tolerance,
                           std::vector<int>& known_sets, const RunContext& context) {
  VertexImages images(mesh.vertices, tolerance);
  if (known_sets.empty()) known_sets = closed_sets_of_vertices(mesh, regions, images, context);
  return OrbitBuilder(mesh, regions, words, images.grid(), known_sets, tolerance).run(context);
}

int set_of_vertex(const VertexOrbits& orbits, int vertex) {
  const VertexOrbits::Follower& follower = orbits.followers[static_cast<std::size_t>(vertex)];
  const auto r = static_cast<std::size_t>(follower.representative);
  for (auto k = orbits.first_point[r]; k < orbits.first_point[r + 1]; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (orbits.point_words[at] == follower.word) return orbits.point_sets[at];
  }
  return orbits.point_sets[static_cast<std::size_t>(orbits.first_point[r])];
}

std::vector<VertexOrbits::Offset> follower_offsets(const Mesh& mesh, const RegionMap& regions,
                                                   const VertexOrbits& orbits, const GroupWords& words) {
  std::vector<VertexOrbits::Offset> result;
  result.reserve(orbits.followers.size());
  for (int v = 0; v < static_cast<int>(orbits.followers.size()); ++v) {
    const VertexOrbits::Follower& follower = orbits.followers[static_cast<std::size_t>(v)];
    Eigen::Vector3d place = words.motion(follower.word)(orbits.positions.row(follower.representative).transpose());
    if (follower.turn >= 0) place = orbits.turns[static_cast<std::size_t>(follower.turn)].motion(place);
    result.push_back({mesh.vertices.row(v).transpose() - place, innermost_region(regions, set_of_vertex(orbits, v))});
  }
  return result;
}

VertexOrbits lone_vertices(const Mesh& mesh) {
  VertexOrbits result;
  const auto count = static_cast<std::size_t>(mesh.vertices.rows());
  result.tolerance = 1e-6 * diagonal(mesh.vertices);
  result.positions = mesh.vertices;
  result.bound.assign(count, -1);
  result.point_words.assign(count, 0);
  result.point_sets.assign(count, 0);
  for (std::size_t v = 0; v < count; ++v) {
    result.followers.push_back({static_cast<int>(v), 0, -1});
    result.first_point.push_back(static_cast<std::int64_t>(v));
  }
  result.first_point.push_back(static_cast<std::int64_t>(count));
  return in_space_order(std::move(result));
}

}  // namespace orbifit
