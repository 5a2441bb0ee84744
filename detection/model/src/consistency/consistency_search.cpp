#include "consistency/consistency_search.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "consistency/halvings.h"

namespace orbifit {

bool stands_at(const Region& region, const GroupPlace& place, const Extent& extent, double tolerance) {
  if (region.group.continuous()) return true;  // the place was made of its axis and centre
  const std::vector<Motion> due = members(place);
  return std::ranges::all_of(region.elements, [&](const Motion& element) {
    return std::ranges::any_of(due, [&](const Motion& motion) {
      return motion_distance(element, motion, extent.centre, extent.reach) <= tolerance;
    });
  });
}

ShapeSurface ConsistencySearch::surface_of(const Mesh& mesh, double tolerance, const RunContext& context) {
  return {mesh, ConsistencyPolicy{}.reach * tolerance * diagonal(mesh.vertices), context};
}

RegionShapes ConsistencySearch::shapes_of(const ShapeSurface& surface, const SymmetryAnnotation& annotation) {
  RegionShapes result(surface);
  for (const Region& region : annotation.regions) result.add(region.faces);
  for (const Pattern& pattern : annotation.patterns) {
    for (const PatternInstance& instance : pattern.instances) result.add(instance.faces);
  }
  return result;
}

ConsistencySearch::ConsistencySearch(const Mesh& mesh, const SymmetryAnnotation& annotation, RegionShapes& shapes,
                                     const std::map<Claim, std::string>& excluded,
                                     const std::set<std::size_t>& preferred, const RunContext& context)
    : mesh_(mesh),
      annotation_(annotation),
      context_(context),
      diagonal_(diagonal(mesh.vertices)),
      tolerance_(annotation.tolerance * diagonal_),
      rounding_(policy_.exact * (diagonal_ + mesh.vertices.cwiseAbs().maxCoeff())),
      shapes_(shapes),
      given_shapes_(shapes.count()),
      preferred_(preferred) {
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
  Refused refused{std::move(claims), refusal.reason, 0, {}, {}};
  for (const Claim& claim : refused.claims) {
    refused.saving += saving(claim);
    if (claim.pattern) {
      leave_out_pattern(claim.number, refusal.reason);
    } else {
      leave_out_region(claim.number, refusal.reason);
    }
  }
  refused.against = against(refusal.by);
  std::erase_if(refused.against, [&](const std::vector<Claim>& family) {
    return std::ranges::any_of(
        family, [&](const Claim& claim) { return std::ranges::find(refused.claims, claim) != refused.claims.end(); });
  });
  if (refusal.bar && may_leave_faces(*refusal.bar)) refused.bar = refusal.bar;
  refused_.push_back(std::move(refused));
}

// Whether the bar is a region of the annotation, which may leave faces to others. Those of the whole never do.
bool ConsistencySearch::may_leave_faces(const Bar& bar) const {
  return !bar.claim.pattern && bar.claim.number < regions_.size() && regions_[bar.claim.number].source < 0 &&
         !is_everything(bar.claim);
}

// The families of claims that are in the way of something, without those of the whole, which are never given up.
std::vector<std::vector<Claim>> ConsistencySearch::against(const std::vector<Claim>& claims) const {
  std::vector<std::vector<Claim>> result;
  for (const Claim& claim : claims) {
    if ((!claim.pattern && claim.number >= regions_.size()) || is_everything(claim)) continue;
    std::vector<Claim> family = family_of(claim);
    if (std::ranges::find(result, family) == result.end()) result.push_back(std::move(family));
  }
  return result;
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
  return !claim.pattern && shapes_.area(regions_[claim.number].shape) >= policy_.everything * shapes_.area_of_all();
}

double ConsistencySearch::saving(std::size_t region) const {
  const KnownRegion& known = regions_[region];
  return shapes_.area(known.shape) * halvings(known.region.group) * credit(known.region);
}

// Where a region's surface is farther from its image than the tolerance, some of its faces are not the group's, and may
// keep others from theirs. Of continuous groups it is facets that make it so.
double ConsistencySearch::credit(const Region& region) const {
  const double off = region.residual.max * diagonal_;
  return region.group.continuous() || off <= tolerance_ ? 1 : tolerance_ / off;
}

double ConsistencySearch::saving(const Claim& claim) const {
  if (!claim.pattern) return saving(claim.number);
  const std::vector<int>& shapes = patterns_[claim.number].shapes;
  double area = 0;
  for (const int shape : shapes) area += shapes_.area(shape);
  return area * halvings(shapes.size());
}

// How often elements that two placed regions have in common halve a surface.
double ConsistencySearch::common_halvings(std::size_t a, std::size_t b) const {
  const GroupPlace& one = *regions_[a].place;
  const GroupPlace& other = *regions_[b].place;
  const double near = 10 * rounding_;
  if (distance_from_within(one, other, extent(b)) <= near) return halvings(one.group);
  if (distance_from_within(other, one, extent(b)) <= near) return halvings(other.group);
  if (!one.group.continuous()) return halvings(common_members(one, other, extent(b), near));
  return other.group.continuous() ? 0 : halvings(common_members(other, one, extent(b), near));
}

// Of a region that is placed, without what smaller ones on its faces save by elements that it has as well.
double ConsistencySearch::own_saving(std::size_t region) const {
  const KnownRegion& known = regions_[region];
  const double all = halvings(known.region.group);
  std::vector<std::pair<double, int>> common;  // halvings, and the shape on which
  for (std::size_t other = 0; other < regions_.size(); ++other) {
    const KnownRegion& holder = regions_[other];
    const double smaller = shapes_.area(known.shape) - shapes_.area(holder.shape);
    if (holder.state != State::placed || smaller < 0 || (smaller == 0 && other <= region)) continue;
    if (!shapes_.meet(known.shape, holder.shape)) continue;
    const double shared = common_halvings(region, other);
    if (shared > 0) common.emplace_back(shared, holder.shape);
  }
  if (common.empty()) return saving(region);
  std::ranges::sort(common, std::greater<>());
  double sum = 0;
  for (const int face : shapes_.faces(known.shape)) {
    const auto most = std::ranges::find_if(common, [&](const auto& each) { return shapes_.holds(each.second, face); });
    sum += shapes_.area_of(face) * (all - (most == common.end() ? 0 : most->first));
  }
  return sum * credit(known.region);
}

double ConsistencySearch::total_saving() const {
  double sum = 0;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].state == State::placed) sum += own_saving(i);
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

