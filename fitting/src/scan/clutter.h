#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "geometry/surface_index.h"
#include "scan/scan_preparation.h"

namespace orbifit {

/// The scan's points near the posed template, those of it that are within `reach` of it.
/// \param reach of the template's diagonal \return the points with their normals and viewpoints
PointCloud points_near(const SurfaceIndex& surface, double template_diagonal, const PointCloud& scan,
                       const Similarity& pose, double reach, const RunContext& context);

/// The scan without planes on which the template stands or that stand beside it: a plane of many points most of which
/// the posed template does not explain (RANSAC, Fischler and Bolles 1981). What is left has the same spacing.
/// \param explained  of the template's diagonal: nearer points are the template's
PreparedScan without_planes(const SurfaceIndex& surface, double template_diagonal, const PreparedScan& scan,
                            const Similarity& pose, double explained, const RunContext& context);

}  // namespace orbifit
