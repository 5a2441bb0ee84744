#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <new>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>

#include "orbifit/model/errors.h"

#include "commands.h"
#include "console.h"

namespace {

using namespace orbifit;

constexpr std::array kCommands{
    Command{"info", "Counts, components, defects and size of a mesh.",
            "orbifit info chair.obj\n"
            "orbifit info chair.obj --json",
            commands::info},
    Command{"detect", "Find the symmetric regions of a mesh or a scan.",
            "orbifit detect chair.obj -o chair.json\n"
            "orbifit detect chair.obj -o chair.json --preview chair.png --colour chair_regions.ply\n"
            "orbifit detect noisy.ply -o noisy.json --tolerance 0.02 --max-seconds 30\n"
            "orbifit detect --points scan.pcd -o scan.json",
            commands::detect},
    Command{
        "annotate",
        "Correct an annotation by hand: add a region (where its symmetry sits, roughly, and a face or point that has "
        "it), remove regions, rename them, list them.",
        "orbifit annotate cup.obj -o cup.json --plane 0 0 0 1 0 0 --seed-face 812\n"
        "orbifit annotate cup.obj -o cup.json --annotation cup.json --axis 0 0 0 0 0 1 --order inf --seed-face 12\n"
        "orbifit annotate wheel.stl -o wheel.json --axis 3 0 1 0 1 0 --group C5v --near 3 0.2 1 --name hub\n"
        "orbifit annotate cup.obj --annotation cup.json --list\n"
        "orbifit annotate cup.obj --annotation cup.json -o cup.json --remove 3,5 --rename 2 handle",
        commands::annotate},
    Command{"check", "Measure how symmetric the regions of a mesh are, at rest or after a deformation.",
            "orbifit check chair.obj chair.json\n"
            "orbifit check chair.obj chair.json --deformed edited.obj --max-residual 1e-9",
            commands::check},
    Command{"symmetrize", "Move a mesh to the nearest one whose symmetries are exact.",
            "orbifit symmetrize scanned.ply scanned.json -o symmetric.ply\n"
            "orbifit symmetrize chair.obj chair.json -o exact.obj --annotation-out exact.json",
            commands::symmetrize},
    Command{"subspace", "Build the symmetric subspace of a mesh and say what it holds.",
            "orbifit subspace chair.obj chair.json\n"
            "orbifit subspace chair.obj chair.json --samples 300 --mode fixed -o chair.basis\n"
            "orbifit subspace chair.obj chair.json --lift paper --compare-lifts",
            commands::subspace},
    Command{"deform", "Edit a mesh with handles, its symmetries kept.",
            "orbifit deform chair.obj chair.json --handles handles.json -o edited.obj\n"
            "orbifit deform chair.obj chair.json --handles handles.json -o edited.obj --annotation-out edited.json\n"
            "orbifit deform chair.obj chair.json --basis chair.basis --handles handles.json -o edited.obj",
            commands::deform},
    Command{"fit", "Fit a template to a scan, its symmetries kept and its hidden sides completed by them.",
            "orbifit fit chair.obj scan.ply -o fitted.obj\n"
            "orbifit fit chair.obj scan.ply --annotation chair.json -o fitted.obj --report fit.json --html fit.html\n"
            "orbifit fit chair.obj scan.ply --landmarks landmarks.json -o fitted.obj",
            commands::fit},
    Command{
        "compare", "Fit by ours and by least-squares methods, and set their figures side by side.",
        "orbifit compare fan.ply scan.ply --annotation fan.json -o comparison\n"
        "orbifit compare chair.ply scan.ply --annotation chair.json --truth chair_true.ply --aligned -o comparison\n"
        "orbifit compare chair.ply scan.ply --annotation chair.json --methods ours,kurz --brief -o comparison",
        commands::compare},
    Command{"generate", "Build a model whose symmetries are known.",
            "orbifit generate --list\n"
            "orbifit generate chair -o models\n"
            "orbifit generate chair --param slats=6 --param back_tilt=12 -o models",
            commands::generate},
    Command{"scan", "Scan a mesh with a virtual depth camera.",
            "orbifit scan chair.obj -o scan.ply\n"
            "orbifit scan chair.obj --views 3 --noise 0.002 --azimuth 40 --elevation 25 -o scan.ply",
            commands::scan},
    Command{"convert", "Convert a mesh or a scan to another format.",
            "orbifit convert chair.glb chair.obj\n"
            "orbifit convert scan.pcd scan.ply\n"
            "orbifit convert chair.ply chair_points.ply --points",
            commands::convert},
    Command{"render", "Draw a picture of a mesh, its regions, or a scan over it.",
            "orbifit render chair.obj -o chair.png\n"
            "orbifit render chair.obj --annotation chair.json -o regions.png\n"
            "orbifit render chair.obj --points scan.ply --up 0 1 0 -o fit.png",
            commands::render},
    Command{"report", "Bind texts, tables and pictures into one self-contained HTML page.",
            "orbifit report steps.json -o index.html", commands::report},
};

struct CommonOptions {
  bool json = false;
  bool quiet = false;
  std::uint64_t seed = 1;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  double timeout = 0;
};

void add_common_options(CLI::App& app, CommonOptions& options) {
  const std::string group = "Common options";
  app.add_flag("--json", options.json, "Print one JSON object on standard output")->group(group);
  app.add_flag("--quiet", options.quiet, "No progress and no notes")->group(group);
  app.add_option("--seed", options.seed, "Seed of all random numbers")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  app.add_option("--threads", options.threads, "Threads to use; the result does not depend on it")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  app.add_option("--timeout", options.timeout, "Give up after so many seconds (exit code 4)")
      ->type_name("SECONDS")
      ->group(group);
}

CommandContext make_context(const CommonOptions& options, bool has_timeout, Console& console) {
  if (options.threads < 1 || options.threads > 4096) {
    throw UsageError("--threads is " + std::to_string(options.threads) + ": must be from 1 to 4096");
  }
  CommandContext context;
  context.json = options.json;
  context.quiet = options.quiet;
  context.run.seed = options.seed;
  context.run.threads = options.threads;
  context.run.interrupted = &interruption();
  if (has_timeout) {
    if (!(options.timeout > 0 && options.timeout <= 1e9)) {
      throw UsageError("--timeout is " + short_number(options.timeout) + ": must be a positive number of seconds");
    }
    context.run.deadline =
        std::chrono::steady_clock::now() + std::chrono::microseconds(static_cast<std::int64_t>(1e6 * options.timeout));
  }
  context.run.on_progress = [&console](std::string_view stage, double part) { console.progress(stage, part); };
  context.run.on_message = [&console](std::string_view text) { console.message(text); };
  return context;
}

std::string description(const Command& command) {
  std::string text = "Examples:\n  ";
  for (const char* c = command.examples; *c != '\0'; ++c) text += *c == '\n' ? "\n  " : std::string(1, *c);
  return text + "\n\n" + command.summary;
}

// Runs one command and turns every failure into its exit code.
int run(const CommandBody& body, const CommonOptions& options, bool has_timeout) {
  Console console(options.quiet);
  const auto fail = [&](const std::string& text, int code) {
    console.error(text);
    return code;
  };
  try {
    CommandContext context = make_context(options, has_timeout, console);
    return body(context);
  } catch (const UsageError& error) {
    return fail(error.what(), kUsage);
  } catch (const InputError& error) {
    return fail(error.what(), kBadInput);
  } catch (const NoResultError& error) {
    return fail(error.what(), kNoResult);
  } catch (const TimeoutError& error) {
    return fail(error.what(), kTimeout);
  } catch (const InterruptedError& error) {
    return fail(error.what(), kInterrupted);
  } catch (const std::bad_alloc&) {
    return fail("not enough memory", kNoResult);
  } catch (const std::exception& error) {
    return fail(std::string("internal error: ") + error.what(), kNoResult);
  }
}

// The program's own words for what the parser could not make sense of.
int refuse_call(const CLI::ParseError& error, const std::string& command) {
  Console console(false);
  const std::string help = "'orbifit " + (command.empty() ? "" : command + " ") + "--help'";
  std::string reason = error.what();
  if (reason.starts_with("The following argument")) {
    const std::size_t colon = reason.find(": ");
    reason = "unexpected argument" + (colon == std::string::npos ? "" : " " + reason.substr(colon + 2));
  } else if (reason.starts_with("A subcommand")) {
    reason = "a command is needed";
  } else if (const std::size_t counts = reason.find(" required but received"); counts != std::string::npos) {
    reason = reason.substr(0, reason.find(':')) + ": wrong number of values";
  }
  console.error(reason + " (see " + help + ")");
  return kUsage;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Find the symmetries of a shape; edit it, or fit it to a scan, without breaking them.", "orbifit");
  app.set_version_flag("--version", "orbifit " ORBIFIT_VERSION);
  app.require_subcommand(1);
  app.footer(
      "'orbifit COMMAND --help' shows a command's examples and options.\n"
      "Exit codes: 0 done, 1 no result, 2 wrong call, 3 bad input, 4 timeout, 130 interrupted.");
  CommonOptions options;
  std::array<CommandBody, kCommands.size()> bodies;
  for (std::size_t c = 0; c < kCommands.size(); ++c) {
    CLI::App* sub = app.add_subcommand(kCommands[c].name, kCommands[c].summary);
    bodies[c] = kCommands[c].define(*sub);
    add_common_options(*sub, options);
  }
  const std::string name = argc > 1 && argv[1][0] != '-' ? argv[1] : "";
  const Command* command = nullptr;
  for (const Command& entry : kCommands) {
    if (name == entry.name) command = &entry;
  }
  if (argc > 1 && !name.empty() && command == nullptr) {
    Console(false).error("unknown command '" + name + "' ('orbifit --help' lists the commands)");
    return kUsage;
  }
  // In the list of commands a summary is wanted, in a command's own help the examples too.
  if (command != nullptr) app.get_subcommand(command->name)->description(description(*command));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return refuse_call(error, name);
  }
  const CLI::App* chosen = app.get_subcommands().front();
  for (std::size_t c = 0; c < kCommands.size(); ++c) {
    if (chosen->get_name() != kCommands[c].name) continue;
    return run(bodies[c], options, chosen->count("--timeout") > 0);
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
