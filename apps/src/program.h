#pragma once

#include <span>

#include "command.h"

namespace orbifit {

/// Runs the command that the arguments name, by this program or by the one that does it. Messages go to stderr.
/// \param argv  its first name is that of the program, its second one that of the command
/// \return the exit code
int run_program(std::span<const Command> commands, int argc, char** argv);

}  // namespace orbifit
