#pragma once

#include <vector>

#include "orbifit/fitting/landmarks.h"
#include "orbifit/fitting/scan_preparation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// The similarity that takes the landmarks' vertices nearest to their targets (Umeyama 1991): with scale from three
/// that are not on a line, else the translation of their centroid.
Similarity align_landmarks(const Mesh& mesh, const std::vector<Landmark>& landmarks);

/// Rigid point-to-plane ICP, scan -> template, trimmed and robust, from a rough pose.
/// \param start template -> scan; its scale is kept
/// \return the refined pose, template -> scan; `start` itself when too few points correspond
Similarity align_rigidly(const Mesh& mesh, const PreparedScan& scan, const Similarity& start,
                         const RunContext& context);

/// A small rotation vector about `pivot` and a translation as a motion.
Motion small_motion(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation, const Eigen::Vector3d& pivot);

/// The scan's points and normals in the template's frame.
Points to_template(const Similarity& pose, const Points& points);
Points normals_to_template(const Similarity& pose, const Points& normals);

}  // namespace orbifit
