#pragma once

#include <filesystem>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Reads PLY, PCD (ascii, binary, binary_compressed), XYZ and PTS, with normals where the file has them; a mesh file's
/// vertices also serve. Points that are not finite are left out and counted in PointCloud::dropped. A PCD's VIEWPOINT
/// other than the origin, or PLY vertex properties vx, vy, vz, give viewpoints.
/// \throw InputError with file, line and reason; also when no point remains
PointCloud read_scan(const std::filesystem::path& file);

/// Writes PLY (binary little endian, double; viewpoints as vx, vy, vz when there is one per point), PCD (binary,
/// float), XYZ and PTS (17 digits; XYZ with normals when known). Whole or not at all.
void write_scan(const std::filesystem::path& file, const PointCloud& scan);

}  // namespace orbifit
