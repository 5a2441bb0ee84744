#include <algorithm>

#include <pybind11/stl.h>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/symmetrize.h"

#include "annotations.h"
#include "run.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

struct Check {
  SymmetryReport report;
  bool deformed = false;
};

struct Symmetrized {
  MeshPointer mesh;
  AnnotationPointer annotation;
  SymmetrizeReport report;
};

CarriedMotions motions_from(const std::string& text) {
  if (text == "fixed") return CarriedMotions::fixed;
  if (text == "posed") return CarriedMotions::posed;
  if (text == "floating") return CarriedMotions::floating;
  if (text == "moving") return CarriedMotions::moving;
  throw UsageError("mode is '" + text + "'; it must be 'fixed', 'posed', 'floating' or 'moving'");
}

double worst_of(const Check& check) {
  double worst = check.deformed ? check.report.worst_excess : check.report.worst_floor;
  for (const PatternResidual& pattern : check.report.patterns) {
    worst = std::max(worst, check.deformed ? pattern.deformed.max - pattern.floor.max : pattern.floor.max);
  }
  return worst;
}

py::dict entry_of(const RegionResidual& region, bool deformed) {
  py::dict entry;
  entry["id"] = region.id;
  entry["name"] = region.name;
  entry["group"] = region.group;
  entry["vertices"] = region.vertices;
  entry["pairs"] = region.pairs;
  entry["mapped_pairs"] = region.mapped;
  entry["rest_rms"] = region.floor.rms;
  entry["rest_max"] = region.floor.max;
  if (deformed) {
    entry["deformed_max"] = region.deformed.max;
    entry["excess_rms"] = region.excess.rms;
    entry["excess_max"] = region.excess.max;
  }
  entry["worst_vertex"] = region.worst_vertex;
  return entry;
}

std::shared_ptr<Check> check(const MeshLike& mesh_like, const Annotation& annotation,
                             const std::optional<MeshLike>& deformed_like, const std::string& mode, std::uint64_t seed,
                             std::optional<int> threads, std::optional<double> timeout, const Progress& progress) {
  const MeshPointer mesh = mesh_from(mesh_like);
  require_fit(annotation.value, *mesh);
  const CarriedMotions motions = motions_from(mode);
  MeshPointer deformed;
  if (deformed_like) {
    deformed = mesh_from(*deformed_like);
    if (deformed->vertices.rows() != mesh->vertices.rows() || deformed->faces.rows() != mesh->faces.rows() ||
        deformed->faces != mesh->faces) {
      throw InputError("", "deformed", "is no deformation of the mesh: its faces are others");
    }
  }
  return std::make_shared<Check>(Check{run({seed, threads, timeout, progress},
                                           [&](RunContext& context) {
                                             return symmetry_residual(*mesh, annotation.value, deformed.get(), motions,
                                                                      context);
                                           }),
                                       deformed != nullptr});
}

void define_check_report(py::module_& module) {
  py::class_<Check, std::shared_ptr<Check>>(module, "CheckReport",
                                            "How far regions and patterns are from symmetric. Distances are fractions "
                                            "of the diagonal.")
      .def_property_readonly("residual", &worst_of, "The largest of all: at rest, or what a deformation adds to that.")
      .def_property_readonly(
          "vertices_onto_vertices", [](const Check& check) { return check.report.vertices_onto_vertices; },
          "Whether every element of every region maps vertices onto vertices.")
      .def_property_readonly(
          "regions",
          [](const Check& check) {
            py::list entries;
            for (const RegionResidual& region : check.report.regions) entries.append(entry_of(region, check.deformed));
            return entries;
          },
          "Of each region its figures by their names.")
      .def_property_readonly(
          "patterns",
          [](const Check& check) {
            py::list entries;
            for (const PatternResidual& pattern : check.report.patterns) {
              py::dict entry;
              entry["id"] = pattern.id;
              entry["name"] = pattern.name;
              entry["rest_max"] = pattern.floor.max;
              if (check.deformed) entry["deformed_max"] = pattern.deformed.max;
              entries.append(entry);
            }
            return entries;
          },
          "Of each pattern its figures by their names.")
      .def_property_readonly(
          "vertex_excess",
          [](const py::object& self) { return view_of(self.cast<const Check&>().report.vertex_excess, self); },
          "(n,): the largest that the deformation adds at each vertex; 0 at rest. Read-only.")
      .def("__repr__", [](const Check& check) {
        return "<orbifit.CheckReport: residual " + py::str(py::float_(worst_of(check))).cast<std::string>() + ", " +
               count_text(check.report.regions.size(), "region") + ">";
      });
}

void define_check(py::module_& module) {
  module.def("check", &check, py::arg("mesh"), py::arg("annotation"), py::arg("deformed") = py::none(), py::kw_only(),
             py::arg("mode") = "floating", seed_argument(), threads_argument(), timeout_argument(), progress_argument(),
             "Measures how symmetric each region is, at rest or after a deformation.\n\n"
             "Args:\n"
             "    deformed: the same mesh after a deformation, or its vertices with the same faces.\n"
             "    mode: how the groups may move along: 'fixed', 'posed', 'floating' or 'moving'.\n" ORBIFIT_RUN_DOC
             "\nRaises:\n"
             "    InputError: a deformed mesh with other faces, an annotation of another mesh.");
}

std::shared_ptr<Symmetrized> symmetrize(const MeshPointer& mesh, const SymmetryAnnotation& annotation,
                                        RunContext& context) {
  auto result = std::make_shared<Symmetrized>();
  const SymmetryAnnotation consistent = made_consistent(*mesh, annotation, context);
  const auto moved = std::make_shared<Mesh>(symmetrized(*mesh, consistent, context, &result->report));
  result->mesh = moved;
  result->annotation = std::make_shared<Annotation>(Annotation{consistent, moved});
  SymmetryAnnotation& after = result->annotation->value;
  const SymmetryReport residuals = symmetry_residual(*moved, after, nullptr, CarriedMotions::fixed, context);
  after.mesh_diagonal = diagonal(moved->vertices);
  for (std::size_t r = 0; r < after.regions.size(); ++r) after.regions[r].residual = residuals.regions[r].floor;
  for (std::size_t p = 0; p < after.patterns.size(); ++p) after.patterns[p].residual = residuals.patterns[p].floor;
  return result;
}

void define_symmetrize(py::module_& module) {
  py::class_<Symmetrized, std::shared_ptr<Symmetrized>>(module, "SymmetrizeResult",
                                                        "The nearest symmetric mesh, and what moved. Lengths are "
                                                        "fractions of the diagonal.")
      .def_property_readonly(
          "mesh", [](const Symmetrized& result) { return std::const_pointer_cast<Mesh>(result.mesh); },
          "The moved mesh; its faces are those given.")
      .def_property_readonly(
          "annotation", [](const Symmetrized& result) { return result.annotation; }, "Of that mesh.")
      .def_property_readonly(
          "largest_movement", [](const Symmetrized& result) { return result.report.largest_movement; }, "Of a vertex.")
      .def_property_readonly(
          "rms_movement", [](const Symmetrized& result) { return result.report.rms_movement; },
          "Over the vertices in regions.")
      .def_property_readonly(
          "in_regions", [](const Symmetrized& result) { return result.report.in_regions; }, "Number of those.")
      .def_property_readonly(
          "mapped", [](const Symmetrized& result) { return result.report.mapped; },
          "Number of those all of whose images are vertices: they are exactly symmetric.")
      .def_property_readonly(
          "held", [](const Symmetrized& result) { return result.report.held; },
          "Number of those left where they are, lest a region get worse.")
      .def("__repr__", [](const Symmetrized& result) {
        return "<orbifit.SymmetrizeResult: moved by " +
               py::str(py::float_(result.report.largest_movement)).cast<std::string>() + " at most>";
      });
  module.def(
      "symmetrize",
      [](const MeshLike& mesh_like, const Annotation& annotation, std::uint64_t seed, std::optional<int> threads,
         std::optional<double> timeout, const Progress& progress) {
        const MeshPointer mesh = mesh_from(mesh_like);
        require_fit(annotation.value, *mesh);
        return run({seed, threads, timeout, progress},
                   [&](RunContext& context) { return symmetrize(mesh, annotation.value, context); });
      },
      py::arg("mesh"), py::arg("annotation"), py::kw_only(), seed_argument(), threads_argument(), timeout_argument(),
      progress_argument(),
      "Moves every vertex to the mean over its orbit: the nearest exactly symmetric rest shape.\n\n"
      "Args:\n"
      "    annotation: its tolerance says how far an image may lie from its vertex.\n" ORBIFIT_RUN_DOC
      "\nRaises:\n"
      "    NoResultError: a region would be less symmetric than before.");
}

}  // namespace

void define_checks(py::module_& module) {
  define_check_report(module);
  define_check(module);
  define_symmetrize(module);
}

}  // namespace orbifit::python
