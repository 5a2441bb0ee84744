#pragma once

#include <filesystem>
#include <string>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// A GLB for Blender: the mesh, whose vertices have `_REGION_n`, 1 within the region of id n and 0 outside, and an
/// empty node for each region's mirror planes and axes, whose local z is the plane's normal or the axis' direction.
std::string glb_with_regions(const std::filesystem::path& file, const Mesh& mesh, const SymmetryAnnotation& annotation);

struct InstancedGlb {
  std::string bytes;
  int meshes = 0, nodes = 0;
  double largest_distance = 0;  ///< of an instance's vertex from the part it stands for, mesh units
};

/// A GLB in which the components that regions and patterns relate are one mesh at several nodes.
InstancedGlb glb_of_instances(const std::filesystem::path& file, const Mesh& mesh, const SymmetryAnnotation& annotation,
                              const RunContext& context);

/// A PLY for MeshLab: each face in its region's colour and with the region's id as `quality`, -1 outside of all; of
/// several regions the smallest.
std::string ply_with_quality(const Mesh& mesh, const SymmetryAnnotation& annotation);

}  // namespace orbifit
