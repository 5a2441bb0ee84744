#pragma once

#include <memory>
#include <vector>

#include "orbifit/model/annotation.h"

#include "meshes.h"

namespace orbifit::python {

/// An annotation and, where it is known, the mesh that it is of, for pictures. Never changed once made, so that arrays
/// may alias it.
struct Annotation {
  SymmetryAnnotation value;
  MeshPointer mesh = nullptr;
};
using AnnotationPointer = std::shared_ptr<Annotation>;

/// \throw UsageError where the annotation is of a mesh with other counts
void require_fit(const SymmetryAnnotation& annotation, const Mesh& mesh);

std::string count_text(std::size_t count, const std::string& noun);

void define_regions(py::module_& module);
void define_patterns(py::module_& module);
void define_annotations(py::module_& module);

/// What pickles hold, and what comes back of it.
py::tuple state_of(const Region& region);
Region region_from_state(const py::tuple& state);
py::tuple state_of(const Pattern& pattern);
Pattern pattern_from_state(const py::tuple& state);
py::bytes bytes_of(const std::vector<Motion>& motions);
std::vector<Motion> motions_from_bytes(const py::bytes& bytes);

}  // namespace orbifit::python
