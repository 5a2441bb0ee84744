#include "search/part_regions.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "orbifit/detection/explanation.h"

#include "base/dense.h"
#include "evidence/chance_symmetry.h"
#include "group/axis_orders.h"
#include "group/verification.h"
#include "primitives/featureless.h"
#include "primitives/line_orbits.h"
#include "primitives/symmetry_lines.h"
#include "search/completion.h"
#include "support/own_group.h"
#include "support/region_growth.h"
#include "surface/face_points.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kPartSamples = 700;
constexpr std::size_t kMaxPartRegions = 200;

struct Found {
  GroupPlacement placement;
  std::vector<int> parts;  // ascending; what the region covers
  double area = 0;
  bool known = false;   // found before
  double residual = 0;  // largest, a fraction of the diagonal
};

class PartSearch {
 public:
  PartSearch(const PreparedMesh& prepared, ComponentSurvey survey, const SurfaceIndex& whole,
             const DirectionSet& screen, const PartRegionOptions& options, const RunContext& context)
      : prepared_(prepared), whole_(whole), screen_(screen), options_(options), context_(context) {
    result_.survey = std::move(survey);
  }

  PartRegions run(const std::vector<FoundRegion>& known) {
    context_.progress("parts", 0);
    mover_.emplace(prepared_, survey(), whole_, options_.tolerance, context_);
    for (const FoundRegion& region : known) take(region);
    result_.own_groups.resize(classes().size());
    find_part_groups();
    find_class_groups();
    find_line_regions();
    context_.progress("subgroups", 0);
    find_subgroup_regions();
    for (const Found& found : found_) {
      if (found.known) continue;
      std::vector<int> faces = kept_faces(found);
      const double area = orbifit::area_of(prepared_, faces);
      result_.regions.push_back({found.placement, std::move(faces), area, name_of_parts(found.parts)});
    }
    return std::move(result_);
  }

 private:
  const ComponentSurvey& survey() const { return result_.survey; }
  const std::vector<CongruenceClass>& classes() const { return result_.survey.classes; }
  const SurfaceMoments& moments(int part) const { return survey().moments[static_cast<std::size_t>(part)]; }
  bool late() const { return options_.late && options_.late(); }
  double least_area() const { return options_.least_share * prepared_.area; }

  std::vector<int> faces_of(const std::vector<int>& parts) const {
    constexpr std::size_t kMuch = 8;  // of which it is faster to mark the faces of a whole than to sort
    std::vector<int> faces;
    for (const int c : parts) {
      const std::vector<int>& part = prepared_.components.faces[static_cast<std::size_t>(c)];
      faces.insert(faces.end(), part.begin(), part.end());
    }
    const std::size_t all = prepared_.components.component_of_face.size();
    if (kMuch * faces.size() < all) {
      std::ranges::sort(faces);
      return faces;
    }
    std::vector<char> held(all, 0);
    for (const int face : faces) held[static_cast<std::size_t>(face)] = 1;
    faces.clear();
    for (std::size_t f = 0; f < held.size(); ++f) {
      if (held[f] != 0) faces.push_back(static_cast<int>(f));
    }
    return faces;
  }

  double area_of(const std::vector<int>& parts) const {
    double area = 0;
    for (const int c : parts) area += moments(c).area;
    return area;
  }

  SurfaceMoments moments_of(const std::vector<int>& parts) const {
    return parts.size() == 1 ? moments(parts.front()) : surface_moments(prepared_, faces_of(parts));
  }

  SurfacePatch patch_of(const std::vector<int>& parts, std::string_view stream) const {
    const int extra = parts.size() > 1 ? 40 * static_cast<int>(std::min<std::size_t>(parts.size(), 40)) : 0;
    return patch_of(parts, kPartSamples + extra, stream);
  }

  // Where a piece was joined to others its surface has holes, which have no images.
  SurfacePatch patch_of(const std::vector<int>& parts, int samples, std::string_view stream) const {
    constexpr double kLargestHole = 0.02;
    SurfacePatch patch = make_patch(prepared_, faces_of(parts), samples, options_.tolerance, context_, stream);
    if (options_.pieces && parts.size() == 1) patch.largest_blot = kLargestHole;
    return patch;
  }