void ConsistencySearch::find_moves() {
  moves_.clear();
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].state == State::placed) add_moves_of_region(i);
  }
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    if (patterns_[i].state == State::placed) add_moves_of_pattern(i);
  }
}

// What gave up faces may be left with those of a region whose group holds its own: it then says nothing more. It goes
// with its images, where these say nothing either.
void ConsistencySearch::leave_out_repeated() {
  const auto repeats = [&](std::size_t region) -> std::optional<std::size_t> {
    const KnownRegion& known = regions_[region];
    for (std::size_t other = 0; other < regions_.size(); ++other) {
      const KnownRegion& holder = regions_[other];
      if (holder.state != State::placed || !shapes_.within(known.shape, holder.shape)) continue;
      if (!(halvings(holder.region.group) > halvings(known.region.group))) continue;
      if (distance_from_within(*known.place, *holder.place, extent(other)) <= 10 * rounding_) return other;
    }
    return std::nullopt;
  };
  std::map<std::size_t, std::vector<std::size_t>> families;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].state == State::placed) families[regions_[i].family].push_back(i);
  }
  bool any = false;
  for (const auto& [first, members] : families) {
    const std::optional<std::size_t> holder = repeats(members.front());
    if (!holder || !std::ranges::all_of(members, [&](std::size_t i) { return repeats(i).has_value(); })) continue;
    for (const std::size_t i : members) leave_out_region(i, label(*holder) + " says the same and more");
    any = true;
  }
  if (any) find_moves();
}

ConsistencyOutcome ConsistencySearch::run() {
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
    const Item item = items[i];
    if (item.pattern) {
      if (patterns_[item.number].state != State::waiting) continue;
      const double left = trimmed_area(item.number) / (1 - RegionShapes::kSliver);
      if (left > 0 && left < (1 - RegionShapes::kSliver) * item.area) {  // others hold an instance now
        const auto later = std::find_if(items.begin() + static_cast<std::ptrdiff_t>(i) + 1, items.end(),
                                        [&](const Item& other) { return other.area < left; });
        if (later != items.begin() + static_cast<std::ptrdiff_t>(i) + 1) {
          items.insert(later, {true, item.number, left, 0});
          continue;
        }
      }
      place_pattern(item.number);
    } else if (regions_[item.number].state == State::waiting) {
      place_family(item.number);
      if (regions_[item.number].state == State::placed) yield_to_preferred(item.number);
    }
  }
  while (drop_contradictions()) find_moves();
  leave_out_repeated();
  while (drop_contradictions()) find_moves();
  const double saved = total_saving();
  return {result(), saved, std::move(refused_)};
}

}  // namespace orbifit
