#include "consistency/consistency_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace orbifit {

namespace {

bool is_identity(const Motion& motion, const Extent& extent, double tolerance) {
  return motion_distance(motion, Motion{}, extent.centre, extent.reach) <= tolerance;
}

// The region with its group at `place`, as it was but for that.
Region at_place(const Region& region, const GroupPlace& place, double movement) {
  Region result = make_region(place.group, place.centre, place.frame, region.faces, region.name);
  result.id = region.id;
  result.residual = {region.residual.rms + movement, region.residual.max + movement};
  return result;
}

double bits(const Residual& residual) {
  return std::max(1.0, -std::log2(residual.rms + ConsistencyPolicy{}.told));
}

}  // namespace

bool stands_at(const Region& region, const GroupPlace& place, const Extent& extent, double tolerance) {
  if (region.group.continuous()) return true;  // the place was made of its axis and centre
  const std::vector<Motion> due = members(place);
  return std::ranges::all_of(region.elements, [&](const Motion& element) {
    return std::ranges::any_of(due, [&](const Motion& motion) {
      return motion_distance(element, motion, extent.centre, extent.reach) <= tolerance;
    });
  });
}

double saving_of(double area, const PointGroup& group, const Residual& residual) {
  const double saved = area * bits(residual);
  return group.continuous() ? saved : saved * (1 - 1.0 / group.order());
}

double saving_of(const std::vector<double>& areas, const Residual& residual) {
  if (areas.empty()) return 0;
  return (std::accumulate(areas.begin(), areas.end(), 0.0) - *std::ranges::max_element(areas)) * bits(residual);
}

RegionShapes ConsistencySearch::shapes_of(const Mesh& mesh, const SymmetryAnnotation& annotation) {
  RegionShapes result(mesh, ConsistencyPolicy{}.reach * annotation.tolerance * diagonal(mesh.vertices));
  for (const Region& region : annotation.regions) result.add(region.faces);
  for (const Pattern& pattern : annotation.patterns) {
    for (const PatternInstance& instance : pattern.instances) result.add(instance.faces);
  }
  return result;
}

ConsistencySearch::ConsistencySearch(const Mesh& mesh, const SymmetryAnnotation& annotation, RegionShapes& shapes,
                                     const std::map<Claim, std::string>& excluded, const RunContext& context)
    : mesh_(mesh),
      annotation_(annotation),
      context_(context),
      diagonal_(diagonal(mesh.vertices)),
      tolerance_(annotation.tolerance * diagonal_),
      rounding_(policy_.exact * (diagonal_ + mesh.vertices.cwiseAbs().maxCoeff())),
      shapes_(shapes),
      given_shapes_(shapes.count()) {
  int shape = 0;
  for (const Region& region : annotation.regions) {
    regions_.push_back({region, shape++, place_of(region), State::waiting, -1, regions_.size()});
  }
  for (const Pattern& pattern : annotation.patterns) {
    KnownPattern known{pattern, {}, State::waiting};
    for (std::size_t t = 0; t < pattern.instances.size(); ++t) known.shapes.push_back(shape++);
    patterns_.push_back(std::move(known));
  }
  for (const auto& [claim, reason] : excluded) {
    if (claim.pattern) {
      leave_out_pattern(claim.number, reason);
    } else {
      leave_out_region(claim.number, reason);
    }
  }
}

ConsistencySearch::~ConsistencySearch() {
  shapes_.keep(given_shapes_);
}

std::string ConsistencySearch::label(std::size_t region) const {
  const Region& known = regions_[region].region;
  return "\"" + (known.name.empty() ? "region " + std::to_string(known.id) : known.name) + "\" (" +
         known.group.symbol() + ")";
}

std::string ConsistencySearch::name_of(const Move& move) const {
  if (move.region >= 0) return label(static_cast<std::size_t>(move.region));
  const Pattern& pattern = patterns_[static_cast<std::size_t>(move.pattern)].pattern;
  return "\"" + (pattern.name.empty() ? "pattern " + std::to_string(pattern.id) : pattern.name) + "\" (" +
         to_string(pattern.kind) + ")";
}

