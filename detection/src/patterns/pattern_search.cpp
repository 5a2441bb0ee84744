#include "patterns/pattern_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "group/patterns.h"
#include "group/verification.h"
#include "search/completion.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

class PatternSearch {
 public:
  PatternSearch(const PreparedMesh& prepared, const PartRegions& parts, const std::vector<FoundRegion>& regions,
                const PartRegionOptions& options, const RunContext& context)
      : prepared_(prepared),
        parts_(parts),
        regions_(regions),
        options_(options),
        context_(context),
        used_(prepared.components.faces.size(), 0),
        boxes_(prepared.components.faces.size()) {
    for (std::size_t c = 0; c < boxes_.size(); ++c) {
      for (const int face : prepared.components.faces[c]) {
        for (const int vertex : prepared.mesh.faces.row(face)) {
          boxes_[c].extend(Vector3d(prepared.mesh.vertices.row(vertex)));
        }
      }
    }
  }

  std::vector<Pattern> run() {
    for (std::size_t k = 0; k < classes().size() && !late(); ++k) {
      context_.check();
      look_at(k);
    }
    return std::move(found_);
  }

 private:
  struct Instances {
    Arrangement arrangement;
    std::vector<std::vector<int>> parts;  // by instance
  };

  const std::vector<CongruenceClass>& classes() const { return parts_.survey.classes; }
  const SurfaceMoments& moments(int part) const { return parts_.survey.moments[static_cast<std::size_t>(part)]; }
  bool late() const { return options_.late && options_.late(); }

  const GroupPlacement* own_group(std::size_t number) const {
    return parts_.own_groups[number] ? &*parts_.own_groups[number] : nullptr;
  }

  double tolerance_of(int part) const { return options_.tolerance * std::min(1.0, 4 * moments(part).diagonal); }

  bool is_used(int part) const { return used_[static_cast<std::size_t>(part)] != 0; }

  void look_at(std::size_t number) {
    CongruenceClass kind = classes()[number];
    if (kind.members.size() < 2 || std::ranges::any_of(kind.members, [&](int c) { return is_used(c); })) return;
    const double all = moments(kind.members.front()).area * static_cast<double>(kind.members.size());
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
    for (const int c : kind.members) used_[static_cast<std::size_t>(c)] = 1;
    if (arrangement.generators.size() == 1) continue_row(instances);
    if (!options_.pieces) grow(instances);
    add(instances);
  }

  Arrangement arranged(std::size_t number, const CongruenceClass& kind) const {
    const int first = kind.members.front();
    std::optional<GroupPlacement> own = parts_.own_groups[number];
    const int of_class = classes()[number].members.front();
    if (own && first != of_class) own = carried(*own, motion_to(number, first));
    return arrange(kind.motions, own ? &*own : nullptr, moments(first).centroid, moments(first).radius,
                   tolerance_of(first));
  }

