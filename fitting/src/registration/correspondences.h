#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/surface_index.h"
#include "scan/scan_preparation.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// Of the diagonal: in the end correspondences farther apart are none, and landmarks farther from their targets hardly
/// count.
inline constexpr double kLastReach = 0.04;
/// Of the diagonal: Geman-McClure's scale in the end.
inline constexpr double kLastRobust = 0.007;

/// Of the diagonal: the direction noise that fits and alignments reckon with.
inline constexpr double kDirectionNoise = 0.003;

struct CorrespondenceOptions {
  double max_distance = 0;         ///< template units, > 0
  double min_normal_cosine = 0.5;  ///< of compatible normals
  bool signed_normals = false;     ///< normals must agree in sign too
  double trim = 0.9;               ///< share of the nearest that is kept, in (0, 1]
  double never_trim = 0;           ///< distances below this are always kept, template units
  double direction_noise = 0;      ///< offsets across an edge below this do not turn the normal, template units
  double robust_scale = 0;         ///< Geman-McClure's, template units, > 0
  int every = 1;                   ///< only each so manieth scan point is looked at, >= 1
};

/// A scan point and the surface point nearest to it.
struct Correspondence {
  int scan_point = -1;
  int face = -1;
  Eigen::Vector3d barycentric;  ///< of the surface point on the face
  Eigen::Vector3d normal;       ///< unit: of the face, or from its edge to the scan point across that edge
  double distance = 0;          ///< between the two, template units
  double weight = 0;            ///< robust_weight()
  int view = 0;  ///< of scans that move by themselves the number of the point's; 0: the first, or they do not
};

/// Geman and McClure's error, distance^2 / (1 + (distance / scale)^2): below scale^2 however far a point is.
double robust_error(double distance, double scale);

/// 1 / (1 + (distance / scale)^2)^2, by which a least-squares step lowers that error: what is far hardly counts.
double robust_weight(double distance, double scale);

/// A surface at rest to match against. The mesh is kept by reference.
class MatchSurface {
  std::shared_ptr<const SurfaceIndex> shared_;
  const Mesh* mesh_;

 public:
  /// \param known  of the mesh; null: made
  explicit MatchSurface(const Mesh& mesh, std::shared_ptr<const SurfaceIndex> known = nullptr)
      : shared_(known ? std::move(known) : std::make_shared<const SurfaceIndex>(mesh)), mesh_(&mesh), index(*shared_) {}

  const Mesh& mesh() const { return *mesh_; }
  Eigen::Vector3d normal(int face) const { return face_normal(*mesh_, face); }

  const SurfaceIndex& index;
};

/// Scan -> surface, never the other way: what the scan does not see must not pull. Both in the template's frame.
/// O(P log F).
/// \param likely  for each scan point the place in the index of a face that may well be the nearest, such as the one of
///   the iteration before, -1 for none: the answer does not depend on it, but comes sooner. Replaced by the places of
///   the faces found for the points looked at. May be null
std::vector<Correspondence> find_correspondences(const MatchSurface& surface, const Points& scan_points,
                                                 const Points& scan_normals, const CorrespondenceOptions& options,
                                                 const RunContext& context, std::vector<int>* likely = nullptr);
std::vector<Correspondence> find_correspondences(const MovingSurface& surface, const Points& scan_points,
                                                 const Points& scan_normals, const CorrespondenceOptions& options,
                                                 const RunContext& context, std::vector<int>* likely = nullptr);

/// Root of the weighted mean square of the distances along the normals' planes; 0 for none.
double weighted_rms(const std::vector<Correspondence>& correspondences);

/// The standard deviation that normally distributed distances of the same median have; 0 for none.
double typical_distance(const std::vector<Correspondence>& correspondences);

}  // namespace orbifit
