#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "base/random.h"
#include "detection_score/face_set.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"

namespace orbifit::scoring {

/// cos 25 degrees: normals further apart do not agree.
inline constexpr double kNormalCosine = 0.90630778703665;

/// From this share on something fits.
inline constexpr double kFits = 0.95;

/// Samples of a surface, and which of them are next to a crease, where the normal says nothing.
struct ScoreSamples {
  SurfaceSamples surface;
  std::vector<char> at_crease;  ///< #S
};

/// Some faces of a mesh, to be asked whether points are on them.
class ScoredSurface {
 public:
  /// \param faces ascending; those without area are left out
  ScoredSurface(const MeasuredMesh& measured, const std::vector<int>& faces, double tolerance);

  bool empty() const { return faces_.empty(); }
  double tolerance() const { return tolerance_; }

  /// Area-uniform; a sample is at a crease where a face whose normal is more than 25 degrees off is about as near as
  /// the sample's own face is long, at least the tolerance, at most three. \pre !empty()
  ScoreSamples sample(int count, Random& random, const RunContext& context) const;

  /// Whether a face is within the tolerance of the point and agrees with the normal, or any face where `free`.
  bool holds(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, bool free) const;

  /// Share of the samples that the motion puts on this surface.
  double fit(const ScoreSamples& samples, const Motion& motion, const RunContext& context) const;

  /// Share of the samples that every motion puts on this surface.
  double fit_under_all(const ScoreSamples& samples, const std::vector<Motion>& motions,
                       const RunContext& context) const;

 private:
  const MeasuredMesh* measured_;
  std::vector<int> faces_;
  double tolerance_;
  std::optional<SurfaceIndex> index_;
};

/// Share of face set a that the motion puts on face set b, within a's tolerance; 0 where one has no area.
double instance_fit(const MeasuredMesh& measured, const Motion& motion, const std::vector<int>& a,
                    const std::vector<int>& b, Random& random, const RunContext& context);

}  // namespace orbifit::scoring
