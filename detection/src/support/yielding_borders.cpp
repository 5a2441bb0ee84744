#include "support/yielding_borders.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "consistency/consistency_search.h"
#include "consistency/group_place.h"
#include "evidence/policy.h"
#include "surface/face_sides.h"
#include "surface/smooth_border.h"

namespace orbifit {

namespace {

class YieldingBorders {
 public:
  YieldingBorders(const ShapeSurface& surface, const std::vector<char>& ends_within,
                  const SymmetryAnnotation& annotation)
      : annotation_(annotation),
        ends_within_(ends_within),
        tolerance_(annotation.tolerance * surface.diagonal),
        shapes_(ConsistencySearch::shapes_of(surface, annotation)) {
    for (const Region& region : annotation.regions) places_.push_back(place_of(region));
  }

  // The faces that a region keeps; nothing where it keeps all, or would keep too few.
  std::optional<std::vector<int>> kept(std::size_t region) {
    if (!ends_within(region) || !places_[region]) return std::nullopt;
    const int shape = shape_of(region);
    std::vector<int> taken;
    for (std::size_t part = 0; part < annotation_.regions.size(); ++part) {
      if (!is_beside(region, part) || (has_images(region, part) && has_images(part, region))) continue;
      const std::vector<int> faces = shapes_.faces_at(shape, shape_of(part));
      taken.insert(taken.end(), faces.begin(), faces.end());
    }
    if (taken.empty()) return std::nullopt;
    std::ranges::sort(taken);
    taken.erase(std::unique(taken.begin(), taken.end()), taken.end());
    std::vector<int> rest = shapes_.without_orbit(shape, taken, *places_[region]);
    if (shapes_.area_of(rest) < policy_.left * shapes_.area(shape)) return std::nullopt;
    return rest;
  }

 private:
  bool ends_within(std::size_t region) const {
    return ends_within_[static_cast<std::size_t>(annotation_.regions[region].id)] != 0;
  }

  static int shape_of(std::size_t region) { return static_cast<int>(region); }

  // Whether the other is a part that the region touches, and neither holds the other.
  bool is_beside(std::size_t region, std::size_t other) const {
    if (other == region || ends_within(other) || !places_[other]) return false;
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
  const std::vector<char>& ends_within_;  // by id
  ConsistencyPolicy policy_;
  double tolerance_;     // mesh units
  RegionShapes shapes_;  // the regions' come first, in their order
  std::vector<std::optional<GroupPlace>> places_;
};

}  // namespace

std::vector<char> ending_within_surface(const PreparedMesh& prepared, const std::vector<Region>& regions,
                                        double tolerance, const RunContext& context) {
  const std::vector<std::array<FaceSide, 3>> sides = face_sides(prepared);
  const double reach = tolerance * diagonal(prepared.mesh.vertices);
  std::vector<char> result(regions.size(), 0);
  parallel_for(context, regions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      context.check();
      const double smooth = smooth_border_share(prepared, sides, regions[i].faces, reach);
      result[i] = smooth > kEvidencePolicy.smooth_border ? 1 : 0;
    }
  });
  return result;
}

void yield_to_parts(const ShapeSurface& surface, const std::vector<char>& ends_within, SymmetryAnnotation& annotation,
                    Explanation* explanation, const RunContext& context) {
  YieldingBorders borders(surface, ends_within, annotation);
  std::vector<std::optional<std::vector<int>>> kept;
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    context.check();
    kept.push_back(borders.kept(i));
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
