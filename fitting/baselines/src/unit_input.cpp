#include "unit_input.h"

#include "orbifit/model/errors.h"

#include "registration/alignment.h"

namespace orbifit {

UnitInput unit_input(const FitInput& input, const KurzOptions& options, const RunContext& context) {
  UnitInput result;
  const Points& vertices = input.mesh.vertices;
  const double length = (vertices.colwise().maxCoeff() - vertices.colwise().minCoeff()).maxCoeff();
  if (!(length > 0)) throw InputError("", "template", "has no extent");
  const Eigen::Vector3d centre = bounding_box_centre(vertices);
  result.unit = {1 / length, Eigen::Matrix3d::Identity(), -centre / length};
  result.mesh = input.mesh;
  result.mesh.vertices = from_template(result.unit, vertices);
  result.annotation = transformed(input.annotation, result.unit);
  Similarity pose = input.pose;
  if (!input.landmarks.empty()) pose = align_landmarks(input.mesh, input.landmarks);
  if (input.scan.points.rows() > 0) {
    ScanPreparationOptions preparation;
    preparation.most_points = options.scan_points;
    result.scan = prepare_scan(input.scan, preparation, context);
    if (options.align && input.landmarks.empty() && input.handles.empty()) {
      pose = align_rigidly(MatchSurface(input.mesh), result.scan, pose, context);
    }
    result.points = from_template(result.unit, to_template(pose, result.scan.points));
    result.normals = normals_to_template(pose, result.scan.normals);
  } else if (input.handles.empty() && input.landmarks.empty()) {
    throw InputError("", "scan", "has no points, and there are no handles");
  }
  result.pose = pose * inverse(result.unit);
  return result;
}

}  // namespace orbifit
