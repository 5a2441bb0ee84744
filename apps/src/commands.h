#pragma once

#include "command.h"

/// One function a subcommand: adds its options to `app` and returns what runs once they are parsed. Each stands in
/// commands/NAME.cpp; the table in main.cpp gives its name, summary and examples.
namespace orbifit::commands {

CommandBody annotate(CLI::App& app);
CommandBody check(CLI::App& app);
CommandBody compare(CLI::App& app);
CommandBody convert(CLI::App& app);
CommandBody deform(CLI::App& app);
CommandBody detect(CLI::App& app);
CommandBody fit(CLI::App& app);
CommandBody generate(CLI::App& app);
CommandBody info(CLI::App& app);
CommandBody render(CLI::App& app);
CommandBody report(CLI::App& app);
CommandBody scan(CLI::App& app);
CommandBody subspace(CLI::App& app);
CommandBody symmetrize(CLI::App& app);

}  // namespace orbifit::commands
