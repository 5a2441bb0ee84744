#include "consistency/consistency_closure.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "consistency/consistency_search.h"
#include "consistency/halvings.h"
#include "domains/closed_sets.h"

namespace orbifit {

namespace {

class Closure {
 public:
  Closure(const Mesh& mesh, KnownDomains& domains, const SymmetryAnnotation& given, ConsistentAnnotation& kept,
          const RunContext& context)
      : domains_(domains), given_(given), kept_(kept), context_(context), areas_(face_areas(mesh)) {}

  // What motions take to one another goes together: without one, the others would lose their image.
  // \param named  disagreements() or unclosed_groups()
  // \return whether anything had to go
  bool leave_out_one(decltype(unclosed_groups)* named) {
    std::vector<ClaimFamily> families;
    const Disagreements pairs = named(domains_.of(kept_.annotation), kept_.annotation, context_, &families);
    std::map<Claim, std::size_t> family_of;
    std::vector<double> savings(families.size(), 0);
    for (std::size_t f = 0; f < families.size(); ++f) {
      for (const Claim& claim : families[f]) {
        family_of[claim] = f;
        savings[f] += kept_saving(claim);
      }
    }
    std::map<std::size_t, std::set<std::size_t>> against;
    for (const auto& [pair, count] : pairs) {
      const std::size_t a = family_of.at(pair.first);
      const std::size_t b = family_of.at(pair.second);
      against[a].insert(b);
      against[b].insert(a);
    }
    const ClaimFamily* worst = nullptr;
    double most = 0;
    for (const auto& [family, others] : against) {
      double barred = 0;
      for (const std::size_t other : others) barred += savings[other];
      const double ratio = barred / savings[family];
      if (ratio <= most ||
          std::ranges::any_of(families[family], [&](const Claim& claim) { return holds_everything(claim); })) {
        continue;
      }
      most = ratio;
      worst = &families[family];
    }
    if (worst == nullptr) return false;
    const auto among = [&](const Claim& claim) { return std::ranges::binary_search(*worst, claim); };
    const auto partner = std::ranges::find_if(
        pairs, [&](const auto& entry) { return among(entry.first.first) || among(entry.first.second); });
    leave_out(*worst, among(partner->first.first) ? partner->first.second : partner->first.first);
    return true;
  }

 private:
  double area(const std::vector<int>& faces) const {
    return std::accumulate(faces.begin(), faces.end(), 0.0, [&](double sum, int face) { return sum + areas_[face]; });
  }

  bool holds_everything(const Claim& claim) const {
    return !claim.pattern &&
           area(kept_.annotation.regions[claim.number].faces) >= ConsistencyPolicy{}.everything * areas_.sum();
  }

  // Of a claim on what is kept.
  double kept_saving(const Claim& claim) const {
    const SymmetryAnnotation& kept = kept_.annotation;
    if (!claim.pattern) {
      const Region& region = kept.regions[claim.number];
      return area(region.faces) * halvings(region.group);
    }
    const Pattern& pattern = kept.patterns[claim.number];
    double sum = 0;
    for (const PatternInstance& instance : pattern.instances) sum += area(instance.faces);
    return sum * halvings(pattern.instances.size());
  }

  void leave_out(const ClaimFamily& family, const Claim& other) {
    const std::string reason =
        family == ClaimFamily{other}
            ? "its copies disagree about what lies on them"
            : "where it meets " + kept_label(other) + ", the motions of the one do not take the other along";
    for (auto claim = family.rbegin(); claim != family.rend(); ++claim) leave_out(*claim, reason);  // numbers stay
    set_parents(kept_.annotation.regions);
  }

  void leave_out(const Claim& claim, const std::string& reason) {
    SymmetryAnnotation& kept = kept_.annotation;
    const auto number = static_cast<std::ptrdiff_t>(claim.number);
    if (claim.pattern) {
      const Pattern& pattern = kept.patterns[claim.number];
      kept_.left_out.push_back({true, pattern.id, pattern.name, to_string(pattern.kind), reason});
      kept.patterns.erase(kept.patterns.begin() + number);
      return;
    }
    const Region& region = kept.regions[claim.number];
    const bool given = std::ranges::any_of(given_.regions, [&](const Region& r) { return r.id == region.id; });
    if (given) {
      kept_.left_out.push_back({false, region.id, region.name, region.group.symbol(), reason});
    } else {
      --kept_.added;
    }
    kept.regions.erase(kept.regions.begin() + number);
  }

  std::string kept_label(const Claim& claim) const {
    const SymmetryAnnotation& kept = kept_.annotation;
    if (claim.pattern) {
      const Pattern& pattern = kept.patterns[claim.number];
      return "\"" + (pattern.name.empty() ? "pattern " + std::to_string(pattern.id) : pattern.name) + "\" (" +
             to_string(pattern.kind) + ")";
    }
    const Region& region = kept.regions[claim.number];
    return "\"" + (region.name.empty() ? "region " + std::to_string(region.id) : region.name) + "\" (" +
           region.group.symbol() + ")";
  }

  KnownDomains& domains_;
  const SymmetryAnnotation& given_;
  ConsistentAnnotation& kept_;
  const RunContext& context_;
  Eigen::VectorXd areas_;
};

}  // namespace

void leave_out_disagreements(const Mesh& mesh, KnownDomains& domains, const SymmetryAnnotation& given,
                             ConsistentAnnotation& kept, const RunContext& context) {
  Closure closure(mesh, domains, given, kept, context);
  while (closure.leave_out_one(disagreements)) {
  }
}

bool leave_out_unclosed(const Mesh& mesh, KnownDomains& domains, const SymmetryAnnotation& given,
                        ConsistentAnnotation& kept, const RunContext& context) {
  Closure closure(mesh, domains, given, kept, context);
  bool any = false;
  while (closure.leave_out_one(unclosed_groups)) any = true;
  return any;
}

}  // namespace orbifit
