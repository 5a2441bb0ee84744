#include "annotations.h"

#include <algorithm>
#include <optional>

#include <pybind11/stl.h>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"

#include "run.h"

namespace orbifit::python {

namespace {

// What an annotation holds, each of which keeps it alive.
template <class Item>
std::vector<std::shared_ptr<Item>> items_of(const AnnotationPointer& owner, std::vector<Item>& items) {
  std::vector<std::shared_ptr<Item>> pointers;
  for (Item& item : items) pointers.emplace_back(owner, &item);
  return pointers;
}

template <class Item>
void keep_ids(std::vector<Item>& items, const std::vector<int>& ids, const std::string& what) {
  for (const int id : ids) {
    if (std::ranges::find(items, id, &Item::id) == items.end()) {
      throw UsageError("the annotation has no " + what + " " + std::to_string(id));
    }
  }
  std::erase_if(items, [&](const Item& item) { return std::ranges::find(ids, item.id) == ids.end(); });
}

AnnotationPointer restricted(const Annotation& annotation, const std::optional<std::vector<int>>& regions,
                             const std::optional<std::vector<int>>& patterns) {
  auto result = std::make_shared<Annotation>(annotation);
  if (regions) keep_ids(result->value.regions, *regions, "region");
  if (patterns) keep_ids(result->value.patterns, *patterns, "pattern");
  set_parents(result->value.regions);
  return result;
}

AnnotationPointer made_annotation(const MeshLike& mesh_like, const std::vector<Region>& regions, double tolerance) {
  const MeshPointer mesh = mesh_from(mesh_like);
  auto result = std::make_shared<Annotation>(Annotation{empty_annotation(*mesh, tolerance), mesh});
  for (const Region& region : regions) {
    Region& added = result->value.regions.emplace_back(region);
    added.id = static_cast<int>(result->value.regions.size()) - 1;
    if (added.faces.empty() || added.faces.back() >= mesh->faces.rows()) {
      throw InputError("", "regions[" + std::to_string(added.id) + "]",
                       added.faces.empty() ? "has no faces" : "has faces that the mesh has not");
    }
  }
  set_parents(result->value.regions);
  return result;
}

py::tuple pickled(const Annotation& annotation) {
  const SymmetryAnnotation& value = annotation.value;
  py::list regions, patterns;
  for (const Region& region : value.regions) regions.append(state_of(region));
  for (const Pattern& pattern : value.patterns) patterns.append(state_of(pattern));
  return py::make_tuple(value.mesh_vertices, value.mesh_faces, value.mesh_diagonal, value.tolerance, regions, patterns);
}

AnnotationPointer annotation_from_state(const py::tuple& state) {
  auto result = std::make_shared<Annotation>();
  SymmetryAnnotation& value = result->value;
  value.mesh_vertices = state[0].cast<int>();
  value.mesh_faces = state[1].cast<int>();
  value.mesh_diagonal = state[2].cast<double>();
  value.tolerance = state[3].cast<double>();
  for (const py::handle region : state[4]) value.regions.push_back(region_from_state(region.cast<py::tuple>()));
  for (const py::handle pattern : state[5]) value.patterns.push_back(pattern_from_state(pattern.cast<py::tuple>()));
  return result;
}

AnnotationPointer annotation_read(const PathLike& file, const MeshLike& mesh_like) {
  const MeshPointer mesh = mesh_from(mesh_like);
  return std::make_shared<Annotation>(Annotation{read_annotation(path_from(file), *mesh), mesh});
}

std::shared_ptr<Region> region_of(const AnnotationPointer& annotation, int id) {
  std::vector<Region>& regions = annotation->value.regions;
  const auto found = std::ranges::find(regions, id, &Region::id);
  if (found == regions.end()) throw UsageError("the annotation has no region " + std::to_string(id));
  return {annotation, &*found};
}

using Class = py::class_<Annotation, AnnotationPointer>;

void define_contents(Class& annotation) {
  annotation
      .def_property_readonly(
          "regions", [](const AnnotationPointer& a) { return items_of(a, a->value.regions); },
          "Regions with their groups, in the annotation's order.")
      .def_property_readonly(
          "patterns", [](const AnnotationPointer& a) { return items_of(a, a->value.patterns); }, "Repeated parts.")
      .def_property_readonly(
          "mesh",
          [](const Annotation& a) {
            return a.mesh ? std::optional(std::const_pointer_cast<Mesh>(a.mesh)) : std::nullopt;
          },
          "The mesh that it is of; None where that is not known, as after unpickling.")
      .def_property_readonly(
          "tolerance", [](const Annotation& a) { return a.value.tolerance; },
          "The detector's, as a fraction of the diagonal.")
      .def_property_readonly(
          "mesh_vertices", [](const Annotation& a) { return a.value.mesh_vertices; }, "Number of the mesh's vertices.")
      .def_property_readonly(
          "mesh_faces", [](const Annotation& a) { return a.value.mesh_faces; }, "Number of the mesh's faces.")
      .def_property_readonly(
          "mesh_diagonal", [](const Annotation& a) { return a.value.mesh_diagonal; }, "In the mesh's unit.");
}

void define_edits(Class& annotation) {
  annotation.def("region", &region_of, py::arg("id"), "The region of an id.")
      .def("restrict", &restricted, py::arg("regions") = py::none(), py::arg("patterns") = py::none(),
           "The annotation with some of its regions and patterns alone.\n\n"
           "Args:\n"
           "    regions: ids of those to keep; all if not given.\n"
           "    patterns: likewise.")
      .def(
          "without",
          [](const Annotation& a, const std::vector<int>& ids) {
            return std::make_shared<Annotation>(Annotation{without_regions(a.value, ids), a.mesh});
          },
          py::arg("regions"), "The annotation without the regions of these ids.")
      .def(
          "transformed",
          [](const Annotation& a, const ArrayLike& similarity) {
            const Similarity map = similarity_from(similarity, "similarity");
            auto result = std::make_shared<Annotation>(Annotation{orbifit::transformed(a.value, map)});
            if (a.mesh) {
              auto moved = std::make_shared<Mesh>(*a.mesh);
              for (auto row : moved->vertices.rowwise()) row = map(row.transpose()).transpose();
              result->mesh = moved;
            }
            return result;
          },
          py::arg("similarity"), "The annotation of the mesh after a similarity, (4, 4) or (3, 4).")
      .def(
          "with_mesh",
          [](const Annotation& a, const MeshLike& mesh_like) {
            const MeshPointer mesh = mesh_from(mesh_like);
            require_fit(a.value, *mesh);
            return std::make_shared<Annotation>(Annotation{a.value, mesh});
          },
          py::arg("mesh"), "The same annotation, which knows its mesh, for pictures.")
      .def(
          "consistent",
          [](const Annotation& a, const MeshLike& mesh_like, std::uint64_t seed, std::optional<int> threads,
             std::optional<double> timeout, const Progress& progress) {
            const MeshPointer mesh = mesh_from(mesh_like);
            require_fit(a.value, *mesh);
            return std::make_shared<Annotation>(
                Annotation{run({seed, threads, timeout, progress},
                               [&](RunContext& context) { return made_consistent(*mesh, a.value, context); }),
                           mesh});
          },
          py::arg("mesh"), py::kw_only(), seed_argument(), threads_argument(), timeout_argument(), progress_argument(),
          "The annotation whose groups agree with one another exactly, so that a subspace can keep all of them. What "
          "cannot be kept is left out and named through :mod:`logging`, as 'orbifit'.");
}

void define_files(Class& annotation) {
  annotation
      .def_static("load", &annotation_read, py::arg("file"), py::arg("mesh"),
                  "Reads an annotation of a mesh.\n\n"
                  "Raises:\n"
                  "    InputError: naming the file, the key and the reason.")
      .def(
          "save", [](const Annotation& a, const PathLike& file) { write_annotation(path_from(file), a.value); },
          py::arg("file"), "Writes JSON, whole or not at all.")
      .def(
          "to_json", [](const Annotation& a) { return to_json(a.value); }, "The text of the annotation's file.")
      .def_static(
          "from_json",
          [](const std::string& text, const MeshLike& mesh_like) {
            const MeshPointer mesh = mesh_from(mesh_like);
            return std::make_shared<Annotation>(Annotation{annotation_from_json(text, *mesh, ""), mesh});
          },
          py::arg("text"), py::arg("mesh"), "Of the text of an annotation's file.")
      .def(py::pickle(&pickled, &annotation_from_state));
}

}  // namespace

std::string count_text(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

void require_fit(const SymmetryAnnotation& annotation, const Mesh& mesh) {
  if (annotation.mesh_vertices == mesh.vertices.rows() && annotation.mesh_faces == mesh.faces.rows()) return;
  throw InputError("", "annotation",
                   "is of a mesh with " + std::to_string(annotation.mesh_vertices) + " vertices and " +
                       std::to_string(annotation.mesh_faces) + " faces; this one has " +
                       std::to_string(mesh.vertices.rows()) + " and " + std::to_string(mesh.faces.rows()));
}

void define_annotations(py::module_& module) {
  Class annotation(module, "Annotation",
                   "The symmetries of one mesh: regions with point groups, and repeated parts. It never changes; what "
                   "edits it makes a new one. Pickles leave out the mesh.");
  annotation.def(py::init(&made_annotation), py::arg("mesh"), py::arg("regions") = py::list(), py::kw_only(),
                 py::arg("tolerance") = 0.005,
                 "An annotation of regions made by hand.\n\n"
                 "Raises:\n"
                 "    InputError: a region without faces, or with faces that the mesh has not.");
  define_contents(annotation);
  define_edits(annotation);
  define_files(annotation);
  annotation
      .def(
          "__eq__", [](const Annotation& a, const Annotation& b) { return to_json(a.value) == to_json(b.value); },
          py::is_operator())
      .def("__repr__", [](const Annotation& a) {
        std::string groups;
        const std::size_t shown = std::min<std::size_t>(a.value.regions.size(), 6);
        for (std::size_t r = 0; r < shown; ++r) {
          groups += (r == 0 ? "" : ", ") + a.value.regions[r].group.symbol();
        }
        if (a.value.regions.size() > shown) groups += ", ...";
        return "<orbifit.Annotation: " + count_text(a.value.regions.size(), "region") +
               (groups.empty() ? "" : " (" + groups + ")") + ", " + count_text(a.value.patterns.size(), "pattern") +
               ">";
      });
  module.def("read_annotation", &annotation_read, py::arg("file"), py::arg("mesh"),
             "Reads an annotation of a mesh: see :meth:`Annotation.load`.");
  module.def(
      "write_annotation", [](const PathLike& file, const Annotation& a) { write_annotation(path_from(file), a.value); },
      py::arg("file"), py::arg("annotation"), "Writes JSON, whole or not at all.");
}

}  // namespace orbifit::python
