#pragma once

#include "orbifit/subspace/subspace.h"

namespace CLI {
class App;
}

namespace orbifit {

/// Adds --mode, --radius and --samples, which subspace, deform and fit share.
void add_subspace_options(CLI::App& app, SubspaceOptions& options);

}  // namespace orbifit
