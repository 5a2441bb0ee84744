#include "real.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "benchmarks.h"
#include "files/file.h"
#include "stage_run.h"

namespace orbifit::benchmarks {

namespace {

namespace fs = std::filesystem;

struct RealOptions {
  std::vector<std::string> inputs, modes{"fixed", "floating", "moving"};
  std::string match, annotations, csv;
  double stage_limit = 0;
  StageRun stages;
};

struct Candidate {
  fs::path file;
  bool named = false;  // by the user, not found in a folder
  std::string name;
};

bool is_mesh_file(const fs::path& file) {
  const std::string ending = lower_extension(file);
  return ending == ".obj" || ending == ".off" || ending == ".ply" || ending == ".stl" || ending == ".glb";
}

void add_folder(const fs::path& folder, std::vector<Candidate>& candidates) {
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(folder); entry != fs::recursive_directory_iterator(); ++entry) {
    if (entry->is_directory() && entry->path().filename() == "original") entry.disable_recursion_pending();
    if (entry->is_regular_file() && is_mesh_file(entry->path())) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) candidates.push_back({file, false, {}});
}

std::vector<Candidate> candidates_of(const RealOptions& options) {
  std::vector<Candidate> candidates;
  for (const std::string& input : options.inputs) {
    if (fs::is_directory(input)) {
      add_folder(input, candidates);
    } else if (fs::exists(input)) {
      candidates.push_back({input, true, {}});
    } else {
      throw InputError(input, "", "no such file or folder");
    }
  }
  // Names depend on all files, not on those that match, so that annotations keep theirs.
  std::map<std::string, int> stems;
  for (const Candidate& candidate : candidates) ++stems[candidate.file.stem().string()];
  for (Candidate& candidate : candidates) {
    const std::string stem = candidate.file.stem().string();
    const bool alone = stems[stem] == 1;
    candidate.name = alone ? stem : candidate.file.parent_path().filename().string() + "_" + stem;
  }
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return candidate.file.string().find(options.match) == std::string::npos;
  });
  return candidates;
}

std::vector<GroupMode> modes_of(const RealOptions& options) {
  std::vector<GroupMode> modes;
  for (const std::string& text : options.modes) {
    for (const GroupMode mode : {GroupMode::fixed, GroupMode::floating, GroupMode::moving}) {
      if (text == to_string(mode)) modes.push_back(mode);
    }
  }
  return modes;
}

// Points without faces are a scan.
bool is_scan(const InputError& error) {
  return std::string(error.what()).find("has no faces") != std::string::npos;
}

// The rows of the meshes, each printed as soon as it is known. \throw InterruptedError, with `rows` what is done
void measure_all(const RealOptions& options, const CommandContext& context, const std::vector<GroupMode>& modes,
                 std::vector<RealRow>& rows) {
  const RunContext stages = stage_context(context, options.stages);
  int scans = 0;
  for (const Candidate& candidate : candidates_of(options)) {
    context.run.check();
    RealRow row;
    row.name = candidate.name;
    row.file = candidate.file;
    try {
      const RealMesh real{candidate.file, candidate.name, read_mesh(candidate.file)};
      const fs::path annotation =
          options.annotations.empty() ? fs::path() : fs::path(options.annotations) / (candidate.name + ".json");
      row = measure_real(real, modes, annotation, options.stage_limit, stages);
    } catch (const InputError& error) {
      if (!candidate.named && is_scan(error)) {
        ++scans;
        continue;
      }
      row.failure = error.what();
    }
    print(real_line(row, modes));
    rows.push_back(std::move(row));
    if (!options.csv.empty()) write_file(options.csv, real_csv(rows));
  }
  if (scans > 0) context.run.message(count_of(scans, "file") + " without faces passed over");
}

int run(const RealOptions& options, const CommandContext& context) {
  if (!(options.stage_limit >= 0 && options.stage_limit <= 1e9)) {
    throw UsageError("--stage-limit is " + short_number(options.stage_limit) + ": must be a number of seconds, or 0");
  }
  const std::vector<GroupMode> modes = modes_of(options);
  if (!options.csv.empty()) check_output(options.csv);
  if (!options.annotations.empty()) make_folder(options.annotations);
  std::vector<RealRow> rows;
  print(real_header(modes));
  try {
    measure_all(options, context, modes, rows);
  } catch (const InterruptedError&) {
    if (!rows.empty()) print(real_summary(rows, modes));
    throw;
  }
  if (rows.empty()) throw NoResultError("there is no mesh to measure");
  print(real_summary(rows, modes));
  return kDone;
}

}  // namespace

CommandBody real(CLI::App& app) {
  auto options = std::make_shared<RealOptions>();
  options->stages.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  app.add_option("FOLDER|FILE", options->inputs,
                 "Meshes, and folders in which to look for .obj, .off, .ply, .stl and .glb, also further down; folders "
                 "named 'original' and files without faces are passed over")
      ->required();
  app.add_option("--modes", options->modes, "Modes to measure: fixed, floating, moving")
      ->delimiter(',')
      ->check(CLI::IsMember({"fixed", "floating", "moving"}))
      ->type_name("MODE,...")
      ->capture_default_str();
  app.add_option("--match", options->match, "Only the files whose path holds this text")->type_name("TEXT");
  app.add_option("--annotations", options->annotations,
                 "Folder of annotations: those that are there are read in place of detecting, the others are detected "
                 "and written there")
      ->type_name("DIR");
  app.add_option("--stage-limit", options->stage_limit,
                 "Seconds after which detecting a mesh, or one mode of it, counts as failed; 0: no limit")
      ->type_name("SECONDS")
      ->capture_default_str();
  add_stage_run(app, options->stages, "the handles and the sampling");
  app.add_option("--csv", options->csv, "Write a line for each mesh and mode to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks
