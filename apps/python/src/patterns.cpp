#include <pybind11/stl.h>

#include "orbifit/model/errors.h"

#include "annotations.h"

namespace orbifit::python {

namespace {

std::vector<Motion> instance_motions(const Pattern& pattern) {
  std::vector<Motion> motions;
  for (const PatternInstance& instance : pattern.instances) motions.push_back(instance.motion);
  return motions;
}

}  // namespace

py::tuple state_of(const Pattern& pattern) {
  py::list faces;
  for (const PatternInstance& instance : pattern.instances) {
    faces.append(IntArray(static_cast<py::ssize_t>(instance.faces.size()), instance.faces.data()));
  }
  return py::make_tuple(pattern.id, pattern.name, to_string(pattern.kind), bytes_of(pattern.generators),
                        bytes_of(instance_motions(pattern)), faces, pattern.residual.rms, pattern.residual.max,
                        pattern.importance);
}

Pattern pattern_from_state(const py::tuple& state) {
  Pattern pattern;
  pattern.id = state[0].cast<int>();
  pattern.name = state[1].cast<std::string>();
  const auto kind = parse_pattern_kind(state[2].cast<std::string>());
  if (!kind) throw InputError("", "kind", "is '" + state[2].cast<std::string>() + "'");
  pattern.kind = *kind;
  pattern.generators = motions_from_bytes(state[3]);
  const std::vector<Motion> motions = motions_from_bytes(state[4]);
  const auto faces = state[5].cast<py::list>();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    pattern.instances.push_back({motions[i], indices_from(faces[i], "faces", std::numeric_limits<int>::max())});
  }
  pattern.residual = {state[6].cast<double>(), state[7].cast<double>()};
  pattern.importance = state[8].cast<std::optional<double>>();
  return pattern;
}

void define_patterns(py::module_& module) {
  py::class_<Pattern, std::shared_ptr<Pattern>>(
      module, "Pattern", "Congruent copies of one part that no finite group relates, or that repeat regularly.")
      .def_readonly("id", &Pattern::id, "Number within the annotation.")
      .def_readonly("name", &Pattern::name, "For people.")
      .def_property_readonly(
          "kind", [](const Pattern& pattern) { return to_string(pattern.kind); },
          "'translation-1d', 'translation-2d', 'translation-3d', 'rotation', 'screw' or 'congruent'.")
      .def_property_readonly(
          "generators", [](const py::object& self) { return view_of(self.cast<const Pattern&>().generators, self); },
          "(n, 3, 4): one step of the lattice each; none of congruent copies.")
      .def_property_readonly(
          "motions",
          [](const Pattern& pattern) {
            auto* motions = new std::vector<Motion>(instance_motions(pattern));
            return view_of(
                *motions, py::capsule(motions, [](void* memory) { delete static_cast<std::vector<Motion>*>(memory); }));
          },
          "(n, 3, 4): from instance 0 to each.")
      .def_property_readonly(
          "faces",
          [](const py::object& self) {
            std::vector<IntArray> faces;
            for (const PatternInstance& instance : self.cast<const Pattern&>().instances) {
              faces.push_back(view_of(instance.faces, self));
            }
            return faces;
          },
          "Of each instance its faces: int32, ascending, read-only.")
      .def_property_readonly(
          "residual_rms", [](const Pattern& pattern) { return pattern.residual.rms; },
          "Root mean square distance between instances brought onto one another, fraction of the mesh's diagonal.")
      .def_property_readonly(
          "residual_max", [](const Pattern& pattern) { return pattern.residual.max; },
          "The largest of those distances.")
      .def_readonly("importance", &Pattern::importance,
                    "Share of what was left of the surface that it saves, given those listed before it, or None.")
      .def("__len__", [](const Pattern& pattern) { return pattern.instances.size(); })
      .def("__repr__",
           [](const Pattern& pattern) {
             return "<orbifit.Pattern " + std::to_string(pattern.id) + ": " + to_string(pattern.kind) + ", " +
                    count_text(pattern.instances.size(), "instance") +
                    (pattern.name.empty() ? "" : ", '" + pattern.name + "'") + ">";
           })
      .def(py::pickle([](const Pattern& pattern) { return state_of(pattern); },
                      [](const py::tuple& state) { return std::make_shared<Pattern>(pattern_from_state(state)); }));
}

}  // namespace orbifit::python
