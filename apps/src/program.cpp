#include "program.h"

#include <chrono>
#include <cmath>
#include <exception>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "orbifit/model/errors.h"

#include "console.h"
#include "other_program.h"

namespace orbifit {

namespace {

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
  app.add_flag("--quiet", options.quiet, "Print neither progress nor messages")->group(group);
  app.add_option("--seed", options.seed, "Seed of the random numbers")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  app.add_option("--threads", options.threads, "Number of threads; the result does not depend on it")
      ->type_name("N")
      ->capture_default_str()
      ->group(group);
  app.add_option("--timeout", options.timeout, "Stop without a result after so many seconds (exit code 4)")
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

}  // namespace

int run_program(std::span<const Command> commands, int argc, char** argv) {
  CLI::App app("Find the symmetries of a shape; edit it, or fit it to a scan, without breaking them.", "orbifit");
  app.set_version_flag("--version", "orbifit " ORBIFIT_VERSION);
  app.require_subcommand(1);
  app.footer(
      "'orbifit COMMAND --help' shows a command's examples and options.\n"
      "Exit codes: 0 success, 1 no result, 2 wrong usage, 3 bad input, 4 timeout, 130 interrupted.");
  CommonOptions options;
  std::vector<CommandBody> bodies(commands.size());
  for (std::size_t c = 0; c < commands.size(); ++c) {
    CLI::App* sub = app.add_subcommand(commands[c].name, commands[c].summary);
    if (commands[c].define == nullptr) {
      bodies[c] = [](CommandContext&) -> int { throw UsageError("the command's name comes first"); };
      continue;
    }
    bodies[c] = commands[c].define(*sub);
    add_common_options(*sub, options);
  }
  const std::string name = argc > 1 && argv[1][0] != '-' ? argv[1] : "";
  const Command* command = nullptr;
  for (const Command& entry : commands) {
    if (name == entry.name) command = &entry;
  }
  if (argc > 1 && !name.empty() && command == nullptr) {
    Console(false).error("unknown command '" + name + "' ('orbifit --help' lists the commands)");
    return kUsage;
  }
  if (command != nullptr && command->program != nullptr) return become_program(command->program, argv + 2);
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
  for (std::size_t c = 0; c < commands.size(); ++c) {
    if (chosen->get_name() != commands[c].name) continue;
    return run(bodies[c], options, chosen->count("--timeout") > 0);
  }
  return kUsage;
}

}  // namespace orbifit
