#include "consistency/consistency_choice.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "consistency/consistency_closure.h"
#include "consistency/consistency_search.h"
#include "domains/closed_sets.h"

namespace orbifit {

namespace {

using Excluded = std::map<Claim, std::string>;
using Yielded = std::map<std::size_t, std::vector<int>>;  // by region: the faces that it keeps

// How what contradicts one another is kept apart.
struct Concessions {
  Excluded excluded;
  Yielded yielded;

  friend bool operator<(const Concessions& a, const Concessions& b) {
    return std::tie(a.excluded, a.yielded) < std::tie(b.excluded, b.yielded);
  }
};

class Choice {
 public:
  Choice(const ShapeSurface& surface, const SymmetryAnnotation& annotation, const RunContext& context)
      : mesh_(surface.mesh),
        annotation_(annotation),
        context_(context),
        surface_(surface),
        shapes_(ConsistencySearch::shapes_of(surface, annotation)) {}

  std::optional<ConsistentAnnotation> run() {
    {
      ConsistencySearch search(mesh_, annotation_, shapes_, {}, {}, context_);
      if (search.agrees() && disagreements(surface_.domains.of(annotation_), annotation_, context_).empty())
        return std::nullopt;
      for (std::size_t i = 0; i < annotation_.regions.size(); ++i) savings_[{false, i}] = search.saving({false, i});
      for (std::size_t i = 0; i < annotation_.patterns.size(); ++i) savings_[{true, i}] = search.saving({true, i});
    }
    best_ = search(conceded_);
    while (prefer_a_pattern()) {
    }
    yield_to_all();
    while (improve()) {
    }
    readmit();
    leave_out_disagreements(mesh_, surface_.domains, annotation_, best_.kept, context_);
    return std::move(best_.kept);
  }

 private:
  ConsistencyOutcome search(const Concessions& conceded) {
    if (conceded.yielded.empty()) {
      return ConsistencySearch(mesh_, annotation_, shapes_, conceded.excluded, preferred_, context_).run();
    }
    SymmetryAnnotation yielding = annotation_;
    for (const auto& [region, faces] : conceded.yielded) yielding.regions[region].faces = faces;
    RegionShapes shapes = ConsistencySearch::shapes_of(surface_, yielding);
    ConsistencyOutcome result =
        ConsistencySearch(mesh_, yielding, shapes, conceded.excluded, preferred_, context_).run();
    work_ += shapes.work();
    return result;
  }

  bool has_time() const { return work_ + shapes_.work() < ConsistencyPolicy{}.work; }

  double saving(const std::vector<Claim>& family) const {
    double sum = 0;
    for (const Claim& claim : family) sum += savings_.at(claim);
    return sum;
  }

  std::string name_of(const Claim& claim) const {
    const auto [name, id] =
        claim.pattern ? std::pair(annotation_.patterns[claim.number].name, annotation_.patterns[claim.number].id)
                      : std::pair(annotation_.regions[claim.number].name, annotation_.regions[claim.number].id);
    if (!name.empty()) return "\"" + name + "\"";
    return (claim.pattern ? "pattern " : "region ") + std::to_string(id);
  }

  // Of what overlaps it there are as many versions as a detector has seeds, each of which would take the next one's
  // place: a pattern that saves more than they is held against all of them at once.
  // \return whether one was
  bool prefer_a_pattern() {
    std::vector<Refused> refused = best_.refused;
    std::ranges::stable_sort(refused, std::greater<>(), &Refused::saving);
    for (const Refused& each : refused) {
      const Claim& claim = each.claims.front();
      if (!has_time()) return false;
      if (!claim.pattern || !tried_patterns_.insert(claim.number).second) continue;
      preferred_.insert(claim.number);
      if (take(conceded_, search(conceded_))) return true;
      preferred_.erase(claim.number);
    }
    return false;
  }

  // \return whether something refused could be kept instead of what was in its way, to the good of the whole
  bool improve() {
    struct Change {
      double gain;  // at least one of what bars it would have to go
      const Refused* refused;
    };
    std::vector<Change> changes;
    const std::vector<Refused> refused = best_.refused;
    for (const Refused& each : refused) {
      if (each.against.empty()) continue;
      const auto cost = [&](const std::vector<Claim>& family) { return saving(family); };
      const double least = cost(*std::ranges::min_element(each.against, {}, cost));
      Yielded yielded = conceded_.yielded;
      const double yielding = yield(each, yielded).value_or(least);
      changes.push_back({each.saving - std::min(least, yielding), &each});
    }
    std::ranges::stable_sort(changes, std::greater<>(), &Change::gain);
    return std::ranges::any_of(changes, [&](const Change& change) { return kept_instead(*change.refused); });
  }

