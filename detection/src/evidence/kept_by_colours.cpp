#include "evidence/kept_by_colours.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "evidence/coloured_group.h"
#include "evidence/policy.h"

namespace orbifit {

namespace {

// What a region or a pattern comes to.
template <class Item>
struct Verdict {
  std::optional<Item> kept;
  std::optional<BrokenByColours> broken;
};

Verdict<Region> judged(const Mesh& mesh, const Region& region, const ColourSamples& samples, double reach) {
  const ColourJudge judge(samples, mesh.faces.rows(), region.faces, region.faces);
  const ColouredGroup group = coloured_group(region, judge, reach);
  if (group.whole) return {region, std::nullopt};
  return {group.region, BrokenByColours{region.name, region.group.symbol(),
                                        group.region ? group.region->group.symbol() : "", group.differing}};
}

Verdict<Pattern> judged(const Mesh& mesh, const Pattern& pattern, const ColourSamples& samples) {
  std::vector<std::vector<std::size_t>> alike;
  double worst = 0;
  for (std::size_t i = 0; i < pattern.instances.size(); ++i) {
    bool known = false;
    for (std::vector<std::size_t>& same : alike) {
      const PatternInstance& first = pattern.instances[same.front()];
      const ColourJudge judge(samples, mesh.faces.rows(), first.faces, pattern.instances[i].faces);
      const double differing = judge.differing(pattern.instances[i].motion * inverse(first.motion));
      known = differing <= kColourPolicy.share;
      if (!known) worst = std::max(worst, differing);
      if (known) same.push_back(i);
      if (known) break;
    }
    if (!known) alike.push_back({i});
  }
  if (alike.size() <= 1) return {pattern, std::nullopt};
  const std::vector<std::size_t>& most =
      *std::ranges::max_element(alike, {}, [](const auto& same) { return same.size(); });
  BrokenByColours broken{pattern.name, to_string(pattern.kind), "", worst};
  if (most.size() < 2) return {std::nullopt, broken};
  Pattern kept = pattern;
  kept.kind = Pattern::Kind::congruent;
  kept.generators.clear();
  kept.instances.clear();
  const Motion back = inverse(pattern.instances[most.front()].motion);
  for (const std::size_t i : most) {
    kept.instances.push_back({pattern.instances[i].motion * back, pattern.instances[i].faces});
  }
  kept.instances.front().motion = Motion{};
  broken.kept_as = to_string(kept.kind);
  return {kept, broken};
}

// Whether the one has all that the other has: the same faces, and every element of its group.
bool holds(const Region& large, const Region& small, double scale) {
  if (large.faces != small.faces || large.group.continuous() || small.group.continuous()) return false;
  return std::ranges::all_of(small.elements, [&](const Motion& motion) {
    return std::ranges::any_of(large.elements, [&](const Motion& other) {
      return motion_distance(motion, other, large.centre, scale) <= kColourPolicy.same_motion * scale;
    });
  });
}

// Different groups of one part may come down to the same.
void drop_repeated(std::vector<Region>& regions, double scale) {
  std::vector<Region> distinct;
  for (Region& region : regions) {
    if (std::ranges::any_of(distinct, [&](const Region& other) { return holds(other, region, scale); })) continue;
    std::erase_if(distinct, [&](const Region& other) { return holds(region, other, scale); });
    distinct.push_back(std::move(region));
  }
  regions = std::move(distinct);
}

}  // namespace

KeptByColours kept_by_colours(const Mesh& mesh, const SymmetryAnnotation& annotation, const ColourSamples& samples,
                              const RunContext& context) {
  const double scale = diagonal(mesh.vertices);
  std::vector<Verdict<Region>> regions(annotation.regions.size());
  std::vector<Verdict<Pattern>> patterns(annotation.patterns.size());
  parallel_for(context, regions.size() + patterns.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      context.check();
      if (i < regions.size()) {
        regions[i] = judged(mesh, annotation.regions[i], samples, annotation.tolerance * scale);
      } else {
        patterns[i - regions.size()] = judged(mesh, annotation.patterns[i - regions.size()], samples);
      }
    }
  });
  KeptByColours result;
  result.annotation = annotation;
  result.annotation.regions.clear();
  result.annotation.patterns.clear();
  for (Verdict<Region>& verdict : regions) {
    if (verdict.kept) result.annotation.regions.push_back(std::move(*verdict.kept));
    if (verdict.broken) result.broken.push_back(std::move(*verdict.broken));
  }
  for (Verdict<Pattern>& verdict : patterns) {
    if (verdict.kept) result.annotation.patterns.push_back(std::move(*verdict.kept));
    if (verdict.broken) result.broken.push_back(std::move(*verdict.broken));
  }
  drop_repeated(result.annotation.regions, scale);
  return result;
}

}  // namespace orbifit