  const Motion& motion_to(std::size_t number, int member) const {
    const CongruenceClass& kind = classes()[number];
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

  // Adds copies at the row's next places and in its gaps that the survey did not take for copies: surfaces may differ
  // in their triangles, and a little in shape where they join.
  void continue_row(Instances& instances) {
    const int first = instances.parts.front().front();
    const SurfacePatch patch = make_patch(prepared_, faces_of({first}), 100, options_.tolerance, context_, "pattern");
    const Motion step = instances.arrangement.generators.front();
    for (const Motion& forth : {step, inverse(step)}) {
      Motion motion = forth;
      for (int misses = 0; misses <= 1; motion = forth * motion) {
        const Vector3d goal = motion(moments(first).centroid);
        const auto near = [&](const Motion& other) {
          return (other(moments(first).centroid) - goal).norm() < 2 * options_.tolerance;
        };
        if (std::ranges::any_of(instances.arrangement.motions, near)) continue;
        const int copy = copy_at(patch, motion);
        if (copy < 0) {
          ++misses;
          continue;
        }
        used_[static_cast<std::size_t>(copy)] = 1;
        instances.parts.push_back({copy});
        instances.arrangement.motions.push_back(motion);
      }
    }
  }

  // The part onto which the motion carries nearly all of the patch; -1 for none.
  int copy_at(const SurfacePatch& patch, const Motion& motion) const {
    constexpr double kAlike = 0.1;  // of the area
    for (std::size_t c = 0; c < parts_.survey.moments.size(); ++c) {
      const SurfaceMoments& other = parts_.survey.moments[c];
      if (used_[c] != 0 || std::abs(other.area - patch.moments.area) > kAlike * patch.moments.area) continue;
      if ((other.centroid - motion(patch.moments.centroid)).norm() > 3 * options_.tolerance) continue;
      if (fit_of_copy(patch, motion, prepared_.components.faces[c]).kept >= kKeptOfCopy) return static_cast<int>(c);
    }
    return -1;
  }

  // Adds to the instances the parts that touch them and that the same motions carry along, as long as there are any.
  void grow(Instances& instances) {
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t k = 0; k < classes().size(); ++k) {
        const CongruenceClass& kind = classes()[k];
        if (kind.members.size() < instances.parts.size()) continue;
        for (std::size_t m = 0; m < kind.members.size(); ++m) {
          if (is_used(kind.members[m]) || !touches(kind.members[m], instances.parts.front())) continue;
          const std::vector<int> orbit = orbit_of(k, m, instances);
          if (orbit.empty()) continue;
          for (std::size_t i = 0; i < orbit.size(); ++i) {
            instances.parts[i].push_back(orbit[i]);
            used_[static_cast<std::size_t>(orbit[i])] = 1;
          }
          grown = true;
        }
      }
    }
  }

  bool touches(int part, const std::vector<int>& others) const {
    const Vector3d slack = Vector3d::Constant(0.5 * options_.tolerance);
    const Eigen::AlignedBox3d& box = boxes_[static_cast<std::size_t>(part)];
    const Eigen::AlignedBox3d wider(box.min() - slack, box.max() + slack);
    return std::ranges::any_of(others,
                               [&](int other) { return wider.intersects(boxes_[static_cast<std::size_t>(other)]); });
  }

  // The parts of class k, one an instance, onto which the arrangement's motions carry its m-th member; empty where
  // there are none, or where they are in use.
  std::vector<int> orbit_of(std::size_t k, std::size_t m, const Instances& instances) const {
    const CongruenceClass& kind = classes()[k];
    const SurfaceMoments& mine = moments(kind.members[m]);
    const SurfaceMoments& first = moments(kind.members.front());
    const double tolerance = 3 * tolerance_of(kind.members[m]);
    std::vector<int> orbit;
    for (const Motion& motion : instances.arrangement.motions) {
      const Vector3d goal = motion(mine.centroid);
      std::optional<int> image;
      for (std::size_t j = 0; j < kind.members.size() && !image; ++j) {
        const int part = kind.members[j];
        if (is_used(part) || (moments(part).centroid - goal).norm() > tolerance) continue;
        if (std::ranges::find(orbit, part) != orbit.end()) continue;
        Motion rest = inverse(kind.motions[j]) * motion * kind.motions[m];
        if (own_group(k) != nullptr) rest = straightened(rest, *own_group(k));
        if (motion_distance(rest, Motion{}, first.centroid, first.radius) <= tolerance) image = part;
      }
      if (!image) return {};
      orbit.push_back(*image);
    }
    return orbit;
  }

  // Whether some region's group carries the first member of the class onto each of the others.
  bool related_by_a_region(const CongruenceClass& kind) const {
    const std::vector<int> faces = faces_of(kind.members);
    return std::ranges::any_of(regions_, [&](const FoundRegion& region) {
      if (region.placement.group.continuous()) return false;
      if (area_outside(prepared_, faces, region.faces) > kRelated * area_of(prepared_, faces)) return false;
      const std::vector<Motion> motions =
          judged_motions(region.placement.group, region.placement.frame, region.placement.centre);
      const Vector3d start = moments(kind.members.front()).centroid;
      return std::ranges::all_of(kind.members, [&](int c) {
        const Vector3d goal = moments(c).centroid;
        return c == kind.members.front() || std::ranges::any_of(motions, [&](const Motion& m) {
                 return (m(start) - goal).norm() < 2 * options_.tolerance;
               });
      });
    });
  }

  std::vector<int> faces_of(const std::vector<int>& parts) const {
    std::vector<int> faces;
    for (const int c : parts) {
      std::ranges::copy(prepared_.components.faces[static_cast<std::size_t>(c)], std::back_inserter(faces));
    }
    std::ranges::sort(faces);
    return faces;
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
    const SurfacePatch patch =
        make_patch(prepared_, faces_of(instances.parts.front()), 200, options_.tolerance, context_, "pattern");
    double square = 0;
    int count = 0;
    for (std::size_t i = 0; i < instances.parts.size(); ++i) {
      const Motion& motion = instances.arrangement.motions[i];
      const std::vector<int> faces = faces_of(instances.parts[i]);
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
  const PartRegions& parts_;
  const std::vector<FoundRegion>& regions_;
  const PartRegionOptions& options_;
  const RunContext& context_;
  std::vector<char> used_;                  // by part: in a pattern
  std::vector<Eigen::AlignedBox3d> boxes_;  // by part
  std::vector<Pattern> found_;
};

}  // namespace

std::vector<Pattern> find_patterns(const PreparedMesh& prepared, const PartRegions& parts,
                                   const std::vector<FoundRegion>& regions, const PartRegionOptions& options,
                                   const RunContext& context) {
  return PatternSearch(prepared, parts, regions, options, context).run();
}

}  // namespace orbifit
