#pragma once

#include <optional>
#include <vector>

#include "orbifit/fitting/landmarks.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "registration/correspondences.h"
#include "scan/scan_preparation.h"

namespace orbifit {

/// The similarity that takes the landmarks' vertices nearest to their targets (Umeyama 1991): with scale from three
/// that are not on a line, else the translation of their centroid. \param scale  where it is known
Similarity align_landmarks(const Mesh& mesh, const std::vector<Landmark>& landmarks,
                           const std::optional<double>& scale = {});

/// Rigid point-to-plane ICP, scan -> template, trimmed and robust, from a rough pose.
/// \param surface  the template's \param start template -> scan; its scale is kept
/// \return the refined pose, template -> scan; `start` itself when too few points correspond
Similarity align_rigidly(const MatchSurface& surface, const PreparedScan& scan, const Similarity& start,
                         const RunContext& context);

struct ScaledAlignmentOptions {
  int iterations = 30;         ///< >= 1
  double first_robust = 0.08;  ///< Geman-McClure's scale, fraction of the template's diagonal, at the start, > 0
  double last_robust = 0.015;  ///< and at the end, > 0
  bool keep_scale = false;     ///< the start's
};

/// Point-to-plane ICP with scale, scan -> template, robust, over some points of the scan. Costs O(P log F) an
/// iteration. \param surface  the template's \param points  numbers of the scan's points; the others do not take part
/// \return the refined pose, template -> scan; the last one where no point is near
Similarity align_with_scale(const MatchSurface& surface, const PreparedScan& scan, const std::vector<int>& points,
                            const Similarity& start, const ScaledAlignmentOptions& options, const RunContext& context);

/// The pose at another scale, about the middle of the template's box.
Similarity rescaled(const Similarity& pose, double scale, const Mesh& mesh);

/// A small rotation vector about `pivot` and a translation as a motion.
Motion small_motion(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation, const Eigen::Vector3d& pivot);

/// The template's points in the scan's frame. \param pose template -> scan
Points from_template(const Similarity& pose, const Points& points);

/// The scan's points and normals in the template's frame.
Points to_template(const Similarity& pose, const Points& points);
Points normals_to_template(const Similarity& pose, const Points& normals);

}  // namespace orbifit
