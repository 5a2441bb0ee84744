#include "orbifit/detection/detect.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "orbifit/model/errors.h"

#include "annotate.h"
#include "evidence/colour_samples.h"
#include "evidence/cut_discs.h"
#include "evidence/importance.h"
#include "evidence/kept_by_colours.h"
#include "evidence/noise_check.h"
#include "group/candidates.h"
#include "group/verification.h"
#include "kept_consistent.h"
#include "patterns/partial_rows.h"
#include "patterns/pattern_search.h"
#include "patterns/region_patterns.h"
#include "patterns/row_growth.h"
#include "primitives/symmetry_lines.h"
#include "region_names.h"
#include "resolution/coarse_mesh.h"
#include "resolution/denoise.h"
#include "resolution/transfer.h"
#include "search/axis_regions.h"
#include "search/completion.h"
#include "search/generated_groups.h"
#include "search/groups_at_larger_tolerance.h"
#include "search/maximal_subgroups.h"
#include "search/part_regions.h"
#include "search/plane_regions.h"
#include "search/revolution_regions.h"
#include "support/found_region.h"
#include "support/own_group.h"
#include "support/trimmed_regions.h"
#include "surface/canonical_pose.h"
#include "surface/components.h"
#include "surface/repeated_parts.h"
#include "surface/segments.h"
#include "surface/surface_patch.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxRegions = 300;
constexpr double kMinNoise = 3e-4;     // of the diagonal
constexpr double kMinTurned = 0.006;   // of the area, that speaks for a rotation of pieces
constexpr double kMinMirrored = 0.02;  // of the area, that speaks for a mirror of pieces
constexpr double kLongest = 1e8;       // seconds, which a clock can add
constexpr double kMinSeconds = 1;      // for the whole
constexpr double kOfDetection = 0.6;   // of the time, where what is found is to be carried to a finer mesh
constexpr int kDetectSamples = 6000;
constexpr std::size_t kMaxSegments = 1500;  // beyond, creases say nothing: soup, or noise;
constexpr std::size_t kMaxOfComponent = 4;  // unless that many come of as many components

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

using Clock = std::chrono::steady_clock;

// Whether a share of the time that the options give has been spent.
bool spent(const DetectOptions& options, Clock::time_point start, double share) {
  const std::chrono::duration<double> time = Clock::now() - start;
  return options.time_budget > 0 && time.count() > share * options.time_budget;
}

/// One run of the detector on a prepared mesh.
class Detector {
 public:
  /// \param segments pieces of surface between creases; empty: those of the mesh
  /// \param stretch see CanonicalPose
  Detector(const PreparedMesh& prepared, Components segments, double stretch, const DetectOptions& options,
           Clock::time_point start, RunContext& context)
      : options_(options),
        stretch_(stretch),
        context_(context),
        limited_(context),
        start_(start),
        prepared_(prepared),
        segments_(std::move(segments)),
        screen_(hemisphere_directions(kScreenDirections)) {}

  Findings run() {
    // The whole's own group tells most; it gets its time even where the mesh took long to prepare.
    limit(Clock::now(), std::max(options_.time_budget, kMinSeconds));
    in_time("whole", [this] { find_whole(); });
    limit(start_, options_.time_budget);
    in_time("parts", [this] { find_in_components(); });
    in_time("pieces", [this] { find_in_segments(); });
    in_time("larger tolerance", [this] { tell_of_larger_tolerance(); });
    if (!late(1)) {
      context_.progress("images", 0);
      drop_repeats(prepared_, options_.tolerance, regions_, options_.explanation);
      drop_lesser_groups(prepared_, options_.tolerance, regions_, options_.explanation);
      drop_some_of_rows(prepared_, options_.tolerance, context_, regions_, options_.explanation);
      complete_regions(prepared_, *prepared_.index,
                       {options_.tolerance, kMaxRegions, options_.explanation, [this] { return late(1); }}, context_,
                       regions_);
    }
    drop_repeats(prepared_, options_.tolerance, regions_, options_.explanation);
    drop_lesser_groups(prepared_, options_.tolerance, regions_, options_.explanation);
    drop_featureless(prepared_, *prepared_.index, options_.tolerance, context_, regions_, options_.explanation);
    return {std::move(regions_), std::move(patterns_)};
  }

