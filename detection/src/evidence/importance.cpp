#include "evidence/importance.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "evidence/claim_quotient.h"
#include "evidence/claims.h"
#include "evidence/policy.h"

namespace orbifit {

namespace {

struct Listed {
  std::vector<std::size_t> family;
  double importance;
  bool listed;
};

// Families in greedy order. Savings only fall as more is known, so one that saves most, asked anew, saves most of all.
std::vector<Listed> greedy_order(ClaimQuotient& quotient, std::vector<std::vector<std::size_t>> families, bool all,
                                 const RunContext& context) {
  struct Waiting {
    std::vector<std::size_t> family;
    double saving;
    bool current;
  };
  std::vector<Waiting> waiting;
  for (std::vector<std::size_t>& family : families) waiting.push_back({std::move(family), 0, true});
  parallel_for(context, waiting.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) waiting[i].saving = quotient.saving(waiting[i].family);
  });
  std::vector<Listed> order;
  const EvidencePolicy policy;
  const double surface = quotient.area();  // of which nothing is known yet
  double left = surface;
  while (!waiting.empty()) {
    context.check();
    const auto best = std::ranges::max_element(waiting, {}, &Waiting::saving);
    if (!best->current) {
      best->saving = quotient.saving(best->family);
      best->current = true;
      continue;
    }
    const double importance = left > 0 ? std::clamp(best->saving / left, 0.0, 1.0) : 0;
    const ClaimQuotient::NamedArea named = quotient.named_area(best->family);
    const bool says_more = best->saving > policy.sliver * named.left ||
                           (named.all >= policy.main_part * surface && !quotient.lies_within_accepted(best->family));
    order.push_back({std::move(best->family), importance, says_more || all});
    waiting.erase(best);
    if (!says_more) continue;
    quotient.accept(order.back().family);
    left = quotient.area();
    for (Waiting& rest : waiting) rest.current = false;
  }
  return order;
}

void note_left_out(Explanation* explanation, const SymmetryClaim& claim) {
  if (explanation == nullptr) return;
  const std::string subject = claim.region != nullptr ? claim.region->group.symbol() + " on " + claim.region->name
                                                      : to_string(claim.pattern->kind) + " of " + claim.pattern->name;
  explanation->notes.push_back({"importance", subject, false, "saves next to nothing that those listed have not"});
}

}  // namespace

std::vector<std::vector<std::size_t>> list_by_importance(const PreparedMesh& prepared, SymmetryAnnotation& annotation,
                                                         bool all, Explanation* explanation,
                                                         const RunContext& context) {
  context.progress("importance", 0);
  const SymmetryAnnotation local = transformed(annotation, inverse(prepared.input_of_normalised));
  const std::vector<SymmetryClaim> claims = claims_of(local);
  const ClaimAtoms atoms(prepared, claims);
  ClaimQuotient quotient(prepared, claims, atoms, annotation.tolerance, context);
  std::vector<Region> regions;
  std::vector<Pattern> patterns;
  std::vector<std::vector<std::size_t>> listed;
  for (const Listed& entry :
       greedy_order(quotient, families_of(prepared, claims, atoms, annotation.tolerance), all, context)) {
    std::vector<std::size_t> family;
    for (const std::size_t claim : entry.family) {
      if (!entry.listed) {
        note_left_out(explanation, claims[claim]);
      } else if (claim < annotation.regions.size()) {
        family.push_back(regions.size());
        regions.push_back(std::move(annotation.regions[claim]));
        regions.back().importance = entry.importance;
      } else {
        patterns.push_back(std::move(annotation.patterns[claim - annotation.regions.size()]));
        patterns.back().importance = entry.importance;
      }
    }
    if (!family.empty()) listed.push_back(std::move(family));
  }
  for (std::size_t i = 0; i < regions.size(); ++i) regions[i].id = static_cast<int>(i);
  for (std::size_t i = 0; i < patterns.size(); ++i) patterns[i].id = static_cast<int>(i);
  set_parents(regions);
  annotation.regions = std::move(regions);
  annotation.patterns = std::move(patterns);
  return listed;
}

}  // namespace orbifit
