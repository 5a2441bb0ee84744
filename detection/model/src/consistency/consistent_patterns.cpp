// Patterns in a consistent annotation: where the groups around take their instances, and whether both agree.

#include <algorithm>
#include <iterator>
#include <limits>
#include <numbers>

#include "consistency/consistency_search.h"
#include "groups/motion_closure.h"

namespace orbifit {

// The instance to which the move takes one: the nearest of those that what arrives meets, or touches if not `meets`.
std::optional<std::size_t> ConsistencySearch::arrival_of(const KnownPattern& known, std::size_t from, const Move& move,
                                                         bool meets) const {
  std::optional<std::size_t> result;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t to = 0; to < known.shapes.size(); ++to) {
    if (!(meets ? shapes_.meet(known.shapes[to], move.arrival) : shapes_.touch(known.shapes[to], move.arrival)))
      continue;
    const int domain = meets ? move.domain : known.shapes[from];
    const int arrival = meets ? move.arrival : known.shapes[to];
    if (shapes_.arrived(known.shapes[from], domain, move.motion, known.shapes[to], arrival) < policy_.arrived) continue;
    const double distance = shapes_.distance(known.shapes[from], domain, move.motion, known.shapes[to], arrival);
    if (distance >= best) continue;
    best = distance;
    result = to;
  }
  return result;
}

// The instances that moves take the root to, one after the other, each by the way that is found first.
ConsistencySearch::Verdict ConsistencySearch::follow_from(std::size_t root, const KnownPattern& known,
                                                          InstanceOrbits& orbits) const {
  orbits.roots[root] = static_cast<int>(root);
  std::vector<std::size_t> queue{root};
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const std::size_t from = queue[head];
    const int shape = known.shapes[from];
    for (const Move& move : moves_) {
      const bool meets = shapes_.meet(shape, move.domain);
      // What merely touches it need not come along, but where it does the two agree.
      if (!meets && (move.turning || !shapes_.touch(shape, move.domain))) continue;
      if (move.turning && shapes_.same(shape, move.domain)) continue;
      if (shapes_.within(move.domain, shape) && !shapes_.within(shape, move.domain)) continue;
      const std::optional<std::size_t> to = arrival_of(known, from, move, meets);
      if (!to && !meets) continue;
      if (!to) {
        return Refusal{"the group of " + name_of(move) + " takes its instances where it has none", {mover_of(move)}};
      }
      if (std::ranges::find(orbits.asking, mover_of(move)) == orbits.asking.end()) {
        orbits.asking.push_back(mover_of(move));
      }
      if (move.turning) {
        const GroupPlace turning = turning_part(*regions_[static_cast<std::size_t>(move.region)].place);
        orbits.turns[from].push_back(turning.group.has_axis()
                                         ? Motion::rotation(turning.frame.col(2), std::numbers::pi, turning.centre)
                                         : Motion::about(-Eigen::Matrix3d::Identity(), turning.centre));
      }
      if (move.region >= 0) orbits.normalisers.push_back(move.motion);
      orbits.steps.push_back({from, *to, move.motion});
      if (orbits.roots[*to] < 0) {
        orbits.roots[*to] = static_cast<int>(root);
        orbits.ways[*to] = move.motion * orbits.ways[from];
        queue.push_back(*to);
        continue;
      }
      const Motion stabiliser = inverse(orbits.ways[*to]) * move.motion * orbits.ways[from];
      const Extent& extent = shapes_.extent(known.shapes[root]);
      if (distance(stabiliser, Motion{}, extent) > rounding_) orbits.stabilisers[root].push_back(stabiliser);
    }
  }
  return std::nullopt;
}

// Whether to go by the groups around and come back by the pattern's steps keeps the first instance in finitely many
// ways.
bool ConsistencySearch::closes(const KnownPattern& known, const std::vector<InstanceStep>& steps) const {
  std::vector<Motion> returns;
  const auto place = [&](std::size_t t) { return known.pattern.instances[t].motion; };
  for (const InstanceStep& step : steps) returns.push_back(inverse(place(step.to)) * step.motion * place(step.from));
  const Extent& first = shapes_.extent(known.shapes[0]);
  return closure(returns, first, std::max(1e3 * rounding_, 1e-9 * first.reach)).size() < kMaxStabilisers;
}

