#include "patterns/partial_rows.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "group/verification.h"
#include "support/region_growth.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMaxOfRegion = 24;       // elements
constexpr int kMaxAround = 120;        // elements
constexpr double kMinDeciding = 0.02;  // of the region's area
constexpr double kMinShared = 0.5;
constexpr double kParallel = 0.01;   // radians
constexpr double kMaxShared = 0.97;  // more: the element keeps the region
constexpr double kShift = 4;         // tolerances that a translation moves at least

// A host turned about an axis that the group leaves in place turns into itself anyway: the faces of the region that
// stand on it decide.
std::vector<int> deciding_faces(const PreparedMesh& prepared, const std::vector<FoundRegion>& all,
                                const FoundRegion& region, double tolerance) {
  const SurfaceMoments moments = surface_moments(prepared, region.faces);
  std::vector<int> faces = region.faces;
  for (const FoundRegion& other : all) {
    const GroupPlacement& host = other.placement;
    if (!host.group.continuous() ||
        !contains_group(host, region.placement, moments.centroid, moments.radius, 2 * tolerance)) {
      continue;
    }
    std::erase_if(faces, [&](int face) { return std::ranges::binary_search(other.faces, face); });
  }
  return faces;
}

/// One region, with samples of what decides.
class RowTest {
 public:
  /// \param faces of the region, that decide
  RowTest(const PreparedMesh& prepared, const FoundRegion& region, const std::vector<int>& faces, double tolerance,
          const RunContext& context)
      : prepared_(prepared),
        placement_(region.placement),
        own_(judged_motions(placement_.group, placement_.frame, placement_.centre)),
        patch_(sample_patch(prepared, faces, kSamples, tolerance, context, "row")),
        index_(prepared.index->part(region.faces)) {}

  // Whether the region shares much with its image under the motion, which keeps a region around it, and what they share
  // repeats.
  bool repeats(const Motion& around) const {
    const std::vector<Motion> steps = steps_of(around);
    if (steps.empty()) return false;
    const std::vector<Eigen::Index> shared = kept_by(inverse(around));
    const double share = static_cast<double>(shared.size()) / static_cast<double>(patch_.samples.points.rows());
    if (share < kMinShared || share > kMaxShared) return false;
    return std::ranges::any_of(steps, [&](const Motion& step) { return leaves(step, shared); });
  }

 private:
  static constexpr int kSamples = 200;

  // Products of an element of the region's group and one of its image's: translations, and of two mirrors rotations.
  std::vector<Motion> steps_of(const Motion& around) const {
    std::vector<Motion> result;
    const bool mirror = placement_.group.family == PointGroup::Family::Cs;
    const Motion back = inverse(around);
    const Vector3d& centroid = patch_.moments.centroid;
    for (const Motion& theirs : own_) {
      const Motion image = around * theirs * back;
      for (const Motion& mine : own_) {
        const Motion step = mine * image;
        const bool turns = (step.linear - Matrix3d::Identity()).norm() > kParallel;
        if (turns ? mirror : (step(centroid) - centroid).norm() > kShift * patch_.tolerance) result.push_back(step);
      }
    }
    return result;
  }

  // The samples that the motion carries onto the region.
  std::vector<Eigen::Index> kept_by(const Motion& motion) const {
    std::vector<Eigen::Index> result;
    for (Eigen::Index i = 0; i < patch_.samples.points.rows(); ++i) {
      if (keeps(motion, i, index_)) result.push_back(i);
    }
    return result;
  }

  bool keeps(const Motion& motion, Eigen::Index i, const SurfaceIndex& surface) const {
    const Vector3d normal = motion.linear * patch_.samples.normals.row(i).transpose();
    return surface.within_facing(motion(patch_.samples.points.row(i)), normal, kFacetNormals, patch_.tolerance);
  }

  // Whether some power of the step takes most of the samples off the mesh, before one leaves all where they are.
  bool leaves(const Motion& step, const std::vector<Eigen::Index>& samples) const {
    constexpr int kMaxPowers = 40;
    constexpr double kMax = 0.5;  // of the samples stay
    Motion power = step;
    for (int k = 1; k <= kMaxPowers; ++k, power = step * power) {
      const double moved =
          motion_distance(power, Motion{}, patch_.moments.centroid, std::max(patch_.moments.radius, 1e-9));
      if (moved < patch_.tolerance) return false;
      const auto kept =
          std::ranges::count_if(samples, [&](Eigen::Index i) { return keeps(power, i, *prepared_.index); });
      if (static_cast<double>(kept) < kMax * static_cast<double>(samples.size())) return true;
    }
    return false;
  }

  const PreparedMesh& prepared_;
  const GroupPlacement& placement_;
  std::vector<Motion> own_;
  SurfacePatch patch_;
  SurfaceIndex index_;
};

// Whether the region's group is, but for where it is, of the other's, or any few in an arc have it: then it says no
// more than that they repeat.
bool of_its_kind(const GroupPlacement& other, const GroupPlacement& region) {
  if (region.group.family == PointGroup::Family::Cs) return true;
  const Vector3d origin = Vector3d::Zero();
  return contains_group({other.group, other.frame, origin}, {region.group, region.frame, origin}, origin, 1, kParallel);
}

bool finite_of(const FoundRegion& region, int most) {
  return !region.placement.group.continuous() && region.placement.group.order() <= most;
}

// Whether the other region holds this one.
bool around(const PreparedMesh& prepared, const FoundRegion& other, const FoundRegion& region) {
  constexpr double kMaxOutside = 0.05;  // of the region's area
  return other.area > region.area && finite_of(other, kMaxAround) &&
         area_outside(prepared, region.faces, other.faces) <= kMaxOutside * region.area;
}

}  // namespace

void drop_some_of_rows(const PreparedMesh& prepared, double tolerance, const RunContext& context,
                       std::vector<FoundRegion>& regions, Explanation* explanation) {
  std::vector<char> some(regions.size(), 0);
  parallel_for(context, regions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const FoundRegion& region = regions[r];
      if (!finite_of(region, kMaxOfRegion)) continue;
      const std::vector<int> faces = deciding_faces(prepared, regions, region, tolerance);
      if (area_of(prepared, faces) < kMinDeciding * region.area) continue;
      const RowTest test(prepared, region, faces, tolerance, context);
      some[r] = std::ranges::any_of(regions, [&](const FoundRegion& other) {
        if (!around(prepared, other, region) || !of_its_kind(other.placement, region.placement)) return false;
        const GroupPlacement& placement = other.placement;
        const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
        return std::ranges::any_of(motions, [&](const Motion& motion) { return test.repeats(motion); });
      });
    }
  });
  std::size_t next = 0;
  std::erase_if(regions, [&](const FoundRegion& region) {
    const bool drop = some[next++] != 0;
    if (drop && explanation != nullptr) {
      explanation->notes.push_back({"rows", region.placement.group.symbol() + " on " + region.name, false,
                                    "some of a row: it overlaps its own image"});
    }
    return drop;
  });
}

}  // namespace orbifit
