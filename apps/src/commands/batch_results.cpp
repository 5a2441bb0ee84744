#include "batch_results.h"

#include <CLI/CLI.hpp>

namespace orbifit::commands {

std::function<std::optional<int>(CommandContext&)> define_batch_results(CLI::App&) {
  return [](CommandContext&) -> std::optional<int> { return std::nullopt; };
}

}  // namespace orbifit::commands
