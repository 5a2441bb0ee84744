#include "batch_task.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <span>

#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "batch/shape_invariants.h"
#include "commands.h"
#include "files/file.h"
#include "program.h"
#include "thumbnail.h"

namespace orbifit {

namespace {

using batch::Item;
using batch::Outcome;
using batch::Status;
using nlohmann::ordered_json;
using Words = std::vector<std::string>;

// Options of the commands that change what they find and name no file.
struct TaskOptions {
  const char* task;
  std::vector<std::string> names;
};
const std::array<TaskOptions, 4> kTasks{
    TaskOptions{"detect", {"tolerance", "time-budget", "max-seconds", "samples", "simplify-above-faces", "all"}},
    TaskOptions{"fit",
                {"aligned", "viewpoint", "scale", "detail", "without", "auto-relax", "drop-unsupported", "no-contacts",
                 "stiffness", "scan-points", "max-residual", "mode", "lift", "radius", "samples", "sharp-features"}},
    TaskOptions{"symmetrize", {"without", "remesh", "min-score"}}, TaskOptions{"info", {}}};

constexpr std::string_view kResult = "item.json";

const TaskOptions* find_task(const std::string& name) {
  const auto found = std::ranges::find(kTasks, name, &TaskOptions::task);
  return found == kTasks.end() ? nullptr : &*found;
}

// "--samples 100" of "samples": 100. Throws UsageError.
Words option_words(const TaskOptions& task, const std::string& given, const std::string& value) {
  std::string name = given;
  std::ranges::replace(name, '_', '-');
  if (std::ranges::find(task.names, name) == task.names.end()) {
    std::string known;
    for (const std::string& other : task.names) known += (known.empty() ? "" : ", ") + other;
    throw UsageError("option '" + given + "' is none of " + task.task + " in a batch" +
                     (known.empty() ? "" : " (they are " + known + ")"));
  }
  const ordered_json json = ordered_json::parse(value);
  const auto text = [&](const ordered_json& part) {
    if (part.is_string()) return part.get<std::string>();
    if (part.is_number()) return part.dump();
    throw UsageError("option '" + given + "' is " + value +
                     ": must be a number, a text, a list of them, true or false");
  };
  if (json.is_boolean()) return json.get<bool>() ? Words{"--" + name} : Words{};
  if (!json.is_array()) return {"--" + name + "=" + text(json)};
  Words words{"--" + name};
  for (const ordered_json& part : json) words.push_back(text(part));
  return words;
}

// A path that no command takes for an option.
std::string operand(const std::filesystem::path& path) {
  return path.native().starts_with('-') ? "./" + path.native() : path.native();
}

// What the program said last on standard error, without its name.
std::string own_message() {
  std::string text = batch::own_output(STDERR_FILENO);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text.erase(0, text.rfind('\n') + 1);
  constexpr std::string_view name = "orbifit: ";
  return text.starts_with(name) ? text.substr(name.size()) : text;
}

// One item being done.
class Doing {
 public:
  Doing(const BatchTask& task, const Item& item, const std::filesystem::path& folder)
      : task_(task),
        item_(item),
        folder_(folder),
        parallelism_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(task.threads)) {
    run_.seed = task.seed;
    run_.threads = task.threads;
  }

  Outcome run() {
    try {
      if (task_.name == "detect") detect("item.json", true);
      if (task_.name == "fit") fit();
      if (task_.name == "symmetrize") symmetrize();
      if (task_.name == "info") info();
      if (good()) describe();
    } catch (const UsageError& error) {
      say(Status::bad_input, error.what());
    } catch (const InputError& error) {
      say(Status::bad_input, error.what());
    } catch (const Error& error) {
      say(Status::failed, error.what());
    }
    outcome_.summary = summary_.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
    outcome_.no_room = outcome_.status == Status::bad_input && outcome_.message.starts_with(folder_.native());
    return outcome_;
  }

 private:
  bool good() const { return outcome_.status == Status::ok || outcome_.status == Status::no_symmetry; }

  void say(Status status, std::string message) {
    outcome_.status = status;
    outcome_.message = std::move(message);
  }

  // Runs a command of the program; what it prints is its JSON.
  std::optional<ordered_json> command(Words words, bool own_options) {
    words.insert(words.begin(), "orbifit");
    for (const char* flag : {"--json", "--quiet"}) words.emplace_back(flag);
    words.push_back("--seed=" + std::to_string(task_.seed));
    words.push_back("--threads=" + std::to_string(task_.threads));
    if (own_options) append_options(words);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    batch::clear_own_output(STDOUT_FILENO);
    const int code = run_program(commands::all(), static_cast<int>(words.size()), pointers.data());
    std::fflush(stdout);
    switch (code) {
      case kDone:
        return ordered_json::parse(batch::own_output(STDOUT_FILENO));
      case kUsage:
      case kBadInput:
        say(Status::bad_input, own_message());
        break;
      case kTimeout:
        say(Status::timeout, own_message());
        break;
      default:
        say(own_message() == "not enough memory" ? Status::oom : Status::failed, own_message());
    }
    return std::nullopt;
  }

  // Those of the item take the place of those for all.
  void append_options(Words& words) const {
    std::map<std::string, std::string> options;
    for (const auto* list : {&task_.options, &item_.options}) {
      for (const auto& [name, value] : *list) options[name] = value;
    }
    for (const auto& [name, value] : options) {
      const Words more = option_words(*find_task(task_.name), name, value);
      words.insert(words.end(), more.begin(), more.end());
    }
  }

  std::string file(std::string_view name) const { return (folder_ / name).native(); }

  // Whether there is any symmetry.
  bool detect(std::string_view to, bool own_options) {
    const auto found = command({"detect", operand(item_.mesh), "-o", file(to)}, own_options);
    if (!found) return false;
    for (const auto& region : found->at("regions")) {
      summary_["regions"].push_back({{"group", region.at("group")}, {"area", region.at("area_fraction")}});
    }
    for (const auto& pattern : found->at("patterns")) {
      summary_["patterns"].push_back({{"kind", pattern.at("kind")}, {"instances", pattern.at("instances")}});
    }
    const bool any = !found->at("regions").empty() || !found->at("patterns").empty();
    if (!any) say(Status::no_symmetry, "");
    return any;
  }

  void fit() {
    if (item_.scans.empty()) return say(Status::bad_input, "the item has no scan to be fitted to");
    Words words{"fit", operand(item_.mesh)};
    for (const auto& scan : item_.scans) words.push_back(operand(scan));
    const Words outputs{"-o",          file("item+fitted.ply"), "--report",
                        file(kResult), "--annotation-out",      file("item+annotation.json")};
    words.insert(words.end(), outputs.begin(), outputs.end());
    if (!item_.annotation.empty()) words.push_back("--annotation=" + item_.annotation.native());
    auto report = command(words, true);
    if (!report) return;
    // The record has the time; without it the same fit leaves the same bytes.
    report->erase("seconds");
    write_file(file(kResult), report->dump(2) + "\n");
    for (const char* key : {"inlier_fraction", "hidden_fraction", "confidence", "rms"}) {
      if (report->contains(key)) summary_["fit"][key] = report->at(key);
    }
  }

  void symmetrize() {
    std::string annotation = item_.annotation.native();
    if (annotation.empty()) {
      annotation = file("found.json");
      if (!detect("found.json", false)) return;
    }
    const auto report = command({"symmetrize", operand(item_.mesh), operand(annotation), "-o",
                                 file("item+symmetric.ply"), "--annotation-out", file(kResult)},
                                true);
    if (report) summary_["symmetrize"]["largest_movement"] = report->at("largest_movement");
  }

  void info() {
    const auto found = command({"info", operand(item_.mesh)}, true);
    if (found) write_file(file(kResult), found->dump(2) + "\n");
  }

  // What the report and the export want to know of every mesh.
  void describe() {
    const Mesh mesh = read_mesh(item_.mesh);
    const batch::ShapeInvariants invariants = batch::shape_invariants(mesh);
    ordered_json shape = ordered_json::array();
    for (const double value : invariants.values) shape.push_back(value);
    summary_["mesh"] = {{"file", std::filesystem::absolute(item_.mesh).native()},
                        {"hash", batch::identify(item_.mesh).hash.text()},
                        {"vertices", mesh.vertices.rows()},
                        {"faces", mesh.faces.rows()},
                        {"diagonal", diagonal(mesh.vertices)},
                        {"shape", shape}};
    if (!task_.thumbnails) return;
    const bool symmetrized = task_.name == "symmetrize" && outcome_.status == Status::ok;
    const Mesh shown = task_.name == "fit" ? read_mesh(file("item+fitted.ply"))
                       : symmetrized       ? read_mesh(file("item+symmetric.ply"))
                                           : mesh;
    SymmetryAnnotation annotation = empty_annotation(mesh, kTolerance);
    if (task_.name == "detect" || symmetrized) annotation = read_annotation(file(kResult), shown);
    if (task_.name == "fit") annotation = read_annotation(file("item+annotation.json"), shown);
    write_png(file("item+thumbnail.png"), thumbnail(shown, annotation, task_.up, run_));
  }

  static constexpr double kTolerance = 0.005;  // of an annotation that says nothing

  const BatchTask& task_;
  const Item& item_;
  const std::filesystem::path& folder_;
  tbb::global_control parallelism_;  // Embree's trees are built on TBB's threads, each of which takes memory
  RunContext run_;
  Outcome outcome_;
  ordered_json summary_ = ordered_json::object();
};

}  // namespace

void BatchTask::validate() const {
  const TaskOptions* task = find_task(name);
  if (task == nullptr) {
    throw UsageError("--task is '" + name + "': must be detect, fit, symmetrize or info");
  }
  for (const auto& [option, value] : options) option_words(*task, option, value);
}

std::string BatchTask::settings() const {
  ordered_json all{{"version", ORBIFIT_VERSION},
                   {"task", name},
                   {"seed", seed},
                   {"thumbnails", thumbnails},
                   {"up", {up.x(), up.y(), up.z()}}};
  for (const auto& [option, value] : std::map<std::string, std::string>(options.begin(), options.end())) {
    all["options"][option] = ordered_json::parse(value);
  }
  return all.dump();
}

std::vector<std::string> BatchTask::kinds() const {
  return {".json", "+thumbnail.png", "+fitted.ply", "+annotation.json", "+symmetric.ply"};
}

batch::Outcome BatchTask::run(const Item& item, const std::filesystem::path& folder) const {
  return Doing(*this, item, folder).run();
}

}  // namespace orbifit
