#include <optional>

#include <pybind11/stl.h>

#include "orbifit/apps/scan_union.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/scan_io.h"

#include "meshes.h"

namespace orbifit::python {

namespace {

Points optional_points(const std::optional<ArrayLike>& values, const std::string& name) {
  return values ? points_from(*values, name) : Points(0, 3);
}

ScanPointer scan_from_arrays(const py::handle& points, const std::optional<ArrayLike>& normals,
                             const std::optional<ArrayLike>& viewpoints) {
  auto scan = std::make_shared<PointCloud>();
  scan->points = points_from(points, "points");
  const Eigen::Index count = scan->points.rows();
  if (count == 0) throw InputError("", "points", "is empty");
  scan->normals = optional_points(normals, "normals");
  if (scan->normals.rows() != 0 && scan->normals.rows() != count) {
    throw InputError(
        "", "normals",
        "has " + std::to_string(scan->normals.rows()) + " rows; there are " + std::to_string(count) + " points");
  }
  for (Eigen::Index i = 0; i < scan->normals.rows(); ++i) {
    const double length = scan->normals.row(i).stableNorm();
    if (!(length > 0)) throw InputError("", "normals[" + std::to_string(i) + "]", "is zero");
    scan->normals.row(i) /= length;
  }
  const py::object seen = viewpoints ? py::object(py::array::ensure(*viewpoints)) : py::object();
  if (seen && py::reinterpret_borrow<py::array>(seen).ndim() == 1) {
    scan->viewpoints = vector_from(seen, "viewpoints").transpose();
  } else {
    scan->viewpoints = optional_points(viewpoints, "viewpoints");
  }
  const Eigen::Index seen_from = scan->viewpoints.rows();
  if (seen_from != 0 && seen_from != 1 && seen_from != count) {
    throw InputError("", "viewpoints",
                     "has " + std::to_string(seen_from) + " rows; it must have 1 or " + std::to_string(count));
  }
  return scan;
}

py::object as_array(const Points& points) {
  if (points.rows() == 0) return py::none();
  return DoubleArray({points.rows(), Eigen::Index{3}}, points.data());
}

std::optional<DoubleArray> optional_view(const Points& points, const py::object& owner) {
  if (points.rows() == 0) return std::nullopt;
  return view_of(points, owner);
}

std::optional<ArrayLike> given(const py::handle& value) {
  if (value.is_none()) return std::nullopt;
  return ArrayLike(py::reinterpret_borrow<py::object>(value));
}

void define_point_cloud(py::module_& module) {
  py::class_<PointCloud, std::shared_ptr<PointCloud>>(
      module, "PointCloud", "A scan: points, and normals and viewpoints where known. Its arrays are read-only.")
      .def(py::init([](const ArrayLike& points, const std::optional<ArrayLike>& normals,
                       const std::optional<ArrayLike>& viewpoints) {
             return std::make_shared<PointCloud>(*scan_from_arrays(points, normals, viewpoints));
           }),
           py::arg("points"), py::arg("normals") = py::none(), py::arg("viewpoints") = py::none(),
           "Copies the arrays once.\n\n"
           "Args:\n"
           "    points: (n, 3) coordinates, finite.\n"
           "    normals: (n, 3), of any length but 0.\n"
           "    viewpoints: where each point was seen from, (n, 3), or all of them, (3,).\n\n"
           "Raises:\n"
           "    InputError: an array of another shape, a number that is not finite.")
      .def_static(
          "of", [](const ScanLike& scan) { return std::const_pointer_cast<PointCloud>(scan_from(scan)); },
          py::arg("scan"),
          "The scan of whatever stands for one: a :class:`PointCloud` itself, (n, 3) points, a point cloud of Open3D "
          "or trimesh, a file; a list of those, which have one frame, is one scan of all their points.")
      .def_property_readonly(
          "points", [](const py::object& self) { return view_of(self.cast<const PointCloud&>().points, self); },
          "(n, 3) float64, read-only.")
      .def_property_readonly(
          "normals", [](const py::object& self) { return optional_view(self.cast<const PointCloud&>().normals, self); },
          "(n, 3) float64, unit, read-only; None when unknown.")
      .def_property_readonly(
          "viewpoints",
          [](const py::object& self) { return optional_view(self.cast<const PointCloud&>().viewpoints, self); },
          "(n, 3) or (1, 3) float64, read-only; None when unknown.")
      .def(
          "save", [](const PointCloud& scan, const PathLike& file) { write_scan(path_from(file), scan); },
          py::arg("file"), "Writes PLY, PCD, XYZ or PTS by the file's ending: see :func:`write_scan`.")
      .def("__len__", [](const PointCloud& scan) { return scan.points.rows(); })
      .def("__repr__",
           [](const PointCloud& scan) {
             return "<orbifit.PointCloud: " + std::to_string(scan.points.rows()) + " points" +
                    (scan.normals.rows() > 0 ? ", normals" : "") + (scan.viewpoints.rows() > 0 ? ", viewpoints" : "") +
                    ">";
           })
      .def(py::pickle(
          [](const PointCloud& scan) {
            return py::make_tuple(as_array(scan.points), as_array(scan.normals), as_array(scan.viewpoints),
                                  scan.dropped);
          },
          [](const py::tuple& state) {
            auto scan = std::make_shared<PointCloud>(*scan_from_arrays(state[0], given(state[1]), given(state[2])));
            scan->dropped = state[3].cast<int>();
            return scan;
          }));
}

bool is_list_of_scans(const py::handle& scan) {
  if (!py::isinstance<py::list>(scan) && !py::isinstance<py::tuple>(scan)) return false;
  if (py::len(scan) == 0) return false;
  const py::array whole = py::array::ensure(scan);
  if (!whole) PyErr_Clear();
  return !whole || whole.dtype().kind() == 'O' || whole.ndim() != 2;
}

}  // namespace

std::vector<ScanPointer> scans_from(const py::handle& scans) {
  if (!is_list_of_scans(scans)) return {scan_from(scans)};
  // A list may hold itself.
  if (Py_EnterRecursiveCall(" in a list of scans") != 0) throw py::error_already_set();
  const std::unique_ptr<void, void (*)(void*)> leave(scans.ptr(), [](void*) { Py_LeaveRecursiveCall(); });
  std::vector<ScanPointer> result;
  for (const py::handle item : py::reinterpret_borrow<py::object>(scans)) result.push_back(scan_from(item));
  return result;
}

ScanPointer one_scan(const std::vector<ScanPointer>& scans) {
  if (scans.size() == 1) return scans.front();
  return std::make_shared<PointCloud>(scan_union(pointers_to(scans)));
}

std::vector<const PointCloud*> pointers_to(const std::vector<ScanPointer>& scans) {
  std::vector<const PointCloud*> pointers;
  for (const ScanPointer& scan : scans) pointers.push_back(scan.get());
  return pointers;
}

ScanPointer scan_from(const py::handle& scan) {
  if (py::isinstance<PointCloud>(scan)) return scan.cast<std::shared_ptr<PointCloud>>();
  if (py::isinstance<py::str>(scan) || py::isinstance<py::bytes>(scan) || py::hasattr(scan, "__fspath__")) {
    return std::make_shared<PointCloud>(read_scan(path_from(scan)));
  }
  if (py::hasattr(scan, "has_normals") && py::hasattr(scan, "points")) {  // Open3D
    const bool has_normals = scan.attr("has_normals")().cast<bool>();
    return scan_from_arrays(scan.attr("points"), has_normals ? given(scan.attr("normals")) : std::nullopt, {});
  }
  if (py::hasattr(scan, "vertices")) return scan_from_arrays(scan.attr("vertices"), {}, {});  // trimesh
  if (is_list_of_scans(scan)) return one_scan(scans_from(scan));
  return scan_from_arrays(scan, {}, {});
}

void define_scans(py::module_& module) {
  define_point_cloud(module);
  module.def(
      "read_scan",
      [](const PathLike& file) {
        const std::filesystem::path path = path_from(file);
        const py::gil_scoped_release release;
        return std::make_shared<PointCloud>(read_scan(path));
      },
      py::arg("file"),
      "Reads PLY, PCD, XYZ or PTS by the file's ending; points that are not finite are left out.\n\n"
      "Raises:\n"
      "    InputError: with file, line and reason.");
  module.def(
      "write_scan",
      [](const PathLike& file, const ScanLike& scan) {
        const ScanPointer written = scan_from(scan);
        const std::filesystem::path path = path_from(file);
        const py::gil_scoped_release release;
        write_scan(path, *written);
      },
      py::arg("file"), py::arg("scan"), "Writes PLY, PCD, XYZ or PTS by the file's ending, whole or not at all.");
}

}  // namespace orbifit::python
