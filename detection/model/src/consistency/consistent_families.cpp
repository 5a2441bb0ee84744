// Families: the regions that motions take to one another, and what the motions ask of the first of them.

#include <algorithm>
#include <limits>
#include <utility>

#include "consistency/consistency_search.h"

namespace orbifit {

namespace {

bool is_identity(const Motion& motion, const Extent& extent, double tolerance) {
  return motion_distance(motion, Motion{}, extent.centre, extent.reach) <= tolerance;
}

}  // namespace

// The region to which a motion takes (what lies in `domain` of) another: of the same group, near enough, on the same
// surface; and of all that are, the nearest, which has no nearer one that goes there.
std::optional<std::size_t> ConsistencySearch::image_region(std::size_t region, int domain, const Motion& motion,
                                                           int arrival) const {
  const std::optional<std::size_t> there = nearest_image(region, domain, motion, arrival);
  if (!there || *there == region) return there;
  const std::optional<std::size_t> back = nearest_image(*there, arrival, inverse(motion), domain);
  return back == region ? there : std::nullopt;
}

std::optional<std::size_t> ConsistencySearch::nearest_image(std::size_t region, int domain, const Motion& motion,
                                                            int arrival) const {
  std::optional<std::size_t> best;
  double best_distance = std::numeric_limits<double>::infinity();
  const KnownRegion& from = regions_[region];
  for (std::size_t other = 0; other < regions_.size(); ++other) {
    const KnownRegion& known = regions_[other];
    if (known.state == State::out || !known.place || !(known.place->group == from.place->group)) continue;
    if (!shapes_.touch(known.shape, arrival)) continue;
    if (group_distance(*from.place, motion, *known.place, extent(other)) > length(policy_.same_group)) continue;
    // Of what merely touches, all.
    const bool meets = shapes_.meet(from.shape, domain) && shapes_.meet(known.shape, arrival);
    const int left = meets ? domain : from.shape;
    const int reached = meets ? arrival : known.shape;
    if (shapes_.arrived(from.shape, left, motion, known.shape, reached) < policy_.arrived) continue;
    const double distance = shapes_.distance(from.shape, left, motion, known.shape, reached);
    if (distance >= best_distance) continue;
    best = other;
    best_distance = distance;
  }
  return best;
}

// The regions on what two have in common whose groups hold the groups of both. \param placed  of those that are placed,
// exactly; else of all that may be, nearly
std::vector<std::size_t> ConsistencySearch::holding_both(std::size_t a, std::size_t b, bool placed) const {
  std::vector<std::size_t> result;
  const double near = placed ? 10 * rounding_ : length(policy_.same_group);
  for (std::size_t c = 0; c < regions_.size(); ++c) {
    const KnownRegion& known = regions_[c];
    if (c == a || c == b || !known.place || known.state == State::out) continue;
    if (placed && known.state != State::placed) continue;
    const auto within = [&](std::size_t other) {
      return !shapes_.within(regions_[other].shape, known.shape) &&  // which would say all of it
             shapes_.common_area(known.shape, regions_[other].shape) >= policy_.kept * shapes_.area(known.shape) &&
             distance_from_within(*regions_[other].place, *known.place, extent(c)) <= near;
    };
    if (within(a) && within(b)) result.push_back(c);
  }
  return result;
}

// Whether the one asks nothing of the other, since of what they have in common larger groups say all.
bool ConsistencySearch::follows(std::size_t a, std::size_t b, bool placed) const {
  const int one = regions_[a].shape;
  const int other = regions_[b].shape;
  if (a == b || shapes_.within(one, other) || shapes_.within(other, one)) return false;
  const std::vector<std::size_t> holders = holding_both(a, b, placed);
  if (holders.empty()) return false;
  std::vector<int> common = shapes_.common_faces(one, other);
  const double all = shapes_.area_of(common);
  std::erase_if(common, [&](int face) {
    return std::ranges::none_of(holders, [&](std::size_t c) { return shapes_.holds(regions_[c].shape, face); });
  });
  return all > 0 && shapes_.area_of(common) >= policy_.kept * all;
}

// The image of the family's member `at` is missing: it is added where the surface has it.
ConsistencySearch::Verdict ConsistencySearch::add_image(const Move& move, std::size_t at, Family& family) {
  const Member member = family.members[at];
  const int shape = regions_[member.region].shape;
  const Refusal nowhere{"the group of " + name_of(move) + " takes it where there is no such region", {mover_of(move)}};
  if (!shapes_.within(shape, move.domain)) {
    Refusal across{nowhere.reason, nowhere.by, member.region, move.domain};
    if (shapes_.past_the_end(shape, move.motion)) across.bar = Bar{mover_of(move), shapes_.faces(shape)};
    return across;
  }
  const GroupPlace& first = *regions_[family.members.front().region].place;
  const Motion way = move.motion * member.way;
  const GroupPlace place = image_of(first, way);
  const std::vector<int> faces = shapes_.image_faces(shape, move.domain, move.motion, move.arrival);
  if (faces.empty()) return nowhere;
  const int added = shapes_.add(faces);
  const bool stands = shapes_.area(added) >= policy_.kept * shapes_.area(shape) &&
                      shapes_.area(shape) >= policy_.kept * shapes_.area(added) &&
                      shapes_.kept(added, members(place), shapes_.near()) >= policy_.kept;
  if (!stands) {
    shapes_.keep(added);
    return nowhere;
  }
  for (std::size_t other = 0; other < regions_.size(); ++other) {
    const KnownRegion& known = regions_[other];
    if (known.state == State::out || !shapes_.same(known.shape, added)) continue;
    if (known.state == State::placed ||
        std::ranges::any_of(family.members, [&](const Member& m) { return m.region == other; })) {
      shapes_.keep(added);
      return Refusal{"its image under " + name_of(move) + " contradicts " + label(other),
                     {mover_of(move), {false, other}}};
    }
    family.replaced.push_back(other);
  }
  KnownRegion image;
  image.region = regions_[member.region].region;
  if (!image.region.name.starts_with("image of ")) image.region.name = "image of " + image.region.name;
  image.region.faces = faces;
  image.shape = added;
  image.place = place;
  image.source = static_cast<int>(member.region);
  image.region.residual = shapes_.residual(added, members(place));
  regions_.push_back(std::move(image));
  family.members.push_back({regions_.size() - 1, way});
  return std::nullopt;
}

// What lies on a surface of revolution turns with it: its own motions keep the axis, or all directions would be turned
// into one another.
ConsistencySearch::Verdict ConsistencySearch::turn_with(const Move& move, std::size_t at, Family& family) const {
  const Member& member = family.members[at];
  const int shape = regions_[member.region].shape;
  const GroupPlace& turning = *regions_[static_cast<std::size_t>(move.region)].place;
  const bool meets = shapes_.meet(shape, move.domain);
  if (meets && follows(member.region, static_cast<std::size_t>(move.region), false)) return std::nullopt;
  const auto refusal = [&](const std::string& reason) {
    Refusal result{reason, {mover_of(move)}};
    if (!shapes_.within(shape, move.domain)) {
      result.across = member.region;
      result.shape = move.domain;
    }
    return result;
  };
  if (!meets) {
    // What touches it need not turn with it; but no vertex lies on circles about two axes.
    if (!regions_[member.region].place->group.continuous()) return std::nullopt;
    const GroupPlace part = turning_part(*regions_[member.region].place);
    if (group_distance(part, Motion{}, turning_part(turning), extent(member.region)) > length(policy_.same_group)) {
      return refusal("it touches " + name_of(move) + ", which turns about another axis");
    }
  }
  const Motion some = turning.group.has_axis() ? Motion::rotation(turning.frame.col(2), 1, turning.centre) : Motion{};
  if (meets && shapes_.arrived(shape, move.domain, some, shape, move.arrival) < policy_.arrived) {
    return refusal("it lies on " + name_of(move) + " and does not turn with it");
  }
  family.asking.push_back(mover_of(move));
  Tie tie;
  tie.from = tie.to = image_of(turning_part(turning), inverse(member.way));
  tie.extent = extent(family.members.front().region);
  const std::size_t marks_of_first = marks(*regions_[family.members.front().region].place).size();
  for (std::size_t k = 0; k < marks_of_first; ++k) {
    tie.own = static_cast<int>(k);
    family.ties.push_back(tie);
  }
  return std::nullopt;
}

// Where a move takes a member: to itself or another, which asks something of the first; to a region placed before; or
// to one that now belongs to the family.
ConsistencySearch::Verdict ConsistencySearch::follow(const Move& move, std::size_t at, Family& family) {
  const Member member = family.members[at];
  const int shape = regions_[member.region].shape;
  const bool meets = shapes_.meet(shape, move.domain);
  if (!meets && !shapes_.touch(shape, move.domain)) return std::nullopt;
  if (meets && shapes_.within(move.domain, shape) && !shapes_.within(shape, move.domain)) return std::nullopt;
  if (move.turning) return turn_with(move, at, family);
  Tie tie;
  const std::optional<std::size_t> image = image_region(member.region, move.domain, move.motion, move.arrival);
  if (!image) {
    if (meets && move.region >= 0 && follows(member.region, static_cast<std::size_t>(move.region), false)) {
      return std::nullopt;
    }
    return add_image(move, at, family);
  }
  if (regions_[*image].state == State::placed) {
    tie.before = move.motion * member.way;
    tie.to = regions_[*image].place;
    tie.extent = extent(*image);
    family.ties.push_back(tie);
    family.asking.push_back(mover_of(move));
    return std::nullopt;
  }
  const auto known = std::ranges::find(family.members, *image, &Member::region);
  if (known == family.members.end()) {
    family.members.push_back({*image, move.motion * member.way});
    return std::nullopt;
  }
  tie.before = inverse(known->way) * move.motion * member.way;
  tie.extent = extent(family.members.front().region);
  if (!is_identity(tie.before, tie.extent, rounding_)) {
    family.ties.push_back(tie);
    family.asking.push_back(mover_of(move));
  }
  return std::nullopt;
}

ConsistencySearch::Verdict ConsistencySearch::gather(std::size_t first, Family& family) {
  constexpr std::size_t kMaxMembers = 2000;
  family.members.push_back({first, Motion{}});
  for (std::size_t at = 0; at < family.members.size(); ++at) {
    context_.check();
    for (std::size_t m = 0; m < moves_.size(); ++m) {
      if (auto refusal = follow(moves_[m], at, family)) return refusal;
    }
    if (family.members.size() > kMaxMembers) return Refusal{"it has images without end", {}};
  }
  return ask_of_overlaps(family);
}

// Where larger groups say all that a family's first and another region have in common, its motions are among theirs.
ConsistencySearch::Verdict ConsistencySearch::ask_of_common(std::size_t other, Family& family) {
  const std::size_t first = family.members.front().region;
  const std::vector<std::size_t> holders = holding_both(first, other, false);
  Refusal waiting{"larger groups that say where it is are not placed", {}};
  for (const std::size_t holder : holders) {
    const bool member = std::ranges::find(family.members, holder, &Member::region) != family.members.end();
    if (regions_[holder].state == State::waiting && !member && !placing_.contains(holder)) {
      waiting.first.push_back(holder);
    }
  }
  if (!waiting.first.empty()) return waiting;
  const std::size_t marks_of_first = marks(*regions_[first].place).size();
  for (const std::size_t holder : holders) {
    if (regions_[holder].state != State::placed) continue;
    for (std::size_t k = 0; k < marks_of_first; ++k) {
      Tie tie;
      tie.own = static_cast<int>(k);
      tie.from = tie.to = regions_[holder].place;
      tie.extent = extent(holder);
      family.ties.push_back(tie);
    }
    family.asking.push_back({false, holder});
  }
  return std::nullopt;
}

// Where regions overlap and neither holds the other, the new one's motions take the other to images as well.
ConsistencySearch::Verdict ConsistencySearch::ask_of_overlaps(Family& family) {
  const std::size_t first = family.members.front().region;
  const int shape = regions_[first].shape;
  const std::vector<Motion> own = marks(*regions_[first].place);
  const auto overlaps = [&](int other) {
    return shapes_.meet(shape, other) && !shapes_.within(shape, other) &&
           (!shapes_.within(other, shape) || shapes_.same(other, shape));
  };
  for (std::size_t other = 0; other < regions_.size(); ++other) {
    const KnownRegion& known = regions_[other];
    const auto member = std::ranges::find(family.members, other, &Member::region);
    const bool in_family = member != family.members.end();
    if (other == first || !(known.state == State::placed || in_family) || !overlaps(known.shape)) continue;
    if (follows(first, other, false)) {
      if (auto refusal = ask_of_common(other, family)) return refusal;
      continue;
    }
    const Refusal missing{
        "it overlaps " + label(other) + ", of which its group has no image", {{false, other}}, first, known.shape};
    for (std::size_t k = 0; k < own.size(); ++k) {
      const auto image = image_region(other, shape, own[k], shape);
      if (!image) return missing;
      Tie tie;
      tie.own = static_cast<int>(k);
      tie.extent = extent(*image);
      if (in_family) {
        const auto to = std::ranges::find(family.members, *image, &Member::region);
        if (to == family.members.end()) return missing;
        tie.before = inverse(to->way);
        tie.after = member->way;
        tie.extent = extent(first);
      } else {
        if (regions_[*image].state != State::placed) return missing;
        tie.from = known.place;
        tie.to = regions_[*image].place;
      }
      family.ties.push_back(tie);
      if (!in_family) family.asking.push_back({false, other});
    }
  }
  return std::nullopt;
}

}  // namespace orbifit
