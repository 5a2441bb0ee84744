#include <pybind11/stl.h>

#include "orbifit/apps/scan_union.h"
#include "orbifit/detection/detect.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"

#include "deformers.h"
#include "fits.h"
#include "run.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

using LandmarkList = std::vector<std::pair<int, ArrayLike>>;

std::vector<Landmark> landmarks_from(const LandmarkList& pairs, const Mesh& mesh) {
  std::vector<Landmark> landmarks;
  for (const auto& [vertex, target] : pairs) {
    const std::string place = "landmarks[" + std::to_string(landmarks.size()) + "]";
    if (vertex < 0 || vertex >= mesh.vertices.rows()) {
      throw InputError(
          "", place,
          "is of vertex " + std::to_string(vertex) + "; the mesh has " + std::to_string(mesh.vertices.rows()));
    }
    landmarks.push_back({vertex, vector_from(target, place)});
  }
  return landmarks;
}

struct Given {
  MeshPointer mesh;
  std::vector<ScanPointer> scans;  // at least one
  AnnotationPointer annotation;    // null: to be detected
  SubspacePointer subspace;        // null: to be built
  Similarity pose;
  std::vector<Landmark> landmarks;
  std::vector<Handle> handles;
};

std::shared_ptr<KeptFit> fitted(const Given& given, const FitOptions& options, RunContext& context) {
  SymmetryAnnotation annotation;
  if (given.subspace) {
    annotation = given.subspace->annotation->value;
  } else {
    annotation = given.annotation ? given.annotation->value : detect(*given.mesh, DetectOptions{}, context);
    annotation = made_consistent(*given.mesh, annotation, context);
  }
  const std::vector<const PointCloud*> scans = pointers_to(given.scans);
  FitInput input{*given.mesh, annotation, *scans.front(), given.pose, given.landmarks, given.handles};
  input.others.assign(scans.begin() + 1, scans.end());
  if (given.subspace) input.subspace = std::make_shared<const Subspace>(given.subspace->subspace);
  auto kept = std::make_shared<KeptFit>();
  kept->mesh = given.mesh;
  kept->result = fit(input, options, context);
  kept->scan =
      scans.size() == 1
          ? given.scans.front()
          : std::make_shared<const PointCloud>(scan_union(scans, kept->result.others, kept->result.other_used));
  return kept;
}

constexpr const char* kFitDoc =
    "Deforms a template to a scan within its symmetric subspace.\n\n"
    "Args:\n"
    "    template: see :meth:`Mesh.of`.\n"
    "    scans: see :meth:`PointCloud.of`; or a list of scans of one object, each in a frame of its own: they have "
    "one\n"
    "        shape and one scale together, and the result is in the frame of the first.\n"
    "    annotation: of the template; it is detected if not given.\n"
    "    subspace: of the template, where it is built already; `annotation` and the basis' options are its own "
    "then.\n"
    "    pose: where the template is in the scan, roughly, (4, 4) or (3, 4), a similarity; found if not given.\n"
    "    landmarks: (vertex, target) pairs, targets in the scan's frame; they give the pose.\n"
    "    handles: of :class:`Handle`, their motions in the template's frame.\n"
    "    mode, radius, samples: of the basis, see :class:`Subspace`.\n"
    "    stiffness: of the last iterations; less follows the scan more closely.\n"
    "    refinements: how often the basis may be made finer, by three times the degrees of freedom, where the scan\n"
    "        asks for it; not where `subspace`, `radius` or `samples` say how fine it is.\n"
    "    detail: then displace the vertices along their normals by what all points of the scan show beyond the basis,\n"
    "        exactly as symmetric.\n"
    "    scan_points: how many of the scan's points are used.\n"
    "    inlier_distance: a point nearer than this fraction of the diagonal is explained.\n"
    "    contacts: parts of the template that touch stay in touch.\n"
    "    judge_groups: say which groups the scan has not; takes as long again.\n"
    "    drop_unsupported: and leave those out.\n"
    "    one_frame: the scans have one frame, where they make up one scan.\n"
    "    aligned: `pose`, or the template's own place where that is not given, is neither sought nor refined; the\n"
    "        scans have one frame then.\n"
    "    scale: of the template in the scan: 'any', or 'fixed', that of `pose`, or the template's "
    "own.\n" ORBIFIT_RUN_DOC
    "\nReturns:\n"
    "    A fit, also one that does not explain the scan: its `converged` is False then.\n\n"
    "Raises:\n"
    "    InputError: fewer than 10 points, an annotation of another mesh.\n"
    "    UsageError: an option out of range.";