 private:
  void limit(Clock::time_point from, double seconds) {
    limited_.deadline = context_.deadline;
    if (options_.time_budget <= 0) return;
    const std::chrono::duration<double> time(std::min(seconds, kLongest));
    const auto end = from + std::chrono::duration_cast<Clock::duration>(time);
    if (!context_.deadline || end < *context_.deadline) limited_.deadline = end;
  }

  // Stages look at the time between two candidates; where one alone takes too long it is given up, with its stage.
  template <typename Stage>
  void in_time(std::string_view name, const Stage& stage) {
    try {
      stage();
    } catch (const TimeoutError&) {
      context_.check();  // the caller's time has passed as well
      if (options_.explanation != nullptr) {
        options_.explanation->notes.push_back({std::string(name), "all", false, "no time left"});
      }
    }
  }

  // Whether the share of the time is spent. What was found is worth more with its images: they get the last part.
  bool late(double share = 0.8) const { return spent(options_, start_, share); }

  void find_whole() {
    limited_.progress("whole", 0);
    std::vector<int> all(static_cast<std::size_t>(prepared_.mesh.faces.rows()));
    std::iota(all.begin(), all.end(), 0);
    const SurfacePatch patch = make_patch(prepared_, all, options_.samples, options_.tolerance, limited_, "whole");
    const std::optional<OwnGroup> group = find_own_group(patch, &screen_, {}, limited_);
    if (!group) return;
    regions_.push_back({group->placement, all, prepared_.area, "whole"});
    if (options_.explanation != nullptr) {
      options_.explanation->notes.push_back({"whole", group->placement.group.symbol() + " on whole", true, "verified"});
    }
  }

  void find_in_components() {
    if (prepared_.components.faces.size() < 2) return;
    const PartRegions parts = find_in_parts(prepared_, survey_of(prepared_), false);
    for (const FoundRegion& region : parts.regions) regions_.push_back(region);
    for (std::size_t k = 0; k < parts.own_groups.size(); ++k) {
      const std::optional<GroupPlacement>& own = parts.own_groups[k];
      const std::vector<int>& members = parts.survey.classes[k].members;
      double area = 0;
      for (const int part : members) area += parts.survey.moments[static_cast<std::size_t>(part)].area;
      if (own) symmetric_area_ += area;
      if (members.size() == 1 && !(own && has_axes(own->group))) single_area_ += area;
    }
    drop_repeats(prepared_, options_.tolerance, regions_, options_.explanation);
    add_patterns(prepared_, parts, false);
  }

  // Whether the group has more than a mirror or a half-turn, which many a cut leaves.
  static bool has_axes(const PointGroup& group) { return group.continuous() || group.order() > 2; }

  // The largest group found for all faces, or all but specks.
  std::optional<GroupPlacement> placement_of_whole() const {
    std::optional<GroupPlacement> result;
    for (const FoundRegion& region : regions_) {
      const PointGroup& group = region.placement.group;
      if (region.area < kOfWhole * prepared_.area || (result && result->group.continuous())) continue;
      if (!result || group.continuous() || group.order() > result->group.order()) result = region.placement;
    }
    return result;
  }

  // The elements of that group; none where it is continuous.
  std::vector<Motion> motions_of_whole() const {
    const std::optional<GroupPlacement> whole = placement_of_whole();
    if (!whole || whole->group.continuous()) return {};
    return judged_motions(whole->group, whole->frame, whole->centre);
  }

  // Who looks at a dented box will miss its group: a message says at which tolerance it is found.
  void tell_of_larger_tolerance() {
    constexpr int kFew = 4;  // elements: of more there is little to miss
    const std::optional<GroupPlacement> whole = placement_of_whole();
    const std::optional<PointGroup> has = whole ? std::optional(whole->group) : std::nullopt;
    if (late() || (has && (has->continuous() || has->order() > kFew))) return;
    limited_.progress("larger tolerance", 0);
    const std::vector<LargerToleranceGroup> hints =
        groups_at_larger_tolerance(prepared_, has, options_.tolerance, screen_, limited_);
    if (hints.empty()) return;
    std::string text = "the whole has " + (has ? "only " + has->symbol() : "no symmetry") + " at tolerance " +
                       number(options_.tolerance / stretch_) + ", but ";
    for (const LargerToleranceGroup& each : hints) {
      if (&each != &hints.front()) text += " and ";
      text += each.group.symbol() + " at " + number(each.tolerance / stretch_);
    }
    context_.message(text);
  }

  PartRegionOptions part_options(bool pieces) const {
    return {options_.tolerance,        kLeastArea,        pieces, options_.explanation,
            [this] { return late(); }, motions_of_whole()};
  }

