#pragma once

#include <cstdint>

#include "command.h"

namespace orbifit::benchmarks {

/// How the stages that a benchmark measures are run.
struct StageRun {
  int threads = 1;
  std::uint64_t seed = 1;
};

/// Adds --threads and --seed. \param of  what the seed is of, for the help
void add_stage_run(CLI::App& app, StageRun& run, const std::string& of);

/// The benchmark's context with these threads and this seed, without the stages' own messages.
/// \throw UsageError for threads not from 1 to 4096
RunContext stage_context(const CommandContext& given, const StageRun& run);

}  // namespace orbifit::benchmarks