// Whether what turns the first instance is taken to what turns each other, to rounding.
bool ConsistencySearch::keeps_axes(const KnownPattern& known, const InstanceOrbits& orbits) const {
  for (std::size_t t = 1; t < known.shapes.size(); ++t) {
    const Motion& motion = known.pattern.instances[t].motion;
    const Extent& extent = shapes_.extent(known.shapes[t]);
    if (orbits.turns[0].size() != orbits.turns[t].size()) return false;
    for (const Motion& turn : orbits.turns[0]) {
      const Motion image = conjugate(motion, turn);
      if (std::ranges::none_of(orbits.turns[t],
                               [&](const Motion& other) { return distance(image, other, extent) <= 1e3 * rounding_; }))
        return false;
    }
  }
  return true;
}

ConsistencySearch::Verdict ConsistencySearch::fit_pattern(KnownPattern& known) const {
  InstanceOrbits orbits(known.shapes.size());
  for (std::size_t root = 0; root < known.shapes.size(); ++root) {
    if (orbits.roots[root] >= 0) continue;
    if (Verdict refusal = follow_from(root, known, orbits)) return refusal;
  }
  const bool copies = known.pattern.kind == Pattern::Kind::congruent || known.pattern.generators.empty();
  if (auto reason = copies ? fit_copies(known, orbits) : fit_lattice(known, orbits)) {
    return Refusal{*reason, orbits.asking};
  }
  if (!keeps_axes(known, orbits)) return Refusal{"it does not keep the axes of what turns around it", orbits.asking};
  if (!closes(known, orbits.steps)) {
    return Refusal{"its steps and the groups around it do not close", orbits.asking};
  }
  return std::nullopt;
}

// Whether the pattern's motions take the group of a region at an instance to groups that are placed.
bool ConsistencySearch::takes_along(const KnownPattern& known, std::size_t instance, std::size_t region) const {
  const GroupPlace& place = *regions_[region].place;
  const Motion back = inverse(known.pattern.instances[instance].motion);
  return std::ranges::all_of(known.pattern.instances, [&](const PatternInstance& other) {
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      if (regions_[k].state != State::placed) continue;
      if (group_distance(place, other.motion * back, *regions_[k].place, extent(k)) <= 10 * rounding_) return true;
    }
    return false;
  });
}

