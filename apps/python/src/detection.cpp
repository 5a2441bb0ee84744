#include <cmath>

#include <pybind11/stl.h>

#include "orbifit/detection/detect.h"
#include "orbifit/detection/detect_points.h"
#include "orbifit/model/errors.h"

#include "annotations.h"
#include "run.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

DetectOptions options_from(double tolerance, std::optional<double> time_budget, int samples, int simplify_above_faces) {
  DetectOptions options;
  options.tolerance = tolerance;
  options.samples = samples;
  options.simplify_above_faces = simplify_above_faces;
  if (time_budget) {
    if (!(*time_budget > 0 && std::isfinite(*time_budget))) {
      throw UsageError("time_budget is " + std::to_string(*time_budget) + "; it must be above 0 seconds");
    }
    options.time_budget = *time_budget;
  }
  options.validate();
  return options;
}

}  // namespace

void define_detection(py::module_& module) {
  module.def(
      "detect",
      [](const MeshLike& vertices, const std::optional<ArrayLike>& faces, double tolerance,
         std::optional<double> time_budget, int samples, int simplify_above_faces, bool all, std::uint64_t seed,
         std::optional<int> threads, std::optional<double> timeout, const Progress& progress) {
        DetectOptions options = options_from(tolerance, time_budget, samples, simplify_above_faces);
        options.all = all;
        const MeshPointer mesh = faces ? mesh_from_arrays(vertices, *faces) : mesh_from(vertices);
        return std::make_shared<Annotation>(
            Annotation{run({seed, threads, timeout, progress},
                           [&](RunContext& context) { return detect(*mesh, options, context); }),
                       mesh});
      },
      py::arg("vertices"), py::arg("faces") = py::none(), py::kw_only(), py::arg("tolerance") = 0.005,
      py::arg("time_budget") = py::none(), py::arg("samples") = DetectOptions{}.samples,
      py::arg("simplify_above_faces") = DetectOptions{}.simplify_above_faces, py::arg("all") = false, seed_argument(),
      threads_argument(), timeout_argument(), progress_argument(),
      "Finds the symmetric regions of a mesh and its repeated parts.\n\n"
      "Args:\n"
      "    vertices: (n, 3) coordinates; or all of a mesh, see :meth:`Mesh.of`.\n"
      "    faces: (m, 3) vertex numbers, where the first argument is coordinates.\n"
      "    tolerance: largest distance that still counts as symmetric, as a fraction of the mesh's diagonal.\n"
      "    time_budget: in seconds; search no longer, and keep what is verified by then.\n"
      "    samples: of the surface, on which a whole mesh is verified.\n"
      "    simplify_above_faces: meshes of more faces are searched on a coarser proxy; 0: none are.\n"
      "    all: list also what follows from the rest.\n" ORBIFIT_RUN_DOC
      "\nRaises:\n"
      "    InputError: an array or mesh that cannot be used.\n"
      "    UsageError: an option out of range.");
  module.def(
      "detect_points",
      [](const ScanLike& scan_like, double tolerance, std::optional<double> time_budget, int samples,
         std::uint64_t seed, std::optional<int> threads, std::optional<double> timeout, const Progress& progress) {
        const DetectOptions options =
            options_from(tolerance, time_budget, samples, DetectOptions{}.simplify_above_faces);
        const ScanPointer scan = scan_from(scan_like);
        return std::make_shared<Annotation>(
            Annotation{run({seed, threads, timeout, progress},
                           [&](RunContext& context) { return detect_points(*scan, options, context); })});
      },
      py::arg("scan"), py::kw_only(), py::arg("tolerance") = 0.005, py::arg("time_budget") = py::none(),
      py::arg("samples") = DetectOptions{}.samples, seed_argument(), threads_argument(), timeout_argument(),
      progress_argument(),
      "Finds the symmetries of a scan, of which perhaps one side only was seen.\n\n"
      "Points stand for faces: \"face\" i of a region is point i, and the annotation counts as many vertices and faces "
      "as there are points.\n\n"
      "Args:\n"
      "    scan: see :meth:`PointCloud.of`.\n"
      "    tolerance: as a fraction of the diagonal; raised where the scan is noisier or coarser.\n"
      "    time_budget: in seconds; search no longer, and keep what is verified by then.\n"
      "    samples: of the points, on which the whole is verified.\n" ORBIFIT_RUN_DOC
      "\nRaises:\n"
      "    InputError: fewer than 50 points, or points without extent.");
}

}  // namespace orbifit::python
