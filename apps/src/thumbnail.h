#pragma once

#include "orbifit/apps/render.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// A small picture of a mesh, each face in the colour of the smallest region that has it.
Image thumbnail(const Mesh& mesh, const SymmetryAnnotation& annotation, const Eigen::Vector3d& up,
                const RunContext& run);

}  // namespace orbifit
