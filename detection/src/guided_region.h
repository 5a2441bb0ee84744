#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "group/verification.h"
#include "support/found_region.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// What a person says about a symmetry: roughly where it sits, and faces that have it. Mesh units.
struct RegionHint {
  enum class About { plane, axis, centre };
  static constexpr int kContinuous = 0;  ///< as an order: every rotation

  About about = About::plane;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< on the plane or the axis, or the centre
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit: the plane's normal or the axis; unused for a centre
  /// The group wanted. Without one: Cs for a plane, Ci for a centre, and for an axis the largest group of the region
  /// that the rotations of this `order` keep.
  std::optional<PointGroup> group;
  std::optional<int> order;  ///< >= 2 or kContinuous; without it the highest that fits the seeds' surroundings
  std::vector<int> seeds;    ///< at least one face
  /// False: the plane, axis or centre is taken as it is given, and the group is the one given or the rotations alone.
  bool refine = true;

  /// \param faces of the mesh \throw UsageError naming the field, its value and the rule
  void validate(int faces) const;
};

struct GuidedRegionOptions {
  double tolerance = 0.005;  ///< fraction of the mesh's diagonal, as the detector's
  int samples = 4000;        ///< on which the region is verified
};

/// A region grown from a hint, and whether its group stands there.
struct GuidedRegion {
  FoundRegion region;
  Verification verification;
  Residual residual;
  bool stands = false;  ///< the group passed on a region that holds a seed
};

/// Fits the plane, axis or centre to the seeds' surroundings, then by turns finds the region of the group (by
/// orbit_region.h, tolerances scaled to its size) and fits the group to it; verifies what it comes to.
/// Costs a few orbit tests of the mesh. \param whole index of the whole mesh
/// \throw UsageError for a hint that makes no sense
GuidedRegion guided_region(const PreparedMesh& prepared, const std::shared_ptr<const SurfaceIndex>& whole,
                           const RegionHint& hint, const GuidedRegionOptions& options, const RunContext& context);

}  // namespace orbifit
