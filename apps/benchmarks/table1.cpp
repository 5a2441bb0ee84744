#include "table1.h"

#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "orbifit/model/errors.h"

#include "benchmarks.h"
#include "files/file.h"
#include "lift_floor.h"
#include "soft_symmetry.h"
#include "stopwatch.h"
#include "subject.h"

namespace orbifit::benchmarks {

namespace {

constexpr double kSoftWeights[] = {1, 100, 1e4};

struct Table1Options {
  std::vector<std::string> models;
  std::vector<int> threads;
  std::string json;
  std::string mode = "fixed";
  bool no_peers = false;
  int repeat = 7;
};

std::vector<SoftRow> measure_soft(const BenchmarkModel& model, const Subspace& subspace, const RunContext& context,
                                  const TimingOptions& timing) {
  const HandleRows handles = handle_rows(model, subspace, context);
  const SoftSampling sampling = soft_sampling(subspace);
  std::vector<SoftRow> rows;
  for (const double weight : kSoftWeights) {
    SoftRow& row = rows.emplace_back();
    row.weight = weight;
    SoftSymmetry soft(sampling, weight);
    row.prefactor_ms = median_ms([&] { soft.set_handles(handles.rows, handles.weights, kAlpha); }, timing);
    row.solve5_ms = median_ms([&] { soft.solve(handles.targets, kIterations); }, timing);
    row.residual = soft.symmetry_residual() / diagonal(model.mesh.vertices);
  }
  return rows;
}

// What does not depend on the number of threads is measured with the first.
void measure_once(const BenchmarkModel& model, const Subject& subject, const RunContext& context,
                  const Table1Options& options, const TimingOptions& timing, Table1Row& row) {
  row.field_residual = subject.field_residual();
  row.mesh_residual = subject.mesh_residual();
  if (options.no_peers) return;
  context.message(model.name + ": peers");
  row.soft = measure_soft(model, subject.subspace(), context, timing);
  row.arap = arap_times(model, options.repeat);
}

void measure_ours(const BenchmarkModel& model, double radius, GroupMode mode, const RunContext& context,
                  const TimingOptions& timing, Table1Row& row, std::unique_ptr<Subject>& subject) {
  row.build_ms = median_ms([&] { subject = std::make_unique<Subject>(model, radius, mode, context); }, timing);
  row.setup_ms = median_ms([&] { subject->start_editing(); }, timing);
  row.prefactor_ms = median_ms([&] { subject->prefactor(); }, timing);
  row.solve5_ms = median_ms([&] { subject->solve5(); }, timing);
  row.lift_ms = median_ms([&] { subject->lift(); }, timing);
  const Subject::Traffic traffic = subject->lift_traffic();
  row.lift_bytes = static_cast<double>(traffic.read + traffic.written);
  row.lift_floor_ms = stream_ms(traffic.read, traffic.written, context.threads, timing);
  row.samples = subject->samples();
  row.degrees_of_freedom = subject->degrees_of_freedom();
  row.handle_error = subject->handle_error();
}

void measure(const std::string& name, const Table1Options& options, const RunContext& given,
             std::vector<Table1Row>& rows) {
  const BenchmarkModel model = benchmark_model(name);
  const GroupMode mode = options.mode == "fixed"      ? GroupMode::fixed
                         : options.mode == "floating" ? GroupMode::floating
                                                      : GroupMode::moving;
  RunContext context = given;
  context.on_message = nullptr;  // of the stages: they are run many times
  TimingOptions timing;
  timing.repetitions = options.repeat;
  given.message(name + ": radius");
  const double radius = radius_for_samples(model, model.paper.samples, mode, context);
  Table1Row shared;
  shared.model = name;
  shared.paper = model.paper;
  shared.vertices = static_cast<int>(model.mesh.vertices.rows());
  shared.triangles = static_cast<int>(model.mesh.faces.rows());
  shared.groups = static_cast<int>(model.annotation.regions.size());
  shared.radius = radius / diagonal(model.mesh.vertices);
  bool first = true;
  for (const int threads : options.threads) {
    given.message(name + ": " + count_of(threads, "thread"));
    context.threads = threads;
    Table1Row row = shared;
    row.threads = threads;
    std::unique_ptr<Subject> subject;
    measure_ours(model, radius, mode, context, timing, row, subject);
    if (first) {
      RunContext quiet = given;
      quiet.threads = threads;
      measure_once(model, *subject, quiet, options, timing, row);
      shared.field_residual = row.field_residual;
      shared.mesh_residual = row.mesh_residual;
      shared.soft = row.soft;
      shared.arap = row.arap;
      first = false;
    }
    rows.push_back(std::move(row));
  }
}

int run(Table1Options options, const CommandContext& context) {
  if (options.models.empty()) options.models = benchmark_model_names();
  if (options.threads.empty()) options.threads = {1, 2};
  if (options.repeat < 1) throw UsageError("--repeat is " + std::to_string(options.repeat) + ": must be at least 1");
  for (const int threads : options.threads) {
    if (threads < 1 || threads > 4096) {
      throw UsageError("--threads is " + std::to_string(threads) + ": must be from 1 to 4096");
    }
  }
  if (!options.json.empty()) check_output(options.json);
  std::vector<Table1Row> rows;
  for (const std::string& name : options.models) measure(name, options, context.run, rows);
  if (!options.json.empty()) write_file(options.json, table1_json(rows));
  print(table1_text(rows));
  return kDone;
}

}  // namespace

CommandBody table1(CLI::App& app) {
  auto options = std::make_shared<Table1Options>();
  app.add_option("--models", options->models, "Only these models")->delimiter(',')->type_name("NAME,...");
  app.add_option("--threads", options->threads, "Numbers of threads; 1,2 where not given")
      ->delimiter(',')
      ->type_name("N,...");
  app.add_option("--mode", options->mode, "What may become of the groups; the paper's are fixed")
      ->check(CLI::IsMember({"fixed", "floating", "moving"}))
      ->capture_default_str();
  app.add_option("--repeat", options->repeat, "Batches of which the median time is taken")
      ->type_name("K")
      ->capture_default_str();
  app.add_flag("--no-peers", options->no_peers, "Leave out CGAL and the soft constraints");
  app.add_option("--json", options->json, "Write the rows to a file, as an array")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks
