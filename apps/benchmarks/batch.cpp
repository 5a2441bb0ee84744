#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "base/random.h"
#include "benchmarks.h"
#include "files/file.h"

namespace orbifit::benchmarks {

namespace fs = std::filesystem;

namespace {

constexpr int kMinVertices = 2000, kMaxVertices = 50000;
constexpr double kSpread = 0.15;  // of the models' lengths and angles about their defaults

struct BatchArguments {
  int models = 1000, nodes = 100;
  std::string task = "detect", json;
};

// What one batch took.
struct Run {
  int jobs = 1;
  double seconds = 0;                      // wall-clock
  double processor = 0;                    // user and system, of all processes
  double item_seconds = 0;                 // of all items together
  double parent_memory = 0;                // of the batch without its items, bytes
  double first_half = 0, second_half = 0;  // largest peak memory of an item, bytes
  std::size_t items = 0;

  double overhead() const { return (seconds * jobs - item_seconds) / static_cast<double>(items); }
};

// Models of the generators' kinds, of lengths of their own each, so that no two are the same.
void write_models(const fs::path& folder, int count, const RunContext& run) {
  int kept = 0;
  for (int i = 0; kept < count && i < 4 * count + 100; ++i) {
    run.check();
    const Generator& generator = generators()[static_cast<std::size_t>(i) % generators().size()];
    std::map<std::string, double> parameters;
    Random random(1, generator.name + std::to_string(i));
    for (const GeneratorParameter& parameter : generator.parameters) {
      if (parameter.integer) continue;
      parameters[parameter.name] =
          std::clamp(parameter.value * random.uniform(1 - kSpread, 1 + kSpread), parameter.minimum, parameter.maximum);
    }
    try {
      const Mesh mesh = generate(generator.name, parameters).mesh;
      if (mesh.vertices.rows() < kMinVertices || mesh.vertices.rows() > kMaxVertices) continue;
      write_mesh(folder / (generator.name + "-" + std::to_string(i) + ".ply"), mesh);
      ++kept;
    } catch (const UsageError&) {
      continue;  // lengths that do not go together
    }
  }
  if (kept < count) throw NoResultError("the generators gave only " + std::to_string(kept) + " models");
}

double to_seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

void read_records(const fs::path& file, Run& run) {
  std::ifstream stream(file);
  std::vector<double> peaks;
  for (std::string line; std::getline(stream, line);) {
    const auto record = nlohmann::json::parse(line);
    if (record.at("status") != "ok" && record.at("status") != "no_symmetry") {
      throw NoResultError(record.at("id").get<std::string>() + ": " + record.at("message").get<std::string>());
    }
    run.item_seconds += record.at("seconds").get<double>();
    peaks.push_back(record.at("peak_memory").get<double>());
  }
  run.items = peaks.size();
  if (peaks.empty()) throw NoResultError("the batch has no results");
  const auto middle = peaks.begin() + static_cast<std::ptrdiff_t>(peaks.size() / 2);
  run.first_half = *std::max_element(peaks.begin(), std::max(middle, peaks.begin() + 1));
  run.second_half = *std::max_element(middle, peaks.end());
}

Run run_once(const fs::path& folder, const std::string& task, int jobs) {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "orbifit";
  const fs::path installed = fs::read_symlink("/proc/self/exe").parent_path() / "orbifit";
  const fs::path out = folder / ("results-of-" + std::to_string(jobs));
  std::vector<std::string> words{(fs::exists(installed) ? installed : program).string(),
                                 "batch",
                                 (folder / "models").string(),
                                 "--task",
                                 task,
                                 "--out",
                                 out.string(),
                                 "--quiet",
                                 "--jobs=" + std::to_string(jobs),
                                 "--threads=" + std::to_string(jobs)};
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  const auto begin = std::chrono::steady_clock::now();
  pid_t child = 0;
  const int failure = ::posix_spawn(&child, pointers[0], &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw NoResultError(words[0] + " cannot be started: " + std::strerror(failure));
  rusage usage{};
  int status = 0;
  Run run;
  // What wait4 says of memory counts this process too, from which it was begun.
  const std::string status_file = "/proc/" + std::to_string(child) + "/status";
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    std::ifstream stream(status_file);
    for (std::string line; std::getline(stream, line);) {
      if (line.starts_with("VmHWM:")) run.parent_memory = 1024 * std::strtod(line.c_str() + 6, nullptr);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  run.jobs = jobs;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  run.processor = to_seconds(usage.ru_utime) + to_seconds(usage.ru_stime);
  read_records(out / "results-1.jsonl", run);
  return run;
}

std::string to_text(const BatchArguments& arguments, const std::vector<Run>& runs) {
  TextTable table({"jobs", "items", "seconds", "items/s", "processor s", "overhead ms", "batch MB", "item MB, 1st half",
                   "2nd half"});
  for (const Run& run : runs) {
    table.add({std::to_string(run.jobs), std::to_string(run.items), short_number(run.seconds),
               short_number(static_cast<double>(run.items) / run.seconds), short_number(run.processor),
               short_number(1000 * run.overhead(), 3), short_number(run.parent_memory / 1e6, 3),
               short_number(run.first_half / 1e6, 3), short_number(run.second_half / 1e6, 3)});
  }
  std::string text = table.text();
  const double mean = runs.front().item_seconds / static_cast<double>(runs.front().items) + runs.front().overhead();
  if (runs.size() > 1) {
    text += "efficiency of " + std::to_string(runs[1].jobs) +
            " jobs: " + short_number(runs[0].seconds / (runs[1].jobs * runs[1].seconds), 3) + " by time, " +
            short_number(runs[0].processor / runs[1].processor, 3) + " by processor time\n";
  }
  const double cores = static_cast<double>(std::thread::hardware_concurrency());
  text += "a million: 1e6 * " + short_number(mean, 3) + " s / (" + std::to_string(arguments.nodes) + " nodes * " +
          short_number(cores, 3) + " processors) = " + short_number(1e6 * mean / (arguments.nodes * cores) / 3600, 3) +
          " h\n";
  return text;
}

}  // namespace

CommandBody batch(CLI::App& app) {
  const auto arguments = std::make_shared<BatchArguments>();
  app.add_option("--models", arguments->models, "Generated models of 2 000 to 50 000 vertices")->capture_default_str();
  app.add_option("--task", arguments->task, "detect, symmetrize or info")->capture_default_str();
  app.add_option("--nodes", arguments->nodes, "Of this kind, for the extrapolation")->capture_default_str();
  app.add_option("--json", arguments->json, "File for the figures")->type_name("FILE");
  return [arguments](CommandContext& context) {
    require(arguments->models >= 2 && arguments->models <= 1000000, "--models", arguments->models, "from 2 to 1000000");
    require(arguments->nodes >= 1, "--nodes", arguments->nodes, "at least 1");
    std::string name = (fs::temp_directory_path() / "orbifit-batch-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw NoResultError("no temporary folder");
    const std::shared_ptr<const fs::path> folder(new fs::path(name), [](const fs::path* path) {
      std::error_code ignored;
      fs::remove_all(*path, ignored);
      delete path;
    });
    fs::create_directory(*folder / "models");
    write_models(*folder / "models", arguments->models, context.run);
    std::vector<Run> runs;
    for (const int jobs : {1, 2}) {
      context.run.check();
      runs.push_back(run_once(*folder, arguments->task, jobs));
    }
    print(to_text(*arguments, runs));
    if (!arguments->json.empty()) {
      nlohmann::ordered_json all = nlohmann::ordered_json::array();
      for (const Run& run : runs) {
        all.push_back({{"jobs", run.jobs},
                       {"items", run.items},
                       {"seconds", run.seconds},
                       {"processor_seconds", run.processor},
                       {"item_seconds", run.item_seconds},
                       {"overhead_seconds", run.overhead()},
                       {"batch_memory", run.parent_memory},
                       {"item_memory_first_half", run.first_half},
                       {"item_memory_second_half", run.second_half}});
      }
      write_file(arguments->json, all.dump(2) + "\n");
    }
    return kDone;
  };
}

}  // namespace orbifit::benchmarks
