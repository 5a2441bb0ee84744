#include "consistency/closed_borders.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "consistency/consistency_search.h"
#include "domains/domain_map.h"
#include "domains/vertex_images.h"
#include "domains/vertex_sets.h"

namespace orbifit {

namespace {

// Places of which one is to give up its faces around a vertex; of one alone, both are the same.
struct Conflict {
  int vertex, image;  // by the motion of the place that makes it
  int place, other;
};

class BorderCheck {
 public:
  BorderCheck(const Mesh& mesh, const DomainMap& domains, VertexImages& images, const RunContext& context)
      : mesh_(mesh),
        domains_(domains),
        images_(images),
        context_(context),
        sets_(closed_sets_of_vertices(mesh, domains, images, context)),
        of_place_(static_cast<std::size_t>(domains.places())) {
    for (int place = 0; place < domains.places(); ++place) {
      for (const Motion& motion : domains.elements(place)) {
        of_place_[static_cast<std::size_t>(place)].push_back(&images.of(motion));
      }
    }
  }

  std::vector<Conflict> run() {
    for (int vertex = 0; vertex < static_cast<int>(sets_.size()); ++vertex) {
      if (vertex % 1024 == 0) context_.check();
      const std::vector<int> places = domains_.set_places(set_of(vertex));
      if (places.size() == 1 && domains_.whole(places.front())) continue;
      for (const auto& [a, b] : unclosed(set_of(vertex))) result_.push_back({vertex, vertex, a, b});
      for (const int place : places) {
        for (int e = 0; e < static_cast<int>(domains_.elements(place).size()); ++e) follow(vertex, place, e);
      }
    }
    return std::move(result_);
  }

 private:
  int set_of(int vertex) const { return sets_[static_cast<std::size_t>(vertex)]; }

  const std::vector<std::pair<int, int>>& unclosed(int set) {
    const auto [known, added] = unclosed_.try_emplace(set);
    if (added) known->second = domains_.unclosed(set);
    return known->second;
  }

  // The sets of the points that a place has at a position, with a vertex of each.
  std::map<int, int> sets_at(const Eigen::Vector3d& position, int place) const {
    std::map<int, int> result;
    images_.grid().visit(position, [&](int vertex) {
      if (domains_.holds(set_of(vertex), place)) result.try_emplace(set_of(vertex), vertex);
    });
    return result;
  }

  void follow(int vertex, int place, int element) {
    const int at = (*of_place_[static_cast<std::size_t>(place)][static_cast<std::size_t>(element)])(vertex);
    if (at == VertexImages::kNone) return;
    const Eigen::Vector3d position = mesh_.vertices.row(vertex).transpose();
    const int carried = domains_.carried_set(set_of(vertex), place, element);
    const int arrival = domains_.arrival(place, element);
    std::map<int, int> there;
    if (at == VertexImages::kSeveral) {
      there = sets_at(domains_.elements(place)[static_cast<std::size_t>(element)](position), arrival);
    } else if (set_of(at) != carried && domains_.holds(set_of(at), arrival)) {
      there = {{set_of(at), at}};
    }
    if (there.size() != 1 || there.contains(carried)) return;  // of several, which is meant is not known
    const int only = there.begin()->first;
    const int image = there.begin()->second;
    if (domains_.contains(only, carried)) {
      // Of parts that touch, the place has another here, whose image that is.
      const bool others = std::ranges::any_of(sets_at(position, place), [&](const auto& other) {
        return other.first != set_of(vertex) && domains_.carried_set(other.first, place, element) == only;
      });
      if (others) result_.push_back({vertex, image, place, place});
      return;
    }
    for (const int other : domains_.set_places(set_of(vertex))) {
      const std::vector<int> images = domains_.images_of(other, place, element);
      if (std::ranges::all_of(images, [&](int each) { return domains_.holds(only, each); })) continue;
      result_.push_back({vertex, image, place, other});
    }
  }

  const Mesh& mesh_;
  const DomainMap& domains_;
  VertexImages& images_;
  const RunContext& context_;
  std::vector<int> sets_;
  std::vector<std::vector<VertexImages::Images*>> of_place_;  // by place and element
  std::map<int, std::vector<std::pair<int, int>>> unclosed_;  // of each set seen
  std::vector<Conflict> result_;
};

std::vector<int> faces_around(const Mesh& mesh, const std::vector<int>& faces, const std::set<int>& vertices) {
  std::vector<int> result;
  std::ranges::copy_if(faces, std::back_inserter(result), [&](int face) {
    return std::ranges::any_of(mesh.faces.row(face), [&](int vertex) { return vertices.contains(vertex); });
  });
  return result;
}

// What a place would give up.
struct Loss {
  int place;
  std::vector<int> faces;
};

// The place that loses the smallest share of its faces where it gives up those around its conflicts; none where each
// would lose too much, and is left as it is.
std::optional<Loss> least_loss(const Mesh& mesh, const std::vector<std::vector<int>*>& faces, const DomainMap& domains,
                               const std::vector<Conflict>& conflicts) {
  std::map<int, std::set<int>> vertices;  // by place
  for (const Conflict& conflict : conflicts) {
    for (const int place : {conflict.place, conflict.other}) vertices[place].insert(conflict.vertex);
  }
  double least = 1 - ConsistencyPolicy{}.left;
  std::optional<Loss> result;
  for (const auto& [place, around] : vertices) {
    if (domains.whole(place) || domains.continuum(place) != nullptr) continue;
    const std::vector<int>& own = *faces[static_cast<std::size_t>(place)];
    std::vector<int> given = faces_around(mesh, own, around);
    const double share = static_cast<double>(given.size()) / static_cast<double>(own.size());
    if (given.empty() || share >= least) continue;
    least = share;
    result = {place, std::move(given)};
  }
  return result;
}

}  // namespace

bool close_borders(const ShapeSurface& surface, SymmetryAnnotation& annotation, const RunContext& context) {
  const Mesh& mesh = surface.mesh;
  std::vector<std::vector<int>*> faces;  // of each place
  for (Region& region : annotation.regions) faces.push_back(&region.faces);
  for (Pattern& pattern : annotation.patterns) {
    for (PatternInstance& instance : pattern.instances) faces.push_back(&instance.faces);
  }
  bool any = false;
  while (true) {
    const DomainMap& domains = surface.domains.of(annotation);
    std::vector<Conflict> conflicts = BorderCheck(mesh, domains, surface.vertex_images, context).run();
    bool taken = false;
    while (const std::optional<Loss> loss = least_loss(mesh, faces, domains, conflicts)) {
      taken = true;
      std::vector<int>& losing = *faces[static_cast<std::size_t>(loss->place)];
      std::vector<int> rest;
      std::ranges::set_difference(losing, loss->faces, std::back_inserter(rest));
      losing = std::move(rest);
      // Whether others are still in conflict there, another look will tell.
      const std::vector<int> around = vertices_of_faces(mesh, loss->faces);
      std::erase_if(conflicts, [&](const Conflict& conflict) {
        return conflict.place == loss->place || conflict.other == loss->place ||
               std::ranges::binary_search(around, conflict.vertex) ||
               std::ranges::binary_search(around, conflict.image);
      });
    }
    if (!taken) return any;
    any = true;
  }
}

}  // namespace orbifit
