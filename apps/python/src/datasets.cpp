#include <pybind11/stl.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/errors.h"

#include "annotations.h"
#include "run.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

py::dict generators_of() {
  py::dict result;
  for (const Generator& generator : generators()) {
    py::dict parameters;
    for (const GeneratorParameter& parameter : generator.parameters) {
      py::dict entry;
      entry["default"] = parameter.value;
      entry["minimum"] = parameter.minimum;
      entry["maximum"] = parameter.maximum;
      entry["integer"] = parameter.integer;
      entry["meaning"] = parameter.meaning;
      parameters[py::str(parameter.name)] = entry;
    }
    py::dict entry;
    entry["meaning"] = generator.meaning;
    entry["parameters"] = parameters;
    result[py::str(generator.name)] = entry;
  }
  return result;
}

void define_scan(py::module_& module) {
  const ScanOptions defaults;
  module.def(
      "scan",
      [](const MeshLike& mesh_like, int views, double azimuth, double elevation, double distance, int width, int height,
         double field_of_view, double noise, double outliers, double clutter, double grazing_limit, const ArrayLike& up,
         std::uint64_t seed, std::optional<int> threads, std::optional<double> timeout, const Progress& progress) {
        ScanOptions options;
        options.views = views;
        options.azimuth = azimuth;
        options.elevation = elevation;
        options.distance = distance;
        options.width = width;
        options.height = height;
        options.field_of_view = field_of_view;
        options.noise = noise;
        options.outliers = outliers;
        options.clutter = clutter;
        options.grazing_limit = grazing_limit;
        const Eigen::Vector3d direction = vector_from(up, "up");
        if (!(direction.stableNorm() > 0)) throw UsageError("up must not be zero");
        options.up = direction.stableNormalized();
        options.validate();
        const MeshPointer mesh = mesh_from(mesh_like);
        return std::make_shared<PointCloud>(run({seed, threads, timeout, progress}, [&](RunContext& context) {
          return virtual_scan(*mesh, options, context);
        }));
      },
      py::arg("mesh"), py::kw_only(), py::arg("views") = defaults.views, py::arg("azimuth") = defaults.azimuth,
      py::arg("elevation") = defaults.elevation, py::arg("distance") = defaults.distance,
      py::arg("width") = defaults.width, py::arg("height") = defaults.height,
      py::arg("field_of_view") = defaults.field_of_view, py::arg("noise") = defaults.noise,
      py::arg("outliers") = defaults.outliers, py::arg("clutter") = defaults.clutter,
      py::arg("grazing_limit") = defaults.grazing_limit, py::arg("up") = py::make_tuple(0.0, 0.0, 1.0), seed_argument(),
      threads_argument(), timeout_argument(), progress_argument(),
      "Looks at a mesh with a virtual depth camera.\n\n"
      "Args:\n"
      "    mesh: see :meth:`Mesh.of`.\n"
      "    views: spread evenly around the mesh, starting at `azimuth`.\n"
      "    azimuth, elevation: in degrees, about `up` and above the horizon.\n"
      "    distance: from the camera to the centre, in diagonals.\n"
      "    width, height: in pixels.\n"
      "    field_of_view: vertical, in degrees.\n"
      "    noise: standard deviation along the ray, fraction of the diagonal.\n"
      "    outliers: fraction of points thrown anywhere into the box.\n"
      "    clutter: fraction of points on a floor and blocks around the mesh.\n"
      "    grazing_limit: degrees between ray and normal above which nothing is seen.\n" ORBIFIT_RUN_DOC
      "\nReturns:\n"
      "    Points in the mesh's frame, with viewpoints and without normals.\n\n"
      "Raises:\n"
      "    UsageError: an option out of range.\n"
      "    NoResultError: nothing of the mesh is seen.");
}

}  // namespace

void define_datasets(py::module_& module) {
  module.def(
      "generate",
      [](const std::string& name, const py::kwargs& parameters) {
        std::map<std::string, double> values;
        for (const auto& [key, value] : parameters) values[key.cast<std::string>()] = value.cast<double>();
        GeneratedModel model;
        {
          const py::gil_scoped_release release;
          model = generate(name, values);
        }
        auto mesh = std::make_shared<Mesh>(std::move(model.mesh));
        return std::pair(mesh, std::make_shared<Annotation>(Annotation{std::move(model.truth), mesh}));
      },
      py::arg("name"),
      "Builds a model whose symmetries are known.\n\n"
      "Args:\n"
      "    name: one of :func:`generators`.\n"
      "    **parameters: numbers; the others take their defaults.\n\n"
      "Returns:\n"
      "    The mesh, and its true annotation.\n\n"
      "Raises:\n"
      "    UsageError: an unknown model or parameter, or a value out of range.");
  module.def("generators", &generators_of,
             "What :func:`generate` knows: by name the `meaning` and the `parameters`, each with `default`, `minimum`, "
             "`maximum`, `integer` and `meaning`.");
  define_scan(module);
}

}  // namespace orbifit::python
