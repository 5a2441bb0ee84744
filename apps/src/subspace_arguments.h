#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace orbifit {

/// What subspace, deform, fit and edit are told about the subspace to build.
struct SubspaceArguments {
  SubspaceOptions options;
  std::string radius_field;  ///< file, or empty
};

/// Adds --mode alone.
void add_mode_option(CLI::App& app, GroupMode& mode);

/// Adds --mode, --lift, --radius, --samples, --sharp-features and --radius-field.
void add_subspace_options(CLI::App& app, SubspaceArguments& arguments);

/// Makes an option useless together with any of those.
void exclude_subspace_options(CLI::App& app, CLI::Option& option);

/// Adds --without, which takes the ids of regions.
void add_without_option(CLI::App& app, std::vector<int>& ids);

/// The annotation without the regions that --without names. \throw UsageError naming one that it has not
SymmetryAnnotation without(const std::vector<int>& ids, SymmetryAnnotation annotation);

/// The options with the radius field, if there is one, drawn up for a mesh: for the radius given, or else for the one
/// that the number of samples suggests.
/// \throw UsageError, InputError
SubspaceOptions subspace_options(const SubspaceArguments& arguments, const Mesh& mesh, const RunContext& context);

/// Makes the annotation consistent, which tells what it leaves out (consistent_annotation.h), and builds the subspace
/// of what `annotation` becomes. \throw InputError as build_subspace does
Subspace build_consistent(const Mesh& mesh, SymmetryAnnotation& annotation, const SubspaceOptions& options,
                          const RunContext& context);

}  // namespace orbifit
