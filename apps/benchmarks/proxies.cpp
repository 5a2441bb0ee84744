#include <algorithm>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "base/random.h"
#include "benchmarks.h"
#include "files/file.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "models.h"
#include "peers/decimater.h"
#include "resolution/coarse_mesh.h"
#include "stage_run.h"
#include "stopwatch.h"

namespace orbifit::benchmarks {

namespace {

constexpr int kSamples = 50000;  // on each surface

struct ProxiesOptions {
  std::vector<std::string> meshes, models{"centre_piece", "plane", "yard_tool", "car", "wind_mill", "chair"};
  std::string json;
  double tolerance = 0.005;
  bool peers = true;
  StageRun stages;
};

struct Distance {
  double mean = 0, most = 0;  // fractions of the fine mesh's diagonal
};

struct ProxyRow {
  std::string model, method;
  Eigen::Index faces = 0;
  Distance to_proxy, to_fine;
  double seconds = 0;
  std::string note;
};

Distance distance(const Mesh& from, const Mesh& to, double size, const RunContext& context) {
  Random random(context.seed, "distance to a proxy mesh");
  const SurfaceSamples samples = sample_surface(from, kSamples, random);
  const SurfaceIndex surface(to);
  Distance result;
  for (const auto& point : samples.points.rowwise()) {
    const double here = surface.nearest(point.transpose()).distance / size;
    result.mean += here / static_cast<double>(samples.points.rows());
    result.most = std::max(result.most, here);
  }
  return result;
}

void compare(const Mesh& proxy, const Mesh& fine, const RunContext& context, ProxyRow& row) {
  const double size = diagonal(fine.vertices);
  row.faces = proxy.faces.rows();
  row.to_proxy = distance(fine, proxy, size, context);
  row.to_fine = distance(proxy, fine, size, context);
}

std::vector<ProxyRow> measure(const std::string& name, const Mesh& mesh, const ProxiesOptions& options,
                              const RunContext& context) {
  const PreparedMesh fine = prepare(mesh);
  ProxyRow ours{name, "ours", 0, {}, {}, 0, ""};
  double start = seconds_now();
  const std::optional<CoarseMesh> coarse = coarse_mesh(fine, {options.tolerance}, context);
  ours.seconds = seconds_now() - start;
  if (!coarse) {
    ours.note = "has too few faces for a proxy to be worth it";
    return {ours};
  }
  compare(coarse->mesh, fine.mesh, context, ours);
  if (!options.peers) return {ours};
  ProxyRow theirs{name, "OpenMesh", 0, {}, {}, 0, ""};
  try {
    start = seconds_now();
    const Mesh proxy = decimated(fine.mesh, static_cast<int>(ours.faces));
    theirs.seconds = seconds_now() - start;
    compare(proxy, fine.mesh, context, theirs);
  } catch (const InputError& error) {
    theirs.note = error.what();
  }
  return {ours, theirs};
}

std::string text_of(const std::vector<ProxyRow>& rows) {
  TextTable table({"model", "method", "faces", "to proxy", "most", "to fine", "most", "two-sided", "s"});
  std::string notes;
  for (const ProxyRow& row : rows) {
    if (!row.note.empty()) notes += "  " + row.model + ", " + row.method + ": " + row.note.substr(0, 160) + "\n";
    if (row.faces == 0) continue;
    const auto cell = [](double fraction) { return short_number(100 * fraction, 3); };
    table.add({row.model, row.method, std::to_string(row.faces), cell(row.to_proxy.mean), cell(row.to_proxy.most),
               cell(row.to_fine.mean), cell(row.to_fine.most), cell(std::max(row.to_proxy.most, row.to_fine.most)),
               short_number(row.seconds, 3)});
  }
  return "Proxy meshes of fine meshes, beside OpenMesh's Decimater at the same number of faces\n" + table.text() +
         "to proxy: from points of the fine mesh to the proxy, mean and most; to fine: the other way; two-sided: the "
         "greater\nof both; percent of the diagonal.\n" +
         notes;
}

std::string json_of(const std::vector<ProxyRow>& rows) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const ProxyRow& row : rows) {
    all.push_back({{"model", row.model},
                   {"method", row.method},
                   {"faces", row.faces},
                   {"to_proxy_mean", row.to_proxy.mean},
                   {"to_proxy_most", row.to_proxy.most},
                   {"to_fine_mean", row.to_fine.mean},
                   {"to_fine_most", row.to_fine.most},
                   {"seconds", row.seconds},
                   {"note", row.note}});
  }
  return nlohmann::ordered_json{{"rows", all}}.dump(2) + "\n";
}

int run(const ProxiesOptions& options, const CommandContext& given) {
  if (!options.json.empty()) check_output(options.json);
  const RunContext context = stage_context(given, options.stages);
  std::vector<ProxyRow> rows;
  const auto add = [&](const std::string& name, const Mesh& mesh) {
    given.run.check();
    given.run.message(name + ": " + count_of(mesh.faces.rows(), "face"));
    for (const ProxyRow& row : measure(name, mesh, options, context)) rows.push_back(row);
  };
  for (const std::string& file : options.meshes) add(std::filesystem::path(file).filename().string(), read_mesh(file));
  for (const std::string& model : options.meshes.empty() ? options.models : std::vector<std::string>{}) {
    add(model, benchmark_model(model).mesh);
  }
  if (!options.json.empty()) write_file(options.json, json_of(rows));
  print(text_of(rows));
  return kDone;
}

}  // namespace

CommandBody proxies(CLI::App& app) {
  auto options = std::make_shared<ProxiesOptions>();
  app.add_option("meshes", options->meshes, "Mesh files; without any, models of Table 1")->type_name("MESH ...");
  app.add_option("--models", options->models, "Which models")->delimiter(',')->type_name("NAME,...");
  app.add_option("--tolerance", options->tolerance, "Of detection, a fraction of the diagonal")
      ->check(CLI::Range(1e-6, 0.1))
      ->capture_default_str();
  app.add_flag("!--no-peers", options->peers, "Leave OpenMesh out");
  add_stage_run(app, options->stages, "sampled points");
  app.add_option("--json", options->json, "Write the rows to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks
