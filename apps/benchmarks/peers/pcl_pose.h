#pragma once

#include <optional>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit::benchmarks {

/// The pose of a template of known size in a scan, as PCL's users find it: normals, VoxelGrid, FPFH features (Rusu et
/// al. 2009), SampleConsensusPrerejective (Buch et al. 2013), then ICP.
/// \param scale  of the template in the scan
/// \param similarity  how alike the sides of a triangle of correspondences must be, in (0, 1): 0.9, as in PCL's
/// tutorial, for scans of the very object; 0.7 for shapes whose lengths differ by a third
/// \return template -> scan; nothing where PCL did not converge
std::optional<Similarity> pcl_pose(const Mesh& mesh, const PointCloud& scan, double scale, const RunContext& context,
                                   double similarity = 0.7);

}  // namespace orbifit::benchmarks
