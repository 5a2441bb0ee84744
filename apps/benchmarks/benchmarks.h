#pragma once

#include "command.h"

namespace orbifit::benchmarks {

/// The subcommands: each adds its options to `app` and returns what runs it.
CommandBody table1(CLI::App& app);
CommandBody scaling(CLI::App& app);
CommandBody baselines(CLI::App& app);
CommandBody detection(CLI::App& app);
CommandBody fitting(CLI::App& app);
CommandBody moving(CLI::App& app);
CommandBody proxies(CLI::App& app);
CommandBody real(CLI::App& app);
CommandBody scans(CLI::App& app);
CommandBody batch(CLI::App& app);

}  // namespace orbifit::benchmarks
