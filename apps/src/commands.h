#pragma once

#include <span>

#include "command.h"

/// One function a subcommand: adds its options to `app` and returns what runs once they are parsed. Each stands in
/// commands/NAME.cpp; the table in main.cpp gives its name, summary and examples. A command may be a program of its
/// own.
namespace orbifit::commands {

CommandBody annotate(CLI::App& app);
CommandBody batch(CLI::App& app);
CommandBody check(CLI::App& app);
CommandBody compare(CLI::App& app);
CommandBody convert(CLI::App& app);
CommandBody deform(CLI::App& app);
CommandBody detect(CLI::App& app);
CommandBody edit(CLI::App& app);
CommandBody fit(CLI::App& app);
CommandBody generate(CLI::App& app);
CommandBody info(CLI::App& app);
CommandBody render(CLI::App& app);
CommandBody report(CLI::App& app);
CommandBody scan(CLI::App& app);
CommandBody subspace(CLI::App& app);
CommandBody symmetrize(CLI::App& app);

/// The program's table of commands, for those that call others.
std::span<const Command> all();

/// orbifit starts it; the function above stands in that program alone, which links what is under the GPL.
inline constexpr Command kCompare{
    "compare",
    "Compare with least-squares baselines: the same fit by several methods, side by side.",
    "orbifit compare fan.ply scan.ply --annotation fan.json -o comparison\n"
    "orbifit compare chair.ply scan.ply --annotation chair.json --truth chair_true.ply --aligned -o comparison\n"
    "orbifit compare chair.ply scan.ply --annotation chair.json --methods ours,kurz --brief -o comparison",
    nullptr,
    "orbifit-compare",
};

}  // namespace orbifit::commands