// What an instance gives up: where it touches another, since a point on both has an image on every pair of neighbours
// but the last; where it touches a region that its motions do not take along; and where it overlaps such a region, what
// one of the two has less of.
std::vector<int> ConsistencySearch::given_up(const KnownPattern& known, std::size_t instance) const {
  const int shape = known.shapes[instance];
  std::vector<int> result;
  const auto add = [&](const std::vector<int>& faces) { result.insert(result.end(), faces.begin(), faces.end()); };
  for (const int other : known.shapes) {
    if (other != shape && shapes_.touch(shape, other)) add(shapes_.faces_at(shape, other));
  }
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const KnownRegion& region = regions_[r];
    if (region.state != State::placed || !shapes_.touch(shape, region.shape)) continue;
    const bool meets = shapes_.meet(shape, region.shape);
    if (meets && (shapes_.within(shape, region.shape) || shapes_.within(region.shape, shape))) continue;
    if (takes_along(known, instance, r)) continue;
    if (!meets || 2 * shapes_.common_area(shape, region.shape) < shapes_.area(shape)) {
      add(shapes_.faces_at(shape, region.shape));
      continue;
    }
    std::vector<int> outside;
    std::ranges::set_difference(shapes_.faces(shape), shapes_.faces(region.shape), std::back_inserter(outside));
    add(outside);
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// All instances give up what one does. \return whether enough is left of each
bool ConsistencySearch::trim_pattern(KnownPattern& known) {
  const int before = shapes_.count();
  std::vector<PatternInstance>& instances = known.pattern.instances;
  std::vector<std::vector<int>> lost;
  for (std::size_t t = 0; t < known.shapes.size(); ++t) lost.push_back(given_up(known, t));
  if (std::ranges::all_of(lost, [](const auto& faces) { return faces.empty(); })) return true;
  const auto lose_images = [&](std::size_t from, std::size_t to) {
    if (lost[from].empty() || from == to) return;
    const Motion motion = instances[to].motion * inverse(instances[from].motion);
    const int part = shapes_.add(lost[from]);
    const std::vector<int> faces = shapes_.image_faces(part, known.shapes[from], motion, known.shapes[to]);
    shapes_.keep(before);
    std::vector<int> both;
    std::ranges::set_union(lost[to], faces, std::back_inserter(both));
    lost[to] = std::move(both);
  };
  for (std::size_t t = 1; t < lost.size(); ++t) lose_images(t, 0);
  for (std::size_t t = 1; t < lost.size(); ++t) lose_images(0, t);
  std::vector<int> shapes;
  for (std::size_t t = 0; t < lost.size(); ++t) {
    const int shape = known.shapes[t];
    std::vector<int> left;
    std::ranges::set_difference(shapes_.faces(shape), lost[t], std::back_inserter(left));
    if (left.empty()) break;
    shapes.push_back(shapes_.add(left));
    if (shapes_.area(shapes.back()) < policy_.left * shapes_.area(shape)) break;
  }
  if (shapes.size() < lost.size() || shapes_.area(shapes.back()) < policy_.left * shapes_.area(known.shapes.back())) {
    shapes_.keep(before);
    return false;
  }
  for (std::size_t t = 0; t < lost.size(); ++t) instances[t].faces = shapes_.faces(shapes[t]);
  known.shapes = std::move(shapes);
  return true;
}

// Of the largest instance, beside what is placed; 0 where too little is left.
double ConsistencySearch::trimmed_area(std::size_t number) {
  const int before = shapes_.count();
  KnownPattern known = patterns_[number];
  double area = 0;
  if (trim_pattern(known)) {
    for (const int shape : known.shapes) area = std::max(area, shapes_.area(shape));
  }
  shapes_.keep(before);
  return area;
}

// Trimmed and fitted to what is placed, or why it cannot be.
std::variant<ConsistencySearch::KnownPattern, ConsistencySearch::Refusal> ConsistencySearch::fitted(
    const KnownPattern& known) {
  KnownPattern result = known;
  if (result.shapes.size() < 2) return Refusal{"it has fewer than two instances", {}};
  if (!trim_pattern(result)) return Refusal{"regions that overlap it leave too little of its instances", {}};
  if (Verdict refusal = fit_pattern(result)) return *refusal;
  return result;
}

void ConsistencySearch::place_pattern(std::size_t number) {
  auto result = fitted(patterns_[number]);
  if (const Refusal* refusal = std::get_if<Refusal>(&result)) {
    refuse({{true, number}}, *refusal);
    return;
  }
  patterns_[number] = std::move(std::get<KnownPattern>(result));
  patterns_[number].state = State::placed;
  add_moves_of_pattern(number);
}

// A family that was just placed goes again where a preferred pattern would not agree with it.
void ConsistencySearch::yield_to_preferred(std::size_t region) {
  if (is_everything({false, region})) return;
  for (const std::size_t number : preferred_) {
    if (patterns_[number].state != State::waiting) continue;
    const int before = shapes_.count();
    const bool agrees = std::holds_alternative<KnownPattern>(fitted(patterns_[number]));
    shapes_.keep(before);
    if (agrees) continue;
    std::vector<Claim> family;
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      if (regions_[i].state == State::placed && regions_[i].family == regions_[region].family) {
        family.push_back({false, i});
      }
    }
    refuse(std::move(family),
           {"it contradicts \"" + patterns_[number].pattern.name + "\", which saves more", {{true, number}}});
    find_moves();
    return;
  }
}

}  // namespace orbifit
