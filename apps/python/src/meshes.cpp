#include "meshes.h"

#include <array>
#include <optional>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

namespace orbifit::python {

namespace {

bool is_path(const py::handle& object) {
  return py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object) || py::hasattr(object, "__fspath__");
}

// Cells of meshio: triangles, and quadrilaterals cut from their first corner, in the order of the blocks.
MeshPointer mesh_from_cells(const py::object& source) {
  py::list faces, polygons;
  int polygon = 0;
  bool cut = false;
  for (const py::handle block : source.attr("cells")) {
    const auto type = block.attr("type").cast<std::string>();
    const py::object data = block.attr("data");
    if (type == "vertex" || type == "line") continue;
    if (type != "triangle" && type != "quad") {
      throw InputError("", "cells", "holds cells of type '" + type + "'; a surface has triangles and quads");
    }
    for (const py::handle cell : data) {
      const auto corners = cell.attr("tolist")().cast<py::list>();
      for (std::size_t k = 2; k < corners.size(); ++k) {
        faces.append(py::make_tuple(corners[0], corners[k - 1], corners[k]));
        polygons.append(polygon);
      }
      cut = cut || type == "quad";
      ++polygon;
    }
  }
  const MeshPointer triangles = mesh_from_arrays(source.attr("points"), faces);
  if (!cut) return triangles;
  auto mesh = std::make_shared<Mesh>(*triangles);
  mesh->polygon_of_face = polygons.cast<std::vector<int>>();
  return mesh;
}

py::tuple state_of(const Mesh& mesh) {
  return py::make_tuple(DoubleArray({mesh.vertices.rows(), Eigen::Index{3}}, mesh.vertices.data()),
                        IntArray({mesh.faces.rows(), Eigen::Index{3}}, mesh.faces.data()), mesh.polygon_of_face);
}

std::shared_ptr<Mesh> mesh_from_state(const py::tuple& state) {
  auto mesh = std::make_shared<Mesh>(*mesh_from_arrays(state[0], state[1]));
  mesh->polygon_of_face = state[2].cast<std::vector<int>>();
  return mesh;
}

bool equal(const Mesh& a, const Mesh& b) {
  return a.vertices.rows() == b.vertices.rows() && a.faces.rows() == b.faces.rows() && a.vertices == b.vertices &&
         a.faces == b.faces;
}

}  // namespace

MeshPointer mesh_from_arrays(const py::handle& vertices, const py::handle& faces) {
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices = points_from(vertices, "vertices");
  if (mesh->vertices.rows() == 0) throw InputError("", "vertices", "is empty");
  mesh->faces = triangles_from(faces, "faces", mesh->vertices.rows());
  if (mesh->faces.rows() == 0) throw InputError("", "faces", "is empty");
  return mesh;
}

MeshPointer mesh_from(const py::handle& mesh) {
  if (py::isinstance<Mesh>(mesh)) return mesh.cast<std::shared_ptr<Mesh>>();
  if (is_path(mesh)) return std::make_shared<Mesh>(read_mesh(path_from(mesh)));
  if ((py::isinstance<py::tuple>(mesh) || py::isinstance<py::list>(mesh)) && py::len(mesh) == 2) {
    const auto pair = py::reinterpret_borrow<py::sequence>(mesh);
    return mesh_from_arrays(pair[0], pair[1]);
  }
  if (py::hasattr(mesh, "vertices")) {
    for (const char* faces : {"faces", "triangles"}) {
      if (py::hasattr(mesh, faces)) return mesh_from_arrays(mesh.attr("vertices"), mesh.attr(faces));
    }
  }
  if (py::hasattr(mesh, "points") && py::hasattr(mesh, "cells")) {
    return mesh_from_cells(py::reinterpret_borrow<py::object>(mesh));
  }
  throw py::type_error(
      "a mesh must be an orbifit.Mesh, a pair (vertices, faces), a mesh of trimesh, Open3D or meshio, "
      "or a file's name, not " +
      py::str(py::type::of(mesh)).cast<std::string>());
}

MeshPointer mesh_from(const py::handle& mesh_or_vertices, const py::handle& faces) {
  return faces.is_none() ? mesh_from(mesh_or_vertices) : mesh_from_arrays(mesh_or_vertices, faces);
}

