#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

struct AnnotatedMesh {
  Mesh mesh;
  SymmetryAnnotation annotation;
};

/// The same surface with each face in four, by the middles of its edges: face f becomes 4 f ... 4 f + 3, the vertices
/// keep their numbers, and regions and patterns their places.
AnnotatedMesh divided(const Mesh& mesh, const SymmetryAnnotation& annotation);

}  // namespace orbifit
