#pragma once

#include "orbifit/detection/detect.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Finds the symmetries of a scan, of which perhaps one side only was seen: surfaces of revolution among its points
/// (Cinfv), and the groups of the whole and of its clusters where they were seen from all sides. Points stand for
/// faces: the annotation's `mesh_vertices` and `mesh_faces` are both the number of points, and "face" i of a region is
/// point i of `scan.points` (points that a reader dropped are not counted). Outliers are in no region. The tolerance is
/// raised to twice the scan's noise, and to half the distance between the points looked at; the annotation has the one
/// used. What cannot be kept exactly beside larger regions is left out. There are no patterns. The result is the same
/// for any number of threads.
/// \throw InputError for fewer than 50 points, for points that are not finite, and when they
/// have no extent
SymmetryAnnotation detect_points(const PointCloud& scan, const DetectOptions& options, RunContext& context);

}  // namespace orbifit