void ConsistencySearch::leave_out_region(std::size_t region, const std::string& reason) {
  KnownRegion& known = regions_[region];
  known.state = State::out;
  if (known.source >= 0) return;
  left_out_.push_back({false, known.region.id, known.region.name, known.region.group.symbol(), reason});
}

void ConsistencySearch::leave_out_pattern(std::size_t number, const std::string& reason) {
  KnownPattern& known = patterns_[number];
  known.state = State::out;
  left_out_.push_back({true, known.pattern.id, known.pattern.name, to_string(known.pattern.kind), reason});
}

void ConsistencySearch::refuse(std::vector<Claim> claims, const Refusal& refusal) {
  Refused refused{std::move(claims), refusal.reason, 0, {}};
  for (const Claim& claim : refused.claims) {
    refused.saving += saving(claim);
    if (claim.pattern) {
      leave_out_pattern(claim.number, refusal.reason);
    } else {
      leave_out_region(claim.number, refusal.reason);
    }
  }
  for (const Claim& claim : refusal.by) {
    const bool own = std::ranges::find(refused.claims, claim) != refused.claims.end();
    if (own || (!claim.pattern && claim.number >= regions_.size()) || is_everything(claim)) continue;
    std::vector<Claim> family = family_of(claim);
    if (std::ranges::find(refused.against, family) == refused.against.end()) {
      refused.against.push_back(std::move(family));
    }
  }
  refused_.push_back(std::move(refused));
}

// Of the annotation's own; an image that was added stands or falls with what it is the image of.
std::vector<Claim> ConsistencySearch::family_of(const Claim& claim) const {
  if (claim.pattern) return {claim};
  std::vector<Claim> result;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].source < 0 && regions_[i].family == regions_[claim.number].family) result.push_back({false, i});
  }
  return result;
}

bool ConsistencySearch::is_everything(const Claim& claim) const {
  return !claim.pattern && regions_[claim.number].region.faces.size() == static_cast<std::size_t>(mesh_.faces.rows());
}

double ConsistencySearch::saving(std::size_t region) const {
  const Region& known = regions_[region].region;
  return saving_of(shapes_.area(regions_[region].shape), known.group, known.residual);
}

double ConsistencySearch::saving(const Claim& claim) const {
  if (!claim.pattern) return saving(claim.number);
  std::vector<double> areas;
  for (const int shape : patterns_[claim.number].shapes) areas.push_back(shapes_.area(shape));
  return saving_of(areas, patterns_[claim.number].pattern.residual);
}

double ConsistencySearch::total_saving() const {
  double sum = 0;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].state == State::placed) sum += saving(i);
  }
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    if (patterns_[i].state == State::placed) sum += saving(Claim{true, i});
  }
  return sum;
}

Claim ConsistencySearch::mover_of(const Move& move) const {
  return move.region >= 0 ? Claim{false, static_cast<std::size_t>(move.region)}
                          : Claim{true, static_cast<std::size_t>(move.pattern)};
}

void ConsistencySearch::add_moves_of_region(std::size_t region) {
  const KnownRegion& known = regions_[region];
  const auto number = static_cast<int>(region);
  if (known.place->group.continuous()) moves_.push_back({known.shape, known.shape, Motion{}, number, -1, true});
  for (const Motion& motion : movers(*known.place)) moves_.push_back({known.shape, known.shape, motion, number, -1});
}

void ConsistencySearch::add_moves_of_pattern(std::size_t pattern) {
  const KnownPattern& known = patterns_[pattern];
  for (std::size_t t = 1; t < known.shapes.size(); ++t) {
    const Motion& motion = known.pattern.instances[t].motion;
    moves_.push_back({known.shapes[0], known.shapes[t], motion, -1, static_cast<int>(pattern)});
    moves_.push_back({known.shapes[t], known.shapes[0], inverse(motion), -1, static_cast<int>(pattern)});
  }
}

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
    const RegionShapes::Match match = meets ? shapes_.match(from.shape, domain, motion, known.shape, arrival)
                                            : shapes_.match(from.shape, from.shape, motion, known.shape, known.shape);
    if (match.share < policy_.arrived || match.distance >= best_distance) continue;
    best = other;
    best_distance = match.distance;
  }
  return best;
}

