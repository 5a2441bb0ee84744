#pragma once

#include <functional>
#include <optional>

#include "../command.h"

namespace orbifit::commands {

/// Adds what one does before and after a batch: `batch manifest`, `status`, `report` and `export`.
/// \return runs the one that was called, if any, and gives its exit code
std::function<std::optional<int>(CommandContext&)> define_batch_results(CLI::App& batch);

}  // namespace orbifit::commands
