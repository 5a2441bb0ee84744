// Patterns in a consistent annotation: where the groups around take their instances, and whether both agree.

#include <algorithm>
#include <limits>
#include <numbers>

#include "consistency/consistency_search.h"
#include "consistency/motion_closure.h"

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
    const auto match = shapes_.match(known.shapes[from], domain, move.motion, known.shapes[to], arrival);
    if (match.share < policy_.arrived || match.distance >= best) continue;
    best = match.distance;
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

void ConsistencySearch::place_pattern(std::size_t number) {
  KnownPattern fitted = patterns_[number];
  Verdict refusal;
  if (fitted.shapes.size() < 2) refusal = Refusal{"it has fewer than two instances", {}};
  if (!refusal) refusal = fit_pattern(fitted);
  if (refusal) {
    refuse({{true, number}}, *refusal);
    return;
  }
  patterns_[number] = std::move(fitted);
  patterns_[number].state = State::placed;
  add_moves_of_pattern(number);
}

}  // namespace orbifit