void define_fit(py::module_& module) {
  const FitOptions defaults;
  module.def(
      "fit",
      [](const MeshLike& mesh_like, const ScanLike& scans, const AnnotationPointer& annotation,
         const SubspacePointer& subspace, const std::optional<ArrayLike>& pose,
         const std::optional<LandmarkList>& landmarks, const std::optional<py::iterable>& handles,
         const std::string& mode, std::optional<double> radius, std::optional<int> samples, double stiffness,
         int refinements, bool detail, int scan_points, double inlier_distance, bool contacts, bool judge_groups,
         bool drop_unsupported, bool one_frame, bool aligned, const std::string& scale, std::uint64_t seed,
         std::optional<int> threads, std::optional<double> timeout, const Progress& progress) {
        Given given{mesh_from(mesh_like), scans_from(scans), annotation, subspace, {}, {}, {}};
        if (one_frame || aligned) given.scans = {one_scan(given.scans)};
        if (scale != "any" && scale != "fixed")
          throw UsageError("scale is '" + scale + "'; it must be 'any' or 'fixed'");
        if (subspace) require_fit(subspace->annotation->value, *given.mesh);
        if (annotation) require_fit(annotation->value, *given.mesh);
        if (pose) given.pose = similarity_from(*pose, "pose");
        if (landmarks) given.landmarks = landmarks_from(*landmarks, *given.mesh);
        if (handles) given.handles = handles_from(*handles, *given.mesh);
        FitOptions options;
        options.subspace = subspace_options(mode, "orbit", radius, samples, {}, false, *given.mesh);
        options.place = !pose && !aligned && given.handles.empty();
        options.align = !aligned;
        options.fixed_scale = scale == "fixed";
        options.last_stiffness = stiffness;
        options.refinements = subspace ? 0 : refinements;
        options.detail = detail;
        options.scan_points = scan_points;
        options.inlier_distance = inlier_distance;
        options.contacts = contacts;
        options.judge_groups = judge_groups;
        options.drop_unsupported = drop_unsupported;
        options.validate();
        return run({seed, threads, timeout, progress},
                   [&](RunContext& context) { return fitted(given, options, context); });
      },
      py::arg("template"), py::arg("scans"), py::arg("annotation") = py::none(), py::kw_only(),
      py::arg("subspace") = py::none(), py::arg("pose") = py::none(), py::arg("landmarks") = py::none(),
      py::arg("handles") = py::none(), py::arg("mode") = "floating", py::arg("radius") = py::none(),
      py::arg("samples") = py::none(), py::arg("stiffness") = defaults.last_stiffness,
      py::arg("refinements") = defaults.refinements, py::arg("detail") = false,
      py::arg("scan_points") = defaults.scan_points, py::arg("inlier_distance") = defaults.inlier_distance,
      py::arg("contacts") = true, py::arg("judge_groups") = false, py::arg("drop_unsupported") = false,
      py::arg("one_frame") = false, py::arg("aligned") = false, py::arg("scale") = "any", seed_argument(),
      threads_argument(), timeout_argument(), progress_argument(), kFitDoc);
}

}  // namespace

void define_fitting(py::module_& module) {
  define_fit(module);
  module.def(
      "find_placements",
      [](const MeshLike& mesh_like, const ScanLike& scans, const AnnotationPointer& annotation,
         const std::optional<ArrayLike>& pose, std::uint64_t seed, std::optional<int> threads,
         std::optional<double> timeout, const Progress& progress) {
        const MeshPointer mesh = mesh_from(mesh_like);
        const ScanPointer scan = scan_from(scans);
        const SymmetryAnnotation used =
            annotation ? annotation->value : empty_annotation(*mesh, DetectOptions{}.tolerance);
        require_fit(used, *mesh);
        std::optional<Similarity> given;
        if (pose) given = similarity_from(*pose, "pose");
        const std::vector<Placement> placements = run({seed, threads, timeout, progress}, [&](RunContext& context) {
          return find_placements(*mesh, used, *scan, PlacementOptions{}, context, given);
        });
        std::vector<std::pair<DoubleArray, double>> result;
        for (const Placement& placement : placements) result.emplace_back(matrix_of(placement.pose), placement.score());
        return result;
      },
      py::arg("template"), py::arg("scans"), py::arg("annotation") = py::none(), py::kw_only(),
      py::arg("pose") = py::none(), seed_argument(), threads_argument(), timeout_argument(), progress_argument(),
      "Finds a template in a scan at any position, rotation and scale.\n\n"
      "Args:\n"
      "    annotation: of the template; its mirrors and axes propose poses.\n"
      "    pose: a pose that is tried as well.\n" ORBIFIT_RUN_DOC
      "\nReturns:\n"
      "    (pose, score) pairs, best first, at most 10: (4, 4), template to scan, and a share of 1.");
  module.def(
      "read_landmarks",
      [](const PathLike& file, const MeshLike& mesh) {
        std::vector<std::pair<int, DoubleArray>> result;
        for (const Landmark& landmark : read_landmarks(path_from(file), *mesh_from(mesh))) {
          result.emplace_back(landmark.vertex, array_of(landmark.target));
        }
        return result;
      },
      py::arg("file"), py::arg("mesh"), "Reads a file of landmarks as `orbifit fit` takes it: (vertex, target) pairs.");
}

}  // namespace orbifit::python