  // The faces of the parts but for those that lie where holes are carried, if there are any.
  std::vector<int> kept_faces(const Found& found) const {
    std::vector<int> faces = faces_of(found.parts);
    const PointGroup& group = found.placement.group;
    if (!options_.pieces || found.parts.size() > 1 || group.continuous()) return faces;
    const SurfacePatch patch = patch_of(found.parts, "holes");
    const std::vector<Motion> motions = judged_motions(group, found.placement.frame, found.placement.centre);
    if (passes(verify(patch, motions, patch.tolerance, 0, 0, context_))) return faces;
    std::erase_if(faces, [&](int face) { return !stays_on(patch, motions, face); });
    return faces;
  }

  // A region found before counts for the parts that lie in it.
  void take(const FoundRegion& region) {
    const SurfacePatch patch =
        make_patch(prepared_, region.faces, kPartSamples, options_.tolerance, context_, "known region");
    Found found{region.placement, {}, region.area, true, largest_residual(region.placement, patch)};
    std::vector<double> inside(survey().moments.size(), 0);
    for (const int face : region.faces) {
      inside[static_cast<std::size_t>(prepared_.components.component_of_face[static_cast<std::size_t>(face)])] +=
          prepared_.areas[face];
    }
    for (std::size_t c = 0; c < inside.size(); ++c) {
      if (inside[c] > 0.98 * survey().moments[c].area) found.parts.push_back(static_cast<int>(c));
    }
    found_.push_back(std::move(found));
  }

