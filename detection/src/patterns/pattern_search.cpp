#include "patterns/pattern_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "group/patterns.h"
#include "group/verification.h"
#include "patterns/instance_growth.h"
#include "search/completion.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

class PatternSearch {
 public:
  PatternSearch(const PreparedMesh& prepared, const PartRegions& parts, const std::vector<FoundRegion>& regions,
                const PartRegionOptions& options, const RunContext& context)
      : prepared_(prepared),
        regions_(regions),
        options_(options),
        context_(context),
        table_(prepared, parts, options.tolerance),
        growth_(table_, context) {}

  std::vector<Pattern> run() {
    for (std::size_t k = 0; k < table_.classes().size() && !late(); ++k) {
      context_.check();
      look_at(k);
    }
    return std::move(found_);
  }

 private:
  bool late() const { return options_.late && options_.late(); }

  void look_at(std::size_t number) {
    CongruenceClass kind = table_.classes()[number];
    if (kind.members.size() < 2 || std::ranges::any_of(kind.members, [&](int c) { return growth_.is_used(c); })) return;
    const double all = table_.moments(kind.members.front()).area * static_cast<double>(kind.members.size());
    if (all < options_.least_share * prepared_.area) return;
    Instances instances{arranged(number, kind), {}};
    const Arrangement& arrangement = instances.arrangement;
    if (arrangement.kind == Pattern::Kind::congruent) leave_one_out(number, kind, instances.arrangement);
    // A group says more than a pattern, unless the pattern is a true row or grid.
    const bool ordered = arrangement.kind != Pattern::Kind::congruent;
    const bool lattice = ordered && arrangement.kind != Pattern::Kind::rotation &&
                         kind.members.size() > (std::size_t{1} << arrangement.generators.size());
    if (options_.pieces && !lattice && (!ordered || kind.members.size() < 3)) return;
    constexpr double kTrueLattice = 0.75;  // six places of a hexagon are of nine of a lattice
    if (!(lattice && arrangement.filled >= kTrueLattice) && related_by_a_region(kind)) return;
    for (const int c : kind.members) instances.parts.push_back({c});
    for (const int c : kind.members) growth_.use(c);
    if (arrangement.generators.size() == 1) growth_.continue_row(instances);
    if (!options_.pieces) growth_.grow(instances);
    add(instances);
  }

  Arrangement arranged(std::size_t number, const CongruenceClass& kind) const {
    const int first = kind.members.front();
    std::optional<GroupPlacement> own;
    if (const GroupPlacement* of_class = table_.own_group(number)) {
      const bool itself = first == table_.classes()[number].members.front();
      own = itself ? *of_class : carried(*of_class, motion_to(number, first));
    }
    const SurfaceMoments& moments = table_.moments(first);
    const double tolerance = table_.tolerance_of(first);
    Arrangement found = arrange(kind.motions, own ? &*own : nullptr, moments.centroid, moments.radius, tolerance);
    if (found.kind != Pattern::Kind::congruent) return found;
    // A copy may be turned and lie as if it were not, by more than the own group that was found of it.
    std::vector<Motion> shifts;
    for (const int c : kind.members) {
      shifts.push_back({Eigen::Matrix3d::Identity(), table_.moments(c).centroid - moments.centroid});
    }
    Arrangement shifted = arrange(shifts, nullptr, moments.centroid, moments.radius, tolerance);
    return shifted.kind != Pattern::Kind::congruent && are_copies(kind.members, shifted.motions) ? shifted : found;
  }

  bool are_copies(const std::vector<int>& members, const std::vector<Motion>& motions) const {
    const SurfacePatch patch = patch_of({members.front()});
    for (std::size_t i = 1; i < members.size(); ++i) {
      context_.check();
      if (fit_of_copy(patch, motions[i], table_.faces_of({members[i]})).kept < kKeptOfCopy) return false;
    }
    return true;
  }

  SurfacePatch patch_of(const std::vector<int>& parts) const {
    constexpr int kSamples = 200;
    return make_patch(prepared_, table_.faces_of(parts), kSamples, options_.tolerance, context_, "pattern");
  }

  const Motion& motion_to(std::size_t number, int member) const {
    const CongruenceClass& kind = table_.classes()[number];
    return kind.motions[static_cast<std::size_t>(std::ranges::find(kind.members, member) - kind.members.begin())];
  }

