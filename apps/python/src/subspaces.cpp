#include "subspaces.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <pybind11/stl.h>
#include <unistd.h>

#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/subspace/displacement_field.h"
#include "orbifit/subspace/radius_field.h"
#include "orbifit/subspace/subspace_io.h"

#include "run.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

/// A file's name that nobody else uses; what is there in the end is removed.
class ScratchFile {
 public:
  ScratchFile() {
    std::string pattern = (std::filesystem::temp_directory_path() / "orbifit-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw InputError(pattern, "", "no folder can be made here");
    folder_ = pattern;
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  std::filesystem::path name() const { return folder_ / "subspace.basis"; }

 private:
  std::filesystem::path folder_;
};

SubspacePointer built(const MeshPointer& mesh, const SymmetryAnnotation& annotation, const SubspaceOptions& options,
                      const RunArguments& arguments) {
  return run(arguments, [&](RunContext& context) {
    auto kept = std::make_shared<KeptSubspace>();
    kept->mesh = mesh;
    kept->annotation = std::make_shared<Annotation>(Annotation{made_consistent(*mesh, annotation, context), mesh});
    kept->subspace = build_subspace(*mesh, kept->annotation->value, options, context);
    return kept;
  });
}

SubspacePointer loaded(const std::filesystem::path& file, const MeshPointer& mesh, const AnnotationPointer& annotation,
                       const RunArguments& arguments) {
  return run(arguments, [&](RunContext& context) {
    auto kept = std::make_shared<KeptSubspace>();
    kept->mesh = mesh;
    kept->annotation =
        std::make_shared<Annotation>(Annotation{made_consistent(*mesh, annotation->value, context), mesh});
    kept->subspace = read_subspace(file, *mesh, kept->annotation->value, context);
    return kept;
  });
}

py::tuple state_of(const KeptSubspace& kept) {
  const ScratchFile file;
  write_subspace(file.name(), kept.subspace, *kept.mesh, kept.annotation->value);
  std::ifstream stream(file.name(), std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  return py::make_tuple(std::const_pointer_cast<Mesh>(kept.mesh), kept.annotation, py::bytes(bytes));
}

SubspacePointer subspace_from_state(const py::tuple& state) {
  auto kept = std::make_shared<KeptSubspace>();
  kept->mesh = state[0].cast<std::shared_ptr<Mesh>>();
  kept->annotation = std::make_shared<Annotation>(Annotation{state[1].cast<AnnotationPointer>()->value, kept->mesh});
  const ScratchFile file;
  std::ofstream(file.name(), std::ios::binary) << state[2].cast<std::string>();
  kept->subspace = read_subspace(file.name(), *kept->mesh, kept->annotation->value, RunContext{});
  return kept;
}

Points lifted(const KeptSubspace& kept, const py::handle& q, std::optional<int> threads) {
  const SubspaceState state = state_from(kept, q);
  RunContext context;
  context.threads = threads.value_or(1);
  const py::gil_scoped_release release;
  return vertex_displacements(kept.subspace, state, context);
}

// U, column by column: the samples' displacements for each coordinate alone.
DoubleArray basis_of(const KeptSubspace& kept) {
  using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Dense basis(3 * kept.subspace.samples().rows(), kept.subspace.degrees_of_freedom());
  for (Eigen::Index j = 0; j < basis.cols(); ++j) {
    const Points column = sample_displacements(kept.subspace, Eigen::VectorXd::Unit(basis.cols(), j));
    basis.col(j) = column.reshaped<Eigen::RowMajor>();
  }
  return owning(std::move(basis));
}

using Class = py::class_<KeptSubspace, SubspacePointer>;

void define_building(Class& subspace) {
  subspace
      .def(py::init([](const MeshLike& mesh_like, const Annotation& annotation, const std::string& mode,
                       std::optional<double> radius, std::optional<int> samples, const std::string& lift,
                       const std::optional<ArrayLike>& relative_radii, bool sharp_features_first, std::uint64_t seed,
                       std::optional<int> threads, std::optional<double> timeout, const Progress& progress) {
             const MeshPointer mesh = mesh_from(mesh_like);
             require_fit(annotation.value, *mesh);
             return built(mesh, annotation.value,
                          subspace_options(mode, lift, radius, samples, relative_radii, sharp_features_first, *mesh),
                          {seed, threads, timeout, progress});
           }),
           py::arg("mesh"), py::arg("annotation"), py::kw_only(), py::arg("mode") = "floating",
           py::arg("radius") = py::none(), py::arg("samples") = py::none(), py::arg("lift") = "orbit",
           py::arg("relative_radii") = py::none(), py::arg("sharp_features_first") = false, seed_argument(),
           threads_argument(), timeout_argument(), progress_argument(),
           "Samples the mesh symmetrically and builds the basis.\n\n"
           "Args:\n"
           "    mesh: see :meth:`Mesh.of`.\n"
           "    annotation: of the mesh; made consistent first, see :meth:`Annotation.consistent`.\n"
           "    mode: what may become of the groups: 'fixed', 'floating' (each moved by a translation) or 'moving'\n"
           "        (each by a rigid motion).\n"
           "    radius: of sampling, in the mesh's unit; chosen for about 200 degrees of freedom if not given.\n"
           "    samples: number of samples to aim at instead.\n"
           "    lift: 'orbit', exact in every region, or 'paper', which is not on partial ones.\n"
           "    relative_radii: (n,), > 0: the radius at each vertex relative to `radius`; see :func:`radius_field`.\n"
           "    sharp_features_first: sample sharp edges and corners first.\n" ORBIFIT_RUN_DOC
           "\nRaises:\n"
           "    InputError: a mesh without area, orbits that do not close, an annotation of another mesh.\n"
           "    UsageError: an option out of range.")
      .def_static(
          "load",
          [](const PathLike& file, const MeshLike& mesh, const AnnotationPointer& annotation,
             std::optional<int> threads) {
            return loaded(path_from(file), mesh_from(mesh), annotation, {1, threads, {}, Progress(py::none())});
          },
          py::arg("file"), py::arg("mesh"), py::arg("annotation"), py::kw_only(), threads_argument(),
          "The subspace as it was saved: its displacements are the same bytes.\n\n"
          "Raises:\n"
          "    InputError: no such file, or it is damaged or of another mesh or annotation.")
      .def(
          "save",
          [](const KeptSubspace& kept, const PathLike& file) {
            write_subspace(path_from(file), kept.subspace, *kept.mesh, kept.annotation->value);
          },
          py::arg("file"), "Writes the subspace for the mesh and annotation that it was built from.")
      .def(py::pickle(&state_of, &subspace_from_state));
}

void define_parts(Class& subspace) {
  subspace
      .def_property_readonly(
          "mesh", [](const KeptSubspace& kept) { return std::const_pointer_cast<Mesh>(kept.mesh); }, "At rest.")
      .def_property_readonly(
          "annotation", [](const KeptSubspace& kept) { return kept.annotation; }, "Of the groups that it keeps.")
      .def_property_readonly(
          "mode", [](const KeptSubspace& kept) { return to_string(kept.subspace.mode()); },
          "'fixed', 'floating' or 'moving'.")
      .def_property_readonly(
          "degrees_of_freedom", [](const KeptSubspace& kept) { return kept.subspace.degrees_of_freedom(); },
          "Number of coordinates.")
      .def_property_readonly(
          "radius", [](const KeptSubspace& kept) { return kept.subspace.radius(); }, "Of sampling, in the mesh's unit.")
      .def_property_readonly(
          "samples",
          [](const py::object& self) { return view_of(self.cast<const KeptSubspace&>().subspace.samples(), self); },
          "(s, 3): the samples at rest, orbit by orbit.")
      .def_property_readonly("basis", &basis_of,
                             "(3 s, degrees_of_freedom): what a coordinate makes of the samples' displacements, x0 y0 "
                             "z0 x1 ...; dense, made anew at each use.");
}

void define_displacements(Class& subspace) {
  subspace
      .def(
          "lift",
          [](const KeptSubspace& kept, const StateLike& q, std::optional<int> threads) {
            return owning(lifted(kept, q, threads));
          },
          py::arg("q"), py::kw_only(), py::arg("threads") = 1,
          "(n, 3): displacements of the vertices. Images of a vertex move exactly as it does.\n\n"
          "Args:\n"
          "    q: coordinates, (degrees_of_freedom,), or a :class:`Deformation`.\n"
          "    threads: one is enough for most meshes.")
      .def(
          "deformed",
          [](const KeptSubspace& kept, const StateLike& q) {
            auto mesh = std::make_shared<Mesh>(*kept.mesh);
            mesh->vertices += lifted(kept, q, 1);
            return mesh;
          },
          py::arg("q"), "The mesh as coordinates, or a :class:`Deformation`, move it.")
      .def(
          "annotation_of",
          [](const KeptSubspace& kept, const StateLike& q) {
            const SubspaceState state = state_from(kept, q);
            auto mesh = std::make_shared<Mesh>(*kept.mesh);
            mesh->vertices += lifted(kept, q, 1);
            return std::make_shared<Annotation>(
                Annotation{deformed_annotation(kept.annotation->value, kept.subspace, state, *mesh), mesh});
          },
          py::arg("q"), "The annotation of the mesh so moved: its regions' groups go along.")
      .def(
          "residuals",
          [](const KeptSubspace& kept, const StateLike& q, std::uint64_t seed, std::optional<int> threads,
             std::optional<double> timeout, const Progress& progress) {
            const SubspaceState state = state_from(kept, q);
            const std::vector<Residual> residuals = run({seed, threads, timeout, progress}, [&](RunContext& context) {
              return field_residuals(kept.subspace, *kept.mesh, kept.annotation->value, state, context);
            });
            Eigen::VectorXd largest(static_cast<Eigen::Index>(residuals.size()));
            for (Eigen::Index r = 0; r < largest.size(); ++r) largest[r] = residuals[static_cast<std::size_t>(r)].max;
            return owning(std::move(largest));
          },
          py::arg("q"), py::kw_only(), seed_argument(), threads_argument(), timeout_argument(), progress_argument(),
          "(regions,): how far each region's displacement is from symmetric, fraction of the diagonal: rounding.")
      .def("__repr__", [](const KeptSubspace& kept) {
        return "<orbifit.Subspace: " +
               count_text(static_cast<std::size_t>(kept.subspace.degrees_of_freedom()), "degree") + " of freedom, " +
               count_text(static_cast<std::size_t>(kept.subspace.samples().rows()), "sample") + ", " +
               to_string(kept.subspace.mode()) + ">";
      });
}

void define_radius_field(py::module_& module) {
  module.def(
      "radius_field",
      [](const MeshLike& mesh_like, double base, const std::vector<std::tuple<ArrayLike, double, double>>& areas,
         bool feature_size, double smallest, double largest, double gradation, std::uint64_t seed,
         std::optional<int> threads, std::optional<double> timeout, const Progress& progress) {
        RadiusFieldOptions options;
        options.base = base;
        for (const auto& [centre, radius, factor] : areas) {
          options.areas.push_back({vector_from(centre, "centre"), radius, factor});
        }
        options.feature_size = feature_size;
        options.smallest = smallest;
        options.largest = largest;
        options.gradation = gradation;
        options.validate();
        const MeshPointer mesh = mesh_from(mesh_like);
        return owning(run({seed, threads, timeout, progress},
                          [&](RunContext& context) { return radius_field(*mesh, options, context); }));
      },
      py::arg("mesh"), py::arg("base"), py::kw_only(),
      py::arg("areas") = std::vector<std::tuple<ArrayLike, double, double>>{}, py::arg("feature_size") = false,
      py::arg("smallest") = 0.5, py::arg("largest") = 1.0, py::arg("gradation") = 0.5, seed_argument(),
      threads_argument(), timeout_argument(), progress_argument(),
      "(n,): a sampling radius for each vertex, in the mesh's unit; divided by `base` it is what :class:`Subspace` "
      "takes as `relative_radii`.\n\n"
      "Args:\n"
      "    base: the radius where nothing else is said.\n"
      "    areas: (centre, radius, factor): painted spheres in which the radius is `factor` of the base.\n"
      "    feature_size: finer on thin parts: half their thickness, from `smallest` to `largest` of the base.\n"
      "    gradation: how fast the radius may grow with distance.\n" ORBIFIT_RUN_DOC
      "\nRaises:\n"
      "    UsageError: a number out of range.");
}

}  // namespace

GroupMode mode_from(const std::string& text) {
  for (const GroupMode mode : {GroupMode::fixed, GroupMode::floating, GroupMode::moving}) {
    if (to_string(mode) == text) return mode;
  }
  throw UsageError("mode is '" + text + "'; it must be 'fixed', 'floating' or 'moving'");
}

LiftKind lift_kind_from(const std::string& text) {
  for (const LiftKind kind : {LiftKind::paper, LiftKind::orbit}) {
    if (to_string(kind) == text) return kind;
  }
  throw UsageError("lift is '" + text + "'; it must be 'orbit' or 'paper'");
}

SubspaceOptions subspace_options(const std::string& mode, const std::string& lift, std::optional<double> radius,
                                 std::optional<int> samples, const std::optional<ArrayLike>& relative_radii,
                                 bool sharp_features_first, const Mesh& mesh) {
  SubspaceOptions options;
  options.mode = mode_from(mode);
  options.lift = lift_kind_from(lift);
  if (radius && !(*radius > 0)) throw UsageError("radius is " + std::to_string(*radius) + "; it must be above 0");
  if (radius && samples) throw UsageError("radius and samples cannot both be given");
  options.radius = radius.value_or(0);
  options.samples = samples.value_or(0);
  if (relative_radii) options.relative_radii = numbers_from(*relative_radii, "relative_radii", mesh.vertices.rows());
  options.sharp_features_first = sharp_features_first;
  options.validate();
  return options;
}

void define_subspace(py::module_& module) {
  Class subspace(module, "Subspace",
                 "The displacements of a mesh that keep every symmetry of its annotation: coordinates q, samples, "
                 "vertices. Pickles hold the mesh and the annotation too.");
  define_building(subspace);
  define_parts(subspace);
  define_displacements(subspace);
  define_radius_field(module);
}

}  // namespace orbifit::python