  GroupHints hints(const std::vector<Vector3d>& more = {}) const {
    GroupHints result{more};
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

  // Whether only the borders of pieces of larger surfaces give them the group.
  bool mere_border(const GroupPlacement& placement, const std::vector<int>& parts) const {
    return options_.pieces &&
           orbifit::mere_border(prepared_, faces_of(parts), moments_of(parts), placement, options_.tolerance, context_);
  }

  // Whether the other region holds the parts, or but for what a group of few elements keeps by chance.
  bool holds_nearly(const Found& other, const GroupPlacement& placement, const std::vector<int>& parts,
                    double area) const {
    if (std::ranges::includes(other.parts, parts)) return true;
    const double share = share_of_few(other.placement.group, placement.group);
    if (share <= 0 || area > kNearlyWhole * prepared_.area) return false;
    std::vector<int> outside;
    std::ranges::set_difference(parts, other.parts, std::back_inserter(outside));
    return area_of(outside) <= share * area;
  }

  // Whether the first group may hold the second.
  static bool as_large(const PointGroup& group, const PointGroup& other) {
    return group.continuous() || (!other.continuous() && group.order() >= other.order());
  }

  bool already_known(const GroupPlacement& placement, const std::vector<int>& parts) const {
    const double area = area_of(parts);
    std::optional<SurfaceMoments> mine;  // few ask
    return std::ranges::any_of(found_, [&](const Found& other) {
      if (!holds_nearly(other, placement, parts, area) || !as_large(other.placement.group, placement.group))
        return false;
      if (!mine) mine = moments_of(parts);
      const double tolerance = tolerance_of_part(options_.tolerance, mine->diagonal);
      return contains_group(other.placement, placement, mine->centroid, mine->radius, tolerance);
    });
  }

  bool verified(const GroupPlacement& placement, const std::vector<int>& parts) const {
    return orbifit::verified(patch_of(parts, kPartSamples, "grown"), placement, context_);
  }

  // Smaller groups on more of the surface: a subgroup may permute parts that the group itself does not.
  void find_subgroup_regions() {
    constexpr std::size_t kMaxGroups = 30;
    constexpr double kMaterial = 1.05;
    std::ranges::stable_sort(found_, std::greater<>(), &Found::area);
    const std::vector<Found> groups(found_.begin(),
                                    found_.begin() + static_cast<std::ptrdiff_t>(std::min(found_.size(), kMaxGroups)));
    for (const Found& each : groups) {
      if (late()) return;
      for (SubgroupRegion& region : mover_->subgroup_regions(each.placement, each.parts)) {
        if (each.parts.size() == 1) drop_siblings(region.components, each.parts.front(), classes());
        const double area = area_of(region.components);
        if (area < kMaterial * each.area || already_known(region.placement, region.components)) continue;
        if (some_of_a_grid(region.placement.group, region.components, classes(), survey().moments)) {
          note("subgroups", region.placement, region.components, false, "some of many of a kind");
          continue;
        }
        const bool holds = verified(region.placement, region.components);
        note("subgroups", region.placement, region.components, holds, holds ? "verified" : "not verified");
        if (holds) {
          found_.push_back({region.placement, region.components, area, false});
        }
      }
    }
  }

  // How closely parts must fit a group that fits the seed as well as it does, in tolerances: parts that fit far worse
  // are not of the same making.
  double strictness(const GroupPlacement& placement, const SurfacePatch& seed) const {
    if (placement.group.continuous()) return 1;
    constexpr double kDeviations = 8;
    constexpr double kStrictest = 0.15;
    constexpr std::size_t kQueries = 1500;
    const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
    const double rms = measure_residual(seed, motions, context_, kQueries).rms;
    return std::clamp(kDeviations * rms / seed.tolerance, kStrictest, 1.0);
  }

  void note(std::string_view stage, const GroupPlacement& placement, const std::vector<int>& parts, bool kept,
            std::string_view reason) const {
    if (options_.explanation == nullptr) return;
    options_.explanation->notes.push_back({std::string(options_.pieces ? "segments: " : "") + std::string(stage),
                                           placement.group.symbol() + " on " + name_of_parts(parts), kept,
                                           std::string(reason)});
  }

  double largest_residual(const GroupPlacement& placement, const SurfacePatch& patch) const {
    constexpr std::size_t kQueries = 1500;
    const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
    return measure_residual(patch, motions, context_, kQueries).max;
  }

  // Whether the shape around the parts shows them to be symmetric by coincidence: it is far more exact.
  bool coincidence(const GroupPlacement& placement, const std::vector<int>& parts, double area, double off) const {
    return !placement.group.continuous() && std::ranges::any_of(found_, [&](const Found& around) {
      return by_coincidence(area, off, around.area, around.residual, options_.tolerance) &&
             std::ranges::includes(around.parts, parts);
    });
  }

  // Whether the parts are some of a row or a grid, all of which has such a group: any few in a row have one.
  bool some_of_a_row(const GroupPlacement& placement, const std::vector<int>& parts) const {
    constexpr double kAngle = 0.01;  // radians
    std::vector<int> rows;
    for (const std::size_t kind : kinds_of_a_row(parts, classes(), survey().moments)) {
      const std::vector<int>& members = classes()[kind].members;
      rows.insert(rows.end(), members.begin(), members.end());
    }
    if (rows.empty() || placement.group.continuous()) return false;
    std::ranges::sort(rows);
    const Vector3d origin = Vector3d::Zero();
    const GroupPlacement mine{placement.group, placement.frame, origin};
    return std::ranges::any_of(found_, [&](const Found& other) {
      const GroupPlacement theirs{other.placement.group, other.placement.frame, origin};
      return std::ranges::includes(other.parts, rows) && contains_group(theirs, mine, origin, 1, kAngle);
    });
  }

  // Adds a region for a group known on `seed`, grown to all parts that the group permutes.
  void add(std::string_view stage, const GroupPlacement& placement, const std::vector<int>& seed, double strictness) {
    if (already_known(placement, seed)) return note(stage, placement, seed, false, "known from a larger region");
    std::vector<int> grown = mover_->permuted(placement, seed, strictness);
    if (seed.size() == 1 && !options_.pieces) drop_siblings(grown, seed.front(), classes());
    if (grown.size() > seed.size() && !verified(placement, grown)) grown = seed;
    const double area = area_of(grown);
    if (area < least_area()) return note(stage, placement, grown, false, "too small");
    if (some_of_a_grid(placement.group, grown, classes(), survey().moments)) {
      return note(stage, placement, grown, false, "some of many of a kind");
    }
    if (some_of_a_row(placement, grown)) return note(stage, placement, grown, false, "some of a row that has it");
    if (mere_border(placement, grown))
      return note(stage, placement, grown, false, "only its border gives it the group");
    const SurfacePatch patch = patch_of(grown, "residual");
    if (options_.pieces && grown.size() > 1 && fades(patch, placement, context_)) {
      return note(stage, placement, grown, false, "fades as the tolerance shrinks");
    }
    const double off = largest_residual(placement, patch);
    if (coincidence(placement, grown, area, off))
      return note(stage, placement, grown, false, "far less exact than a region around it");
    note(stage, placement, grown, true, grown.size() > seed.size() ? "grown and verified" : "verified");
    found_.push_back({placement, grown, area, false, off});
  }

  // Calls look(i) for each i < count on all threads: large ones come first, and each thread takes the next that is
  // left.
  template <typename Look>
  void for_each(std::size_t count, const Look& look) const {
    constexpr std::size_t kStride = 64;
    parallel_for(context_, std::min(count, kStride), [&](std::size_t begin, std::size_t end) {
      for (std::size_t first = begin; first < end; ++first) {
        for (std::size_t i = first; i < count && !late(); i += kStride) look(i);
      }
    });
  }

  // A part of a class, looked at by itself.
  struct PartLook {
    SurfacePatch patch;
    bool sheet;
    std::optional<OwnGroup> group;
  };

  PartLook look_at_part(int part, const GroupHints& given) const {
    const SurfaceMoments& mine = moments(part);
    PartLook look{patch_of({part}, kPartSamples, "part"), flat(mine, options_.tolerance), {}};
    bool screen = needs_screen(mine);
    GroupHints hints = given;
    if (options_.pieces) {
      // A piece of a plane or a turned surface is as symmetric as that, or by its border only.
      const std::optional<RevolutionFit> fit = revolution_of(look.patch);
      if (look.sheet || (fit && (fit->planar || fit->spherical || turned(*fit)))) screen = false;
      if (fit && !fit->planar && !fit->spherical) hints.axes.insert(hints.axes.begin(), fit->axis.direction);
    }
    look.group = find_own_group(look.patch, screen ? &screen_ : nullptr, hints, context_);
    return look;
  }

  // The groups of the parts, each class's by one of its members. Batch by batch: what was looked at when time is up is
  // not lost.
  void find_part_groups() {
    constexpr std::size_t kBatch = 32;
    const std::size_t count = classes().size();
    const GroupHints known = hints();
    for (std::size_t first = 0; first < count && !late(); first += kBatch) {
      context_.progress("parts", static_cast<double>(first) / static_cast<double>(count));
      std::vector<std::optional<PartLook>> looks(std::min(kBatch, count - first));
      for_each(looks.size(), [&](std::size_t i) {
        const CongruenceClass& kind = classes()[first + i];
        const int part = kind.members.front();
        if (moments(part).area * static_cast<double>(kind.members.size()) < least_area()) return;
        looks[i] = look_at_part(part, known);
      });
      for (std::size_t i = 0; i < looks.size(); ++i) {
        if (looks[i]) take_part_group(first + i, *looks[i]);
      }
    }
  }

  void take_part_group(std::size_t number, const PartLook& look) {
    const CongruenceClass& kind = classes()[number];
    const int first = kind.members.front();
    if (!look.group) return note("parts", {}, {first}, false, "no group of its own");
    const GroupPlacement& group = look.group->placement;
    result_.own_groups[number] = group;
    mover_->know(number, group);
    if (flat_mirror_only(moments(first), group, options_.tolerance)) return;
    if (options_.pieces && (look.sheet || mere_border(group, {first}))) {
      return note("parts", group, {first}, false, "only its border gives it the group");
    }
    const double strict = strictness(group, look.patch);
    for (std::size_t i = 0; i < kind.members.size() && found_.size() < kMaxPartRegions; ++i) {
      add("parts", carried(group, kind.motions[i]), {kind.members[i]}, strict);
    }
  }

  // Several parts, looked at together.
  struct SetLook {
    SurfacePatch patch;
    std::optional<OwnGroup> group;
  };

  SetLook look_at_set(const std::vector<int>& members) const {
    SetLook look{patch_of(members, "set"), {}};
    look_for_group(look, {});
    return look;
  }

  void look_for_group(SetLook& look, const std::vector<Vector3d>& axes) const {
    const bool screen = axes.empty() && needs_screen(look.patch.moments);
    look.group = find_own_group(look.patch, screen ? &screen_ : nullptr, hints(axes), context_);
  }

  bool worth_a_look(const std::vector<int>& members) {
    return area_of(members) >= least_area() && !mere_pair(members, classes()) && tried_.insert(members).second;
  }

  // Whether the members have a group together.
  bool take_set_group(std::string_view stage, const SetLook& look, const std::vector<int>& members) {
    if (!look.group) {
      note(stage, {}, members, false, "no group of their own");
      return false;
    }
    add(stage, look.group->placement, members, strictness(look.group->placement, look.patch));
    return true;
  }

  // The groups of whole classes.
  void find_class_groups() {
    std::vector<const std::vector<int>*> sets;
    for (const CongruenceClass& kind : classes()) {
      const bool some = kind.members.size() > 1 && kind.members.size() < survey().moments.size();
      if (some && worth_a_look(kind.members)) sets.push_back(&kind.members);
    }
    std::vector<std::optional<SetLook>> looks(sets.size());
    for_each(sets.size(), [&](std::size_t i) { looks[i] = look_at_set(*sets[i]); });
    for (std::size_t i = 0; i < sets.size() && !late(); ++i) {
      context_.progress("sets", static_cast<double>(i) / static_cast<double>(sets.size()));
      if (looks[i]) take_set_group("sets", *looks[i], *sets[i]);
      looks[i].reset();
    }
  }

  // Whether the parts may turn by a third or less: two of their principal moments are then equal.
  bool may_turn_by_less(const std::vector<int>& parts) const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments_of(parts).covariance, Eigen::EigenvaluesOnly);
    const Vector3d d = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
    return std::min(d[1] - d[0], d[2] - d[1]) < options_.tolerance;
  }

  // The own group of several parts that are known to turn like that. Whether there is one.
  bool find_set_group(const std::vector<int>& members, const GroupPlacement& turn) {
    if (!worth_a_look(members)) return false;
    if (some_of_a_grid(turn.group, members, classes(), survey().moments) && !may_turn_by_less(members)) {
      note("axes", turn, members, false, "some of many of a kind");
      return true;
    }
    SetLook look{patch_of(members, "set"), {}};
    // A finite group that holds the turn is at least as far off as the turn alone.
    const GroupPlacement fitted = refine(look.patch, turn, context_);
    if (!continuous_about(look.patch, fitted.frame.col(2), fitted.centre) &&
        coincidence(fitted, members, area_of(members), largest_residual(fitted, look.patch))) {
      note("axes", fitted, members, false, "far less exact than a region around it");
      return true;
    }
    look_for_group(look, {turn.frame.col(2)});
    return take_set_group("axes", look, members);
  }

  // The parts of `of` that none of the others holds.
  static std::vector<int> without(const std::vector<int>& of, const std::vector<std::vector<int>>& others) {
    std::vector<int> result;
    for (const int c : of) {
      const bool held =
          std::ranges::any_of(others, [&](const auto& each) { return std::ranges::binary_search(each, c); });
      if (!held) result.push_back(c);
    }
    return result;
  }

  void find_line_regions() {
    const SymmetryLines lines = find_symmetry_lines(prepared_, survey(), options_.tolerance);
    std::size_t done = 0;
    const auto total = static_cast<double>(lines.axes.size() + lines.planes.size());
    std::vector<Line> axes;
    for (const CandidateLine& axis : lines.axes) axes.push_back(axis.line);
    LineOrbits orbits(axes, options_.of_whole, options_.tolerance);
    for (; done < axes.size(); ++done) {
      if (late()) return;
      if (!orbits.worth_a_look(done)) continue;
      context_.progress("axes", static_cast<double>(done) / total);
      const std::size_t before = found_.size();
      find_axis_regions(axes[done]);
      if (found_.size() > before) orbits.found(done);
    }
    for (const CandidateLine& plane : lines.planes) {
      if (late() || crowded()) return;
      context_.progress("axes", static_cast<double>(done++) / total);
      find_mirror_region(plane.line);
    }
  }

  // Among so many pieces any few are mirror images of one another by chance: only whole rings say something.
  bool crowded() const {
    constexpr std::size_t kMany = 150;
    return options_.pieces && survey().moments.size() > kMany;
  }

  static double distance_from(const Line& line, const Vector3d& point) {
    return (point - line.point).cross(line.direction).norm();
  }

  // Everything that turns into itself about the line: by any angle first, then by 1/n of a turn, n descending, wherever
  // that is materially more than for the multiples of n.
  void find_axis_regions(const Line& line) {
    const GroupFrame frame = frame_about(line.direction);
    const std::vector<int> round = mover_->permuted({{Family::Cinf, 1}, frame, line.point}, {});
    const GroupPlacement by_any{{Family::Cinf, 1}, frame, line.point};
    if (!round.empty() && !already_known(by_any, round)) find_set_group(round, by_any);
    std::vector<std::pair<int, std::vector<int>>> found;
    const int lowest = crowded() ? 3 : 2;
    // What lies on the line speaks for itself: what turns about it is looked for off it first.
    std::vector<int> beside;
    for (std::size_t c = 0; c < survey().moments.size(); ++c) {
      if (distance_from(line, survey().moments[c].centroid) >= 3 * options_.tolerance)
        beside.push_back(static_cast<int>(c));
    }
    std::vector<std::vector<int>> permuted(static_cast<std::size_t>(kHighestOrder - lowest + 1));
    for_each(permuted.size(), [&](std::size_t i) {
      const int n = kHighestOrder - static_cast<int>(i);
      permuted[i] = mover_->permuted_among(beside, {{Family::Cn, n}, frame, line.point}, round);
    });
    for (int n = kHighestOrder; n >= lowest; --n) {
      context_.check();
      std::vector<std::vector<int>> larger{round};
      for (const auto& [order, parts] : found) {
        if (order % n == 0) larger.push_back(parts);
      }
      const std::vector<int> fresh = without(permuted[static_cast<std::size_t>(kHighestOrder - n)], larger);
      if (area_of(fresh) < least_area()) continue;
      // Whole classes were looked at before; what turns with a larger region as well has nothing new to say.
      const GroupPlacement turn{{Family::Cn, n}, frame, line.point};
      std::vector<int> turned = mover_->permuted(turn, round);
      for (const CongruenceClass& kind : classes()) {
        std::vector<int> ring;
        std::ranges::set_intersection(fresh, kind.members, std::back_inserter(ring));
        if (ring.size() > 1 && !already_known(turn, ring)) find_set_group(ring, turn);
      }
      if (!mere_pair(turned, classes()) && !already_known(turn, turned) && !find_set_group(turned, turn)) {
        const SurfacePatch patch = patch_of(turned, "axis");
        const GroupPlacement placement = refine(patch, turn, context_);
        if (orbifit::verified(patch, placement, context_)) add("axes", placement, turned, strictness(placement, patch));
      }
      found.emplace_back(n, std::move(turned));
    }
  }

  void find_mirror_region(const Line& line) {
    GroupPlacement placement{{Family::Cs, 1}, frame_about(line.direction), line.point};
    const std::vector<int> parts = mover_->permuted(placement, {});
    if (parts.size() < 2 || area_of(parts) < least_area() || already_known(placement, parts)) return;
    if (mere_pair(parts, classes()) || !tried_.insert(parts).second) return;
    const SurfacePatch patch = patch_of(parts, "mirror");
    placement = refine(patch, placement, context_);
    if (orbifit::verified(patch, placement, context_)) add("planes", placement, parts, strictness(placement, patch));
  }

  const PreparedMesh& prepared_;
  const SurfaceIndex& whole_;
  const DirectionSet& screen_;
  const PartRegionOptions& options_;
  const RunContext& context_;
  PartRegions result_;
  std::optional<ComponentMover> mover_;
  std::vector<Found> found_;
  std::set<std::vector<int>> tried_;
};

}  // namespace

std::string name_of_parts(const std::vector<int>& parts) {
  std::string text = parts.size() == 1 ? "part " : "parts ";
  for (std::size_t i = 0; i < parts.size();) {
    std::size_t j = i;
    while (j + 1 < parts.size() && parts[j + 1] == parts[j] + 1) ++j;
    if (i > 0) text += ", ";
    text += std::to_string(parts[i]);
    if (j > i) text += "-" + std::to_string(parts[j]);
    i = j + 1;
    if (text.size() > 60 && i < parts.size()) return text + ", ...";
  }
  return text;
}

PartRegions find_part_regions(const PreparedMesh& prepared, ComponentSurvey survey, const SurfaceIndex& whole,
                              const std::vector<FoundRegion>& known, const DirectionSet& screen,
                              const PartRegionOptions& options, const RunContext& context) {
  return PartSearch(prepared, std::move(survey), whole, screen, options, context).run(known);
}

}  // namespace orbifit
