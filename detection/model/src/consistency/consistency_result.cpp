// What is left of a consistency search: verified once more, its shapes made clean.

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "consistency/consistency_search.h"

namespace orbifit {

// A last look at all pairs. \return whether anything had to go
bool ConsistencySearch::drop_contradictions() {
  for (const Move& move : moves_) {
    context_.check();
    for (std::size_t j = 0; j < regions_.size(); ++j) {
      const KnownRegion& known = regions_[j];
      if (known.state != State::placed || !shapes_.touch(known.shape, move.domain)) continue;
      const bool meets = shapes_.meet(known.shape, move.domain);
      if (!meets && move.turning && !known.place->group.continuous()) continue;
      if (meets && shapes_.within(move.domain, known.shape) && !shapes_.within(known.shape, move.domain)) continue;
      bool has_image = false;
      if (move.turning) {
        const GroupPlace turning = turning_part(*regions_[static_cast<std::size_t>(move.region)].place);
        has_image = std::ranges::all_of(marks(*known.place), [&](const Motion& mark) {
          return group_distance(turning, mark, turning, extent(j)) <= 10 * rounding_;
        });
      }
      for (std::size_t k = 0; k < regions_.size() && !has_image && !move.turning; ++k) {
        const KnownRegion& other = regions_[k];
        if (other.state != State::placed || !shapes_.touch(other.shape, move.arrival)) continue;
        if (group_distance(*known.place, move.motion, *other.place, extent(k)) > 10 * rounding_) continue;
        has_image = (meets ? shapes_.arrived(known.shape, move.domain, move.motion, other.shape, move.arrival)
                           : shapes_.arrived(known.shape, known.shape, move.motion, other.shape, other.shape)) >= 0.5;
      }
      if (has_image || (meets && move.region >= 0 && follows(j, static_cast<std::size_t>(move.region), true))) continue;
      const Claim mover = mover_of(move);
      const bool mover_is_less = mover.pattern ? !preferred_.contains(mover.number) && saving(mover) < saving(j)
                                               : shapes_.area(move.domain) < shapes_.area(known.shape);
      const std::string reason = "it overlaps " + (mover_is_less ? label(j) : name_of(move)) +
                                 ", and the one's group has no image of the other";
      const Claim loser = mover_is_less ? mover : Claim{false, j};
      if (!loser.pattern && regions_[loser.number].source >= 0) {
        regions_[loser.number].state = State::out;
      } else {
        refuse({loser}, {reason, {mover_is_less ? Claim{false, j} : mover}});
      }
      return true;
    }
  }
  return false;
}

// Whether the groups around leave a pattern where it is.
bool ConsistencySearch::stands(const KnownPattern& known) const {
  KnownPattern fitted = known;
  if (known.shapes.size() < 2 || fit_pattern(fitted)) return false;
  const Extent& extent = shapes_.extent(known.shapes[0]);
  for (std::size_t t = 0; t < known.shapes.size(); ++t) {
    const Motion& before = known.pattern.instances[t].motion;
    const Motion& now = fitted.pattern.instances[t].motion;
    if (motion_distance(before, now, extent.centre, extent.reach) > rounding_) return false;
  }
  return true;
}

bool ConsistencySearch::agrees() {
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    KnownRegion& known = regions_[i];
    if (!known.place || !stands_at(known.region, *known.place, extent(i), rounding_)) return false;
    known.state = State::placed;
    add_moves_of_region(i);
  }
  for (const KnownPattern& known : patterns_) {
    if (!stands(known)) return false;
  }
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    patterns_[i].state = State::placed;
    add_moves_of_pattern(i);
  }
  return !drop_contradictions();
}

// Of two that overlap by a sliver the smaller loses it, and what it has outside of one that holds all but a sliver of
// it: then each pair is disjoint, nested, or overlaps as the search has seen it. A region and an instance that are the
// same but for a sliver become the same, as they may be at the other instances.
void ConsistencySearch::trim_slivers() {
  struct Part {
    std::vector<int>* faces;
    double area;
    bool instance;
  };
  const Eigen::VectorXd areas = face_areas(mesh_);
  const auto area_of = [&](const std::vector<int>& faces) {
    double sum = 0;
    for (const int face : faces) sum += areas[face];
    return sum;
  };
  std::vector<Part> parts;
  for (KnownRegion& known : regions_) {
    if (known.state == State::placed) parts.push_back({&known.region.faces, area_of(known.region.faces), false});
  }
  for (KnownPattern& known : patterns_) {
    if (known.state != State::placed) continue;
    for (PatternInstance& instance : known.pattern.instances) {
      parts.push_back({&instance.faces, area_of(instance.faces), true});
    }
  }
  std::ranges::stable_sort(parts, std::greater<>(), &Part::area);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    context_.check();
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      std::vector<int> common;
      std::ranges::set_intersection(*parts[i].faces, *parts[j].faces, std::back_inserter(common));
      if (common.empty()) continue;
      const double shared = area_of(common);
      if (parts[i].instance != parts[j].instance && shared >= (1 - RegionShapes::kSliver) * parts[i].area) {
        *parts[i].faces = *parts[j].faces = std::move(common);
        continue;
      }
      if (common.size() == parts[j].faces->size()) continue;
      if (shared <= RegionShapes::kSliver * parts[j].area) {
        std::vector<int> rest;
        std::ranges::set_difference(*parts[j].faces, common, std::back_inserter(rest));
        *parts[j].faces = std::move(rest);
      } else if (shared >= (1 - RegionShapes::kSliver) * parts[j].area) {
        *parts[j].faces = std::move(common);
      }
    }
  }
}

