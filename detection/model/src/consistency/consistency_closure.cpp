#include "consistency/consistency_closure.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "consistency/consistency_search.h"
#include "consistency/halvings.h"
#include "domains/closed_sets.h"

namespace orbifit {

namespace {

class Closure {
 public:
  Closure(const Mesh& mesh, const SymmetryAnnotation& given, ConsistentAnnotation& kept, const RunContext& context)
      : mesh_(mesh), given_(given), kept_(kept), context_(context), areas_(face_areas(mesh)) {}

  // \return whether anything had to go
  bool leave_out_disagreement() {
    SymmetryAnnotation& kept = kept_.annotation;
    const Disagreements pairs = disagreements(mesh_, kept, context_);
    std::map<Claim, double> barred;
    for (const auto& [pair, count] : pairs) {
      barred[pair.first] += kept_saving(pair.second);
      barred[pair.second] += kept_saving(pair.first);
    }
    const Claim* worst = nullptr;
    double most = 0;
    for (const auto& [claim, sum] : barred) {
      const double ratio = sum / kept_saving(claim);
      if (holds_everything(claim) || ratio <= most) continue;
      most = ratio;
      worst = &claim;
    }
    if (worst == nullptr) return false;
    const auto partner = std::ranges::find_if(
        pairs, [&](const auto& entry) { return entry.first.first == *worst || entry.first.second == *worst; });
    leave_out(*worst, partner->first.first == *worst ? partner->first.second : partner->first.first);
    return true;
  }

 private:
  bool holds_everything(const Claim& claim) const {
    return !claim.pattern &&
           kept_.annotation.regions[claim.number].faces.size() == static_cast<std::size_t>(mesh_.faces.rows());
  }

  // Of a claim on what is kept.
  double kept_saving(const Claim& claim) const {
    const SymmetryAnnotation& kept = kept_.annotation;
    const auto area = [&](const std::vector<int>& faces) {
      return std::accumulate(faces.begin(), faces.end(), 0.0, [&](double sum, int face) { return sum + areas_[face]; });
    };
    if (!claim.pattern) {
      const Region& region = kept.regions[claim.number];
      return area(region.faces) * halvings(region.group);
    }
    const Pattern& pattern = kept.patterns[claim.number];
    double sum = 0;
    for (const PatternInstance& instance : pattern.instances) sum += area(instance.faces);
    return sum * halvings(pattern.instances.size());
  }

  void leave_out(const Claim& claim, const Claim& other) {
    SymmetryAnnotation& kept = kept_.annotation;
    const auto number = static_cast<std::ptrdiff_t>(claim.number);
    const std::string reason =
        other == claim ? "its copies disagree about what lies on them"
                       : "where it meets " + kept_label(other) + ", the motions of the one do not take the other along";
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
    set_parents(kept.regions);
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

  const Mesh& mesh_;
  const SymmetryAnnotation& given_;
  ConsistentAnnotation& kept_;
  const RunContext& context_;
  Eigen::VectorXd areas_;
};

}  // namespace

void leave_out_disagreements(const Mesh& mesh, const SymmetryAnnotation& given, ConsistentAnnotation& kept,
                             const RunContext& context) {
  Closure closure(mesh, given, kept, context);
  while (closure.leave_out_disagreement()) {
  }
}

}  // namespace orbifit
