#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/point_group.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// What a person says about a symmetry: roughly where its plane, axis or centre is, and a place that has it. Mesh
/// units.
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
  std::vector<int> seeds;    ///< faces of the region; at least one, or `near`
  std::optional<Eigen::Vector3d> near;  ///< the face nearest to this point is a seed too
  /// False: the plane, axis or centre is taken as it is given, and the group is the one given or the rotations alone.
  bool refine = true;

  /// \param faces of the mesh
  /// \throw UsageError naming the field, its value and the rule
  void validate(int faces) const;
};

struct GuidedRegionOptions {
  double tolerance = 0.005;  ///< fraction of the mesh's diagonal, as the detector's
  int samples = 4000;        ///< on which the region is verified
};

/// A region grown from a hint, and whether it has the group.
struct GuidedRegion {
  Region region;          ///< in the mesh's frame, its residual measured; without name and place in an annotation
  double kept = 0;        ///< share of its area that every motion of the group keeps on the region
  bool holds = false;     ///< the group passed on a region that holds a seed
  std::string shortfall;  ///< where it does not hold: what falls short, and of how much
};

/// Fits the plane, axis or centre to the seeds' surroundings, then alternates between finding the region of the group
/// (tolerances scaled to its size) and fitting the group to it, and verifies the result. Costs O(F log F) for the mesh
/// and a few orbit tests of it.
/// \throw UsageError for a hint that makes no sense, InputError when the mesh has no area
GuidedRegion guided_region(const Mesh& mesh, const RegionHint& hint, const GuidedRegionOptions& options,
                           const RunContext& context);

/// The least tolerance tried, each half as large again as the one before, at which the region that a hint names has its
/// group; none up to 0.1 of the diagonal, the largest that detect() takes. Errors as above.
std::optional<double> passing_tolerance(const Mesh& mesh, const RegionHint& hint, const GuidedRegionOptions& options,
                                        const RunContext& context);

}  // namespace orbifit
