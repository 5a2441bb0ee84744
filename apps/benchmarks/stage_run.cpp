#include "stage_run.h"

#include <CLI/CLI.hpp>

#include "orbifit/model/errors.h"

namespace orbifit::benchmarks {

void add_stage_run(CLI::App& app, StageRun& run, const std::string& of) {
  app.add_option("--seed", run.seed, "Of " + of)->capture_default_str();
  app.add_option("--threads", run.threads, "Threads to use")->type_name("N")->capture_default_str();
}

RunContext stage_context(const CommandContext& given, const StageRun& run) {
  if (run.threads < 1 || run.threads > 4096) {
    throw UsageError("--threads is " + std::to_string(run.threads) + ": must be from 1 to 4096");
  }
  RunContext context = given.run;
  context.on_message = nullptr;
  context.threads = run.threads;
  context.seed = run.seed;
  return context;
}

}  // namespace orbifit::benchmarks