  ComponentSurvey survey_of(const PreparedMesh& partition) const {
    return survey_components(partition, options_.tolerance, kLeastArea, limited_);
  }

  PartRegions find_in_parts(const PreparedMesh& partition, ComponentSurvey survey, bool pieces) const {
    return find_part_regions(partition, std::move(survey), *prepared_.index, regions_, screen_, part_options(pieces),
                             limited_);
  }

  // Pieces of surface between creases take the place of components.
  void find_in_segments() {
    if (late()) return;
    PreparedMesh partition = prepared_;
    partition.components = segments_.faces.empty() ? smooth_segments(prepared_) : std::move(segments_);
    const std::size_t count = partition.components.faces.size();
    if (count > std::max(kMaxSegments, kMaxOfComponent * prepared_.components.faces.size())) return;
    // Of one surface what lines say is asked first: pieces have little to add to it. Of parts that no other equals,
    // such as what a cut left of one of several, they say what still turns and mirrors with the others.
    const bool fine_triangles = has_fine_triangles();
    const bool fine = fine_triangles && one_surface();
    const bool about_lines = fine || (fine_triangles && single_area_ >= kMinTurned * prepared_.area);
    const bool cut = count != prepared_.components.faces.size();
    if (fine) {
      for (FoundRegion& region : regions_) region.of_pieces = true;  // where components end is chance there
      find_turned(partition, fine);
    }
    if (late()) return;
    if (about_lines || cut) {
      ComponentSurvey survey = survey_of(partition);
      if (about_lines) find_about_lines(partition, survey);
      if (fine) find_repeated(partition);
      if (cut) add_of_pieces(find_in_parts(partition, std::move(survey), true).regions);
    }
    if (!fine) find_turned(partition, fine);
  }

  // Parts of one surface that repeat on a host take the place of components.
  void find_repeated(const PreparedMesh& partition) {
    if (late()) return;
    PreparedMesh repeated = prepared_;
    repeated.components = repeated_parts(partition);
    PartRegions parts = find_in_parts(repeated, survey_of(repeated), true);
    add_of_pieces(std::move(parts.regions));
    add_patterns(repeated, parts, true);
  }

  // Whether triangles are small: of them a part of a surface can be put together wherever it ends. Where they are large
  // the pieces are exact.
  bool has_fine_triangles() const {
    constexpr double kFine = 5;  // mean length of the triangles' longest edges, tolerances
    double lengths = 0;
    for (Eigen::Index f = 0; f < prepared_.mesh.faces.rows(); ++f) {
      double longest = 0;
      for (int k = 0; k < 3; ++k) {
        const Vector3d edge = prepared_.mesh.vertices.row(prepared_.mesh.faces(f, k)) -
                              prepared_.mesh.vertices.row(prepared_.mesh.faces(f, (k + 1) % 3));
        longest = std::max(longest, edge.norm());
      }
      lengths += prepared_.areas[f] * longest;
    }
    return lengths < kFine * options_.tolerance * prepared_.area;
  }

  // Whether nearly all is one component; or much of it is, and others have no symmetry: thin parts fall into scraps
  // where a surface was made anew. Where parts are modelled as such, they and their pieces say most of what there is.
  bool one_surface() const {
    constexpr double kMuch = 0.4;  // of the area
    constexpr double kAll = 0.9;   // of the area, in components with a group of their own
    double largest = 0;
    for (const std::vector<int>& faces : prepared_.components.faces) {
      largest = std::max(largest, area_of(prepared_, faces));
    }
    return largest > kOneSurface * prepared_.area ||
           (largest > kMuch * prepared_.area && symmetric_area_ < kAll * prepared_.area);
  }

  void add_of_pieces(std::vector<FoundRegion> found) {
    for (FoundRegion& region : found) {
      region.of_pieces = true;
      regions_.push_back(std::move(region));
    }
  }

