#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// All points of several scans in one frame, as one scan. Normals and viewpoints stay known where they are of all.
/// \pre there is at least one, and none is null
PointCloud scan_union(const std::vector<const PointCloud*>& scans);

/// The same of scans with a frame each, in that of the first, as a fit has found it (FitResult::others, other_used).
/// \param into  of all but the first: their frames into that of the first  \param used  whether they take part
PointCloud scan_union(const std::vector<const PointCloud*>& scans, const std::vector<Motion>& into,
                      const std::vector<char>& used);

}  // namespace orbifit
