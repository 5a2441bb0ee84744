#include <algorithm>
#include <cstdio>

#include "command.h"
#include "real.h"

namespace orbifit::benchmarks {

namespace {

constexpr double kExactField = 1e-12;  // of the diagonal
constexpr double kExactMesh = 1e-9;    // of the diagonal

// Cells of a line whose columns stand still, since each line is printed as soon as it is known.
std::string cell(std::string text, int width) {
  const auto size = static_cast<std::size_t>(std::abs(width));
  if (text.size() > size) text.resize(size);
  const std::string blanks(size - text.size(), ' ');
  return (width < 0 ? text + blanks : blanks + text) + " ";
}

constexpr int kName = -24;
constexpr int kFaces = 7;
constexpr int kKept = 7;
constexpr int kWhole = 5;
constexpr int kSeconds = 6;
constexpr int kModeSeconds = 5;
constexpr int kResidual = 5;
constexpr int kMode = 2 * (kModeSeconds + kResidual) + 3;

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", seconds < 10 ? 2 : seconds < 100 ? 1 : 0, seconds);
  return text;
}

std::string residual_text(double residual) {
  if (residual == 0) return "0";
  char text[32];
  std::snprintf(text, sizeof text, "%.0e", residual);
  return text;
}

std::string ended(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

int least_kept(const RealRow& row) {
  int least = row.regions;
  for (const RealMode& mode : row.modes) least = std::min(least, mode.failure.empty() ? mode.regions : 0);
  return least;
}

bool whole_kept(const RealRow& row) {
  return std::ranges::all_of(row.modes, [](const RealMode& mode) { return mode.failure.empty() && mode.whole; });
}

bool failed(const RealRow& row) {
  return !row.failure.empty() || std::ranges::any_of(row.modes, [](const auto& mode) { return !mode.failure.empty(); });
}

std::string share(std::size_t part, std::size_t all) {
  return std::to_string(part) + " of " + std::to_string(all) +
         (all == 0 ? "" : " (" + short_number(100.0 * double(part) / double(all), 3) + " %)");
}

std::string in_csv(std::string text) {
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

std::string number(double value) {
  return short_number(value, 6);
}

}  // namespace

std::string real_header(const std::vector<GroupMode>& modes) {
  std::string above = cell("", kName) + cell("", kFaces) + cell("", kKept) + cell("", kWhole) + cell("", kSeconds);
  std::string names = cell("mesh", kName) + cell("faces", kFaces) + cell("kept", kKept) + cell("whole", kWhole) +
                      cell("detect", kSeconds);
  for (const GroupMode mode : modes) {
    above += cell(to_string(mode), -kMode);
    names +=
        cell("build", kModeSeconds) + cell("solve", kModeSeconds) + cell("field", kResidual) + cell("mesh", kResidual);
  }
  return ended(above) + ended(names);
}

std::string real_line(const RealRow& row, const std::vector<GroupMode>& modes) {
  std::string line = cell(row.name, kName) + cell(std::to_string(row.faces), kFaces);
  if (!row.failure.empty()) return line + "failed: " + row.failure + "\n";
  line += cell(std::to_string(least_kept(row)) + "/" + std::to_string(row.regions), kKept);
  line += cell(row.whole ? whole_kept(row) ? "kept" : "lost" : "-", kWhole);
  line += cell(row.detect_seconds ? seconds_text(*row.detect_seconds) : "read", kSeconds);
  std::string failures;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const RealMode& mode = row.modes[m];
    if (!mode.failure.empty()) {
      line += cell("failed", -kMode);
      failures += "    " + to_string(mode.mode) + " failed: " + mode.failure + "\n";
      continue;
    }
    line += cell(seconds_text(mode.build_seconds), kModeSeconds) +
            cell(seconds_text(mode.solve_seconds), kModeSeconds) + cell(residual_text(mode.field_residual), kResidual) +
            cell(mode.mesh_pairs > 0 ? residual_text(mode.mesh_residual) : "-", kResidual);
  }
  return ended(line) + failures;
}

std::string real_summary(const std::vector<RealRow>& rows, const std::vector<GroupMode>& modes) {
  const std::size_t count = rows.size();
  std::string text = "\n" + count_of(static_cast<long long>(count), "mesh", "meshes") + ", " +
                     share(count - static_cast<std::size_t>(std::ranges::count_if(rows, failed)), count) +
                     " without any failure\n";
  TextTable table(
      {"mode", "builds", "in time", "field exact", "mesh exact", "whole kept", "regions kept", "patterns kept"});
  for (std::size_t m = 0; m < modes.size(); ++m) {
    std::size_t builds = 0;
    std::size_t in_time = 0;
    std::size_t field = 0;
    std::size_t mesh = 0;
    std::size_t wholes = 0;
    std::size_t wholes_kept = 0;
    std::size_t listed = 0;
    std::size_t kept = 0;
    std::size_t patterns = 0;
    std::size_t patterns_kept = 0;
    for (const RealRow& row : rows) {
      wholes += row.whole ? 1 : 0;
      listed += static_cast<std::size_t>(row.regions);
      patterns += static_cast<std::size_t>(row.patterns);
      if (m >= row.modes.size() || !row.modes[m].failure.empty()) continue;
      const RealMode& mode = row.modes[m];
      ++builds;
      in_time += mode.build_seconds <= row.allowed_seconds ? 1 : 0;
      field += mode.field_residual <= kExactField ? 1 : 0;
      mesh += mode.mesh_residual <= kExactMesh ? 1 : 0;
      wholes_kept += row.whole && mode.whole ? 1 : 0;
      kept += static_cast<std::size_t>(mode.regions);
      patterns_kept += static_cast<std::size_t>(mode.patterns);
    }
    table.add({to_string(modes[m]), share(builds, count), share(in_time, count), share(field, count),
               share(mesh, count), share(wholes_kept, wholes), share(kept, listed), share(patterns_kept, patterns)});
  }
  return text + table.text() +
         "  In time: built within 3 s, or 1 s for each 50000 vertices. Field exact: each region kept within " +
         residual_text(kExactField) + "\n  of the diagonal; mesh exact: within " + residual_text(kExactMesh) +
         " wherever vertices lie on images of vertices. Kept: of what detection lists.\n";
}

std::string real_csv(const std::vector<RealRow>& rows) {
  std::string text =
      "name,file,vertices,faces,listed_regions,listed_patterns,whole_listed,detect_seconds,allowed_seconds,mode,"
      "kept_regions,kept_patterns,whole_kept,build_seconds,solve_seconds,field_residual,mesh_residual,mesh_pairs,"
      "failure,messages\n";
  for (const RealRow& row : rows) {
    const std::string mesh = in_csv(row.name) + "," + in_csv(row.file.string()) + "," + std::to_string(row.vertices) +
                             "," + std::to_string(row.faces) + "," + std::to_string(row.regions) + "," +
                             std::to_string(row.patterns) + "," + (row.whole ? "1," : "0,") +
                             (row.detect_seconds ? number(*row.detect_seconds) : "") + "," +
                             number(row.allowed_seconds) + ",";
    if (!row.failure.empty()) text += mesh + ",,,,,,,,," + in_csv(row.failure) + ",\n";
    for (const RealMode& mode : row.modes) {
      text += mesh + to_string(mode.mode) + ",";
      text += mode.failure.empty() ? std::to_string(mode.regions) + "," + std::to_string(mode.patterns) + "," +
                                         (row.whole ? mode.whole ? "1" : "0" : "") + "," + number(mode.build_seconds) +
                                         "," + number(mode.solve_seconds) + "," + number(mode.field_residual) + "," +
                                         number(mode.mesh_residual) + "," + std::to_string(mode.mesh_pairs) + ",,"
                                   : ",,,,,,,," + in_csv(mode.failure) + ",";
      text += (mode.messages.empty() ? "" : in_csv(mode.messages)) + "\n";
    }
  }
  return text;
}

}  // namespace orbifit::benchmarks
