#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "geometry/sampling.h"
#include "registration/correspondences.h"
#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// Points of the template that the scan should have seen: where it saw through them they are pulled to what it saw.
class SilhouettePulls {
 public:
  /// \param cloud  all of the scan, with its viewpoints \param scan  the points that are matched
  SilhouettePulls(const Mesh& mesh, const PointCloud& cloud, const PreparedScan& scan, const RunContext& context);

  const SeenSurface& seen() const { return seen_; }

  bool knows_viewpoints() const { return seen_.knows_viewpoints(); }

  /// Whether viewpoints have nothing where much of the template should be: then points have been cut off the scan, with
  /// other things or as noise, and that viewpoints do not see the template says nothing of it.
  bool cut_off(const Mesh& deformed, const MovingSurface& surface, const Similarity& pose,
               const RunContext& context) const;

  /// Appends a pair for each sample of the deformed template that was seen through and the scan's point nearest to it.
  /// \param surface of the deformed mesh \param points  the scan's, in the template's frame
  /// \param pose template -> scan \param robust  Geman-McClure's scale, template units
  /// \return their robust_error(), weighted
  double add(const Mesh& deformed, const MovingSurface& surface, const Points& points, const Similarity& pose,
             double robust, std::vector<Correspondence>& pairs, const RunContext& context) const;

 private:
  SurfaceSamples samples_on(const Mesh& deformed, const MovingSurface& surface) const;
  SeenSurface::Look look(const SurfaceSamples& samples, const MovingSurface& surface, const Similarity& pose,
                         const RunContext& context) const;

  double size_;     // the template's diagonal
  double spacing_;  // the scan's
  SeenSurface seen_;
  std::vector<int> faces_;  // of the samples
  std::vector<Eigen::Vector3d> barycentric_;
};

}  // namespace orbifit