// The image of the family's member `at` is missing: it is added where the surface has it.
ConsistencySearch::Verdict ConsistencySearch::add_image(const Move& move, std::size_t at, Family& family) {
  const Member member = family.members[at];
  const int shape = regions_[member.region].shape;
  const Refusal nowhere{"the group of " + name_of(move) + " takes it where there is no such region", {mover_of(move)}};
  if (!shapes_.within(shape, move.domain)) return Refusal{nowhere.reason, nowhere.by, member.region, move.domain};
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
  if (meets && shapes_.match(shape, move.domain, some, shape, move.arrival).share < policy_.arrived) {
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
  if (!image) return add_image(move, at, family);
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

void ConsistencySearch::place_family(std::size_t first) {
  if (!regions_[first].place) {
    refuse({{false, first}}, {"its elements form no group of that symbol", {}});
    return;
  }
  std::map<std::size_t, std::pair<int, std::vector<int>>> given;  // of regions that were trimmed: shape and faces
  Family family;
  Verdict refusal;
  std::size_t regions_before = 0;
  for (bool again = true; again;) {
    regions_before = regions_.size();
    const int shapes_before = shapes_.count();
    family = {};
    refusal = gather(first, family);
    if (!refusal && !given.empty() && !trim_alike(family))
      refusal = Refusal{"its images overlap others differently", {}};
    if (!refusal) refusal = accept_family(family);
    if (!refusal) break;
    regions_.resize(regions_before);
    shapes_.keep(shapes_before);
    again = false;
    if (refusal->across && *refusal->across < regions_before && refusal->shape < shapes_before) {
      const KnownRegion& across = regions_[*refusal->across];
      given.try_emplace(*refusal->across, across.shape, across.region.faces);
      again = trim(*refusal->across, refusal->shape);
    }
  }
  if (refusal) {
    for (auto& [region, before] : given) std::tie(regions_[region].shape, regions_[region].region.faces) = before;
    std::vector<Claim> claims;
    for (const Member& member : family.members) {
      if (member.region < regions_before && regions_[member.region].source < 0 &&
          regions_[member.region].state == State::waiting) {
        claims.push_back({false, member.region});
      }
    }
    refuse(std::move(claims), *refusal);
    return;
  }
  for (const std::size_t other : family.replaced) {
    if (regions_[other].state == State::waiting) {
      leave_out_region(other, "an image of " + label(first) + " takes its place");
    }
  }
  for (const Member& member : family.members) add_moves_of_region(member.region);
}

ConsistencyOutcome ConsistencySearch::run(std::optional<Claim> wanted) {
  struct Item {
    bool pattern;
    std::size_t number;
    double area;
    int order;
  };
  std::vector<Item> items;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const PointGroup& group = regions_[i].region.group;
    const int order = group.continuous() ? std::numeric_limits<int>::max() : group.order();
    items.push_back({false, i, shapes_.area(regions_[i].shape), order});
  }
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    // After the regions that hold an instance, which take instances to instances, and before those within one.
    double area = 0;
    for (const int shape : patterns_[i].shapes) area = std::max(area, shapes_.area(shape));
    items.push_back({true, i, area / (1 - RegionShapes::kSliver), 0});
  }
  std::ranges::stable_sort(
      items, [](const Item& a, const Item& b) { return a.area != b.area ? a.area > b.area : a.order > b.order; });
  for (std::size_t i = 0; i < items.size(); ++i) {
    context_.progress("consistency", static_cast<double>(i) / static_cast<double>(items.size()));
    const Item& item = items[i];
    if (item.pattern) {
      if (patterns_[item.number].state == State::waiting) place_pattern(item.number);
    } else if (regions_[item.number].state == State::waiting) {
      place_family(item.number);
    }
    if (wanted && !refused_.empty() &&
        std::ranges::find(refused_.back().claims, *wanted) != refused_.back().claims.end())
      return {{}, 0, std::move(refused_)};
  }
  while (drop_contradictions()) {
    moves_.clear();
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      if (regions_[i].state == State::placed) add_moves_of_region(i);
    }
    for (std::size_t i = 0; i < patterns_.size(); ++i) {
      if (patterns_[i].state == State::placed) add_moves_of_pattern(i);
    }
  }
  const double saved = total_saving();
  return {result(), saved, std::move(refused_)};
}

}  // namespace orbifit
