#include "program.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <new>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"

#include "console.h"
#include "interruption.h"
#include "last_words.h"
#include "memory_limit.h"
#include "other_program.h"
#include "picture_options.h"
#include "stop_guard.h"

namespace orbifit {

namespace {

struct CommonOptions {
  bool json = false;
  bool quiet = false;
  std::uint64_t seed = 1;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  double timeout = 0;
  std::uint64_t memory = 0;  // bytes; 0: no limit
  std::string output_format;
  bool data_on_output = false;
};

// Which limits the call names; 0 is not to mean none.
struct GivenOptions {
  bool timeout = false, memory = false;
};

void add_common_options(CLI::App& app, CommonOptions& options) {
  const std::string group = "Common options";
  app.add_flag("--json", options.json, "Print one JSON object on standard output")->group(group);
  app.add_flag("--quiet", options.quiet, "Print nothing but errors (and what --json asks for)")->group(group);
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
  app.add_option("--max-memory", options.memory,
                 "Stop without a result where more memory than that would be needed, such as 500M or 4G (exit code 4)")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE")
      ->group(group);
  app.add_option("--output-format", options.output_format,
                 "Format of a file written to standard output ('-' as its name): obj, ply, xyz ...")
      ->type_name("FORMAT")
      ->group(group);
}

// "-" as the name of an output is standard output, which has no ending that tells the format.
void name_standard_output(CLI::App& app, CommonOptions& options, const std::string& format) {
  constexpr std::array outputs{"--output", "--colour", "--preview", "--annotation-out", "--report", "--html", "OUT"};
  for (const char* name : outputs) {
    CLI::Option* option = app.get_option_no_throw(name);
    if (option == nullptr) continue;
    option->transform(CLI::Validator(
        [&options, format](std::string& value) {
          if (value != "-") return std::string();
          if (options.data_on_output) return std::string("standard output can take one file only");
          options.data_on_output = true;
          if (!format.empty()) value += "." + format;
          return std::string();
        },
        ""));
  }
}

CommandContext make_context(const CommonOptions& options, const GivenOptions& given, Console& console) {
  if (options.threads < 1 || options.threads > 4096) {
    throw UsageError("--threads is " + std::to_string(options.threads) + ": must be from 1 to 4096");
  }
  CommandContext context;
  context.json = options.json;
  context.quiet = options.quiet;
  context.data_on_output = options.data_on_output;
  if (options.json && options.data_on_output) {
    throw UsageError("--json and an output '-' both want standard output: give the output a file's name");
  }
  context.run.seed = options.seed;
  context.run.threads = options.threads;
  context.run.interrupted = &interruption();
  if (given.memory && options.memory == 0) throw UsageError("--max-memory is 0: must be a positive size");
  if (given.timeout) {
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

std::string error_object(const std::string& text, int code) {
  const nlohmann::ordered_json object{{"error", text}, {"exit_code", code}};
  return object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

// One line on stderr, and where JSON was asked for an object on stdout.
int fail(Console& console, bool json, const std::string& text, int code) {
  console.error(text);
  if (json) print(error_object(text, code));
  return code;
}

// The same for a process that must end at once.
LastWords last_words(const std::string& text, int code, std::function<bool()> wants_object) {
  return {"orbifit: " + text + "\n", error_object(text, code), std::move(wants_object), code};
}

constexpr const char* kOutOfMemory = "not enough memory";
constexpr const char* kAboveMaxMemory = "not enough memory: more is needed than --max-memory allows";

// Runs one command and turns every failure into its exit code.
int run(const CommandBody& body, const CommonOptions& options, const GivenOptions& given) {
  Console console(options.quiet);
  CommandContext context;
  // Nothing follows the object that the command printed, or the file that it wrote.
  const auto wants_object = [&] {
    return options.json && !options.data_on_output && !std::atomic_ref(context.printed).load();
  };
  const auto fail = [&](const std::string& text, int code) {
    return orbifit::fail(console, wants_object(), text, code);
  };
  const std::string timeout_text = "stopped after " + short_number(options.timeout) + " s (--timeout)";
  const EndWithoutMemory end(last_words(kOutOfMemory, kNoResult, wants_object));
  try {
    context = make_context(options, given, console);
    std::optional<MemoryLimit> limit;
    if (options.memory > 0) limit.emplace(options.memory, last_words(kAboveMaxMemory, kTimeout, wants_object));
    const StopGuard guard(context.run, [&](StopReason reason) {
      const bool timeout = reason == StopReason::timeout;
      return say(last_words(timeout ? timeout_text : "interrupted", timeout ? kTimeout : kInterrupted, wants_object));
    });
    return body(context);
  } catch (const UsageError& error) {
    return fail(error.what(), kUsage);
  } catch (const InputError& error) {
    return fail(error.what(), kBadInput);
  } catch (const NoResultError& error) {
    return fail(error.what(), kNoResult);
  } catch (const TimeoutError&) {
    return fail(timeout_text, kTimeout);
  } catch (const InterruptedError& error) {
    return fail(error.what(), kInterrupted);
  } catch (const std::bad_alloc&) {
    return options.memory > 0 ? fail(kAboveMaxMemory, kTimeout) : fail(kOutOfMemory, kNoResult);
  } catch (const std::exception& error) {
    return fail(std::string("internal error: ") + error.what(), kNoResult);
  }
}

// The word after the option, or after its "=".
std::string value_of(const std::string& option, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == option && i + 1 < words.size()) return words[i + 1];
    if (words[i].starts_with(option + "=")) return words[i].substr(option.size() + 1);
  }
  return "";
}

// How many letters must be inserted, deleted or replaced to make one word the other.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

// "; did you mean --seed?" for the first of the words that looks like an option, or a list of all options.
std::string suggestion(const std::string& words, CLI::App& command) {
  const std::size_t option_at = words.find("--");
  if (option_at == std::string::npos) return "";
  const std::string name = words.substr(option_at + 2, words.find_first_of("= ", option_at) - option_at - 2);
  std::string best;
  std::string all;
  std::size_t least = 1 + name.size() / 3;  // of more letters apart no mistake is likely
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& known : option->get_lnames()) {
      if (option->get_group().empty()) continue;  // hidden
      all += (all.empty() ? "--" : ", --") + known;
      if (const std::size_t distance = edit_distance(name, known); distance <= least) {
        least = distance;
        best = known;
      }
    }
  }
  return best.empty() ? "; there are " + all : "; did you mean --" + best + "?";
}

// "--mode: Check loose value in {fixed->0,floating->1} OR {0,1} FAILED" in plain words.
std::string wrong_choice(const std::string& reason) {
  const std::size_t check = reason.find(": Check ");
  const std::size_t value = reason.find(" value in {");
  if (check == std::string::npos || value == std::string::npos) return reason;
  std::string names;
  std::istringstream entries(reason.substr(value + 11, reason.find('}', value) - value - 11));
  for (std::string entry; std::getline(entries, entry, ',');) {
    names += (names.empty() ? "" : ", ") + entry.substr(0, entry.find("->"));
  }
  return reason.substr(0, check) + " is '" + reason.substr(check + 8, value - check - 8) + "': must be one of " + names;
}

// The program's own words for what the parser could not make sense of.
int refuse_call(const CLI::ParseError& error, const std::string& command, CLI::App& app, bool json) {
  Console console(false);
  const std::string help = "'orbifit " + (command.empty() ? "" : command + " ") + "--help'";
  std::string reason = wrong_choice(error.what());
  if (reason.starts_with("The following argument")) {
    const std::size_t colon = reason.find(": ");
    const std::string words = colon == std::string::npos ? "" : reason.substr(colon + 2);
    reason = "unexpected argument " + words + suggestion(words, app);
  } else if (reason.starts_with("A subcommand")) {
    reason = "a command is needed";
  } else if (const std::size_t counts = reason.find(" required but received"); counts != std::string::npos) {
    reason = reason.substr(0, reason.find(':')) + ": wrong number of values";
  }
  return fail(console, json, reason + " (see " + help + ")", kUsage);
}

}  // namespace

