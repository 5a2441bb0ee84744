#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include "orbifit/detection/detect.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/model/scan_io.h"

#include "benchmarks.h"
#include "files/file.h"
#include "stage_run.h"
#include "stopwatch.h"

namespace orbifit::benchmarks {

namespace {

namespace fs = std::filesystem;

struct ScansOptions {
  std::string pairs, match, annotations, csv;
  bool fixed_scale = false;
  bool detail = false;
  StageRun stages;
};

// A line of the file of pairs.
struct Pair {
  fs::path mesh, scan;
  bool same = false;  // the scan shows the very thing, at its size
  std::optional<Eigen::Vector3d> viewpoint;
};

// What a fit came to. Lengths are fractions of the template's diagonal.
struct PairRow {
  std::string name;
  bool same = false;
  std::string failure;  // of reading, detecting or building; empty: none
  bool fitted = false;
  double confidence = 0, explained = 0, used = 0, coverage = 0, part = 0, open = 0;
  double bent = 0;  // root mean square over vertices, after the similarity that suits them best
  double size = 1;  // of that similarity
  double rms = 0;
  double seconds = 0;
};

// Tab-separated: template, scan, "same" or "kind", and perhaps three numbers. Paths are relative to the file's folder.
std::vector<Pair> read_pairs(const fs::path& file) {
  std::istringstream text(read_file(file));
  std::vector<Pair> pairs;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream cells(line);
    std::string mesh, scan, kind, place;
    std::getline(cells, mesh, '\t');
    std::getline(cells, scan, '\t');
    std::getline(cells, kind, '\t');
    if (kind != "same" && kind != "kind") {
      throw InputError(file, "line " + std::to_string(number), "must be a template, a scan and 'same' or 'kind'");
    }
    Pair pair{file.parent_path() / mesh, file.parent_path() / scan, kind == "same", std::nullopt};
    if (std::getline(cells, place)) {
      std::istringstream numbers(place);
      Eigen::Vector3d viewpoint;
      if (!(numbers >> viewpoint.x() >> viewpoint.y() >> viewpoint.z())) {
        throw InputError(file, "line " + std::to_string(number), "the viewpoint must be three numbers");
      }
      pair.viewpoint = viewpoint;
    }
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

SymmetryAnnotation annotation_of(const Mesh& mesh, const fs::path& file, RunContext& context) {
  if (!file.empty() && fs::exists(file)) return read_annotation(file, mesh);
  const SymmetryAnnotation found = detect(mesh, DetectOptions{}, context);
  if (!file.empty()) write_annotation(file, found);
  return found;
}

void measure_shape(const Mesh& mesh, const Mesh& fitted, PairRow& row) {
  const Eigen::MatrixXd from = mesh.vertices.transpose();
  const Eigen::MatrixXd to = fitted.vertices.transpose();
  const Eigen::Matrix4d best = Eigen::umeyama(from, to, true);
  const Eigen::MatrixXd apart = (best.topLeftCorner<3, 3>() * from).colwise() + best.topRightCorner<3, 1>().eval();
  row.size = std::cbrt(best.topLeftCorner<3, 3>().determinant());
  row.bent =
      std::sqrt((apart - to).squaredNorm() / static_cast<double>(from.cols())) / (row.size * diagonal(mesh.vertices));
}

PairRow measure(const Pair& pair, const ScansOptions& options, RunContext context) {
  PairRow row;
  row.name = pair.scan.stem().string();
  row.same = pair.same;
  try {
    const Mesh mesh = read_mesh(pair.mesh);
    PointCloud scan = read_scan(pair.scan);
    if (pair.viewpoint) scan.viewpoints = pair.viewpoint->transpose();
    const fs::path file = options.annotations.empty()
                              ? fs::path()
                              : fs::path(options.annotations) / (pair.mesh.stem().string() + ".json");
    const SymmetryAnnotation annotation = made_consistent(mesh, annotation_of(mesh, file, context), context);
    FitOptions chosen;
    chosen.place = true;
    chosen.fixed_scale = options.fixed_scale;
    chosen.detail = options.detail;
    const double start = seconds_now();
    const FitResult result = fit({mesh, annotation, scan, Similarity{}}, chosen, context);
    row.seconds = seconds_now() - start;
    row.fitted = result.converged;
    row.confidence = result.confidence;
    row.explained = result.inlier_ratio;
    row.used = result.overlap;
    row.coverage = result.visible_coverage;
    row.part = result.unexplained_part;
    row.open = result.open_stretch();
    row.rms = result.rms;
    measure_shape(mesh, result.fitted, row);
  } catch (const InterruptedError&) {
    throw;
  } catch (const std::exception& error) {
    row.failure = error.what();
  }
  return row;
}

std::vector<std::string> cells(const PairRow& row) {
  if (!row.failure.empty()) return {row.name, "failed"};
  const auto part = [](double share) { return short_number(share, 3); };
  return {row.name,
          row.fitted ? "yes" : "no",
          part(row.confidence),
          part(row.explained),
          part(row.used),
          part(row.coverage),
          part(row.part),
          part(row.open),
          part(100 * row.rms),
          part(100 * row.bent),
          part(row.size),
          part(row.seconds)};
}

std::vector<std::string> columns() {
  return {"scan", "fitted", "confidence", "explained", "used", "seen",
          "part", "open",   "rms, %",     "bent, %",   "size", "seconds"};
}

std::string summary(const std::vector<PairRow>& rows) {
  int fitted = 0, same = 0, sure = 0;
  double bent = 0, most_bent = 0, off = 0, most_off = 0;
  for (const PairRow& row : rows) {
    if (!row.failure.empty()) continue;
    fitted += row.fitted ? 1 : 0;
    if (!row.same) continue;
    constexpr double kSure = 0.7;  // as the verdict has it
    ++same;
    sure += row.confidence >= kSure ? 1 : 0;
    bent += row.bent;
    most_bent = std::max(most_bent, row.bent);
    off += std::abs(row.size - 1);
    most_off = std::max(most_off, std::abs(row.size - 1));
  }
  const auto percent = [](double share) { return short_number(100 * share, 3); };
  std::string text = "\n" + count_of(static_cast<long long>(rows.size()), "pair") + ", " + std::to_string(fitted) +
                     " taken for fitted\n";
  if (same == 0) return text;
  return text + count_of(same, "scan") + " of the very thing: " + std::to_string(sure) +
         " with a confidence of .7 or more; bent by " + percent(bent / same) + " % of the diagonal, " +
         percent(most_bent) + " at most; size off by " + percent(off / same) + " %, " + percent(most_off) +
         " at most\n";
}

std::string failures(const std::vector<PairRow>& rows) {
  std::string text;
  for (const PairRow& row : rows) {
    if (!row.failure.empty()) text += "  " + row.name + " failed: " + row.failure + "\n";
  }
  return text;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string text;
  for (std::string cell : cells) {
    for (std::size_t at = 0; (at = cell.find('"', at)) != std::string::npos; at += 2) cell.insert(at, 1, '"');
    text += (text.empty() ? "\"" : ",\"") + cell + "\"";
  }
  return text + "\n";
}

int run(const ScansOptions& options, const CommandContext& context) {
  if (!options.csv.empty()) check_output(options.csv);
  if (!options.annotations.empty()) make_folder(options.annotations);
  std::vector<Pair> pairs = read_pairs(options.pairs);
  std::erase_if(pairs, [&](const Pair& pair) {
    return (pair.scan.string() + pair.mesh.string()).find(options.match) == std::string::npos;
  });
  if (pairs.empty()) throw NoResultError("there is no pair to measure");
  const RunContext stages = stage_context(context, options.stages);
  std::vector<PairRow> rows;
  TextTable table(columns());
  std::string csv = csv_line(columns());
  for (const Pair& pair : pairs) {
    context.run.check();
    rows.push_back(measure(pair, options, stages));
    context.run.message(rows.back().name + ": " + short_number(rows.back().seconds, 3) + " s");
    table.add(cells(rows.back()));
    csv += csv_line(cells(rows.back()));
  }
  print(table.text() + failures(rows) + summary(rows));
  if (!options.csv.empty()) write_file(options.csv, csv);
  return kDone;
}

}  // namespace

CommandBody scans(CLI::App& app) {
  auto options = std::make_shared<ScansOptions>();
  app.add_option(
         "PAIRS", options->pairs,
         "Lines of a template's file, a scan's, 'same' or 'kind' and perhaps the scan's viewpoint, tab-separated; "
         "'same' is a scan of the very thing that the mesh shows")
      ->required();
  app.add_option("--match", options->match, "Only the pairs in whose paths this text stands")->type_name("TEXT");
  app.add_option("--annotations", options->annotations,
                 "Folder of annotations: those that are there are read in place of detecting, the others are detected "
                 "and written there")
      ->type_name("DIR");
  app.add_flag("--detail", options->detail, "Fit detail as well, as `orbifit fit --detail` does");
  app.add_flag("--fixed-scale", options->fixed_scale, "The templates have the size of their files");
  add_stage_run(app, options->stages, "the fits");
  app.add_option("--csv", options->csv, "Write a line for each pair to a file")->type_name("FILE");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks
