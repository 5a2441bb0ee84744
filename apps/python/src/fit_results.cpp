#include <pybind11/stl.h>

#include "orbifit/fitting/fit_verdict.h"

#include "fits.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

py::dict figures_of(const FitResult& result) {
  py::dict figures;
  figures["samples"] = result.samples;
  figures["degrees_of_freedom"] = result.degrees_of_freedom;
  figures["iterations"] = result.iterations.size();
  figures["overlap"] = result.overlap;
  figures["torn_off"] = result.torn_off;
  figures["unexplained_part"] = result.unexplained_part;
  figures["inlier_ratio"] = result.inlier_ratio;
  figures["rms"] = result.rms;
  figures["visible_coverage"] = result.visible_coverage;
  figures["cut_off"] = result.cut_off;
  figures["own_size"] = result.own_size;
  figures["growth"] = result.growth;
  figures["open_stretch"] = result.open_stretch();
  figures["open_distance"] = result.open_distance();
  figures["confidence"] = result.confidence;
  figures["landmark_rms"] = result.landmark_rms;
  figures["detail_rms"] = result.detail_rms;
  figures["hidden_fraction"] = result.hidden_fraction;
  figures["symmetry_residual"] = result.field_residual;
  for (const StageTime& time : result.times) figures[py::str("seconds_" + time.stage)] = time.seconds;
  return figures;
}

// The iterations' figures as columns.
py::dict history_of(const FitResult& result) {
  const auto count = static_cast<py::ssize_t>(result.iterations.size());
  py::dict history;
  const auto add = [&](const char* name, auto FitIteration::*member) {
    DoubleArray column(count);
    for (py::ssize_t i = 0; i < count; ++i) {
      column.mutable_at(i) = static_cast<double>(result.iterations[static_cast<std::size_t>(i)].*member);
    }
    history[name] = column;
  };
  add("stiffness", &FitIteration::stiffness);
  add("correspondences", &FitIteration::correspondences);
  add("rms", &FitIteration::rms);
  add("energy", &FitIteration::energy);
  add("damping", &FitIteration::damping);
  add("change", &FitIteration::change);
  add("seconds", &FitIteration::seconds);
  return history;
}

py::list groups_of(const FitResult& result) {
  py::list groups;
  for (const GroupAgreement& group : result.groups) {
    py::dict entry;
    entry["region"] = group.region;
    entry["pairs"] = group.pairs;
    entry["disagreement"] = group.disagreement;
    entry["rms_with"] = group.held;
    entry["rms_without"] = group.free;
    entry["disagrees"] = group.disagrees;
    groups.append(entry);
  }
  return groups;
}

// What points that were held out say of a level.
template <class Level>
void add_held_out(const Level& level, py::dict& entry) {
  entry["held_out_before"] = level.held_out_before;
  entry["held_out"] = level.held_out;
  entry["kept"] = level.kept;
}

py::list levels_of(const FitResult& result) {
  py::list levels;
  for (const ResolutionLevel& level : result.levels) {
    py::dict entry;
    entry["samples"] = level.samples;
    entry["degrees_of_freedom"] = level.degrees_of_freedom;
    add_held_out(level, entry);
    levels.append(entry);
  }
  return levels;
}

py::list detail_levels_of(const FitResult& result) {
  py::list levels;
  for (const DetailLevel& level : result.detail_levels) {
    py::dict entry;
    entry["length"] = level.length;
    add_held_out(level, entry);
    levels.append(entry);
  }
  return levels;
}

using Class = py::class_<KeptFit, std::shared_ptr<KeptFit>>;

void define_shapes(Class& fit) {
  fit.def_property_readonly(
         "mesh", [](const std::shared_ptr<KeptFit>& kept) { return std::shared_ptr<Mesh>(kept, &kept->result.fitted); },
         "The fitted template, in the scan's frame; its faces are the template's.")
      .def_property_readonly(
          "annotation",
          [](const std::shared_ptr<KeptFit>& kept) {
            return std::make_shared<Annotation>(
                Annotation{kept->result.annotation, MeshPointer(kept, &kept->result.fitted)});
          },
          "Of the fitted mesh: the template's, its groups carried along.")
      .def_property_readonly(
          "template", [](const KeptFit& kept) { return std::const_pointer_cast<Mesh>(kept.mesh); }, "What was fitted.")
      .def_property_readonly(
          "scan", [](const KeptFit& kept) { return std::const_pointer_cast<PointCloud>(kept.scan); },
          "What it was fitted to: the scan, or all points of those that took part, in the frame of the first.")
      .def_property_readonly(
          "others",
          [](const KeptFit& kept) {
            std::vector<std::optional<DoubleArray>> motions;
            for (std::size_t k = 0; k < kept.result.others.size(); ++k) {
              const Motion& motion = kept.result.others[k];
              motions.emplace_back();
              if (kept.result.other_used[k] != 0) motions.back() = matrix_of({1, motion.linear, motion.translation});
            }
            return motions;
          },
          "(4, 4) each: of the scans but the first, their frames into that of the first; None for a scan in which the\n"
          "shape was not found, which took no part.")
      .def_property_readonly(
          "pose", [](const KeptFit& kept) { return matrix_of(kept.result.pose); },
          "(4, 4): template to scan, a similarity.")
      .def_property_readonly(
          "scale", [](const KeptFit& kept) { return kept.result.pose.scale; }, "Of the pose.")
      .def_property_readonly(
          "placements",
          [](const KeptFit& kept) {
            std::vector<DoubleArray> poses;
            for (const Placement& placement : kept.result.placements) poses.push_back(matrix_of(placement.pose));
            return poses;
          },
          "(4, 4) each: where the template may be, best first; none where that was not asked.")
      .def_property_readonly(
          "q", [](const py::object& self) { return view_of(self.cast<const KeptFit&>().result.q, self); },
          "(degrees_of_freedom,): coordinates of the deformation, read-only.")
      .def_property_readonly(
          "seen",
          [](const KeptFit& kept) {
            py::array_t<bool> seen(static_cast<py::ssize_t>(kept.result.seen.size()));
            for (std::size_t v = 0; v < kept.result.seen.size(); ++v) {
              seen.mutable_at(static_cast<py::ssize_t>(v)) = kept.result.seen[v] != 0;
            }
            return seen;
          },
          "(n,) bool: whether a point of the scan lies near each vertex; symmetry completed the others.");
}

}  // namespace

void define_fit_result(py::module_& module) {
  Class fit(module, "FitResult", "A template fitted to a scan, and what the fit explains.");
  define_shapes(fit);
  fit.def_property_readonly(
         "converged", [](const KeptFit& kept) { return kept.result.converged; }, "Whether it explains the scan.")
      .def_property_readonly(
          "stopped_because", [](const KeptFit& kept) { return kept.result.stopped_because; }, "In words.")
      .def_property_readonly(
          "verdict", [](const KeptFit& kept) { return fit_verdict(kept.result); },
          "What a person should know of it, a sentence each: whether to rely on it, and what to look at.")
      .def_property_readonly(
          "confidence", [](const KeptFit& kept) { return kept.result.confidence; }, "In [0, 1].")
      .def_property_readonly(
          "rms", [](const KeptFit& kept) { return kept.result.rms; },
          "Of the explained points' distances, fraction of the fitted mesh's diagonal.")
      .def_property_readonly(
          "inlier_ratio", [](const KeptFit& kept) { return kept.result.inlier_ratio; },
          "Share of the scan's used points within `inlier_distance` of the fitted surface.")
      .def_property_readonly(
          "symmetry_residual", [](const KeptFit& kept) { return kept.result.field_residual; },
          "How far the worst region's displacement is from symmetric, fraction of the diagonal: rounding.")
      .def_property_readonly(
          "figures", [](const KeptFit& kept) { return figures_of(kept.result); }, "All figures by their names.")
      .def_property_readonly(
          "history", [](const KeptFit& kept) { return history_of(kept.result); },
          "Of each iteration, an array for each figure.")
      .def_property_readonly(
          "levels", [](const KeptFit& kept) { return levels_of(kept.result); },
          "The subspaces that were tried, from coarse to fine, and what points held out of the fit say of them: root\n"
          "mean square distances, fractions of the diagonal. One at most where `radius`, `samples` or `subspace` say "
          "how\n"
          "fine it is.")
      .def_property_readonly(
          "detail_levels", [](const KeptFit& kept) { return detail_levels_of(kept.result); },
          "The same of what `detail` has added: heights along the normals that are alike over `length`, a fraction of "
          "the\n"
          "diagonal.")
      .def_property_readonly(
          "groups", [](const KeptFit& kept) { return groups_of(kept.result); },
          "What the scan says of each region's group, where `judge_groups` asked for it.")
      .def_property_readonly(
          "dropped", [](const KeptFit& kept) { return kept.result.dropped; },
          "Ids of regions left out since the scan has not their symmetry (`drop_unsupported`).")
      .def("__repr__", [](const KeptFit& kept) {
        return "<orbifit.FitResult: " + std::string(kept.result.converged ? "converged" : "not converged") +
               ", confidence " +
               py::str(py::float_(std::round(kept.result.confidence * 1000) / 1000)).cast<std::string>() + ">";
      });
}

}  // namespace orbifit::python
