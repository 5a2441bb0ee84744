// A family placed where all that is asked of it holds, or trimmed until it can be, or refused.

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "consistency/consistency_search.h"
#include "consistency/halvings.h"

namespace orbifit {

namespace {

// The region with its group at `place`, as it was but for that.
Region at_place(const Region& region, const GroupPlace& place, double movement) {
  Region result = make_region(place.group, place.centre, place.frame, region.faces, region.name);
  result.id = region.id;
  result.residual = {region.residual.rms + movement, region.residual.max + movement};
  return result;
}

}  // namespace

// Directions of the rows within a region that are far more exact than the region's own group.
std::vector<Eigen::Vector3d> ConsistencySearch::exact_steps(std::size_t region) const {
  std::vector<Eigen::Vector3d> result;
  const KnownRegion& known = regions_[region];
  for (const KnownPattern& pattern : patterns_) {
    if (pattern.state != State::waiting ||
        pattern.pattern.residual.max > policy_.far_more_exact * known.region.residual.max)
      continue;
    if (std::ranges::count_if(pattern.shapes, [&](int shape) { return shapes_.within(shape, known.shape); }) < 2)
      continue;
    for (const Motion& step : pattern.pattern.generators) {
      const bool translation = (step.linear - Eigen::Matrix3d::Identity()).norm() < 1e-9;
      if (translation && step.translation.norm() > 0) result.push_back(step.translation.normalized());
    }
  }
  return result;
}

// Places the first where all that is asked holds, and the others as its images.
ConsistencySearch::Verdict ConsistencySearch::accept_family(const Family& family) {
  const std::size_t first = family.members.front().region;
  const GroupPlace start = *regions_[first].place;
  std::vector<GroupPlace> wanted;
  for (const Member& member : family.members) {
    if (member.region == first || regions_[member.region].source >= 0) continue;
    wanted.push_back(image_of(*regions_[member.region].place, inverse(member.way)));
  }
  const double near = length(policy_.same_group);
  const std::vector<Eigen::Vector3d> steps = exact_steps(first);
  auto fit = fitted_place(start, wanted, family.ties, extent(first), near, steps);
  if (!steps.empty() && !(fit && fit->unmet <= rounding_)) {
    fit = fitted_place(start, wanted, family.ties, extent(first), near);
  }
  if (!fit) return Refusal{"its group is not the one that larger groups take it to", family.asking};
  if (!(fit->unmet <= rounding_)) {
    return Refusal{"its placement cannot agree with those of larger regions", family.asking};
  }
  std::vector<GroupPlace> places;
  for (const Member& member : family.members) {
    places.push_back(image_of(fit->place, member.way));
    const KnownRegion& known = regions_[member.region];
    if (known.source >= 0) continue;
    const double moved = group_distance(*known.place, Motion{}, places.back(), extent(member.region));
    if (moved > length(policy_.movement)) {
      return Refusal{"to agree with larger regions it would have to move by " +
                         std::to_string(100 * moved / diagonal_).substr(0, 5) + " % of the diagonal",
                     family.asking};
    }
  }
  for (std::size_t k = 0; k < family.members.size(); ++k) {
    const KnownRegion& known = regions_[family.members[k].region];
    if (known.source >= 0 ||
        group_distance(*known.place, Motion{}, places[k], extent(family.members[k].region)) <= 0.2 * tolerance_)
      continue;
    const double before = shapes_.kept(known.shape, members(*known.place), tolerance_);
    if (shapes_.kept(known.shape, members(places[k]), tolerance_) < before - (1 - policy_.kept)) {
      return Refusal{"where it agrees with larger regions it does not fit its surface", family.asking};
    }
  }
  for (std::size_t k = 0; k < family.members.size(); ++k) {
    KnownRegion& known = regions_[family.members[k].region];
    known.state = State::placed;
    known.family = first;
    const Extent& around = extent(family.members[k].region);
    const double moved = group_distance(*known.place, Motion{}, places[k], around);
    if (known.source < 0 && moved <= rounding_ && stands_at(known.region, places[k], around, rounding_)) continue;
    if (known.source < 0) largest_movement_ = std::max(largest_movement_, moved);
    known.place = places[k];
    known.region = at_place(known.region, places[k], known.source < 0 ? moved / diagonal_ : 0);
  }
  return std::nullopt;
}

// Of two regions that overlap the later one gives up what the former takes of it, to the last vertex, or what it has
// outside of that, whichever is less, with all its images. \return whether enough is left
bool ConsistencySearch::trim(std::size_t region, int other) {
  KnownRegion& known = regions_[region];
  const std::vector<int>& own = shapes_.faces(known.shape);
  const bool inner = shapes_.common_area(known.shape, other) > 0.5 * shapes_.area(known.shape);
  std::vector<int> taken;
  if (inner) {
    std::ranges::set_difference(own, shapes_.faces(other), std::back_inserter(taken));
  } else {
    taken = shapes_.faces_at(known.shape, other);
  }
  if (taken.empty() || taken.size() == own.size()) return false;
  std::vector<int> rest = shapes_.without_orbit(known.shape, taken, *known.place);
  const int trimmed = shapes_.add(rest);
  const double given = shapes_.area(static_cast<int>(region));  // shapes of regions come first, in their order
  if (shapes_.area(trimmed) < policy_.left * given || shapes_.area(trimmed) >= shapes_.area(known.shape)) {
    shapes_.keep(trimmed);
    return false;
  }
  known.shape = trimmed;
  known.region.faces = std::move(rest);
  return true;
}

// Where one of a family gave something up, all give up its images. \return whether enough is left of each
bool ConsistencySearch::trim_alike(const Family& family) {
  const auto left = [&](std::size_t region, std::vector<int> faces) {
    const int before = regions_[region].shape;
    const int after = shapes_.add(faces);
    regions_[region].shape = after;
    regions_[region].region.faces = std::move(faces);
    return shapes_.area(after) >= policy_.kept * shapes_.area(before);
  };
  const std::size_t first = family.members.front().region;
  for (const Member& member : family.members) {
    const int shape = regions_[member.region].shape;
    const int own = regions_[first].shape;
    if (!left(first, shapes_.image_faces(shape, shape, inverse(member.way), own))) return false;
  }
  for (const Member& member : family.members) {
    const int own = regions_[first].shape;
    if (!left(member.region, shapes_.image_faces(own, own, member.way, regions_[member.region].shape))) return false;
  }
  return true;
}

// What a family gave up counts as refused: without what takes it, all of it could be kept.
void ConsistencySearch::note_given_up(const Family& family, const std::vector<Claim>& takers) {
  Refused refused{{}, "it gives up what others take of it", 0, against(takers), {}};
  for (const Member& member : family.members) {
    if (regions_[member.region].source >= 0) continue;
    refused.claims.push_back({false, member.region});
    const KnownRegion& known = regions_[member.region];
    const double before =
        shapes_.area(static_cast<int>(member.region));  // shapes of regions come first, in their order
    refused.saving += before * halvings(known.region.group) - saving(member.region);
  }
  if (refused.saving > 0) refused_.push_back(std::move(refused));
}

// Lets all members give up the same; what is left of them is looked at once more. \return whether it is enough
bool ConsistencySearch::give_up_alike(const Family& family, std::size_t regions_before, int shapes_before,
                                      GivenUp& given_up) {
  std::vector<std::size_t> members;
  for (const Member& member : family.members) {
    if (member.region >= regions_before) continue;
    members.push_back(member.region);
    given_up.remember(member.region, regions_[member.region]);
  }
  given_up.alike = trim_alike(family);
  regions_.resize(regions_before);
  shapes_.keep(shapes_before);
  if (!given_up.alike) return false;
  for (const std::size_t region : members) regions_[region].shape = shapes_.add(regions_[region].region.faces);
  return true;
}

void ConsistencySearch::refuse_family(const Family& family, std::size_t regions_before, const GivenUp& given_up,
                                      Refusal refusal) {
  for (const auto& [region, before] : given_up.before) {
    std::tie(regions_[region].shape, regions_[region].region.faces) = before;
    if (!refusal.bar) continue;
    std::vector<int> whole;
    std::ranges::set_union(refusal.bar->faces, before.second, std::back_inserter(whole));
    refusal.bar->faces = std::move(whole);
  }
  std::vector<Claim> claims;
  for (const Member& member : family.members) {
    if (member.region < regions_before && regions_[member.region].source < 0 &&
        regions_[member.region].state == State::waiting) {
      claims.push_back({false, member.region});
    }
  }
  refuse(std::move(claims), refusal);
}

void ConsistencySearch::place_family(std::size_t first) {
  if (!regions_[first].place) {
    refuse({{false, first}}, {"its elements form no group of that symbol", {}});
    return;
  }
  placing_.insert(first);
  GivenUp given_up;
  Family family;
  Verdict refusal;
  std::size_t regions_before = 0;
  for (bool again = true; again;) {
    regions_before = regions_.size();
    const int shapes_before = shapes_.count();
    family = {};
    refusal = gather(first, family);
    if (!refusal && !given_up.alike) {
      again = give_up_alike(family, regions_before, shapes_before, given_up);
      if (!again) refusal = Refusal{"its images overlap others differently", {}};
      continue;
    }
    if (!refusal) refusal = accept_family(family);
    if (!refusal) break;
    regions_.resize(regions_before);
    shapes_.keep(shapes_before);
    again = !refusal->first.empty();
    for (const std::size_t before : refusal->first) {
      if (regions_[before].state != State::waiting) continue;
      if (!shapes_.within(regions_[before].shape, regions_[first].shape)) trim(before, regions_[first].shape);
      place_family(before);
    }
    if (again) continue;
    if (refusal->across && *refusal->across < regions_before && refusal->shape < shapes_before) {
      given_up.remember(*refusal->across, regions_[*refusal->across]);
      again = trim(*refusal->across, refusal->shape);
      given_up.alike = given_up.alike && !again;
      given_up.takers.insert(given_up.takers.end(), refusal->by.begin(), refusal->by.end());
    }
  }
  placing_.erase(first);
  if (refusal) {
    refuse_family(family, regions_before, given_up, std::move(*refusal));
    return;
  }
  if (!given_up.before.empty()) note_given_up(family, given_up.takers);
  for (const std::size_t other : family.replaced) {
    if (regions_[other].state == State::waiting) {
      leave_out_region(other, "an image of " + label(first) + " takes its place");
    }
  }
  for (const Member& member : family.members) add_moves_of_region(member.region);
}

}  // namespace orbifit
