#include <array>
#include <exception>
#include <string>

#include <CLI/CLI.hpp>

#include "orbifit/model/errors.h"

#include "benchmarks.h"
#include "console.h"
#include "interruption.h"

namespace {

using namespace orbifit;

constexpr std::array kBenchmarks{
    Command{"table1", "The paper's Table 1 beside ours, with the memory floor and the peers.",
            "orbifit-benchmark table1\n"
            "orbifit-benchmark table1 --models bar,car --threads 1 --json table1.json",
            benchmarks::table1},
    Command{"scaling", "Time and memory of building the subspace against the number of vertices.",
            "orbifit-benchmark scaling\n"
            "orbifit-benchmark scaling --most 1000000 --json scaling.json",
            benchmarks::scaling},
    Command{"detection", "What detection finds of the known symmetries of a suite of models, spoilt in several ways.",
            "orbifit-benchmark detection\n"
            "orbifit-benchmark detection --forms remesh --noise 0,0.001,0.003,0.01 --cut --json detection.json\n"
            "orbifit-benchmark detection --models none --write cases",
            benchmarks::detection},
    Command{"fitting", "How near fits come to shapes of which they have a part, beside what others do.",
            "orbifit-benchmark fitting\n"
            "orbifit-benchmark fitting --levels anywhere --methods ours --json fitting.json",
            benchmarks::fitting},
    Command{"baselines", "Ours beside least-squares methods: a fan and an armchair, scans and handles, three sizes.",
            "orbifit-benchmark baselines\n"
            "orbifit-benchmark baselines --families armchair --sizes 1 --json baselines.json",
            benchmarks::baselines},
    Command{"moving", "Our boxes around a mesh that moves, beside Embree's refitted tree.",
            "orbifit-benchmark moving\n"
            "orbifit-benchmark moving --models car,plane --threads 2",
            benchmarks::moving},
    Command{"proxies", "The coarse meshes on which detection works for fine ones, beside OpenMesh's Decimater.",
            "orbifit-benchmark proxies\n"
            "orbifit-benchmark proxies fine.ply --tolerance 0.002 --json proxies.json",
            benchmarks::proxies},
    Command{"real", "Meshes of any kind, from detection to an edit in every mode: what builds, how fast, how exactly.",
            "orbifit-benchmark real meshes\n"
            "orbifit-benchmark real meshes --annotations detected --csv real.csv\n"
            "orbifit-benchmark real chair.obj --modes moving --stage-limit 60",
            benchmarks::real},
    Command{"scans",
            "Fits to real scans, of the template's own object or another of its kind: size, bending, confidence.",
            "orbifit-benchmark scans pairs.tsv --annotations detected\n"
            "orbifit-benchmark scans pairs.tsv --match mug --csv scans.csv",
            benchmarks::scans},
    Command{"batch",
            "How many items a second a batch does on one and on two processors, and what it costs beside them.",
            "orbifit-benchmark batch\n"
            "orbifit-benchmark batch --models 100 --task info --json batch.json",
            benchmarks::batch},
};

int run(const CommandBody& body, bool quiet) {
  Console console(quiet);
  const auto fail = [&](const std::exception& error, int code) {
    console.error(error.what());
    return code;
  };
  try {
    CommandContext context;
    context.quiet = quiet;
    context.run.interrupted = &interruption();
    context.run.on_message = [&console](std::string_view text) { console.message(text); };
    return body(context);
  } catch (const UsageError& error) {
    return fail(error, kUsage);
  } catch (const InputError& error) {
    return fail(error, kBadInput);
  } catch (const InterruptedError& error) {
    return fail(error, kInterrupted);
  } catch (const std::exception& error) {
    return fail(error, kNoResult);
  }
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Measure Orbifit against the paper, the memory's bandwidth and its peers.", "orbifit-benchmark");
  app.require_subcommand(1);
  bool quiet = false;
  std::array<CommandBody, kBenchmarks.size()> bodies;
  for (std::size_t i = 0; i < kBenchmarks.size(); ++i) {
    CLI::App* sub = app.add_subcommand(kBenchmarks[i].name, kBenchmarks[i].summary);
    std::string examples = kBenchmarks[i].examples;
    for (std::size_t at = 0; (at = examples.find('\n', at)) != std::string::npos; at += 3)
      examples.insert(at + 1, "  ");
    sub->footer("Examples:\n  " + examples);
    bodies[i] = kBenchmarks[i].define(*sub);
    sub->add_flag("--quiet", quiet, "No notes on standard error");
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    Console(false).error(std::string(error.what()) + " (see 'orbifit-benchmark --help')");
    return kUsage;
  }
  for (std::size_t i = 0; i < kBenchmarks.size(); ++i) {
    if (app.got_subcommand(kBenchmarks[i].name)) return run(bodies[i], quiet);
  }
  return kUsage;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return parse_and_run(argc, argv);
  } catch (const std::exception& error) {
    Console(false).error(std::string("internal error: ") + error.what());
    return kNoResult;
  }
}
