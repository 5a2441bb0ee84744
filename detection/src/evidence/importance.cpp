#include "evidence/importance.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "consistency/halvings.h"
#include "domains/closed_sets.h"
#include "evidence/claim_quotient.h"
#include "evidence/claims.h"
#include "evidence/policy.h"

namespace orbifit {

namespace {

using Families = std::vector<std::vector<std::size_t>>;

struct Chosen {
  Families kept, left_out;
};

// Whether the claim ends where parts do, and not within one.
class PartEnds {
 public:
  explicit PartEnds(const PreparedMesh& prepared) : parts_(prepared.components.faces) {
    part_of_face_.resize(static_cast<std::size_t>(prepared.mesh.faces.rows()), -1);
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      for (const int face : parts_[part]) part_of_face_[static_cast<std::size_t>(face)] = static_cast<int>(part);
    }
  }

  bool hold(const SymmetryClaim& claim) const {
    return std::ranges::all_of(claim.pieces, [&](const std::vector<int>* faces) {
      std::map<int, std::size_t> counts;
      for (const int face : *faces) ++counts[part_of_face_[static_cast<std::size_t>(face)]];
      return std::ranges::all_of(counts, [&](const auto& each) {
        return each.first < 0 || each.second == parts_[static_cast<std::size_t>(each.first)].size();
      });
    });
  }

 private:
  const std::vector<std::vector<int>>& parts_;
  std::vector<int> part_of_face_;  // -1: of no area
};

// The claims of an annotation, and the quotient of which nothing is known yet.
struct Weighed {
  Weighed(const PreparedMesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context)
      : prepared(mesh),
        local(transformed(annotation, inverse(mesh.input_of_normalised))),
        claims(claims_of(local)),
        atoms(mesh, claims),
        quotient(mesh, claims, atoms, annotation.tolerance, context),
        families(families_of(mesh, claims, atoms, annotation.tolerance)) {}

  const PreparedMesh& prepared;
  SymmetryAnnotation local;  // in the prepared mesh's frame
  std::vector<SymmetryClaim> claims;
  ClaimAtoms atoms;
  ClaimQuotient quotient;
  Families families;
};

// Joins families of which motions take one to another: of what is consistent, they stand or fall together.
void join_images(Weighed& weighed, const RunContext& context) {
  const std::size_t regions = weighed.local.regions.size();
  DisjointSets joined(weighed.claims.size());
  const auto unite = [&](std::size_t a, std::size_t b) { joined.unite(static_cast<int>(a), static_cast<int>(b)); };
  for (const std::vector<std::size_t>& family : weighed.families) {
    for (const std::size_t claim : family) unite(family.front(), claim);
  }
  std::vector<ClaimFamily> images;
  disagreements(weighed.prepared.mesh, weighed.local, context, &images);
  const auto number = [&](const Claim& claim) { return claim.pattern ? regions + claim.number : claim.number; };
  for (const ClaimFamily& family : images) {
    for (const Claim& claim : family) unite(number(family.front()), number(claim));
  }
  weighed.families = joined.sets();
}

double halvings_of(const SymmetryClaim& claim) {
  return claim.region != nullptr ? halvings(claim.region->group) : halvings(claim.pieces.size());
}

// What a person would name: claims on whole parts first, then those that end within one; each in the order of how often
// a family's motions halve its area, times that area; of them those that say more than what comes before. So parts and
// rows come before what follows from them.
Chosen chosen_families(const Weighed& weighed, const RunContext& context) {
  struct Rated {
    std::vector<std::size_t> family;
    bool within_a_part;
    double area, saving;
  };
  ClaimQuotient quotient = weighed.quotient;
  const double surface = quotient.area();
  const PartEnds parts(weighed.prepared);
  std::vector<Rated> rated;
  for (const std::vector<std::size_t>& family : weighed.families) {
    const double area = quotient.named_area(family).all;
    const bool whole =
        std::ranges::all_of(family, [&](std::size_t claim) { return parts.hold(weighed.claims[claim]); });
    rated.push_back({family, !whole, area, area * halvings_of(weighed.claims[family.front()])});
  }
  std::ranges::stable_sort(rated, {}, [](const Rated& each) { return std::pair(each.within_a_part, -each.saving); });
  Chosen result;
  for (Rated& each : rated) {
    context.check();
    const double saving = quotient.saving(each.family);
    const bool tiny = each.within_a_part && saving < kEvidencePolicy.least * quotient.area();
    const bool says_more =
        (saving > kEvidencePolicy.sliver * quotient.named_area(each.family).left && !tiny) ||
        (each.area >= kEvidencePolicy.main_part * surface && !quotient.lies_within_accepted(each.family));
    if (says_more) quotient.accept(each.family);
    (says_more ? result.kept : result.left_out).push_back(std::move(each.family));
  }
  return result;
}

struct Listed {
  std::vector<std::size_t> family;
  double importance;
};

// Families in greedy order. Savings only fall as more is known, so one that saves most, asked anew, saves most of all.
std::vector<Listed> greedy_order(ClaimQuotient quotient, Families families, const RunContext& context) {
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
  double left = quotient.area();
  while (!waiting.empty()) {
    context.check();
    const auto best = std::ranges::max_element(waiting, {}, &Waiting::saving);
    if (!best->current) {
      best->saving = quotient.saving(best->family);
      best->current = true;
      continue;
    }
    order.push_back({std::move(best->family), left > 0 ? std::clamp(best->saving / left, 0.0, 1.0) : 0});
    waiting.erase(best);
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

SymmetryAnnotation without_what_follows(const PreparedMesh& prepared, const SymmetryAnnotation& annotation,
                                        const RunContext& context) {
  const Weighed weighed(prepared, annotation, context);
  const Chosen chosen = chosen_families(weighed, context);
  std::vector<bool> kept(weighed.claims.size(), false);
  for (const std::vector<std::size_t>& family : chosen.kept) {
    for (const std::size_t claim : family) kept[claim] = true;
  }
  SymmetryAnnotation result = annotation;
  result.regions.clear();
  result.patterns.clear();
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    if (kept[i]) result.regions.push_back(annotation.regions[i]);
  }
  for (std::size_t i = 0; i < annotation.patterns.size(); ++i) {
    if (kept[annotation.regions.size() + i]) result.patterns.push_back(annotation.patterns[i]);
  }
  return result;
}

std::vector<std::vector<std::size_t>> list_by_importance(const PreparedMesh& prepared, SymmetryAnnotation& annotation,
                                                         bool all, Explanation* explanation,
                                                         const RunContext& context) {
  context.progress("importance", 0);
  Weighed weighed(prepared, annotation, context);
  join_images(weighed, context);
  Chosen chosen = chosen_families(weighed, context);
  std::vector<Listed> order = greedy_order(weighed.quotient, std::move(chosen.kept), context);
  for (std::vector<std::size_t>& family : chosen.left_out) {
    if (all) {
      order.push_back({std::move(family), 0});
    } else {
      for (const std::size_t claim : family) note_left_out(explanation, weighed.claims[claim]);
    }
  }
  std::vector<Region> regions;
  std::vector<Pattern> patterns;
  std::vector<std::vector<std::size_t>> listed;
  for (const Listed& entry : order) {
    std::vector<std::size_t> family;
    for (const std::size_t claim : entry.family) {
      if (claim < annotation.regions.size()) {
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
