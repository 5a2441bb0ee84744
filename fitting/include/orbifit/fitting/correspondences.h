#pragma once

#include <vector>

#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/model/surface_index.h"

namespace orbifit {

struct CorrespondenceOptions {
  double max_distance = 0;         ///< template units, > 0
  double min_normal_cosine = 0.5;  ///< of compatible normals
  bool signed_normals = false;     ///< normals must agree in sign too
  double trim = 0.9;               ///< share of the nearest that is kept, in (0, 1]
  double never_trim = 0;           ///< distances below this are always kept, template units
  double direction_noise = 0;      ///< offsets across an edge below this do not turn the normal, template units
  double robust_scale = 0;         ///< Geman-McClure's, template units, > 0
};

/// A scan point and the surface point nearest to it.
struct Correspondence {
  int scan_point = -1;
  int face = -1;
  Eigen::Vector3d barycentric;  ///< of the surface point on the face
  Eigen::Vector3d normal;       ///< unit: of the face, or from its edge to the scan point across that edge
  double distance = 0;          ///< between the two, template units
  double weight = 0;            ///< 1 / (1 + (distance / robust_scale)^2)^2 (Geman and McClure)
};

/// A surface to match against.
struct MatchSurface {
  SurfaceIndex index;
  Points normals;  ///< of its faces, #F by 3
  explicit MatchSurface(const Mesh& mesh) : index(mesh), normals(face_normals(mesh)) {}
};

/// Scan -> surface, never the other way: what the scan does not see must not pull. Both in the template's frame.
/// O(P log F).
std::vector<Correspondence> find_correspondences(const MatchSurface& surface, const Points& scan_points,
                                                 const Points& scan_normals, const CorrespondenceOptions& options,
                                                 const RunContext& context);

/// Root of the weighted mean square of the distances along the normals' planes; 0 for none.
double weighted_rms(const std::vector<Correspondence>& correspondences);

}  // namespace orbifit
