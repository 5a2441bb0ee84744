#include "consistency/consistency_choice.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "consistency/consistency_closure.h"
#include "consistency/consistency_search.h"
#include "domains/closed_sets.h"

namespace orbifit {

namespace {

using Excluded = std::map<Claim, std::string>;

class Choice {
 public:
  Choice(const ShapeSurface& surface, const SymmetryAnnotation& annotation, const RunContext& context)
      : mesh_(surface.mesh),
        annotation_(annotation),
        context_(context),
        shapes_(ConsistencySearch::shapes_of(surface, annotation)) {}

  std::optional<ConsistentAnnotation> run() {
    {
      ConsistencySearch search(mesh_, annotation_, shapes_, {}, {}, context_);
      if (search.agrees() && disagreements(mesh_, annotation_, context_).empty()) return std::nullopt;
      for (std::size_t i = 0; i < annotation_.regions.size(); ++i) savings_[{false, i}] = search.saving({false, i});
      for (std::size_t i = 0; i < annotation_.patterns.size(); ++i) savings_[{true, i}] = search.saving({true, i});
    }
    best_ = search(excluded_);
    while (prefer_a_pattern()) {
    }
    while (improve()) {
    }
    readmit();
    leave_out_disagreements(mesh_, annotation_, best_.kept, context_);
    return std::move(best_.kept);
  }

 private:
  ConsistencyOutcome search(const Excluded& excluded) {
    return ConsistencySearch(mesh_, annotation_, shapes_, excluded, preferred_, context_).run();
  }

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
      if (shapes_.work() >= ConsistencyPolicy{}.work) return false;
      if (!claim.pattern || !tried_patterns_.insert(claim.number).second) continue;
      preferred_.insert(claim.number);
      if (take(excluded_, search(excluded_))) return true;
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
      changes.push_back({each.saving - cost(*std::ranges::min_element(each.against, {}, cost)), &each});
    }
    std::ranges::stable_sort(changes, std::greater<>(), &Change::gain);
    return std::ranges::any_of(changes, [&](const Change& change) { return kept_instead(*change.refused); });
  }

  // Leaves out what bars the first of the refused claims, of several that which saves least, until nothing does or it
  // would cost more than it brings.
  bool kept_instead(Refused refused) {
    const Claim wanted = refused.claims.front();
    Excluded trial = excluded_;
    double cost = 0;
    while (!refused.against.empty() && shapes_.work() < ConsistencyPolicy{}.work) {
      const auto least = std::ranges::min_element(refused.against, {}, [&](const auto& f) { return saving(f); });
      cost += saving(*least);
      if (cost >= best_.refused_saving()) return false;
      const std::string reason = "it contradicts " + name_of(wanted) + ", which saves more";
      for (const Claim& claim : *least) trial.emplace(claim, reason);
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
  bool take(const Excluded& excluded, const ConsistencyOutcome& outcome) {
    if (!(outcome.saving > (1 + 1e-9) * best_.saving)) return false;
    best_ = outcome;
    excluded_ = excluded;
    return true;
  }

  // What was left out on the way and does no harm.
  void readmit() {
    const Excluded all = excluded_;
    for (const auto& [claim, reason] : all) {
      if (shapes_.work() >= ConsistencyPolicy{}.work) return;
      Excluded trial = excluded_;
      trial.erase(claim);
      if (trial.size() != excluded_.size() && tried_.emplace(trial).second) take(trial, search(trial));
    }
  }

  const Mesh& mesh_;
  const SymmetryAnnotation& annotation_;
  const RunContext& context_;
  RegionShapes shapes_;
  Excluded excluded_;
  std::set<std::size_t> preferred_;       // patterns with which all else is to agree
  std::set<std::size_t> tried_patterns_;  // that were, or would have been
  std::map<Claim, double> savings_;       // of all claims, whole
  ConsistencyOutcome best_;
  std::set<Excluded> tried_;
};

}  // namespace

std::optional<ConsistentAnnotation> chosen_annotation(const ShapeSurface& surface, const SymmetryAnnotation& annotation,
                                                      const RunContext& context) {
  return Choice(surface, annotation, context).run();
}

}  // namespace orbifit
