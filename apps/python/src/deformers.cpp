#include "deformers.h"

#include <mutex>
#include <shared_mutex>

#include <pybind11/stl.h>

#include "orbifit/model/errors.h"

#include "run.h"
#include "verbs.h"

namespace orbifit::python {

namespace {

/// A deformer that several threads may use: solves at once, new handles alone.
class KeptDeformer {
 public:
  KeptDeformer(SubspacePointer of, const DeformerOptions& options, const RunContext& context)
      : of_(std::move(of)), deformer_(of_->subspace, *of_->mesh, options, context), threads_(context.threads) {}

  void set_handles(const std::vector<Handle>& handles, double alpha) {
    if (handles.empty()) throw UsageError("handles is empty");
    if (!(alpha > 0)) throw UsageError("alpha is " + std::to_string(alpha) + "; it must be above 0");
    run_released(arguments(), [&](RunContext&) {
      const std::unique_lock lock(mutex_);
      deformer_.set_handles(handles, alpha);
      handles_ = handles;
    });
  }

  Deformation solve(std::optional<std::vector<Motion>> motions, int iterations, const SubspaceState& start) {
    if (iterations < 1) throw UsageError("iterations is " + std::to_string(iterations) + "; it must be at least 1");
    const auto solved = [&](const RunContext& context) {
      const std::shared_lock lock(mutex_);
      if (handles_.empty()) throw UsageError("solve() without handles: call set_handles() first");
      if (!motions) {
        motions.emplace();
        for (const Handle& handle : handles_) motions->push_back(handle.motion);
      }
      if (motions->size() != handles_.size()) {
        throw UsageError("motions has " + std::to_string(motions->size()) + " of them; there are " +
                         count_text(handles_.size(), "handle"));
      }
      return deformer_.solve(*motions, iterations, start, &context);
    };
    if (!is_short(iterations)) return run(arguments(), solved);
    const py::gil_scoped_release release;
    return solved(RunContext{});
  }

  const SubspacePointer& of() const { return of_; }
  std::size_t contacts() const { return deformer_.contacts(); }

 private:
  // Whether a solve is over before anybody would want it stopped, so that a thread to wait for it is not worth its 25
  // microseconds: at O(DoF^2) an iteration within some 10 ms.
  bool is_short(int iterations) const {
    constexpr double kShort = 1e7;  // products
    const auto freedom = static_cast<double>(of_->subspace.degrees_of_freedom());
    return of_->subspace.mode() != GroupMode::moving && iterations * freedom * freedom < kShort;
  }

  RunArguments arguments() const { return {1, threads_, {}, Progress(py::none())}; }

