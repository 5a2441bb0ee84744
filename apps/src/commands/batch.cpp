#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <thread>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "orbifit/model/errors.h"

#include "../batch_task.h"
#include "../commands.h"
#include "batch/batch_run.h"
#include "batch_results.h"

namespace orbifit::commands {

namespace fs = std::filesystem;

namespace {

struct BatchArguments {
  std::string source, out, glob, shard = "1/1", retry;
  int jobs = 0;
  double item_timeout = 600;
  std::uint64_t item_memory = 0;
  std::vector<std::string> options;
  std::vector<double> up{0, 0, 1};
  bool no_thumbnails = false;
  BatchTask task;
};

// "tolerance=0.01": what follows is JSON, or a text where it is none.
std::pair<std::string, std::string> to_option(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0) throw UsageError("--option '" + text + "': must be NAME=VALUE");
  const std::string value = text.substr(at + 1);
  const nlohmann::json json = nlohmann::json::parse(value, nullptr, false);
  return {text.substr(0, at), json.is_discarded() ? nlohmann::json(value).dump() : json.dump()};
}

std::set<batch::Status> to_statuses(const std::string& list) {
  std::set<batch::Status> result;
  std::istringstream stream(list);
  for (std::string name; std::getline(stream, name, ',');) {
    const auto status = batch::parse_status(name);
    if (!status) {
      throw UsageError("--retry has '" + name +
                       "': must be some of ok, no_symmetry, bad_input, failed, timeout, crash, oom");
    }
    result.insert(*status);
  }
  return result;
}

std::uint64_t physical_memory() {
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

batch::BatchOptions to_options(BatchArguments& arguments, const CommandContext& context) {
  if (arguments.source.empty()) throw UsageError("a MANIFEST or FOLDER is required");
  if (arguments.task.name.empty()) throw UsageError("--task is required: detect, fit, symmetrize or info");
  if (arguments.out.empty()) throw UsageError("--out is required");
  if (arguments.jobs < 0) throw UsageError("--jobs is " + std::to_string(arguments.jobs) + ": must be at least 0");
  batch::BatchOptions options;
  options.jobs = arguments.jobs > 0 ? arguments.jobs : context.run.threads;
  options.task = arguments.task.name;
  options.out = arguments.out;
  options.shard = batch::Shard::parse(arguments.shard);
  options.limits.seconds = arguments.item_timeout;
  options.limits.memory =
      arguments.item_memory > 0 ? arguments.item_memory : physical_memory() / static_cast<std::uint64_t>(options.jobs);
  options.retry = to_statuses(arguments.retry);

  BatchTask& task = arguments.task;
  task.seed = context.run.seed;
  task.threads = std::max(1, context.run.threads / options.jobs);
  task.thumbnails = !arguments.no_thumbnails;
  task.up = to_direction("--up", arguments.up);
  for (const std::string& text : arguments.options) task.options.push_back(to_option(text));
  task.validate();
  options.settings = task.settings();
  options.kinds = task.kinds();
  options.validate();
  return options;
}

std::string to_text(const batch::BatchCounts& counts, const fs::path& out) {
  std::string text = count_of(static_cast<long long>(counts.done), "item") + " done";
  if (counts.skipped > 0) text += ", " + std::to_string(counts.skipped) + " done before";
  text += "; ";
  bool first = true;
  for (std::size_t s = 0; s < batch::kStatusNames.size(); ++s) {
    if (counts.by_status[s] == 0) continue;
    text += std::string(first ? "" : ", ") + batch::kStatusNames[s] + " " + std::to_string(counts.by_status[s]);
    first = false;
  }
  return text + (first ? "none in this shard" : "") + "; results in " + out.string() + "\n";
}

nlohmann::ordered_json to_json(const batch::BatchCounts& counts) {
  nlohmann::ordered_json by_status;
  for (std::size_t s = 0; s < batch::kStatusNames.size(); ++s) by_status[batch::kStatusNames[s]] = counts.by_status[s];
  return {{"done", counts.done}, {"skipped", counts.skipped}, {"status", by_status}};
}

int run_items(BatchArguments& arguments, CommandContext& context) {
  const batch::BatchOptions options = to_options(arguments, context);
  std::error_code ignored;
  const batch::Manifest manifest =
      fs::is_directory(arguments.source, ignored)
          ? batch::Manifest::from_folder(arguments.source, arguments.glob, options.shard, options.out)
          : batch::Manifest::from_lines(arguments.source, options.shard);
  const BatchTask& task = arguments.task;
  const batch::BatchCounts counts = batch::run_batch(
      manifest, options, [&task](const batch::Item& item, const fs::path& folder) { return task.run(item, folder); },
      context.run);
  print(context.json ? to_json(counts).dump(2) + "\n" : to_text(counts, options.out));
  return counts.unsuccessful() == 0 ? kDone : kSomeFailed;
}

}  // namespace

CommandBody batch(CLI::App& app) {
  const auto arguments = std::make_shared<BatchArguments>();
  app.add_option("SOURCE", arguments->source,
                 "Manifest (JSON lines: id, mesh, scans, annotation, options) or folder of meshes")
      ->type_name("MANIFEST|FOLDER");
  app.add_option("--task", arguments->task.name, "detect, fit, symmetrize or info")->type_name("TASK");
  app.add_option("--out", arguments->out, "Folder for the results; another run on it goes on")->type_name("DIR");
  app.add_option("--glob", arguments->glob, "Files of a folder to take; '*' also stands for '/'")->type_name("PATTERN");
  app.add_option("--shard", arguments->shard, "The part of the items to do, for as many runs as there are parts")
      ->type_name("I/N")
      ->capture_default_str();
  app.add_option("--jobs", arguments->jobs, "Items at a time, which share --threads; 0: as many as threads")
      ->capture_default_str();
  app.add_option("--item-timeout", arguments->item_timeout, "Seconds that an item may take")->capture_default_str();
  app.add_option(
         "--item-memory", arguments->item_memory,
         "Memory that an item may take beside the program's own, such as 4G; without it, the machine's is shared")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  app.add_option("--retry", arguments->retry, "Do these again though nothing changed, such as timeout,crash")
      ->type_name("STATUS,...");
  app.add_option("--option", arguments->options, "Option of the task for all items; an item's own come first")
      ->type_name("NAME=VALUE");
  app.add_option("--up", arguments->up, "Upward direction of the pictures")->expected(3)->type_name("X Y Z");
  app.add_flag("--no-thumbnails", arguments->no_thumbnails, "No picture of each item for the gallery");
  const auto results = define_batch_results(app);
  return [arguments, results](CommandContext& context) {
    if (const auto code = results(context)) return *code;
    return run_items(*arguments, context);
  };
}

}  // namespace orbifit::commands