// Of two regions that follow from larger groups where they meet, the one whose family is the lesser, or both of one
// family, keep of what they have in common, faces and vertices, only what lies in those groups' regions, and these
// nothing else.
void ConsistencySearch::trim_to_common(std::size_t a, std::size_t b) {
  const std::vector<std::size_t> holders = holding_both(a, b, true);
  std::vector<char> held(static_cast<std::size_t>(mesh_.faces.rows()), 0);
  const auto is_held = [&](int face) { return held[static_cast<std::size_t>(face)] != 0; };
  std::vector<int>& one = regions_[a].region.faces;
  std::vector<int>& other = regions_[b].region.faces;
  std::vector<int> common;
  std::ranges::set_intersection(one, other, std::back_inserter(common));
  for (const std::size_t holder : holders) {
    std::vector<int>& faces = regions_[holder].region.faces;
    std::vector<int> within;
    std::ranges::set_intersection(faces, common, std::back_inserter(within));
    faces = std::move(within);
    for (const int face : faces) held[static_cast<std::size_t>(face)] = 1;
  }
  using Vertices = std::vector<char>;  // by vertex: whether it is one of them
  const Vertices none(static_cast<std::size_t>(mesh_.vertices.rows()), 0);
  Vertices of_held = none;
  const auto vertices_beside = [&](const std::vector<int>& faces) {
    Vertices result = none;
    for (const int face : faces) {
      Vertices& to = is_held(face) ? of_held : result;
      for (const int vertex : mesh_.faces.row(face)) to[static_cast<std::size_t>(vertex)] = 1;
    }
    return result;
  };
  const Vertices beside_one = vertices_beside(one);
  const Vertices beside_other = vertices_beside(other);
  const auto where_they_touch = [&](int vertex) {
    const auto v = static_cast<std::size_t>(vertex);
    return beside_one[v] != 0 && beside_other[v] != 0 && of_held[v] == 0;
  };
  const auto trimmed = [&](std::vector<int>& faces) {
    std::erase_if(faces, [&](int face) {
      return !is_held(face) &&
             (std::ranges::binary_search(common, face) || std::ranges::any_of(mesh_.faces.row(face), where_they_touch));
    });
  };
  const std::size_t of_one = regions_[a].family;
  const std::size_t of_other = regions_[b].family;
  const auto size = [&](std::size_t family) { return shapes_.area(regions_[family].shape); };
  if (of_one == of_other || size(of_one) < size(of_other)) trimmed(one);
  if (of_one == of_other || size(of_one) >= size(of_other)) trimmed(other);
}

ConsistentAnnotation ConsistencySearch::result() {
  std::vector<std::pair<std::size_t, std::size_t>> following;
  for (std::size_t a = 0; a < regions_.size(); ++a) {
    for (std::size_t b = a + 1; b < regions_.size(); ++b) {
      if (regions_[a].state != State::placed || regions_[b].state != State::placed) continue;
      if (shapes_.meet(regions_[a].shape, regions_[b].shape) && follows(a, b, true)) following.emplace_back(a, b);
    }
  }
  trim_slivers();
  for (const auto& [a, b] : following) trim_to_common(a, b);
  ConsistentAnnotation result;
  result.annotation = annotation_;
  result.annotation.regions.clear();
  result.annotation.patterns.clear();
  int next_id = 0;
  for (const KnownRegion& known : regions_) {
    if (known.source < 0) next_id = std::max(next_id, known.region.id + 1);
  }
  for (KnownRegion& known : regions_) {
    if (known.state != State::placed) continue;
    if (known.source >= 0) {
      known.region.id = next_id++;
      ++result.added;
    }
    result.annotation.regions.push_back(known.region);
  }
  for (const KnownPattern& known : patterns_) {
    if (known.state == State::placed) result.annotation.patterns.push_back(known.pattern);
  }
  set_parents(result.annotation.regions);
  result.left_out = std::move(left_out_);
  result.largest_movement = largest_movement_ / diagonal_;
  return result;
}

}  // namespace orbifit