namespace {

std::shared_ptr<Mesh> with_vertices(const Mesh& mesh, const ArrayLike& vertices) {
  Mesh moved = mesh;
  moved.vertices = points_from(vertices, "vertices");
  if (moved.vertices.rows() != mesh.vertices.rows()) {
    throw InputError("", "vertices",
                     "has " + std::to_string(moved.vertices.rows()) + " rows; the mesh has " +
                         std::to_string(mesh.vertices.rows()) + " vertices");
  }
  return std::make_shared<Mesh>(std::move(moved));
}

void define_mesh_files(py::module_& module) {
  module.def(
      "read_mesh",
      [](const PathLike& file) {
        const std::filesystem::path path = path_from(file);
        const py::gil_scoped_release release;
        return std::make_shared<Mesh>(read_mesh(path));
      },
      py::arg("file"),
      "Reads OBJ, OFF, PLY, STL, glTF or GLB by the file's ending; order and double precision are kept.\n\n"
      "Raises:\n"
      "    InputError: with file, line or element and reason.");
  module.def(
      "write_mesh",
      [](const PathLike& file, const MeshLike& mesh, const std::optional<ArrayLike>& colours) {
        const MeshPointer written = mesh_from(mesh);
        std::optional<Points> colour;
        if (colours) colour = points_from(*colours, "colours");
        const std::filesystem::path path = path_from(file);
        const py::gil_scoped_release release;
        write_mesh(path, *written, colour);
      },
      py::arg("file"), py::arg("mesh"), py::arg("colours") = py::none(),
      "Writes OBJ, OFF, PLY, STL or GLB by the file's ending, whole or not at all.\n\n"
      "Args:\n"
      "    colours: (m, 3) for faces or (n, 3) for vertices, in [0, 1]; written by PLY only.\n\n"
      "Raises:\n"
      "    InputError: the file cannot be written.\n"
      "    UsageError: an unknown ending.");
}

}  // namespace

void define_meshes(py::module_& module) {
  py::class_<Mesh, std::shared_ptr<Mesh>>(module, "Mesh",
                                          "A triangle mesh: vertices and faces in their given order.\n\n"
                                          "Its arrays are kept by the library and are not copied again by any call; "
                                          "what it shows of them is read-only.")
      .def(py::init([](const ArrayLike& vertices, const ArrayLike& faces) {
             return std::make_shared<Mesh>(*mesh_from_arrays(vertices, faces));
           }),
           py::arg("vertices"), py::arg("faces"),
           "Copies the arrays once.\n\n"
           "Args:\n"
           "    vertices: (n, 3) coordinates, finite, in any unit.\n"
           "    faces: (m, 3) vertex numbers from 0.\n\n"
           "Raises:\n"
           "    InputError: an array of another shape, a coordinate that is not finite, a number out of range.")
      .def_static(
          "of", [](const MeshLike& mesh) { return std::const_pointer_cast<Mesh>(mesh_from(mesh)); }, py::arg("mesh"),
          "The mesh of whatever stands for one: a :class:`Mesh` itself, a pair (vertices, faces), a mesh of trimesh, "
          "Open3D or meshio, or a file.")
      .def_property_readonly(
          "vertices", [](const py::object& self) { return view_of(self.cast<const Mesh&>().vertices, self); },
          "(n, 3) float64, read-only.")
      .def_property_readonly(
          "faces", [](const py::object& self) { return view_of(self.cast<const Mesh&>().faces, self); },
          "(m, 3) int32, read-only.")
      .def_property_readonly(
          "diagonal", [](const Mesh& mesh) { return diagonal(mesh.vertices); },
          "Length of the bounding box' diagonal, in the mesh's unit.")
      .def_property_readonly(
          "area", [](const Mesh& mesh) { return face_areas(mesh).sum(); }, "Of all faces, in the mesh's unit squared.")
      .def("with_vertices", &with_vertices, py::arg("vertices"), "The same faces with the vertices elsewhere, (n, 3).")
      .def(
          "save", [](const Mesh& mesh, const PathLike& file) { write_mesh(path_from(file), mesh); }, py::arg("file"),
          "Writes OBJ, OFF, PLY, STL or GLB by the file's ending: see :func:`write_mesh`.")
      .def("__len__", [](const Mesh& mesh) { return mesh.faces.rows(); })
      .def("__eq__", &equal, py::is_operator())
      .def("__repr__",
           [](const Mesh& mesh) {
             return "<orbifit.Mesh: " + std::to_string(mesh.vertices.rows()) + " vertices, " +
                    std::to_string(mesh.faces.rows()) + " faces>";
           })
      .def(py::pickle(&state_of, &mesh_from_state));
  define_mesh_files(module);
}

}  // namespace orbifit::python
