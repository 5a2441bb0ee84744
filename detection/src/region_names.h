#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/annotation.h"

#include "part_names.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Directions in which a mesh has its sides, by columns: right, backwards, up.
using SideAxes = Eigen::Matrix3d;

/// Those of a mesh seen with `up` upwards, towards the axis that follows (z up: from -y; y up: from +z).
SideAxes side_axes(const Eigen::Vector3d& up);

/// Names regions and patterns by what and where they are: "whole", "upper ring", "bar 2 of 4, lower left",
/// "row of 5 plates"; by the file's names where they are of parts that have one: "leg 2 of 4, lower left", "plate of
/// door", "row of 5 window".
/// \param axes  of its sides, in the prepared mesh's frame
/// \param families  of regions that are images of one another, by their places in the annotation
void name_by_shape_and_place(const PreparedMesh& prepared, const std::vector<std::vector<std::size_t>>& families,
                             const SideAxes& axes, const PartNames& names, SymmetryAnnotation& annotation,
                             Explanation* explanation);

}  // namespace orbifit
