#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// The finite subgroup of a region's continuous group that its tessellation has: the largest order n <= 128 for which
/// rotations by 1/n turn map the region's vertices onto vertices to 1e-6 of the diagonal, 12 where there is none; T and
/// Th stand for K and Kh.
PointGroup finite_subgroup(const Mesh& mesh, const Region& region);

/// Its elements, in a frame in which mirrors and half turns map vertices onto vertices too where they can.
std::vector<Motion> subgroup_elements(const Mesh& mesh, const Region& region, const PointGroup& finite);

}  // namespace orbifit
