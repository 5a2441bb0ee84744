#include <chrono>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/displacement_field.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace_io.h"

#include "../commands.h"
#include "../edit_warnings.h"
#include "../subspace_arguments.h"

namespace orbifit::commands {

namespace {

struct DeformArguments {
  std::string mesh, annotation, handles, output, annotation_output, basis;
  std::string laplacian = "graph";
  int iterations = 0;
  std::vector<int> without;
  bool limited = false;  // by --max-residual
  double max_residual = 0;
  bool no_contacts = false;
  SubspaceArguments subspace;
};

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

void add_options(CLI::App& app, DeformArguments& arguments) {
  app.add_option("MESH", arguments.mesh, "Mesh to edit")->required();
  app.add_option("ANNOTATION", arguments.annotation, "Its annotation (.json)")->required();
  app.add_option("--handles", arguments.handles, "Handles and their motions (.json)")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments.output, "Edited mesh to write")->required()->type_name("FILE");
  app.add_option("--annotation-out", arguments.annotation_output, "Annotation of the edited mesh to write (.json)")
      ->type_name("FILE");
  app.add_option("--iterations", arguments.iterations,
                 "Number of co-rotated iterations, instead of the one in the handle file")
      ->check(CLI::Range(1, 100000))
      ->type_name("N");
  app.add_option("--laplacian", arguments.laplacian, "Laplacian of the samples: graph, cotangent or point")
      ->check(CLI::IsMember({"graph", "cotangent", "point"}))
      ->capture_default_str();
  app.add_flag("--no-contacts", arguments.no_contacts, "Allow parts that touch at rest to come apart");
  auto* basis = app.add_option("--basis", arguments.basis,
                               "Basis stored by 'orbifit subspace -o', to load instead of building it")
                    ->type_name("FILE");
  app.add_option(
         "--max-residual", arguments.max_residual,
         "Write nothing and exit with 1 if the symmetry residual of the edit exceeds this fraction of the diagonal")
      ->type_name("R");
  add_without_option(app, arguments.without);
  add_subspace_options(app, arguments.subspace);
  exclude_subspace_options(app, *basis);
}

void check_arguments(const DeformArguments& arguments) {
  arguments.subspace.options.validate();
  if (arguments.limited && !(arguments.max_residual >= 0)) {
    throw UsageError("--max-residual is " + short_number(arguments.max_residual) + ": must be at least 0");
  }
  const std::string& radius_field = arguments.subspace.radius_field;
  check_output(arguments.output, {}, {arguments.annotation, arguments.handles, arguments.basis, radius_field});
  if (arguments.annotation_output.empty()) return;
  check_output(arguments.annotation_output, {".json"},
               {arguments.mesh, arguments.handles, arguments.output, arguments.basis, radius_field});
}

// An edit, with what its stages took.
struct Edit {
  Subspace subspace;
  Deformation deformation;
  std::size_t contacts;
  Mesh edited;
  double field_residual;  // the worst, of the diagonal
  double subspace_ms, prefactor_ms, solve_ms, lift_ms;
};

Edit make_edit(const Mesh& mesh, const SymmetryAnnotation& annotation, const HandleSet& set,
               const DeformArguments& arguments, const RunContext& context) {
  const SubspaceOptions options = subspace_options(arguments.subspace, mesh, context);
  const auto start = Clock::now();
  const Subspace subspace = arguments.basis.empty() ? build_subspace(mesh, annotation, options, context)
                                                    : read_subspace(arguments.basis, mesh, annotation, context);
  const auto with_subspace = Clock::now();
  context.progress("handles", 0);
  DeformerOptions editing;
  editing.laplacian = parse_laplacian_kind(arguments.laplacian).value();
  editing.contacts = !arguments.no_contacts;
  Deformer deformer(subspace, mesh, editing, context);
  deformer.set_handles(set.handles, set.alpha);
  const auto factorised = Clock::now();
  std::vector<Motion> motions;
  for (const Handle& handle : set.handles) motions.push_back(handle.motion);
  const Deformation deformation = deformer.solve(motions, set.iterations);
  const auto solved = Clock::now();
  Mesh edited = mesh;
  edited.vertices += vertex_displacements(subspace, deformation.state, context);
  const auto lifted = Clock::now();
  return {subspace,
          deformation,
          deformer.contacts(),
          edited,
          worst_field_residual(subspace, mesh, annotation, deformation.state, context),
          milliseconds(start, with_subspace),
          milliseconds(with_subspace, factorised),
          milliseconds(factorised, solved),
          milliseconds(solved, lifted)};
}

nlohmann::ordered_json to_json(const Edit& edit, const HandleSet& set, const DeformArguments& arguments, double size,
                               const std::vector<std::string>& warnings, bool written) {
  return {{"mode", to_string(edit.subspace.mode())},
          {"lift", to_string(edit.subspace.lift_kind())},
          {"basis", arguments.basis.empty() ? "built" : "loaded"},
          {"samples", edit.subspace.samples().rows()},
          {"degrees_of_freedom", edit.subspace.degrees_of_freedom()},
          {"handles", set.handles.size()},
          {"contacts", edit.contacts},
          {"iterations", set.iterations},
          {"energy", edit.deformation.energy},
          {"handle_error", edit.deformation.handle_error / size},
          {"last_change", edit.deformation.last_change / size},
          {"field_residual", edit.field_residual},
          {"warnings", warnings},
          {"written", written},
          {"milliseconds",
           {{"subspace", edit.subspace_ms},
            {"prefactor", edit.prefactor_ms},
            {"solve", edit.solve_ms},
            {"lift", edit.lift_ms}}}};
}

std::string to_text(const Edit& edit, const HandleSet& set, const DeformArguments& arguments, double size) {
  return arguments.output + ": " + count_of(static_cast<long long>(set.handles.size()), "handle") + ", " +
         count_of(edit.subspace.degrees_of_freedom(), "degree of freedom", "degrees of freedom") + ", " +
         exactness(edit.field_residual) + ", handles missed by " +
         short_number(100 * edit.deformation.handle_error / size, 3) + " % of the diagonal\n" +
         (arguments.basis.empty() ? "subspace " : "basis loaded ") + short_number(edit.subspace_ms, 3) +
         " ms, prefactor " + short_number(edit.prefactor_ms, 3) + " ms, " + count_of(set.iterations, "iteration") +
         " " + short_number(edit.solve_ms, 3) + " ms, lift " + short_number(edit.lift_ms, 3) + " ms\n";
}

int run(const DeformArguments& arguments, CommandContext& context) {
  check_arguments(arguments);
  const Mesh mesh = read_mesh(arguments.mesh);
  const SymmetryAnnotation annotation =
      made_consistent(mesh, without(arguments.without, read_annotation(arguments.annotation, mesh)), context.run);
  HandleSet set = read_handles(arguments.handles, mesh);
  if (arguments.iterations > 0) set.iterations = arguments.iterations;
  const Edit edit = make_edit(mesh, annotation, set, arguments, context.run);
  const std::vector<std::string> warnings =
      edit_warnings(mesh, annotation, edit.subspace, set.handles, edit.edited, edit.field_residual);
  for (const std::string& warning : warnings) context.run.message("warning: " + warning);
  context.run.check();
  const bool within = !arguments.limited || edit.field_residual <= arguments.max_residual;
  if (within) {
    write_edited(arguments.output, arguments.mesh, edit.edited, context.run);
    if (!arguments.annotation_output.empty()) {
      write_annotation(arguments.annotation_output,
                       deformed_annotation(annotation, edit.subspace, edit.deformation.state, edit.edited));
    }
  }
  const double size = diagonal(mesh.vertices);
  if (context.json) {
    print(context, to_json(edit, set, arguments, size, warnings, within).dump(2) + "\n");
  } else if (within) {
    print(context, to_text(edit, set, arguments, size));
  }
  if (!within) {
    throw NoResultError("the edit is only " + exactness(edit.field_residual) + ", above --max-residual " +
                        short_number(arguments.max_residual) + "; nothing was written");
  }
  return kDone;
}

}  // namespace

CommandBody deform(CLI::App& app) {
  const auto arguments = std::make_shared<DeformArguments>();
  add_options(app, *arguments);
  return [arguments, &app](CommandContext& context) {
    arguments->limited = app.count("--max-residual") > 0;
    return run(*arguments, context);
  };
}

}  // namespace orbifit::commands
