#include "resolution/transfer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "group/patterns.h"
#include "group/verification.h"
#include "resolution/region_border.h"
#include "search/completion.h"
#include "support/own_group.h"
#include "surface/components.h"
#include "surface/creases.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kPartSamples = 1000;
constexpr int kCopySamples = 300;
constexpr int kRefined = 800;                 // samples
constexpr std::size_t kBorderQueries = 3000;  // for a residual
constexpr double kExact = 1e-3;               // root mean square distance, tolerances
constexpr double kToRefine = 0.8;             // of the time; the rest to verify
constexpr const char* kNoTime = "no time left";

class CarryBack {
 public:
  CarryBack(const PreparedMesh& fine, const CoarseMesh& coarse, const PreparedMesh& prepared,
            const CarryBackOptions& options, const RunContext& context)
      : fine_(fine),
        coarse_(coarse),
        prepared_(prepared),
        options_(options),
        context_(context),
        border_(fine, coarse, prepared, options.tolerance) {}

  Findings run(Findings found) {
    context_.progress("transfer to the fine mesh", 0);
    std::ranges::stable_sort(found.regions, std::greater<>(), &FoundRegion::area);
    std::vector<FoundRegion> refined(found.regions.size());
    for_each(refined.size(), [&](std::size_t i) {
      if (i == 0 || !late(kToRefine)) refined[i] = refined_on_fine(found.regions[i]);
    });
    drop_unrefined(found.regions, refined);
    context_.progress("transfer to the fine mesh", 0.4);
    const std::vector<GroupPlacement> goals = consistent(found.regions, refined);
    context_.progress("transfer to the fine mesh", 0.5);
    std::vector<std::string> objections(refined.size(), kNoTime);
    for_each(refined.size(), [&](std::size_t i) {
      if (i == 0 || !late(1)) objections[i] = accept(refined[i], goals[i]);
    });
    Findings result;
    for (std::size_t i = 0; i < refined.size(); ++i) {
      if (objections[i].empty()) {
        result.regions.push_back(std::move(refined[i]));
      } else {
        note(refined[i].placement.group.symbol() + " on " + refined[i].name, objections[i]);
      }
    }
    for (const Pattern& pattern : found.patterns) {
      context_.check();
      if (late(1)) {
        note(to_string(pattern.kind) + " of " + pattern.name, kNoTime);
        continue;
      }
      if (std::optional<Pattern> carried = carried_pattern(pattern)) {
        carried->id = static_cast<int>(result.patterns.size());
        result.patterns.push_back(std::move(*carried));
      }
    }
    return result;
  }

