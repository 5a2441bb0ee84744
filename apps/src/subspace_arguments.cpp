#include "subspace_arguments.h"

#include <map>
#include <string>

#include <CLI/CLI.hpp>

namespace orbifit {

namespace {
const std::map<std::string, GroupMode> kModes{
    {"fixed", GroupMode::fixed}, {"floating", GroupMode::floating}, {"moving", GroupMode::moving}};
}

void add_subspace_options(CLI::App& app, SubspaceOptions& options) {
  app.add_option("--mode", options.mode,
                 "What may become of the groups: fixed (as they are), floating (each moved by a translation) or moving (each by a rigid motion)")
      ->transform(CLI::CheckedTransformer(kModes).description(""))
      ->type_name("MODE")
      ->default_str("floating");
  auto* radius =
      app.add_option("--radius", options.radius, "Sampling radius in the mesh's units: smaller edits, more unknowns");
  app.add_option("--samples", options.samples, "Number of samples to aim at instead of a radius")->excludes(radius);
}

}  // namespace orbifit
