#include <cstring>
#include <optional>

#include <Eigen/Dense>
#include <pybind11/stl.h>

#include "orbifit/model/errors.h"

#include "annotations.h"

namespace orbifit::python {

namespace {

PointGroup group_from(const std::string& symbol) {
  const std::optional<PointGroup> group = PointGroup::parse(symbol);
  if (!group) throw UsageError("group is '" + symbol + "': no Schoenflies symbol such as Cs, C4v, D2h, Oh, Cinfv, Kh");
  return *group;
}

Eigen::Vector3d unit_from(const py::handle& values, const std::string& name) {
  const Eigen::Vector3d vector = vector_from(values, name);
  if (!(vector.stableNorm() > 0)) throw UsageError(name + " must not be zero");
  return vector.stableNormalized();
}

// A frame of a group: its axis, and what else tells where it lies.
GroupFrame frame_from(const PointGroup& group, const std::optional<ArrayLike>& axis,
                      const std::optional<ArrayLike>& towards) {
  if (!axis) {
    if (group.has_axis()) throw UsageError("axis must be given: the group " + group.symbol() + " has one");
    if (!towards) return GroupFrame::Identity();
  }
  const Eigen::Vector3d main = axis ? unit_from(*axis, "axis") : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  if (!towards) return frame_about(main);
  const Eigen::Vector3d second = unit_from(*towards, "towards");
  if (second.cross(main).norm() < 1e-9) throw UsageError("towards must not lie along the axis");
  return frame_about(main, second);
}

Region made_region(const std::string& symbol, const ArrayLike& faces, const ArrayLike& centre,
                   const std::optional<ArrayLike>& axis, const std::optional<ArrayLike>& towards,
                   const std::string& name) {
  const PointGroup group = group_from(symbol);
  // The mesh, whose faces these are, is not known yet: Annotation() checks them against it.
  return make_region(group, vector_from(centre, "centre"), frame_from(group, axis, towards),
                     index_set_from(faces, "faces", std::numeric_limits<int>::max()), name);
}

}  // namespace

py::bytes bytes_of(const std::vector<Motion>& motions) {
  return {reinterpret_cast<const char*>(motions.data()), motions.size() * sizeof(Motion)};
}

std::vector<Motion> motions_from_bytes(const py::bytes& bytes) {
  const auto text = bytes.cast<std::string_view>();
  std::vector<Motion> motions(text.size() / sizeof(Motion));
  if (!motions.empty()) std::memcpy(static_cast<void*>(motions.data()), text.data(), motions.size() * sizeof(Motion));
  return motions;
}

py::tuple state_of(const Region& region) {
  return py::make_tuple(region.id, region.name, region.group.symbol(), array_of(region.centre), array_of(region.axis),
                        bytes_of(region.generators), bytes_of(region.elements),
                        IntArray(static_cast<py::ssize_t>(region.faces.size()), region.faces.data()), region.parent,
                        region.residual.rms, region.residual.max, region.importance);
}

Region region_from_state(const py::tuple& state) {
  Region region;
  region.id = state[0].cast<int>();
  region.name = state[1].cast<std::string>();
  region.group = group_from(state[2].cast<std::string>());
  region.centre = vector_from(state[3], "centre");
  region.axis = vector_from(state[4], "axis");
  region.generators = motions_from_bytes(state[5]);
  region.elements = motions_from_bytes(state[6]);
  region.faces = indices_from(state[7], "faces", std::numeric_limits<int>::max());
  region.parent = state[8].cast<std::optional<int>>();
  region.residual = {state[9].cast<double>(), state[10].cast<double>()};
  region.importance = state[11].cast<std::optional<double>>();
  return region;
}

void define_regions(py::module_& module) {
  const auto array = [](auto member) {
    return [member](const py::object& self) { return view_of(self.cast<const Region&>().*member, self); };
  };
  py::class_<Region, std::shared_ptr<Region>>(
      module, "Region", "A part of the surface, a set of faces, and the point group that maps it to itself.")
      .def(py::init([](const std::string& group, const ArrayLike& faces, const ArrayLike& centre,
                       const std::optional<ArrayLike>& axis, const std::optional<ArrayLike>& towards,
                       const std::string& name) {
             return std::make_shared<Region>(made_region(group, faces, centre, axis, towards, name));
           }),
           py::arg("group"), py::arg("faces"), py::kw_only(), py::arg("centre"), py::arg("axis") = py::none(),
           py::arg("towards") = py::none(), py::arg("name") = "",
           "A region whose elements are computed in closed form. :class:`Annotation` takes it up.\n\n"
           "Args:\n"
           "    group: Schoenflies symbol: 'Cs', 'C4v', 'D2h', 'Oh', 'Cinfv', 'Kh' ...\n"
           "    faces: face numbers, or a mask of all faces.\n"
           "    centre: a point that every element leaves fixed.\n"
           "    axis: the main axis; of 'Cs' the plane's normal.\n"
           "    towards: across the axis: the normal of one vertical mirror of Cnv, a twofold axis of Dn, Dnh, Dnd.\n\n"
           "Raises:\n"
           "    UsageError: an unknown group, an axis that is missing or zero.")
      .def_readonly("id", &Region::id, "Number within the annotation.")
      .def_readonly("name", &Region::name, "For people.")
      .def_property_readonly(
          "group", [](const Region& region) { return region.group.symbol(); }, "Schoenflies symbol in ASCII: 'C4v'.")
      .def_property_readonly(
          "continuous", [](const Region& region) { return region.group.continuous(); },
          "Whether the group is continuous, as of surfaces of revolution; it has no list of elements then.")
      .def_property_readonly(
          "order", [](const Region& region) { return region.group.order(); },
          "Number of elements; 0 for a continuous group.")
      .def_property_readonly(
          "centre", [](const Region& region) { return array_of(region.centre); },
          "(3,): a point that every element leaves fixed.")
      .def_property_readonly(
          "axis",
          [](const Region& region) {
            return region.axis.isZero(0) ? std::nullopt : std::optional(array_of(region.axis));
          },
          "(3,), unit; of 'Cs' the plane's normal; None where the group has none.")
      .def_property_readonly("generators", array(&Region::generators), "(n, 3, 4) motions that generate the group.")
      .def_property_readonly("elements", array(&Region::elements),
                             "(n, 3, 4) motions, the identity first; (0, 3, 4) for a continuous group. Read-only.")
      .def_property_readonly("faces", array(&Region::faces), "(m,) int32, ascending, read-only.")
      .def_readonly("parent", &Region::parent, "Id of the smallest region that strictly contains this one, or None.")
      .def_property_readonly(
          "residual_rms", [](const Region& region) { return region.residual.rms; },
          "Root mean square distance between the region and its images, fraction of the mesh's diagonal.")
      .def_property_readonly(
          "residual_max", [](const Region& region) { return region.residual.max; }, "The largest of those distances.")
      .def_readonly("importance", &Region::importance,
                    "Share of what was left of the surface that it saves, given those listed before it, or None.")
      .def("__repr__",
           [](const Region& region) {
             return "<orbifit.Region " + std::to_string(region.id) + ": " + region.group.symbol() + ", " +
                    count_text(region.faces.size(), "face") + (region.name.empty() ? "" : ", '" + region.name + "'") +
                    ">";
           })
      .def(py::pickle([](const Region& region) { return state_of(region); },
                      [](const py::tuple& state) { return std::make_shared<Region>(region_from_state(state)); }));
}

}  // namespace orbifit::python
