#include "support/yielding_borders.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "consistency/consistency_search.h"
#include "consistency/group_place.h"
#include "consistency/halvings.h"
#include "evidence/policy.h"
#include "group/verification.h"
#include "surface/face_sides.h"
#include "surface/smooth_border.h"
#include "surface/surface_ends.h"

namespace orbifit {

namespace {

// The motions that judge the region's group, on the normalised mesh; none where its placement is not a group's.
std::vector<Motion> normalised_motions(const PreparedMesh& prepared, const Region& region) {
  const std::optional<GroupPlace> place = place_of(region);
  if (!place) return {};
  const Similarity to_normalised = inverse(prepared.input_of_normalised);
  std::vector<Motion> motions = judged_motions(place->group, place->frame, place->centre);
  for (Motion& motion : motions) motion = conjugate(to_normalised, motion);
  return motions;
}

class YieldingBorders {
 public:
  YieldingBorders(const ShapeSurface& surface, const std::vector<BorderPlace>& borders,
                  const SymmetryAnnotation& annotation)
      : annotation_(annotation),
        borders_(borders),
        tolerance_(annotation.tolerance * surface.diagonal),
        shapes_(ConsistencySearch::shapes_of(surface, annotation)) {
    for (const Region& region : annotation.regions) places_.push_back(place_of(region));
  }

  // The faces that a region keeps; nothing where it keeps all, or would keep too few.
  std::optional<std::vector<int>> kept(std::size_t region) {
    if (border_of(region) == BorderPlace::kOfPart || !places_[region]) return std::nullopt;
    const int shape = shape_of(region);
    std::vector<int> taken;
    std::vector<int> parts;
    for (std::size_t part = 0; part < annotation_.regions.size(); ++part) {
      if (!is_beside(region, part) || (has_images(region, part) && has_images(part, region))) continue;
      const std::vector<int> faces = shapes_.faces_at(shape, shape_of(part));
      taken.insert(taken.end(), faces.begin(), faces.end());
      parts.push_back(static_cast<int>(part));
    }
    if (taken.empty()) return std::nullopt;
    std::ranges::sort(taken);
    taken.erase(std::unique(taken.begin(), taken.end()), taken.end());
    std::vector<int> rest = shapes_.without_orbit(shape, taken, *places_[region]);
    const double left = shapes_.area_of(rest);
    if (left < policy_.left * shapes_.area(shape)) return std::nullopt;
    const double lost = (shapes_.area(shape) - left) * halvings(places_[region]->group);
    if (border_of(region) == BorderPlace::kBeforeEnds && saved_by(std::move(parts)) <= lost) return std::nullopt;
    return rest;
  }

 private:
  BorderPlace border_of(std::size_t region) const {
    return borders_[static_cast<std::size_t>(annotation_.regions[region].id)];
  }

  static int shape_of(std::size_t region) { return static_cast<int>(region); }

  // What the regions save together: a face what the largest group there does.
  double saved_by(std::vector<int> regions) const {
    const auto halved = [&](int region) { return halvings(places_[static_cast<std::size_t>(region)]->group); };
    std::ranges::stable_sort(regions, std::ranges::greater{}, halved);
    std::vector<int> counted;
    double saved = 0;
    for (const int region : regions) {
      const std::vector<int>& faces = annotation_.regions[static_cast<std::size_t>(region)].faces;
      std::vector<int> more;
      std::ranges::set_difference(faces, counted, std::back_inserter(more));
      saved += shapes_.area_of(more) * halved(region);
      const auto middle = counted.insert(counted.end(), more.begin(), more.end());
      std::inplace_merge(counted.begin(), middle, counted.end());
    }
    return saved;
  }

  // Whether the other is a part that the region touches, and neither holds the other.
  bool is_beside(std::size_t region, std::size_t other) const {
    if (other == region || border_of(other) != BorderPlace::kOfPart || !places_[other]) return false;
    const int shape = shape_of(region);
    const int part = shape_of(other);
    return shapes_.touch(shape, part) && !shapes_.within(part, shape) && !shapes_.within(shape, part);
  }

  // Whether all motions of the one take the other to regions of its group.
  bool has_images(std::size_t mover, std::size_t moved) const {
    return std::ranges::all_of(movers(*places_[mover]), [&](const Motion& motion) {
      for (std::size_t image = 0; image < annotation_.regions.size(); ++image) {
        if (is_image(moved, motion, image)) return true;
      }
      return false;
    });
  }

  bool is_image(std::size_t moved, const Motion& motion, std::size_t image) const {
    const std::optional<GroupPlace>& from = places_[moved];
    const std::optional<GroupPlace>& to = places_[image];
    const int source = shape_of(moved);
    const int target = shape_of(image);
    return to && to->group == from->group &&
           group_distance(*from, motion, *to, shapes_.extent(target)) <= policy_.same_group * tolerance_ &&
           shapes_.arrived(source, source, motion, target, target) >= policy_.arrived;
  }

  const SymmetryAnnotation& annotation_;
  const std::vector<BorderPlace>& borders_;  // by id
  ConsistencyPolicy policy_;
  double tolerance_;     // mesh units
  RegionShapes shapes_;  // the regions' come first, in their order
  std::vector<std::optional<GroupPlace>> places_;
};

}  // namespace

std::vector<BorderPlace> border_places(const PreparedMesh& prepared, const std::vector<Region>& regions,
                                       double tolerance, const RunContext& context) {
  const std::vector<std::array<FaceSide, 3>> sides = face_sides(prepared);
  const double reach = tolerance * diagonal(prepared.mesh.vertices);
  const SurfaceEnds ends(prepared, reach);
  std::vector<BorderPlace> result(regions.size(), BorderPlace::kOfPart);
  const double most = kEvidencePolicy.smooth_border;
  parallel_for(context, regions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      context.check();
      const std::vector<Motion> motions = normalised_motions(prepared, regions[i]);
      const auto ended = [&](const Eigen::Vector3d& middle) { return ends.taken_near(middle, motions); };
      if (smooth_border_share(prepared, sides, regions[i].faces, reach) <= most) continue;
      const bool before_ends = smooth_border_share(prepared, sides, regions[i].faces, reach, ended) <= most;
      result[i] = before_ends ? BorderPlace::kBeforeEnds : BorderPlace::kWithinSmooth;
    }
  });
  return result;
}

void yield_to_parts(const ShapeSurface& surface, const std::vector<BorderPlace>& borders,
                    SymmetryAnnotation& annotation, Explanation* explanation, const RunContext& context) {
  YieldingBorders yielding(surface, borders, annotation);
  std::vector<std::optional<std::vector<int>>> kept;
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    context.check();
    kept.push_back(yielding.kept(i));
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i]) continue;
    Region& region = annotation.regions[i];
    if (explanation != nullptr) {
      explanation->notes.push_back({"yielding", region.group.symbol() + " on " + region.name, true,
                                    std::to_string(region.faces.size() - kept[i]->size()) +
                                        " faces go around parts of which its group has no images"});
    }
    region.faces = std::move(*kept[i]);
  }
}

}  // namespace orbifit