  // What turns and mirrors into itself about axes and planes that pieces suggest, wherever it ends.
  void find_about_lines(const PreparedMesh& partition, const ComponentSurvey& survey) {
    if (late()) return;
    limited_.progress("axes", 0);
    const ScreenedSurface surface(partition, options_.tolerance, kDetectSamples, limited_);
    const SymmetryLines lines = find_symmetry_lines(partition, survey, options_.tolerance);
    std::vector<Line> axes = axes_of_regions();
    for (const CandidateLine& axis : lines.axes) axes.push_back(axis.line);
    axes.insert(axes.end(), fitted_axes_.begin(), fitted_axes_.end());
    LineRegionOptions options{kMinTurned, options_.explanation, [this] { return late(); }, motions_of_whole()};
    axes = distinct_lines(axes);
    AxisRegions about = find_axis_regions(surface, *prepared_.index, axes, regions_, options, limited_);
    add_of_pieces(std::move(about.regions));
    limited_.progress("subgroups", 0);
    add_of_pieces(
        find_wider_subgroups(surface, *prepared_.index, regions_, about.turning, regions_, options, limited_));
    if (late()) return;
    options.least_share = kMinMirrored;
    std::vector<CandidateLine> planes = mirror_planes(surface, about.turning, options.least_share, limited_);
    planes.insert(planes.end(), lines.planes.begin(), lines.planes.end());
    add_of_pieces(find_plane_regions(surface, *prepared_.index, planes, about.turning, regions_, options, limited_));
    limited_.progress("joined", 0);
    add_joined(surface, about.turning, options);
  }

  // Groups that those found generate together, and what subgroups of them keep besides.
  void add_joined(const ScreenedSurface& surface, const std::vector<Line>& turning, const LineRegionOptions& options) {
    constexpr double kNothingMore = 0.05;  // of a region, that lies outside of what has the larger group
    const SurfaceIndex& whole = *prepared_.index;
    std::vector<FoundRegion> joined = find_joined_groups(surface, whole, turning, regions_, options, limited_);
    if (joined.empty()) return;
    std::erase_if(regions_, [&](const FoundRegion& region) {
      const bool drop = region.of_pieces && region.area < kNearlyWhole * prepared_.area &&
                        says_nothing_new_beside(prepared_, joined, region, options_.tolerance, kNothingMore);
      if (drop && options_.explanation != nullptr) {
        options_.explanation->notes.push_back({"joined", region.placement.group.symbol() + " on " + region.name, false,
                                               "known from a larger group joined of others"});
      }
      return drop;
    });
    std::vector<FoundRegion> known = regions_;
    known.insert(known.end(), joined.begin(), joined.end());
    add_of_pieces(find_wider_subgroups(surface, whole, joined, turning, known, options, limited_));
    add_of_pieces(std::move(joined));
  }

  // Of regions that turn by a third or less.
  std::vector<Line> axes_of_regions() const {
    std::vector<Line> axes;
    for (const FoundRegion& region : regions_) {
      const PointGroup& group = region.placement.group;
      const bool turns = group.continuous()
                             ? group.family != PointGroup::Family::K && group.family != PointGroup::Family::Kh
                             : group.order() >= 3;
      if (turns) axes.push_back({region.placement.centre, region.placement.frame.col(2)});
    }
    return axes;
  }

  std::vector<Line> distinct_lines(const std::vector<Line>& lines) const {
    std::vector<Line> distinct;
    for (const Line& line : lines) {
      const bool known = std::ranges::any_of(distinct, [&](const Line& other) {
        return line.direction.cross(other.direction).norm() < 0.01 &&
               (line.point - other.point).cross(other.direction).norm() < 0.3 * options_.tolerance;
      });
      if (!known) distinct.push_back(line);
    }
    return distinct;
  }

  // Turned regions that end within a piece.
  void find_turned(const PreparedMesh& partition, bool fine) {
    if (late()) return;
    std::vector<Line> axes = axes_of_regions();
    fitted_axes_ = revolution_axes(partition, options_.tolerance, limited_);
    axes.insert(axes.end(), fitted_axes_.begin(), fitted_axes_.end());
    const std::vector<Line> distinct = distinct_lines(axes);
    RevolutionRegionOptions turned{options_.tolerance,        kLeastArea,        fine, options_.explanation,
                                   [this] { return late(); }, motions_of_whole()};
    RevolutionRegions found =
        find_revolution_regions(partition, *prepared_.index, distinct, regions_, turned, limited_);
    add_of_pieces(std::move(found.regions));
    fitted_axes_.insert(fitted_axes_.begin(), found.axes.begin(), found.axes.end());
  }