  // Where all copies but one are in order, leaves that one out: one of many may be out of place.
  void leave_one_out(std::size_t number, CongruenceClass& kind, Arrangement& arrangement) const {
    constexpr std::size_t kMin = 6;  // any few are in some order
    constexpr std::size_t kMax = 40;
    if (kind.members.size() < kMin || kind.members.size() > kMax) return;
    for (std::size_t out = 0; out < kind.members.size(); ++out) {
      context_.check();
      CongruenceClass others = kind;
      others.members.erase(others.members.begin() + static_cast<std::ptrdiff_t>(out));
      others.motions.erase(others.motions.begin() + static_cast<std::ptrdiff_t>(out));
      if (out == 0) {
        const Motion back = inverse(others.motions.front());
        for (Motion& motion : others.motions) motion = motion * back;
        others.motions.front() = {};
      }
      Arrangement found = arranged(number, others);
      if (found.kind == Pattern::Kind::congruent) continue;
      kind = std::move(others);
      arrangement = std::move(found);
      return;
    }
  }

  // Whether some region's group carries the first member of the class onto each of the others.
  bool related_by_a_region(const CongruenceClass& kind) const {
    const std::vector<int> faces = table_.faces_of(kind.members);
    return std::ranges::any_of(regions_, [&](const FoundRegion& region) {
      if (region.placement.group.continuous()) return false;
      if (area_outside(prepared_, faces, region.faces) > kRelated * area_of(prepared_, faces)) return false;
      const std::vector<Motion> motions =
          judged_motions(region.placement.group, region.placement.frame, region.placement.centre);
      const Vector3d start = table_.moments(kind.members.front()).centroid;
      return std::ranges::all_of(kind.members, [&](int c) {
        const Vector3d goal = table_.moments(c).centroid;
        return c == kind.members.front() || std::ranges::any_of(motions, [&](const Motion& m) {
                 return (m(start) - goal).norm() < 2 * options_.tolerance;
               });
      });
    });
  }

  void add(const Instances& instances) {
    Pattern pattern;
    pattern.id = static_cast<int>(found_.size());
    std::vector<int> all;
    for (const std::vector<int>& each : instances.parts) std::ranges::copy(each, std::back_inserter(all));
    std::ranges::sort(all);
    pattern.name = name_of_parts(all);
    pattern.kind = instances.arrangement.kind;
    for (const Motion& step : instances.arrangement.generators) {
      pattern.generators.push_back(conjugate(prepared_.input_of_normalised, step));
    }
    const SurfacePatch patch = patch_of(instances.parts.front());
    double square = 0;
    int count = 0;
    for (std::size_t i = 0; i < instances.parts.size(); ++i) {
      const Motion& motion = instances.arrangement.motions[i];
      const std::vector<int> faces = table_.faces_of(instances.parts[i]);
      const CopyFit copy = fit_of_copy(patch, motion, faces);
      if (copy.kept < kKeptOfCopy) continue;
      square += copy.square;
      count += static_cast<int>(patch.samples.points.rows());
      pattern.residual.max = std::max(pattern.residual.max, copy.largest);
      pattern.instances.push_back({i == 0 ? Motion{} : conjugate(prepared_.input_of_normalised, motion), faces});
    }
    pattern.residual.rms = std::sqrt(square / std::max(count, 1));
    const bool enough = pattern.instances.size() == instances.parts.size() || pattern.instances.size() >= 3;
    note(instances, enough);
    if (enough) found_.push_back(std::move(pattern));
  }

  void note(const Instances& instances, bool kept) const {
    if (options_.explanation == nullptr) return;
    options_.explanation->notes.push_back({options_.pieces ? "segments: patterns" : "patterns",
                                           to_string(instances.arrangement.kind) + " of " +
                                               std::to_string(instances.parts.size()) + " times " +
                                               name_of_parts(instances.parts.front()),
                                           kept, kept ? "no region relates them" : "not verified"});
  }

  static constexpr double kRelated = 0.02;  // of the area outside of the region

  const PreparedMesh& prepared_;
  const std::vector<FoundRegion>& regions_;
  const PartRegionOptions& options_;
  const RunContext& context_;
  PartTable table_;
  InstanceGrowth growth_;  // of the table
  std::vector<Pattern> found_;
};

}  // namespace

std::vector<Pattern> find_patterns(const PreparedMesh& prepared, const PartRegions& parts,
                                   const std::vector<FoundRegion>& regions, const PartRegionOptions& options,
                                   const RunContext& context) {
  return PatternSearch(prepared, parts, regions, options, context).run();
}

}  // namespace orbifit