  SubspacePointer of_;
  Deformer deformer_;  // never asks the context that it keeps, which ends with the call that made it
  int threads_;
  std::shared_mutex mutex_;
  std::vector<Handle> handles_;
};

LaplacianKind laplacian_from(const std::string& text) {
  const auto kind = parse_laplacian_kind(text);
  if (!kind) throw UsageError("laplacian is '" + text + "'; it must be 'graph', 'cotangent' or 'point'");
  return *kind;
}

void define_handle(py::module_& module) {
  py::class_<Handle, std::shared_ptr<Handle>>(module, "Handle", "A part of the surface that is held or moved.")
      .def(py::init([](const ArrayLike& vertices, const std::optional<ArrayLike>& motion, const std::string& name) {
             auto handle = std::make_shared<Handle>();
             handle->name = name;
             handle->vertices = index_set_from(vertices, "vertices", std::numeric_limits<int>::max());
             if (motion) handle->motion = motion_from(*motion, "motion");
             return handle;
           }),
           py::arg("vertices"), py::arg("motion") = py::none(), py::kw_only(), py::arg("name") = "",
           "Args:\n"
           "    vertices: their numbers.\n"
           "    motion: where they shall go, (3, 4) or (4, 4), a Euclidean motion; without one they are held.\n"
           "    name: for people.")
      .def_static(
          "near",
          [](const MeshLike& mesh_like, const ArrayLike& centre, double radius, const std::optional<ArrayLike>& motion,
             const std::string& name) {
            const MeshPointer mesh = mesh_from(mesh_like);
            const Eigen::RowVector3d point = vector_from(centre, "centre").transpose();
            auto handle = std::make_shared<Handle>();
            handle->name = name;
            for (int v = 0; v < mesh->vertices.rows(); ++v) {
              if ((mesh->vertices.row(v) - point).norm() <= radius) handle->vertices.push_back(v);
            }
            if (handle->vertices.empty()) throw InputError("", "handle", "takes no vertex: none is that near");
            if (motion) handle->motion = motion_from(*motion, "motion");
            return handle;
          },
          py::arg("mesh"), py::arg("centre"), py::arg("radius"), py::arg("motion") = py::none(), py::kw_only(),
          py::arg("name") = "", "A handle on all vertices within `radius` of `centre`, in the mesh's unit.")
      .def_property_readonly(
          "vertices", [](const py::object& self) { return view_of(self.cast<const Handle&>().vertices, self); },
          "Ascending, int32, read-only.")
      .def_property_readonly(
          "motion",
          [](const Handle& handle) {
            return matrix_of({1, handle.motion.linear, handle.motion.translation});
          },
          "(4, 4)")
      .def_readonly("name", &Handle::name, "For people.")
      .def("__repr__", [](const Handle& handle) {
        return "<orbifit.Handle: " + std::to_string(handle.vertices.size()) +
               (handle.vertices.size() == 1 ? " vertex" : " vertices") +
               (handle.name.empty() ? "" : ", '" + handle.name + "'") + ">";
      });
  module.def(
      "read_handles",
      [](const PathLike& file, const MeshLike& mesh) {
        std::vector<std::shared_ptr<Handle>> handles;
        for (Handle& handle : read_handles(path_from(file), *mesh_from(mesh)).handles) {
          handles.push_back(std::make_shared<Handle>(std::move(handle)));
        }
        return handles;
      },
      py::arg("file"), py::arg("mesh"),
      "Reads a file of handles as `orbifit deform` takes it.\n\n"
      "Raises:\n"
      "    InputError: naming the file and the key.");
}

void define_deformation(py::module_& module) {
  py::class_<KeptDeformation, std::shared_ptr<KeptDeformation>>(
      module, "Deformation", "What a solve of a :class:`Deformer` left; stands for its coordinates.")
      .def_property_readonly(
          "q",
          [](const py::object& self) { return view_of(self.cast<const KeptDeformation&>().deformation.state.q, self); },
          "(degrees_of_freedom,): coordinates in the subspace, read-only.")
      .def_property_readonly(
          "energy", [](const KeptDeformation& kept) { return kept.deformation.energy; },
          "The Laplace energy and what the handles miss, weighted.")
      .def_property_readonly(
          "handle_error", [](const KeptDeformation& kept) { return kept.deformation.handle_error; },
          "Root mean square distance of the handles from their targets, in the mesh's unit.")
      .def_property_readonly(
          "last_change", [](const KeptDeformation& kept) { return kept.deformation.last_change; },
          "Largest movement of a sample in the last iteration, in the mesh's unit.")
      .def("__repr__", [](const KeptDeformation& kept) {
        return "<orbifit.Deformation: handles missed by " +
               py::str(py::float_(kept.deformation.handle_error)).cast<std::string>() + ">";
      });
}

}  // namespace

std::vector<Handle> handles_from(const py::handle& handles, const Mesh& mesh) {
  std::vector<Handle> result;
  for (const py::handle item : handles) {
    Handle& handle = result.emplace_back();
    if (py::isinstance<Handle>(item)) {
      handle = item.cast<const Handle&>();
    } else {
      handle.vertices =
          index_set_from(item, "handles[" + std::to_string(result.size() - 1) + "]", mesh.vertices.rows());
    }
    const std::string place = "handles[" + std::to_string(result.size() - 1) + "]";
    if (handle.vertices.empty()) throw InputError("", place, "takes no vertex");
    if (handle.vertices.back() >= mesh.vertices.rows()) {
      throw InputError("", place,
                       "takes vertex " + std::to_string(handle.vertices.back()) + "; the mesh has " +
                           std::to_string(mesh.vertices.rows()));
    }
  }
  return result;
}

SubspaceState state_from(const KeptSubspace& kept, const py::handle& state) {
  if (!py::isinstance<KeptDeformation>(state)) {
    return {numbers_from(state, "q", kept.subspace.degrees_of_freedom()), nullptr};
  }
  const auto& deformation = state.cast<const KeptDeformation&>();
  if (&*deformation.of->subspace != &*kept.subspace) throw UsageError("the deformation is of another subspace");
  return deformation.deformation.state;
}

void define_deformer(py::module_& module) {
  define_handle(module);
  define_deformation(module);
  py::class_<KeptDeformer, std::shared_ptr<KeptDeformer>>(
      module, "Deformer",
      "Edits a mesh with handles within its symmetric subspace: factorise once for a set of handles, solve as often as "
      "they move. Threads may solve at once.")
      .def(py::init([](const SubspacePointer& subspace, const std::string& laplacian, bool contacts,
                       std::optional<int> threads) {
             const DeformerOptions options{laplacian_from(laplacian), contacts};
             return run({1, threads, {}, Progress(py::none())}, [&](RunContext& context) {
               return std::make_shared<KeptDeformer>(subspace, options, context);
             });
           }),
           py::arg("subspace"), py::kw_only(), py::arg("laplacian") = "graph", py::arg("contacts") = true,
           threads_argument(),
           "Args:\n"
           "    laplacian: of the samples: 'graph', 'cotangent' or 'point'.\n"
           "    contacts: parts that touch at rest stay in touch; not in mode 'fixed'.\n"
           "    threads: to use; all cores if not given.")
      .def(
          "set_handles",
          [](KeptDeformer& deformer, const py::iterable& handles, double alpha) {
            deformer.set_handles(handles_from(handles, *deformer.of()->mesh), alpha);
          },
          py::arg("handles"), py::arg("alpha") = HandleSet{}.alpha,
          "Factorises for a set of handles.\n\n"
          "Args:\n"
          "    handles: of :class:`Handle`, or lists of vertex numbers.\n"
          "    alpha: their weight against the Laplace energy.\n\n"
          "Raises:\n"
          "    InputError: a handle on no vertex, or on one that the mesh has not.")
      .def(
          "solve",
          [](KeptDeformer& deformer, const std::optional<ArrayLike>& motions, int iterations,
             const std::shared_ptr<KeptDeformation>& start) {
            std::optional<std::vector<Motion>> given;
            if (motions) given = motions_from(*motions, "motions");
            SubspaceState state;
            if (start) state = state_from(*deformer.of(), py::cast(start));
            return std::make_shared<KeptDeformation>(
                KeptDeformation{deformer.of(), deformer.solve(given, iterations, state)});
          },
          py::arg("motions") = py::none(), py::arg("iterations") = HandleSet{}.iterations, py::kw_only(),
          py::arg("start") = py::none(),
          "Solves for where the handles go.\n\n"
          "Args:\n"
          "    motions: one of each handle, (n, 3, 4) or (n, 4, 4); the handles' own if not given.\n"
          "    iterations: of the co-rotated solve.\n"
          "    start: the deformation to start from; rest if not given.\n\n"
          "Raises:\n"
          "    UsageError: before set_handles(), or with another number of motions.\n"
          "    InputError: a matrix that is no Euclidean motion.")
      .def_property_readonly(
          "subspace", [](const KeptDeformer& deformer) { return deformer.of(); }, "In which it edits.")
      .def_property_readonly("contacts", &KeptDeformer::contacts, "Number of places where parts are kept touching.")
      .def("__repr__", [](const KeptDeformer& deformer) {
        return "<orbifit.Deformer: " + to_string(deformer.of()->subspace.mode()) + ">";
      });
}

}  // namespace orbifit::python