 private:
  // On all threads, the first ones first.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& look) const {
    constexpr std::size_t kStride = 64;
    parallel_for(context_, std::min(count, kStride), [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = 0; row < count; row += kStride) {
        for (std::size_t i = row + begin; i < std::min(count, row + end); ++i) look(i);
      }
    });
  }

  bool late(double share) const { return options_.late && options_.late(share); }

  // Those that time was not left for: the smallest.
  void drop_unrefined(std::vector<FoundRegion>& found, std::vector<FoundRegion>& refined) const {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < refined.size(); ++i) {
      if (refined[i].faces.empty()) {
        note(found[i].placement.group.symbol() + " on " + found[i].name, kNoTime);
        continue;
      }
      if (kept != i) {
        found[kept] = std::move(found[i]);
        refined[kept] = std::move(refined[i]);
      }
      ++kept;
    }
    found.resize(kept);
    refined.resize(kept);
  }

  void note(const std::string& subject, const std::string& reason) const {
    if (options_.explanation == nullptr) return;
    options_.explanation->notes.push_back({"transfer to the fine mesh", subject, false, reason});
  }

  bool is_whole(const FoundRegion& region) const {
    return region.faces.size() == static_cast<std::size_t>(fine_.mesh.faces.rows());
  }

  FoundRegion refined_on_fine(const FoundRegion& found) const {
    FoundRegion region = found;
    region.faces = border_.refined(found, context_);
    region.area = area_of(fine_, region.faces);
    region.placement.centre = prepared_.input_of_normalised(found.placement.centre);
    const SurfacePatch patch = on_whole(region);
    RefinementOptions options;
    options.samples = kRefined;
    options.first_width = 1.5;
    const GroupPlacement refined = refine(patch, region.placement, context_, options);
    // Where vertices are images of one another the surface is as well, all but exactly.
    region.placement =
        largest_residual(patch, refined) < kExact * patch.tolerance ? refine_on_vertices(patch, refined) : refined;
    return region;
  }

  // Samples of the region, and the whole surface to find their images on: one index serves all regions.
  SurfacePatch on_whole(const FoundRegion& region) const {
    SurfacePatch patch = sample_patch(fine_, region.faces, kPartSamples, options_.tolerance, context_, "transfer");
    patch.index = fine_.index;
    return patch;
  }

  double largest_residual(const SurfacePatch& patch, const GroupPlacement& placement) const {
    const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
    return measure_residual(patch, motions, context_, kBorderQueries).rms;
  }

  // Where the placements are when the groups of regions that are images of one another are: refined each by itself
  // they differ by that. Which are images of which the coarse mesh tells.
  std::vector<GroupPlacement> consistent(const std::vector<FoundRegion>& found,
                                         const std::vector<FoundRegion>& refined) const {
    const Similarity coarse_of_fine = inverse(prepared_.input_of_normalised);
    std::vector<FoundRegion> regions = found;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      regions[i].placement = refined[i].placement;
      regions[i].placement.centre = coarse_of_fine(refined[i].placement.centre);
    }
    complete_regions(prepared_, *prepared_.index,
                     {options_.tolerance, regions.size(), nullptr, [this] { return late(kToRefine); }}, context_,
                     regions);
    std::vector<GroupPlacement> result;
    for (const FoundRegion& region : regions) {
      result.push_back(region.placement);
      result.back().centre = prepared_.input_of_normalised(region.placement.centre);
    }
    return result;
  }

  // Moves the region to where it is consistent with others, unless it fits far less well there, and verifies it. What
  // is to be said against it; empty where it stands.
  std::string accept(FoundRegion& region, const GroupPlacement& goal) const {
    SurfacePatch patch = make_patch(fine_, region.faces, is_whole(region) ? options_.samples : kPartSamples,
                                    options_.tolerance, context_, "transfer");
    mark_creases(patch.samples, patch.tolerance, patch.at_crease);
    mark_creases(patch.part_samples, patch.tolerance, patch.part_at_crease);
    const GroupPlacement alone = region.placement;
    if (fits_as_well(largest_residual(patch, goal), largest_residual(patch, alone))) region.placement = goal;
    Verification verification = verify_group(patch, region.placement, context_);
    if (!passes(verification)) {
      region.placement = alone;
      verification = verify_group(patch, alone, context_);
    }
    if (passes(verification)) {
      const GroupPlacement& placement = region.placement;
      region.residual =
          measure_residual(patch, judged_motions(placement.group, placement.frame, placement.centre), context_);
    }
    return objection(verification);
  }

  // Creases within three tolerances, as make_patch() means them: fine faces next to a sample's do not reach that far.
  void mark_creases(const SurfaceSamples& samples, double tolerance, std::vector<char>& at_crease) const {
    const Similarity coarse_of_fine = inverse(prepared_.input_of_normalised);
    for (std::size_t s = 0; s < at_crease.size(); ++s) {
      if (at_crease[s] != 0) continue;
      const Vector3d point = coarse_of_fine(samples.points.row(static_cast<Eigen::Index>(s)));
      const int face = coarse_.proxy_face[static_cast<std::size_t>(samples.faces[s])];
      at_crease[s] = near_crease(prepared_, point, face, kCreaseReach * tolerance) ? 1 : 0;
    }
  }

  std::optional<Pattern> carried_pattern(const Pattern& found) const {
    const std::vector<int> first = border_.fine_faces(found.instances.front().faces);
    const SurfacePatch patch = make_patch(fine_, first, kCopySamples, options_.tolerance, context_, "pattern");
    std::vector<std::vector<int>> faces;
    Arrangement placed{found.kind, {}, {}, 0};
    for (const Motion& step : found.generators) placed.generators.push_back(step);
    for (const PatternInstance& instance : found.instances) {
      faces.push_back(border_.fine_faces(instance.faces));
      placed.motions.push_back(faces.size() == 1 ? Motion{}
                                                 : refined_motion(patch, fine_, faces.back(), instance.motion));
    }
    if (found.kind != Pattern::Kind::congruent) {
      Arrangement arranged =
          arrange(placed.motions, nullptr, patch.moments.centroid, patch.moments.radius, patch.tolerance);
      if (arranged.kind == found.kind) {
        placed = std::move(arranged);
      } else {
        for (std::size_t i = 1; i < placed.motions.size(); ++i) placed.motions[i] = found.instances[i].motion;
      }
    }
    return judged(found, placed, patch, faces);
  }

  // The pattern of those instances that the motions reach.
  std::optional<Pattern> judged(const Pattern& found, const Arrangement& placed, const SurfacePatch& patch,
                                std::vector<std::vector<int>>& faces) const {
    Pattern pattern;
    pattern.name = found.name;
    pattern.kind = found.kind;
    for (const Motion& step : placed.generators) {
      pattern.generators.push_back(conjugate(fine_.input_of_normalised, step));
    }
    double square = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const CopyFit copy = fit_of_copy(patch, placed.motions[i], faces[i]);
      if (copy.kept < kKeptOfCopy) continue;
      square += copy.square;
      pattern.residual.max = std::max(pattern.residual.max, copy.largest);
      const Motion motion = i == 0 ? Motion{} : conjugate(fine_.input_of_normalised, placed.motions[i]);
      pattern.instances.push_back({motion, std::move(faces[i])});
    }
    const auto count = pattern.instances.size() * static_cast<std::size_t>(patch.samples.points.rows());
    pattern.residual.rms = std::sqrt(square / static_cast<double>(std::max<std::size_t>(count, 1)));
    if (pattern.instances.size() == faces.size() || pattern.instances.size() >= 3) return pattern;
    note(to_string(found.kind) + " of " + std::to_string(faces.size()) + " times " + found.name, "not verified");
    return std::nullopt;
  }

  const PreparedMesh& fine_;
  const CoarseMesh& coarse_;
  const PreparedMesh& prepared_;
  const CarryBackOptions& options_;
  const RunContext& context_;
  RegionBorder border_;
};

}  // namespace

Findings transferred(const PreparedMesh& fine, const CoarseMesh& coarse, const PreparedMesh& prepared, Findings found,
                     const CarryBackOptions& options, const RunContext& context) {
  return CarryBack(fine, coarse, prepared, options, context).run(std::move(found));
}

}  // namespace orbifit