  void add_patterns(const PreparedMesh& partition, const PartRegions& parts, bool pieces) {
    for (Pattern& pattern : find_patterns(partition, parts, regions_, part_options(pieces), limited_)) {
      std::optional<Pattern> grown;
      if (pieces && !late()) grown = grown_row(prepared_, pattern, options_.tolerance, limited_);
      if (grown && options_.explanation != nullptr) {
        options_.explanation->notes.push_back(
            {"rows", to_string(pattern.kind) + " of " + pattern.name, true,
             "grown to what the step repeats, " + std::to_string(grown->instances.size()) + " times"});
      }
      patterns_.push_back(grown ? std::move(*grown) : std::move(pattern));
      patterns_.back().id = static_cast<int>(patterns_.size()) - 1;
    }
  }

  const DetectOptions& options_;
  double stretch_;
  RunContext& context_;
  RunContext limited_;  // which the time of the options ends
  Clock::time_point start_;
  const PreparedMesh& prepared_;
  Components segments_;
  DirectionSet screen_;
  std::vector<FoundRegion> regions_;
  std::vector<Pattern> patterns_;
  std::vector<Line> fitted_axes_;  // of pieces that look turned; set by find_turned
  double symmetric_area_ = 0;      // of components that have a group of their own
  double single_area_ = 0;         // of components that no other equals, with a mirror or half-turn at most
};

void take_noise_out(PreparedMesh& prepared, double noise, Explanation* explanation, const RunContext& context) {
  context.progress("noise", 0);
  denoise(prepared, noise, context);
  prepared.noise = noise;
  if (explanation != nullptr) {
    explanation->notes.push_back({"noise", std::to_string(100 * noise) + " % of the diagonal", false,
                                  "taken out of the vertices before anything else"});
  }
}

// Regions that only the smoothing made symmetric go.
void drop_made_by_smoothing(const NoiseCheck& check, Explanation* explanation, std::vector<FoundRegion>& regions) {
  std::erase_if(regions, [&](const FoundRegion& region) {
    const bool holds = check.holds(region);
    if (!holds && explanation != nullptr) {
      explanation->notes.push_back({"noise", region.placement.group.symbol() + " on " + region.name, false,
                                    "does not hold on the mesh before its noise was taken out"});
    }
    return !holds;
  });
}

// A coarse mesh to detect on in place of a fine one; nothing where the mesh is not as fine as that.
std::optional<CoarseMesh> proxy_mesh_of(const PreparedMesh& fine, double noise, const DetectOptions& options,
                                        const RunContext& context) {
  const Eigen::Index count = fine.mesh.faces.rows();
  if (options.simplify_above_faces == 0 || count < options.simplify_above_faces) return std::nullopt;
  context.progress("coarse mesh", 0);
  std::optional<CoarseMesh> coarse = coarse_mesh(fine, {options.tolerance, noise}, context);
  if (coarse && options.explanation != nullptr) {
    options.explanation->notes.push_back(
        {"coarse mesh", std::to_string(coarse->mesh.faces.rows()) + " faces for " + std::to_string(count), true,
         "the mesh is finer than the tolerance asks for"});
  }
  return coarse;
}

// What was found as users see it: consistent, without what follows from the rest unless all is asked for, in the order
// of importance, and named.
SymmetryAnnotation listed(const PreparedMesh& prepared, const CanonicalPose& pose, SymmetryAnnotation annotation,
                          const DetectOptions& options, const RunContext& context) {
  const Mesh& mesh = pose.mesh;
  annotation = options.all
                   ? kept_consistent(prepared, mesh, annotation, options.explanation, context)
                   : kept_without_what_follows(prepared, mesh, std::move(annotation), options.explanation, context);
  const std::vector<std::vector<std::size_t>> families =
      list_by_importance(prepared, annotation, options.all, options.explanation, context);
  const PartNames names(options.named_parts, static_cast<std::size_t>(mesh.faces.rows()));
  const SideAxes axes = pose.motion.linear * side_axes(options.up);
  name_by_shape_and_place(prepared, families, axes, names, annotation, options.explanation);
  context.progress("regions", 1);
  return annotation;
}

}  // namespace

void DetectOptions::validate() const {
  const auto refuse = [](const std::string& field, const std::string& value, const std::string& rule) {
    throw UsageError("DetectOptions." + field + " is " + value + "; it must satisfy " + rule);
  };
  if (!(tolerance >= 1e-6 && tolerance <= 0.1))
    refuse("tolerance", std::to_string(tolerance), "1e-6 <= tolerance <= 0.1");
  if (samples < 100) refuse("samples", std::to_string(samples), "samples >= 100");
  if (simplify_above_faces < 0)
    refuse("simplify_above_faces", std::to_string(simplify_above_faces), "simplify_above_faces >= 0");
  if (!(time_budget >= 0)) refuse("time_budget", std::to_string(time_budget), "time_budget >= 0");
  if (!(up.norm() > 0)) refuse("up", "zero or not a number", "|up| > 0");
}

