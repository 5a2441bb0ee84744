#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <malloc.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

#include "benchmarks.h"
#include "files/file.h"
#include "stage_run.h"
#include "stopwatch.h"
#include "subject.h"

namespace orbifit::benchmarks {

namespace {

constexpr double kRadius = 0.035;  // of the diagonal
constexpr double kSizes[] = {1e4, 1e5, 1e6, 1e7};

struct ScalingOptions {
  double most = 1e7;
  std::string model = "plane";
  std::string json;
  StageRun stages;
};

struct ScalingRow {
  double vertices = 0, samples = 0, degrees_of_freedom = 0;
  double seconds = 0;
  double mesh_bytes = 0;  ///< held by the process before the subspace is built
  double peak_bytes = 0;  ///< most that it held while building
};

double status_bytes(const char* key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return 1024 * std::stod(line.substr(std::string(key).size() + 1));
  }
  return 0;
}

// Makes the peak that the kernel keeps start from what is held now. Where that is refused the peak may be the
// generator's.
void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

// The fineness at which the model has about so many vertices; they grow with its square.
int detail_for(const std::string& model, double vertices) {
  const auto& all = generators();
  const auto generator = std::ranges::find(all, model, &Generator::name);
  if (generator == all.end()) throw UsageError("unknown model '" + model + "'; 'orbifit generate --list' names them");
  const auto detail = std::ranges::find(generator->parameters, "detail", &GeneratorParameter::name);
  if (detail == generator->parameters.end()) throw UsageError("--model is " + model + ": it has no 'detail'");
  static const double usual = static_cast<double>(generate(model).mesh.vertices.rows());
  return static_cast<int>(
      std::clamp(std::round(detail->value * std::sqrt(vertices / usual)), detail->minimum, detail->maximum));
}

ScalingRow measure(int detail, const ScalingOptions& options, const RunContext& context) {
  GeneratedModel generated = generate(options.model, {{"detail", detail}});
  const BenchmarkModel model{options.model, std::move(generated.mesh), std::move(generated.truth), {}, {}};
  const double radius = kRadius * diagonal(model.mesh.vertices);
  ::malloc_trim(0);  // what the generator held and gave back would be taken again unseen
  ScalingRow row;
  row.vertices = static_cast<double>(model.mesh.vertices.rows());
  reset_peak();
  row.mesh_bytes = status_bytes("VmRSS:");
  const double start = seconds_now();
  const Subject subject(model, radius, GroupMode::floating, context);
  row.seconds = seconds_now() - start;
  row.peak_bytes = status_bytes("VmHWM:");
  if (row.peak_bytes == 0) {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    row.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  }
  row.samples = subject.samples();
  row.degrees_of_freedom = subject.degrees_of_freedom();
  return row;
}

// In a process of its own, so that no size sees what another one left in memory.
std::optional<ScalingRow> measure_apart(int detail, const ScalingOptions& options, const RunContext& context) {
  int ends[2];
  if (::pipe(ends) != 0) throw NoResultError("no pipe to a process of its own");
  const pid_t child = ::fork();
  if (child < 0) throw NoResultError("no process of its own");
  if (child == 0) {
    ::close(ends[0]);
    int code = kNoResult;
    try {
      const ScalingRow row = measure(detail, options, context);
      if (::write(ends[1], &row, sizeof(row)) == static_cast<ssize_t>(sizeof(row))) code = kDone;
    } catch (const std::exception& error) {
      std::fprintf(stderr, "orbifit-benchmark: %s\n", error.what());
    }
    ::_exit(code);
  }
  ::close(ends[1]);
  ScalingRow row;
  const bool whole = ::read(ends[0], &row, sizeof(row)) == static_cast<ssize_t>(sizeof(row));
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return whole ? std::optional(row) : std::nullopt;
}

// Slope of log(seconds) over log(vertices) by least squares.
double fitted_exponent(const std::vector<ScalingRow>& rows) {
  double n = 0;
  double x = 0;
  double y = 0;
  double xx = 0;
  double xy = 0;
  for (const ScalingRow& row : rows) {
    const double a = std::log(row.vertices);
    const double b = std::log(row.seconds);
    n += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

std::string text_of(const std::vector<ScalingRow>& rows, const ScalingOptions& options) {
  TextTable table({"vertices", "samples", "DoF", "seconds", "vertices/s", "MB before", "MB peak", "bytes/vertex",
                   "bytes/vertex of the peak"});
  for (const ScalingRow& row : rows) {
    table.add({short_number(row.vertices, 9), short_number(row.samples), short_number(row.degrees_of_freedom),
               short_number(row.seconds, 3), short_number(std::round(row.vertices / row.seconds), 8),
               short_number(1e-6 * row.mesh_bytes, 3), short_number(1e-6 * row.peak_bytes, 4),
               short_number((row.peak_bytes - row.mesh_bytes) / row.vertices, 3),
               short_number(row.peak_bytes / row.vertices, 4)});
  }
  std::string text =
      "Building the subspace of the " + options.model + ", " + count_of(options.stages.threads, "thread") + "\n";
  text += table.text();
  if (rows.size() > 1) {
    text += "  seconds ~ vertices^" + short_number(fitted_exponent(rows), 3) + " over all sizes, vertices^" +
            short_number(fitted_exponent({rows.end() - 2, rows.end()}), 3) + " over the last two.\n";
  }
  return text +
         "  MB before: the process with the mesh and its annotation; MB peak: the most while building, that included;\n"
         "  bytes/vertex: what building adds to the former. One model, ever finer; the same radius.\n";
}

std::string json_of(const std::vector<ScalingRow>& rows, const ScalingOptions& options) {
  nlohmann::json list = nlohmann::json::array();
  for (const ScalingRow& row : rows) {
    list.push_back({{"model", options.model},
                    {"threads", options.stages.threads},
                    {"vertices", row.vertices},
                    {"samples", row.samples},
                    {"dof", row.degrees_of_freedom},
                    {"seconds", row.seconds},
                    {"vertices_per_second", row.vertices / row.seconds},
                    {"bytes_before", row.mesh_bytes},
                    {"bytes_peak", row.peak_bytes},
                    {"bytes_per_vertex", (row.peak_bytes - row.mesh_bytes) / row.vertices},
                    {"bytes_peak_per_vertex", row.peak_bytes / row.vertices}});
  }
  nlohmann::json result{{"rows", list}};
  if (rows.size() > 1) result["exponent"] = fitted_exponent(rows);
  return result.dump(2) + "\n";
}

int run(const ScalingOptions& options, const CommandContext& context) {
  if (!(options.most >= 1e3 && options.most <= 1e9)) {
    throw UsageError("--most is " + short_number(options.most) + ": must be from 1000 to 1e9");
  }
  const RunContext stages = stage_context(context, options.stages);
  if (!options.json.empty()) check_output(options.json);
  std::vector<ScalingRow> rows;
  int last = 0;
  double failed = 0;
  for (const double size : kSizes) {
    const double wanted = std::min(size, options.most);
    const int detail = detail_for(options.model, wanted);
    if (detail == last) continue;
    last = detail;
    context.run.check();
    context.run.message("about " + short_number(wanted, 9) + " vertices");
    const auto row = measure_apart(detail, options, stages);
    if (!row) {
      failed = wanted;
      break;
    }
    rows.push_back(*row);
  }
  if (!options.json.empty()) write_file(options.json, json_of(rows, options));
  print(text_of(rows, options));
  if (failed > 0) {
    throw NoResultError("the subspace of about " + short_number(failed, 9) +
                        " vertices could not be built; the memory may be too small");
  }
  return kDone;
}

}  // namespace

CommandBody scaling(CLI::App& app) {
  auto options = std::make_shared<ScalingOptions>();
  app.add_option("--most", options->most, "Largest number of vertices")->type_name("V")->capture_default_str();
  app.add_option("--model", options->model, "A model that 'orbifit generate --list' names")
      ->type_name("NAME")
      ->capture_default_str();
  add_stage_run(app, options->stages, "the sampling");
  app.add_option("--json", options->json, "Write the rows to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks
