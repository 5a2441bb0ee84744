#include "orbifit/detection/detect.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <string>

#include <Eigen/Eigenvalues>

#include "orbifit/detection/axis_orders.h"
#include "orbifit/detection/candidates.h"
#include "orbifit/detection/components.h"
#include "orbifit/detection/featureless.h"
#include "orbifit/detection/own_group.h"
#include "orbifit/detection/patterns.h"
#include "orbifit/detection/region_growth.h"
#include "orbifit/detection/surface_patch.h"
#include "orbifit/detection/verification.h"
#include "orbifit/model/errors.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kLeastShare = 0.002;  // of the mesh's area: smaller regions and patterns say little
constexpr int kScreenDirections = 2500;
constexpr int kPartSamples = 700;
constexpr std::size_t kMostPartRegions = 200;

struct Found {
  GroupPlacement placement;
  std::vector<int> components;  // ascending; what the region covers
  double area = 0;
  std::string name;
};

/// One run of the detector on a normalised mesh.
class Detector {
 public:
  Detector(const Mesh& mesh, const DetectOptions& options, RunContext& context)
      : options_(options),
        context_(context),
        start_(std::chrono::steady_clock::now()),
        prepared_(prepare(mesh)),
        screen_(hemisphere_directions(kScreenDirections)) {}

  SymmetryAnnotation run(const Mesh& mesh) {
    SymmetryAnnotation annotation = empty_annotation(mesh, options_.tolerance);
    find_whole();
    context_.progress("parts", 0);
    survey_ = survey_components(prepared_, options_.tolerance, kLeastShare, context_);
    if (survey_.moments.size() > 1) {
      mover_.emplace(prepared_, survey_, *whole_index_, options_.tolerance, context_);
      own_groups_.resize(survey_.classes.size());
      for (std::size_t c = 0; c < survey_.classes.size() && !late(); ++c) {
        context_.progress("parts", static_cast<double>(c) / static_cast<double>(survey_.classes.size()));
        find_part_groups(c);
      }
      for (std::size_t c = 0; c < survey_.classes.size() && !late(); ++c) {
        context_.progress("sets", static_cast<double>(c) / static_cast<double>(survey_.classes.size()));
        find_set_group(c);
      }
      context_.progress("subgroups", 0);
      find_subgroup_regions();
      remove_repeats();
      find_patterns(annotation);
    }
    remove_featureless();
    write_regions(annotation);
    context_.progress("regions", 1);
    return annotation;
  }

 private:
  bool late() const {
    if (options_.max_seconds <= 0) return false;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
    return spent.count() > options_.max_seconds;
  }

  std::vector<int> faces_of(const std::vector<int>& components) const {
    std::vector<int> faces;
    for (const int c : components) {
      const std::vector<int>& part = prepared_.components.faces[static_cast<std::size_t>(c)];
      faces.insert(faces.end(), part.begin(), part.end());
    }
    std::ranges::sort(faces);
    return faces;
  }

  double area_of(const std::vector<int>& components) const {
    double area = 0;
    for (const int c : components) area += survey_.moments[static_cast<std::size_t>(c)].area;
    return area;
  }

  void find_whole() {
    context_.progress("whole", 0);
    std::vector<int> all(static_cast<std::size_t>(prepared_.mesh.faces.rows()));
    std::iota(all.begin(), all.end(), 0);
    const SurfacePatch patch = make_patch(prepared_, all, options_.samples, options_.tolerance, context_, "whole");
    whole_index_ = patch.index;
    const std::optional<OwnGroup> group = find_own_group(patch, &screen_, {}, context_);
    if (!group) return;
    std::vector<int> components(prepared_.components.faces.size());
    std::iota(components.begin(), components.end(), 0);
    found_.push_back({group->placement, components, prepared_.area, "whole"});
  }

  GroupHints hints() const {
    GroupHints result;
    if (!found_.empty()) {
      const GroupPlacement& whole = found_.front().placement;
      for (int k = 0; k < 3; ++k) result.axes.emplace_back(whole.frame.col(k));
    }
    return result;
  }

  // Principal axes suffice unless variances are close, or the part is a large share of the whole.
  bool needs_screen(const SurfaceMoments& moments) const {
    if (moments.area > 0.1 * prepared_.area) return true;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance, Eigen::EigenvaluesOnly);
    const Vector3d d = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
    return d[2] - d[0] < 0.05 * d[2];
  }

  static GroupPlacement moved(const GroupPlacement& placement, const Motion& motion) {
    GroupPlacement result = placement;
    result.frame = motion.linear * placement.frame;
    // A frame stays right-handed: turning its first column over changes no group written in it but by a mirror image
    // of its twist, and the elements of a group come with their inverses.
    if (result.frame.determinant() < 0) result.frame.col(1) = -result.frame.col(1);
    result.centre = motion(placement.centre);
    return result;
  }

  bool already_known(const GroupPlacement& placement, const std::vector<int>& components) const {
    const SurfaceMoments moments = components.size() == 1
                                       ? survey_.moments[static_cast<std::size_t>(components.front())]
                                       : surface_moments(prepared_, faces_of(components));
    const double tolerance = options_.tolerance * std::min(1.0, 4 * moments.diagonal);
    return std::ranges::any_of(found_, [&](const Found& other) {
      return std::ranges::includes(other.components, components) &&
             contains_group(other.placement, placement, moments.centroid, moments.radius, tolerance);
    });
  }

  bool verified(const GroupPlacement& placement, const std::vector<int>& components) const {
    const SurfacePatch patch =
        make_patch(prepared_, faces_of(components), kPartSamples, options_.tolerance, context_, "grown");
    const double tolerance = placement.group.continuous() ? continuous_tolerance(patch) : patch.tolerance;
    const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
    return passes(verify(patch, motions, tolerance, 0, VerificationLimits{}.joint, context_));
  }

  // Smaller groups on more of the surface: a subgroup may permute parts that the group itself does not.
  void find_subgroup_regions() {
    constexpr std::size_t kMostGroups = 30;
    constexpr double kMaterial = 1.05;
    std::ranges::stable_sort(found_, std::greater<>(), &Found::area);
    const std::vector<Found> groups(found_.begin(),
                                    found_.begin() + static_cast<std::ptrdiff_t>(std::min(found_.size(), kMostGroups)));
    for (const Found& each : groups) {
      if (late()) return;
      for (SubgroupRegion& region : mover_->subgroup_regions(each.placement, each.components)) {
        if (each.components.size() == 1) drop_siblings(region.components, each.components.front());
        const double area = area_of(region.components);
        if (area < kMaterial * each.area || already_known(region.placement, region.components)) continue;
        if (verified(region.placement, region.components)) {
          found_.push_back({region.placement, region.components, area, name_of(region.components)});
        }
      }
    }
  }

  // Adds a region for a group known on `seed`, grown to all components that the group permutes.
  void add(const GroupPlacement& placement, const std::vector<int>& seed, const std::string& name) {
    if (already_known(placement, seed)) return;
    std::vector<int> grown = mover_->permuted(placement, seed);
    if (seed.size() == 1) drop_siblings(grown, seed.front());
    if (grown.size() > seed.size() && !verified(placement, grown)) grown = seed;
    const double area = area_of(grown);
    if (area < kLeastShare * prepared_.area) return;
    found_.push_back({placement, grown, area, grown.size() == seed.size() ? name : name_of(grown)});
  }

  // Copies of a part that happen to sit symmetrically about it are neighbours in a row, not of its own kind of
  // symmetry.
  void drop_siblings(std::vector<int>& grown, int part) const {
    const auto kind = std::ranges::find_if(
        survey_.classes, [&](const CongruenceClass& each) { return std::ranges::binary_search(each.members, part); });
    if (kind == survey_.classes.end()) return;
    std::erase_if(grown, [&](int c) { return c != part && std::ranges::binary_search(kind->members, c); });
  }

  static std::string name_of(const std::vector<int>& components) {
    std::string text = components.size() == 1 ? "part " : "parts ";
    for (std::size_t i = 0; i < components.size();) {
      std::size_t j = i;
      while (j + 1 < components.size() && components[j + 1] == components[j] + 1) ++j;
      if (i > 0) text += ", ";
      text += std::to_string(components[i]);
      if (j > i) text += "-" + std::to_string(components[j]);
      i = j + 1;
      if (text.size() > 60 && i < components.size()) return text + ", ...";
    }
    return text;
  }

  void find_part_groups(std::size_t number) {
    const CongruenceClass& kind = survey_.classes[number];
    const auto first = static_cast<std::size_t>(kind.members.front());
    const SurfaceMoments& moments = survey_.moments[first];
    if (moments.area * static_cast<double>(kind.members.size()) < kLeastShare * prepared_.area) return;
    const SurfacePatch patch =
        make_patch(prepared_, prepared_.components.faces[first], kPartSamples, options_.tolerance, context_, "part");
    const std::optional<OwnGroup> group =
        find_own_group(patch, needs_screen(moments) ? &screen_ : nullptr, hints(), context_);
    if (!group) return;
    own_groups_[number] = group->placement;
    if (flat_mirror_only(moments, group->placement)) return;
    for (std::size_t i = 0; i < kind.members.size() && found_.size() < kMostPartRegions; ++i) {
      add(moved(group->placement, kind.motions[i]), {kind.members[i]}, name_of({kind.members[i]}));
    }
  }

  // Every flat sheet has the mirror in its own plane.
  bool flat_mirror_only(const SurfaceMoments& moments, const GroupPlacement& placement) const {
    if (placement.group.family != PointGroup::Family::Cs) return false;
    const Vector3d normal = placement.frame.col(2);
    return normal.dot(moments.covariance * normal) < std::pow(0.5 * options_.tolerance * moments.diagonal, 2);
  }

  void find_set_group(std::size_t number) {
    const CongruenceClass& kind = survey_.classes[number];
    if (kind.members.size() < 2 || kind.members.size() == survey_.moments.size()) return;
    const double area = area_of(kind.members);
    if (area < kLeastShare * prepared_.area) return;
    const SurfacePatch patch =
        make_patch(prepared_, faces_of(kind.members),
                   kPartSamples + 40 * static_cast<int>(std::min<std::size_t>(kind.members.size(), 40)),
                   options_.tolerance, context_, "set");
    const std::optional<OwnGroup> group =
        find_own_group(patch, needs_screen(patch.moments) ? &screen_ : nullptr, hints(), context_);
    if (!group) return;
    add(group->placement, kind.members, name_of(kind.members));
  }

  // Only border and position give a piece of a larger plane or cylinder its group. The whole is never such a piece.
  void remove_featureless() {
    std::erase_if(found_, [&](const Found& found) {
      if (found.area > 0.5 * prepared_.area) return false;
      const SurfacePatch patch =
          make_patch(prepared_, faces_of(found.components), 400, options_.tolerance, context_, "slip");
      return featureless(patch, found.placement, *whole_index_, options_.tolerance, context_);
    });
  }

  // Whether the region lies in the other but for a sliver.
  bool covers(const Found& outer, const Found& inner) const {
    if (inner.area > 1.02 * outer.area) return false;
    std::vector<int> common;
    std::ranges::set_intersection(outer.components, inner.components, std::back_inserter(common));
    return inner.area - area_of(common) <= std::min(0.05 * inner.area, kLeastShare * prepared_.area);
  }

  // A region inside another one whose group holds all its elements says nothing new, whichever was found first.
  void remove_repeats() {
    std::vector<Found> kept;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const Found& mine = found_[i];
      const SurfaceMoments moments = surface_moments(prepared_, faces_of(mine.components));
      const double tolerance = options_.tolerance * std::min(1.0, 4 * moments.diagonal);
      bool repeats = false;
      for (std::size_t j = 0; j < found_.size() && !repeats; ++j) {
        if (i == j || !covers(found_[j], mine)) continue;
        if (!contains_group(found_[j].placement, mine.placement, moments.centroid, moments.radius, tolerance)) continue;
        const bool mutual = found_[j].placement.group == mine.placement.group && covers(mine, found_[j]);
        repeats = !mutual || j < i;
      }
      if (!repeats) kept.push_back(mine);
    }
    found_ = std::move(kept);
  }

  // Whether some region's group carries the first member of the class onto each of the others.
  bool related_by_a_region(const CongruenceClass& kind) const {
    return std::ranges::any_of(found_, [&](const Found& region) {
      if (region.placement.group.continuous()) return false;
      if (!std::ranges::includes(region.components, kind.members)) return false;
      const std::vector<Motion> motions =
          judged_motions(region.placement.group, region.placement.frame, region.placement.centre);
      const Vector3d start = survey_.moments[static_cast<std::size_t>(kind.members.front())].centroid;
      return std::ranges::all_of(kind.members, [&](int c) {
        const Vector3d goal = survey_.moments[static_cast<std::size_t>(c)].centroid;
        return c == kind.members.front() || std::ranges::any_of(motions, [&](const Motion& m) {
                 return (m(start) - goal).norm() < 2 * options_.tolerance;
               });
      });
    });
  }

  void find_patterns(SymmetryAnnotation& annotation) const {
    for (std::size_t c = 0; c < survey_.classes.size() && !late(); ++c) {
      const CongruenceClass& kind = survey_.classes[c];
      if (kind.members.size() < 2 || area_of(kind.members) < kLeastShare * prepared_.area) continue;
      const SurfaceMoments& moments = survey_.moments[static_cast<std::size_t>(kind.members.front())];
      const double tolerance = options_.tolerance * std::min(1.0, 4 * moments.diagonal);
      const GroupPlacement* own = own_groups_[c] ? &*own_groups_[c] : nullptr;
      const Arrangement arrangement = arrange(kind.motions, own, moments.centroid, moments.radius, tolerance);
      // A group says more than a pattern, unless the pattern is a true row or grid.
      const bool lattice = arrangement.kind != Pattern::Kind::congruent &&
                           arrangement.kind != Pattern::Kind::rotation &&
                           kind.members.size() > (std::size_t{1} << arrangement.generators.size());
      if (!lattice && related_by_a_region(kind)) continue;
      Pattern pattern;
      pattern.id = static_cast<int>(annotation.patterns.size());
      pattern.name = name_of(kind.members);
      pattern.kind = arrangement.kind;
      for (const Motion& step : arrangement.generators) {
        pattern.generators.push_back(conjugate(prepared_.input_of_normalised, step));
      }
      const SurfacePatch patch =
          make_patch(prepared_, prepared_.components.faces[static_cast<std::size_t>(kind.members.front())], 200,
                     options_.tolerance, context_, "pattern");
      double square = 0;
      int count = 0;
      for (std::size_t i = 0; i < kind.members.size(); ++i) {
        const std::vector<int>& faces = prepared_.components.faces[static_cast<std::size_t>(kind.members[i])];
        pattern.instances.push_back({conjugate(prepared_.input_of_normalised, arrangement.motions[i]), faces});
        if (i == 0) {
          pattern.instances.front().motion = Motion{};
          continue;
        }
        const SurfaceIndex target(prepared_.mesh, faces);
        for (Eigen::Index s = 0; s < patch.samples.points.rows(); ++s) {
          const double distance = target.nearest(arrangement.motions[i](patch.samples.points.row(s))).distance;
          square += distance * distance;
          pattern.residual.max = std::max(pattern.residual.max, distance);
          ++count;
        }
      }
      pattern.residual.rms = std::sqrt(square / std::max(count, 1));
      annotation.patterns.push_back(std::move(pattern));
    }
  }

  void write_regions(SymmetryAnnotation& annotation) {
    std::ranges::stable_sort(found_, std::greater<>(), &Found::area);
    for (const Found& found : found_) {
      const std::vector<int> faces = faces_of(found.components);
      const GroupPlacement& placement = found.placement;
      Region region = make_region(placement.group, prepared_.input_of_normalised(placement.centre), placement.frame,
                                  faces, found.name);
      const SurfacePatch patch = make_patch(prepared_, faces, 1000, options_.tolerance, context_, "residual");
      region.residual =
          measure_residual(patch, judged_motions(placement.group, placement.frame, placement.centre), context_);
      annotation.regions.push_back(std::move(region));
    }
    drop_coincidences(annotation.regions);
    for (std::size_t i = 0; i < annotation.regions.size(); ++i) annotation.regions[i].id = static_cast<int>(i);
    set_parents(annotation.regions);
  }

  // A region that is far less exact than one that contains it is symmetric by coincidence: the shape around it shows
  // how exact this mesh is. Kept, its group would also clash with the exact ones. A turned part's residual is that of
  // its facets and says nothing.
  void drop_coincidences(std::vector<Region>& regions) const {
    constexpr double kFarLess = 20;
    const double least = 0.01 * options_.tolerance;
    const std::vector<Region> all = regions;
    std::erase_if(regions, [&](const Region& region) {
      return !region.group.continuous() && std::ranges::any_of(all, [&](const Region& around) {
        return around.faces.size() > region.faces.size() &&
               region.residual.max > kFarLess * std::max(around.residual.max, least) &&
               std::ranges::includes(around.faces, region.faces);
      });
    });
  }

  const DetectOptions& options_;
  RunContext& context_;
  std::chrono::steady_clock::time_point start_;
  PreparedMesh prepared_;
  DirectionSet screen_;
  std::shared_ptr<const SurfaceIndex> whole_index_;
  ComponentSurvey survey_;
  std::optional<ComponentMover> mover_;
  std::vector<std::optional<GroupPlacement>> own_groups_;  // of each class's first member
  std::vector<Found> found_;
};

}  // namespace

void DetectOptions::validate() const {
  const auto refuse = [](const std::string& field, const std::string& value, const std::string& rule) {
    throw UsageError("DetectOptions." + field + " is " + value + "; it must satisfy " + rule);
  };
  if (!(tolerance >= 1e-6 && tolerance <= 0.1))
    refuse("tolerance", std::to_string(tolerance), "1e-6 <= tolerance <= 0.1");
  if (samples < 100) refuse("samples", std::to_string(samples), "samples >= 100");
  if (!(max_seconds >= 0)) refuse("max_seconds", std::to_string(max_seconds), "max_seconds >= 0");
}

SymmetryAnnotation detect(const Mesh& mesh, const DetectOptions& options, RunContext& context) {
  options.validate();
  Detector detector(mesh, options, context);
  return detector.run(mesh);
}

}  // namespace orbifit