int run_program(std::span<const Command> commands, int argc, char** argv) {
  const EndWithoutMemory end;  // until it is known what the call asks for
  const std::vector<std::string> words = with_up_in_numbers({argv, argv + argc});
  const bool json = std::ranges::find(words, "--json") != words.end();
  CLI::App app("Find the symmetries of a shape; edit it, or fit it to a scan, without breaking them.", "orbifit");
  app.set_version_flag("--version", "orbifit " ORBIFIT_VERSION);
  app.require_subcommand(1);
  app.footer(
      "'orbifit COMMAND --help' shows a command's examples and options.\n"
      "Exit codes: 0 success, 1 no result, 2 wrong usage, 3 bad input, 4 timeout or too little memory allowed, "
      "130 interrupted.");
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
    name_standard_output(*sub, options, value_of("--output-format", words));
  }
  const std::string name = argc > 1 && argv[1][0] != '-' ? argv[1] : "";
  const Command* command = nullptr;
  for (const Command& entry : commands) {
    if (name == entry.name) command = &entry;
  }
  if (argc > 1 && !name.empty() && command == nullptr) {
    std::string names;
    for (const Command& entry : commands) names += (names.empty() ? "" : ", ") + std::string(entry.name);
    Console console(false);
    return fail(console, json, "unknown command '" + name + "'; there are " + names, kUsage);
  }
  if (command != nullptr && command->program != nullptr) return become_program(command->program, argv + 2);
  // In the list of commands a summary is wanted, in a command's own help the examples too.
  if (command != nullptr) app.get_subcommand(command->name)->description(description(*command));
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend() - 1));  // the parser takes them from the end
  } catch (const CLI::Success& success) {                                   // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return refuse_call(error, name, command == nullptr ? app : *app.get_subcommand(name), json);
  }
  const CLI::App* chosen = app.get_subcommands().front();
  for (std::size_t c = 0; c < commands.size(); ++c) {
    if (chosen->get_name() != commands[c].name) continue;
    return run(bodies[c], options, {chosen->count("--timeout") > 0, chosen->count("--max-memory") > 0});
  }
  return kUsage;
}

}  // namespace orbifit
