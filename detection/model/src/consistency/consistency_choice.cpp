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
  Choice(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context)
      : mesh_(mesh),
        annotation_(annotation),
        context_(context),
        shapes_(ConsistencySearch::shapes_of(mesh, annotation)),
        trials_(ConsistencyPolicy{}.work /
                (1.0 + static_cast<double>(annotation.regions.size()) * static_cast<double>(mesh.faces.rows()))) {}

  ConsistentAnnotation run() {
    if (ConsistencySearch(mesh_, annotation_, shapes_, {}, context_).agrees() &&
        disagreements(mesh_, annotation_, context_).empty()) {
      return {annotation_, {}, 0, 0};
    }
    best_ = search(excluded_);
    while (improve()) {
    }
    readmit();
    leave_out_disagreements(mesh_, annotation_, best_.kept, context_);
    return std::move(best_.kept);
  }

 private:
  ConsistencyOutcome search(const Excluded& excluded, std::optional<Claim> wanted = {}) {
    ++searches_;
    return ConsistencySearch(mesh_, annotation_, shapes_, excluded, context_).run(wanted);
  }

  double saving(const std::vector<Claim>& family) {
    const ConsistencySearch search(mesh_, annotation_, shapes_, {}, context_);
    double sum = 0;
    for (const Claim& claim : family) sum += search.saving(claim);
    return sum;
  }

  std::string name_of(const Claim& claim) const {
    const auto [name, id] =
        claim.pattern ? std::pair(annotation_.patterns[claim.number].name, annotation_.patterns[claim.number].id)
                      : std::pair(annotation_.regions[claim.number].name, annotation_.regions[claim.number].id);
    if (!name.empty()) return "\"" + name + "\"";
    return (claim.pattern ? "pattern " : "region ") + std::to_string(id);
  }

  // \return whether something refused could be kept instead of what was in its way, to the good of the whole
  bool improve() {
    std::vector<Refused> refused = best_.refused;
    std::ranges::stable_sort(refused, std::greater<>(), &Refused::saving);
    return std::ranges::any_of(refused, [&](const Refused& each) { return kept_instead(each); });
  }

  // Leaves out what bars the first of the refused claims, of several that which saves least, until nothing does or it
  // would cost more than it brings.
  bool kept_instead(Refused refused) {
    const Claim wanted = refused.claims.front();
    Excluded trial = excluded_;
    double cost = 0;
    while (!refused.against.empty() && searches_ < trials_) {
      const auto least = std::ranges::min_element(refused.against, {}, [&](const auto& f) { return saving(f); });
      cost += saving(*least);
      if (cost >= best_.refused_saving()) return false;
      const std::string reason = "it contradicts " + name_of(wanted) + ", which saves more";
      for (const Claim& claim : *least) trial.emplace(claim, reason);
      if (!tried_.emplace(trial).second) return false;
      ConsistencyOutcome outcome = search(trial, wanted);
      const auto again = std::ranges::find_if(outcome.refused, [&](const Refused& each) {
        return std::ranges::find(each.claims, wanted) != each.claims.end();
      });
      if (again == outcome.refused.end()) return take(std::move(trial), std::move(outcome));
      const double saved = refused.saving;
      refused = *again;
      refused.saving = std::max(refused.saving, saved);
    }
    return false;
  }

  // \return whether what the outcome keeps saves more than the best so far
  bool take(Excluded excluded, ConsistencyOutcome outcome) {
    if (!(outcome.saving > (1 + 1e-9) * best_.saving)) return false;
    best_ = std::move(outcome);
    excluded_ = std::move(excluded);
    return true;
  }

  // What was left out on the way and does no harm.
  void readmit() {
    const Excluded all = excluded_;
    for (const auto& [claim, reason] : all) {
      if (searches_ >= trials_) return;
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
  ConsistencyOutcome best_;
  std::set<Excluded> tried_;
  double trials_;
  double searches_ = 0;
};

}  // namespace

ConsistentAnnotation chosen_annotation(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                       const RunContext& context) {
  return Choice(mesh, annotation, context).run();
}

}  // namespace orbifit
