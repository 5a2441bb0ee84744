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
  double max_residual = 0;
  bool no_contacts = false;
  SubspaceArguments subspace;
};

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

}  // namespace

CommandBody deform(CLI::App& app) {
  const auto arguments = std::make_shared<DeformArguments>();
  app.add_option("MESH", arguments->mesh, "Mesh to edit")->required();
  app.add_option("ANNOTATION", arguments->annotation, "Its annotation (.json)")->required();
  app.add_option("--handles", arguments->handles, "Handles and their motions (.json)")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output, "Edited mesh to write")->required()->type_name("FILE");
  app.add_option("--annotation-out", arguments->annotation_output, "Annotation of the edited mesh to write (.json)")
      ->type_name("FILE");
  app.add_option("--iterations", arguments->iterations,
                 "Number of co-rotated iterations, instead of the one in the handle file")
      ->check(CLI::Range(1, 100000))
      ->type_name("N");
  app.add_option("--laplacian", arguments->laplacian, "Laplacian of the samples: graph, cotangent or point")
      ->check(CLI::IsMember({"graph", "cotangent", "point"}))
      ->capture_default_str();
  app.add_flag("--no-contacts", arguments->no_contacts, "Allow parts that touch at rest to come apart");
  auto* basis = app.add_option("--basis", arguments->basis,
                               "Basis stored by 'orbifit subspace -o', to load instead of building it")
                    ->type_name("FILE");
  app.add_option(
         "--max-residual", arguments->max_residual,
         "Write nothing and exit with 1 if the symmetry residual of the edit exceeds this fraction of the diagonal")
      ->type_name("R");
  add_without_option(app, arguments->without);
  add_subspace_options(app, arguments->subspace);
  exclude_subspace_options(app, *basis);
  return [arguments, &app](CommandContext& context) {
    arguments->subspace.options.validate();
    const bool limited = app.count("--max-residual") > 0;
    if (limited && !(arguments->max_residual >= 0)) {
      throw UsageError("--max-residual is " + short_number(arguments->max_residual) + ": must be at least 0");
    }
    const std::string& radius_field = arguments->subspace.radius_field;
    check_output(arguments->output, {}, {arguments->annotation, arguments->handles, arguments->basis, radius_field});
    if (!arguments->annotation_output.empty()) {
      check_output(arguments->annotation_output, {".json"},
                   {arguments->mesh, arguments->handles, arguments->output, arguments->basis, radius_field});
    }
    const Mesh mesh = read_mesh(arguments->mesh);
    const SymmetryAnnotation annotation =
        made_consistent(mesh, without(arguments->without, read_annotation(arguments->annotation, mesh)), context.run);
    HandleSet set = read_handles(arguments->handles, mesh);
    if (arguments->iterations > 0) set.iterations = arguments->iterations;

    const bool loads = !arguments->basis.empty();
    const SubspaceOptions options = subspace_options(arguments->subspace, mesh, context.run);
    const auto start = Clock::now();
    const Subspace built = loads ? read_subspace(arguments->basis, mesh, annotation, context.run)
                                 : build_subspace(mesh, annotation, options, context.run);
    const auto with_subspace = Clock::now();
    context.run.progress("handles", 0);
    DeformerOptions editing;
    editing.laplacian = parse_laplacian_kind(arguments->laplacian).value();
    editing.contacts = !arguments->no_contacts;
    Deformer deformer(built, mesh, editing, context.run);
    deformer.set_handles(set.handles, set.alpha);
    const auto factorised = Clock::now();
    std::vector<Motion> motions;
    for (const Handle& handle : set.handles) motions.push_back(handle.motion);
    const Deformation deformation = deformer.solve(motions, set.iterations);
    const auto solved = Clock::now();
    Mesh edited = mesh;
    edited.vertices += vertex_displacements(built, deformation.state, context.run);
    const auto lifted = Clock::now();
    const double worst_field = worst_field_residual(built, mesh, annotation, deformation.state, context.run);
    const std::vector<std::string> warnings = edit_warnings(mesh, annotation, built, set.handles, edited, worst_field);
    for (const std::string& warning : warnings) context.run.message("warning: " + warning);
    context.run.check();
    const bool within = !limited || worst_field <= arguments->max_residual;
    const std::string refusal = "the edit is only " + exactness(worst_field) + ", above --max-residual " +
                                short_number(arguments->max_residual) + "; nothing was written";
    if (!within && !context.json) throw NoResultError(refusal);
    if (within) write_edited(arguments->output, arguments->mesh, edited, context.run);
    if (within && !arguments->annotation_output.empty()) {
      write_annotation(arguments->annotation_output, deformed_annotation(annotation, built, deformation.state, edited));
    }

    const double size = diagonal(mesh.vertices);
    const double missed = deformation.handle_error / size;
    if (context.json) {
      const nlohmann::ordered_json summary{{"mode", to_string(built.mode())},
                                           {"lift", to_string(built.lift_kind())},
                                           {"basis", loads ? "loaded" : "built"},
                                           {"samples", built.samples().rows()},
                                           {"degrees_of_freedom", built.degrees_of_freedom()},
                                           {"handles", set.handles.size()},
                                           {"contacts", deformer.contacts()},
                                           {"iterations", set.iterations},
                                           {"energy", deformation.energy},
                                           {"handle_error", missed},
                                           {"last_change", deformation.last_change / size},
                                           {"field_residual", worst_field},
                                           {"warnings", warnings},
                                           {"written", within},
                                           {"milliseconds",
                                            {{"subspace", milliseconds(start, with_subspace)},
                                             {"prefactor", milliseconds(with_subspace, factorised)},
                                             {"solve", milliseconds(factorised, solved)},
                                             {"lift", milliseconds(solved, lifted)}}}};
      print(context, summary.dump(2) + "\n");
      if (!within) throw NoResultError(refusal);
      return kDone;
    }
    print(context, arguments->output + ": " + count_of(static_cast<long long>(set.handles.size()), "handle") + ", " +
                       count_of(built.degrees_of_freedom(), "degree of freedom", "degrees of freedom") + ", " +
                       exactness(worst_field) + ", handles missed by " + short_number(100 * missed, 3) +
                       " % of the diagonal\n" + (loads ? "basis loaded " : "subspace ") +
                       short_number(milliseconds(start, with_subspace), 3) + " ms, prefactor " +
                       short_number(milliseconds(with_subspace, factorised), 3) + " ms, " +
                       count_of(set.iterations, "iteration") + " " + short_number(milliseconds(factorised, solved), 3) +
                       " ms, lift " + short_number(milliseconds(solved, lifted), 3) + " ms\n");
    return kDone;
  };
}

}  // namespace orbifit::commands