  // Lets the region that bars refused claims leave the faces that have lost their image, with all that its group takes
  // them to. \return what that costs; nothing where no such region bars them, it has none of the faces, or less would
  // be left of it than a region must keep
  std::optional<double> yield(const Refused& refused, Yielded& yielded) {
    if (!refused.bar) return std::nullopt;
    const Claim& bar = refused.bar->claim;
    const Region& region = annotation_.regions[bar.number];
    const std::optional<GroupPlace> place = place_of(region);
    if (!place) return std::nullopt;
    const auto known = yielded.find(bar.number);
    const int count = shapes_.count();
    const int now = shapes_.add(known == yielded.end() ? region.faces : known->second);
    const std::vector<int> taken = shapes_.faces_at(now, shapes_.add(refused.bar->faces));
    std::vector<int> rest = taken.empty() ? std::vector<int>{} : shapes_.without_orbit(now, taken, *place);
    const double before = shapes_.area(now);
    shapes_.keep(count);
    const double given = shapes_.area(static_cast<int>(bar.number));
    const double left = shapes_.area_of(rest);
    if (taken.empty() || left < ConsistencyPolicy{}.left * given) return std::nullopt;
    yielded[bar.number] = std::move(rest);
    return savings_.at(bar) * (before - left) / given;
  }

  // The same for all refused claims at once, of which each brings more than it costs. What bars them after that only
  // another search tells, so this goes on until nothing more is left to them.
  void yield_to_all() {
    Concessions trial = conceded_;
    std::vector<Refused> refused = best_.refused;
    while (has_time()) {
      const Yielded before = trial.yielded;
      std::ranges::stable_sort(refused, std::greater<>(), &Refused::saving);
      for (const Refused& each : refused) {
        Yielded yielded = trial.yielded;
        const std::optional<double> cost = yield(each, yielded);
        if (cost && *cost < each.saving) trial.yielded = std::move(yielded);
      }
      if (trial.yielded == before || !tried_.emplace(trial).second) return;
      const ConsistencyOutcome outcome = search(trial);
      take(trial, outcome);
      refused = outcome.refused;
    }
  }

  // Until nothing bars the first of the refused claims, or it would cost more than it brings: lets the region that does
  // leave faces, or leaves out what does, of several that which saves least.
  bool kept_instead(Refused refused) {
    const Claim wanted = refused.claims.front();
    Concessions trial = conceded_;
    double cost = 0;
    while (!refused.against.empty() && has_time()) {
      const auto least = std::ranges::min_element(refused.against, {}, [&](const auto& f) { return saving(f); });
      Yielded yielded = trial.yielded;
      const std::optional<double> yielding = yield(refused, yielded);
      const bool yields = yielding && *yielding < saving(*least);
      cost += yields ? *yielding : saving(*least);
      if (cost >= best_.refused_saving()) return false;
      if (yields) {
        trial.yielded = std::move(yielded);
      } else {
        const std::string reason = "it contradicts " + name_of(wanted) + ", which saves more";
        for (const Claim& claim : *least) trial.excluded.emplace(claim, reason);
      }
      if (!tried_.emplace(trial).second) return false;
      ConsistencyOutcome outcome = search(trial);
      if (take(trial, outcome)) return true;
      const auto again = std::ranges::find_if(outcome.refused, [&](const Refused& each) {
        return std::ranges::find(each.claims, wanted) != each.claims.end();
      });
      if (again == outcome.refused.end()) return false;
      const double saved = refused.saving;
      refused = *again;
      refused.saving = std::max(refused.saving, saved);
    }
    return false;
  }

  // \return whether what the outcome keeps saves more than the best so far
  bool take(const Concessions& conceded, const ConsistencyOutcome& outcome) {
    if (!(outcome.saving > (1 + 1e-9) * best_.saving)) return false;
    best_ = outcome;
    conceded_ = conceded;
    return true;
  }

  // What was left out on the way and does no harm.
  void readmit() {
    const auto without = [&](const auto& given_up) {
      Concessions trial = conceded_;
      if (given_up(trial) && has_time() && tried_.emplace(trial).second) take(trial, search(trial));
    };
    const Concessions all = conceded_;
    for (const auto& each : all.excluded) {
      without([&](Concessions& c) { return c.excluded.erase(each.first) > 0; });
    }
    for (const auto& each : all.yielded) {
      without([&](Concessions& c) { return c.yielded.erase(each.first) > 0; });
    }
  }

  const Mesh& mesh_;
  const SymmetryAnnotation& annotation_;
  const RunContext& context_;
  const ShapeSurface& surface_;
  RegionShapes shapes_;   // of the annotation as it is
  std::size_t work_ = 0;  // that others took
  Concessions conceded_;
  std::set<std::size_t> preferred_;       // patterns with which all else is to agree
  std::set<std::size_t> tried_patterns_;  // that were, or would have been
  std::map<Claim, double> savings_;       // of all claims, whole
  ConsistencyOutcome best_;
  std::set<Concessions> tried_;
};

}  // namespace

std::optional<ConsistentAnnotation> chosen_annotation(const ShapeSurface& surface, const SymmetryAnnotation& annotation,
                                                      const RunContext& context) {
  return Choice(surface, annotation, context).run();
}

}  // namespace orbifit