namespace {

// Of the mesh in its canonical pose. \param as_given  with the colours' faces
SymmetryAnnotation detected(const Mesh& as_given, const CanonicalPose& pose, const DetectOptions& options,
                            RunContext& context) {
  const Mesh& mesh = pose.mesh;
  const auto start = Clock::now();
  PreparedMesh prepared = prepare(mesh);
  SymmetryAnnotation annotation = empty_annotation(mesh, options.tolerance);
  std::optional<PreparedMesh> given;  // where there is noise: before it was taken out
  double noise = noise_of(prepared);
  if (noise >= kMinNoise) {
    given = prepared;
    take_noise_out(prepared, noise, options.explanation, context);
  } else {
    noise = 0;
  }
  Findings found;
  if (const std::optional<CoarseMesh> coarse = proxy_mesh_of(prepared, noise, options, context)) {
    PreparedMesh proxy = prepare(coarse->mesh);
    proxy.noise = prepared.noise;
    // Where creases end within the surface is known to the fine mesh only.
    Components segments = transferred_pieces(smooth_segments(prepared), prepared, *coarse);
    DetectOptions on_coarse = options;
    on_coarse.time_budget *= kOfDetection;
    found = Detector(proxy, std::move(segments), pose.stretch, on_coarse, start, context).run();
    const auto late = [&](double share) { return spent(options, start, share); };
    found = transferred(prepared, *coarse, proxy, std::move(found),
                        {options.tolerance, options.samples, options.explanation, late}, context);
  } else {
    found = Detector(prepared, {}, pose.stretch, options, start, context).run();
  }
  if (given) {
    drop_made_by_smoothing(NoiseCheck(*given, prepared, noise, options.tolerance, context), options.explanation,
                           found.regions);
  }
  drop_cut_discs(prepared, options.tolerance, context, found.regions, options.explanation);
  drop_repeats(prepared, options.tolerance, found.regions, options.explanation);
  const auto late = [&] { return spent(options, start, 1); };
  trim_regions(prepared, options.tolerance, BorderMoves::both_ways, context, found.regions, options.explanation, late);
  if (!late()) {
    const PartRegionOptions parts{options.tolerance, kLeastArea, false, options.explanation, late, {}};
    std::ranges::move(find_region_patterns(prepared, found.regions, found.patterns, parts, context),
                      std::back_inserter(found.patterns));
  }
  annotation.regions = annotated(prepared, std::move(found.regions), options.tolerance, context, options.explanation);
  annotation.patterns = std::move(found.patterns);
  for (std::size_t i = 0; i < annotation.patterns.size(); ++i) annotation.patterns[i].id = static_cast<int>(i);
  if (options.colours == nullptr || options.colours->uniform()) {
    return listed(prepared, pose, std::move(annotation), options, context);
  }
  context.progress("colours", 0);
  const ColourSamples samples(mesh, *options.colours, pose.moved(as_given), pose.face_of,
                              options.tolerance * diagonal(mesh.vertices), context);
  if (options.broken_by_colours != nullptr) {
    DetectOptions by_shape = options;
    by_shape.explanation = nullptr;
    *options.broken_by_colours =
        kept_by_colours(mesh, listed(prepared, pose, annotation, by_shape, context), samples, context).broken;
  }
  return listed(prepared, pose, kept_by_colours(mesh, annotation, samples, context).annotation, options, context);
}

}  // namespace

SymmetryAnnotation detect(const Mesh& mesh, const DetectOptions& options, RunContext& context) {
  options.validate();
  require_finite(mesh);
  const CanonicalPose pose(mesh);
  DetectOptions in_pose = options;
  in_pose.tolerance *= pose.stretch;
  std::vector<int>& parts = in_pose.named_parts.part_of_face;
  if (!parts.empty()) {
    std::ranges::transform(pose.face_of, parts.begin(),
                           [&](int face) { return options.named_parts.part_of_face[static_cast<std::size_t>(face)]; });
  }
  SymmetryAnnotation result = pose.as_given(detected(mesh, pose, in_pose, context), mesh);
  result.tolerance = options.tolerance;
  return kept_when_read(mesh, std::move(result), options.explanation, context);
}

}  // namespace orbifit
