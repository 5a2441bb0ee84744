#pragma once

#include <memory>
#include <string>
#include <vector>

#include "orbifit/model/mesh.h"

#include "arrays.h"

namespace orbifit::python {

using MeshPointer = std::shared_ptr<const Mesh>;
using ScanPointer = std::shared_ptr<const PointCloud>;

/// A mesh of arrays. \throw InputError without vertices or faces, for one that is not finite or out of range
MeshPointer mesh_from_arrays(const py::handle& vertices, const py::handle& faces);

/// A mesh of what stands for one: Mesh, (vertices, faces), trimesh, Open3D, meshio, a file. A Mesh is not copied.
/// \throw TypeError for anything else
MeshPointer mesh_from(const py::handle& mesh);

/// mesh_from() of one argument, or of two where faces are given.
MeshPointer mesh_from(const py::handle& mesh_or_vertices, const py::handle& faces);

/// A scan of what stands for one: PointCloud, points, Open3D, a file; a list of those is one scan of them all.
ScanPointer scan_from(const py::handle& scan);

/// The same of a list or tuple of those, each by itself; there is at least one.
std::vector<ScanPointer> scans_from(const py::handle& scans);

/// All points of scans in one frame.
ScanPointer one_scan(const std::vector<ScanPointer>& scans);

std::vector<const PointCloud*> pointers_to(const std::vector<ScanPointer>& scans);

void define_meshes(py::module_& module);
void define_scans(py::module_& module);

}  // namespace orbifit::python
