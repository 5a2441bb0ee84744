#include "consistency/closed_borders.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <vector>

#include "consistency/consistency_search.h"
#include "domains/closed_sets.h"
#include "domains/domain_map.h"
#include "domains/vertex_sets.h"
#include "geometry/vertex_grid.h"

namespace orbifit {

namespace {

// Of each place the vertices around which it cannot be kept.
using Conflicts = std::vector<std::set<int>>;

class BorderCheck {
 public:
  BorderCheck(const Mesh& mesh, const DomainMap& domains, const RunContext& context)
      : mesh_(mesh),
        domains_(domains),
        context_(context),
        grid_(mesh.vertices, kDoublet * diagonal(mesh.vertices)),
        sets_(closed_sets_of_vertices(mesh, domains, grid_)),
        result_(static_cast<std::size_t>(domains.places())) {}

  Conflicts run() {
    for (int vertex = 0; vertex < static_cast<int>(sets_.size()); ++vertex) {
      if (vertex % 1024 == 0) context_.check();
      const std::vector<int> places = domains_.set_places(set_of(vertex));
      if (places.size() == 1 && domains_.whole(places.front())) continue;
      for (const int place : places) {
        for (int e = 0; e < static_cast<int>(domains_.elements(place).size()); ++e) follow(vertex, place, e);
      }
    }
    return std::move(result_);
  }

 private:
  int set_of(int vertex) const { return sets_[static_cast<std::size_t>(vertex)]; }

  // The sets of the points that a place has at a position.
  std::set<int> sets_at(const Eigen::Vector3d& position, int place) const {
    std::set<int> result;
    grid_.visit(position, [&](int vertex) {
      if (domains_.holds(set_of(vertex), place)) result.insert(set_of(vertex));
    });
    return result;
  }

  void follow(int vertex, int place, int element) {
    const Eigen::Vector3d position = mesh_.vertices.row(vertex).transpose();
    const int carried = domains_.carried_set(set_of(vertex), place, element);
    const int arrival = domains_.arrival(place, element);
    const std::set<int> there = sets_at(domains_.elements(place)[static_cast<std::size_t>(element)](position), arrival);
    if (there.size() != 1 || there.contains(carried)) return;  // of several, which is meant is not known
    const int only = *there.begin();
    if (domains_.contains(only, carried)) {
      // Of parts that touch, the place has another here, whose image that is.
      const bool others = std::ranges::any_of(sets_at(position, place), [&](int other) {
        return other != set_of(vertex) && domains_.carried_set(other, place, element) == only;
      });
      if (others) result_[static_cast<std::size_t>(place)].insert(vertex);
      return;
    }
    for (const int other : domains_.set_places(set_of(vertex))) {
      const std::vector<int> images = domains_.images_of(other, place, element);
      if (std::ranges::all_of(images, [&](int image) { return domains_.holds(only, image); })) continue;
      for (const int either : {place, other}) result_[static_cast<std::size_t>(either)].insert(vertex);
    }
  }

  const Mesh& mesh_;
  const DomainMap& domains_;
  const RunContext& context_;
  VertexGrid grid_;
  std::vector<int> sets_;
  Conflicts result_;
};

std::vector<int> faces_around(const Mesh& mesh, const std::vector<int>& faces, const std::set<int>& vertices) {
  std::vector<int> result;
  std::ranges::copy_if(faces, std::back_inserter(result), [&](int face) {
    return std::ranges::any_of(mesh.faces.row(face), [&](int vertex) { return vertices.contains(vertex); });
  });
  return result;
}

}  // namespace

bool close_borders(const Mesh& mesh, SymmetryAnnotation& annotation, const RunContext& context) {
  std::vector<std::vector<int>*> faces;  // of each place
  for (Region& region : annotation.regions) faces.push_back(&region.faces);
  for (Pattern& pattern : annotation.patterns) {
    for (PatternInstance& instance : pattern.instances) faces.push_back(&instance.faces);
  }
  bool any = false;
  while (true) {
    const DomainMap domains(mesh, annotation, instance_motions(annotation));
    const Conflicts conflicts = BorderCheck(mesh, domains, context).run();
    double least = 1 - ConsistencyPolicy{}.left;  // what would lose more is left as it is
    std::vector<int> taken;
    std::size_t loser = 0;
    for (std::size_t place = 0; place < faces.size(); ++place) {
      const auto number = static_cast<int>(place);
      if (conflicts[place].empty() || domains.whole(number) || domains.continuum(number) != nullptr) continue;
      std::vector<int> around = faces_around(mesh, *faces[place], conflicts[place]);
      const double share = static_cast<double>(around.size()) / static_cast<double>(faces[place]->size());
      if (around.empty() || share >= least) continue;
      least = share;
      taken = std::move(around);
      loser = place;
    }
    if (taken.empty()) return any;
    any = true;
    std::vector<int> rest;
    std::ranges::set_difference(*faces[loser], taken, std::back_inserter(rest));
    *faces[loser] = std::move(rest);
  }
}

}  // namespace orbifit
