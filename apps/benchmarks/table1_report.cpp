#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

#include "command.h"
#include "table1.h"

namespace orbifit::benchmarks {

namespace {

// Three significant digits, without an exponent for what times and ratios can be.
std::string figure(double value) {
  if (!std::isfinite(value)) return "-";
  const int digits = value == 0 ? 0 : std::clamp(2 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 4);
  std::string text(32, '\0');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.*f", digits, value)));
  return text;
}

std::string exponent(double value) {
  std::string text(32, '\0');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.0e", value)));
  return value == 0 ? "0" : text;
}

std::string beside(double ours, double paper) {
  return figure(ours) + " / " + figure(paper);
}

std::string ratio(double other, double ours) {
  return ours > 0 ? figure(other / ours) + "x" : "-";
}

std::string whole(int value) {
  return std::to_string(value);
}

// The first row of each model.
std::vector<const Table1Row*> models(const std::vector<Table1Row>& rows) {
  std::vector<const Table1Row*> result;
  std::set<std::string> seen;
  for (const Table1Row& row : rows) {
    if (seen.insert(row.model).second) result.push_back(&row);
  }
  return result;
}

std::string sizes(const std::vector<Table1Row>& rows) {
  TextTable table(
      {"model", "vertices", "paper", "triangles", "paper", "groups", "paper", "samples", "paper", "DoF", "paper", "r"});
  for (const Table1Row* row : models(rows)) {
    const PaperRow& paper = row->paper;
    table.add({row->model, whole(row->vertices), whole(paper.vertices), whole(row->triangles), whole(paper.triangles),
               whole(row->groups), whole(paper.groups), whole(row->samples), whole(paper.samples),
               whole(row->degrees_of_freedom), whole(paper.degrees_of_freedom), figure(row->radius)});
  }
  return table.text();
}

std::string residuals(const std::vector<Table1Row>& rows) {
  TextTable table({"model", "field", "mesh", "handles", "soft, weight 1", "soft, 100", "soft, 1e4"});
  for (const Table1Row* row : models(rows)) {
    std::vector<std::string> cells{row->model, exponent(row->field_residual), exponent(row->mesh_residual),
                                   exponent(row->handle_error)};
    for (const SoftRow& soft : row->soft) cells.push_back(exponent(soft.residual));
    table.add(cells);
  }
  return table.text();
}

std::string times(const std::vector<Table1Row>& rows, int threads) {
  TextTable table({"model", "build", "setup", "prefactor / paper", "ratio", "5 iter. / paper", "ratio", "lift / paper",
                   "ratio", "floor", "/floor", "MB"});
  for (const Table1Row& row : rows) {
    if (row.threads != threads) continue;
    table.add({row.model, figure(row.build_ms), figure(row.setup_ms), beside(row.prefactor_ms, row.paper.prefactor_ms),
               ratio(row.paper.prefactor_ms, row.prefactor_ms), beside(row.solve5_ms, row.paper.solve5_ms),
               ratio(row.paper.solve5_ms, row.solve5_ms), beside(row.lift_ms, row.paper.lift_ms),
               ratio(row.paper.lift_ms, row.lift_ms), figure(row.lift_floor_ms), ratio(row.lift_ms, row.lift_floor_ms),
               figure(1e-6 * row.lift_bytes)});
  }
  return table.text();
}

std::string peers(const std::vector<Table1Row>& rows) {
  TextTable table(
      {"model", "prefactor: CGAL", "/ours", "soft", "/ours", "5 iterations: CGAL", "/ours", "soft", "/ours"});
  std::string notes;
  bool any = false;
  for (const Table1Row* row : models(rows)) {
    if (row->soft.empty()) continue;
    any = true;
    const auto peer = [](const std::optional<double>& time) { return time ? figure(*time) : std::string("-"); };
    const auto by = [](const std::optional<double>& time, double ours) {
      return time ? ratio(*time, ours) : std::string("-");
    };
    const ArapTimes arap = row->arap.value_or(ArapTimes{});
    const SoftRow& soft = row->soft[row->soft.size() / 2];
    table.add({row->model, peer(arap.prefactor_ms), by(arap.prefactor_ms, row->prefactor_ms), figure(soft.prefactor_ms),
               ratio(soft.prefactor_ms, row->prefactor_ms), peer(arap.solve5_ms), by(arap.solve5_ms, row->solve5_ms),
               figure(soft.solve5_ms), ratio(soft.solve5_ms, row->solve5_ms)});
    if (!arap.note.empty()) notes += "  CGAL, " + row->model + ": " + arap.note + ".\n";
  }
  return any ? table.text() + notes : "";
}

constexpr const char* kResidualNotes =
    "  field: worst |u(g p) - O u(p)| in space, over all regions and elements; mesh: the same between vertices that "
    "were\n"
    "  images of one another, above what they were at rest; soft: on the samples, what symmetry as least squares "
    "leaves;\n"
    "  handles: root mean square distance from their targets.\n";
constexpr const char* kTimeNotes =
    "  build: the subspace from mesh and annotation; setup: once a subspace; prefactor: once a set of handles; lift: "
    "from\n"
    "  samples to all vertices. Paper: one thread of a Xeon E5-1620 at 3.6 GHz. ratio: paper / ours.\n"
    "  floor: the lift's own bytes (MB) streamed through memory by as many threads; /floor: 1x is the bound.\n";
constexpr const char* kPeerNotes =
    "  CGAL: Surface_mesh_deformation (as rigid as possible) on all vertices, without symmetry. soft: the paper's "
    "editing\n"
    "  on all samples, symmetry as least squares of weight 100. /ours: their time by ours with the fewest threads "
    "above.\n";

}  // namespace

std::string table1_text(const std::vector<Table1Row>& rows) {
  std::string text = "Models; r: sampling radius, fraction of the diagonal\n" + sizes(rows);
  std::set<int> threads;
  for (const Table1Row& row : rows) threads.insert(row.threads);
  for (const int count : threads) text += "\nTimes in ms, " + count_of(count, "thread") + "\n" + times(rows, count);
  text += kTimeNotes;
  const std::string others = peers(rows);
  if (!others.empty()) text += "\nPeers in ms, one thread\n" + others + kPeerNotes;
  return text + "\nWhat is left after five iterations, fractions of the diagonal\n" + residuals(rows) + kResidualNotes;
}

std::string table1_json(const std::vector<Table1Row>& rows) {
  nlohmann::json list = nlohmann::json::array();
  for (const Table1Row& row : rows) {
    nlohmann::json entry{{"model", row.model},
                         {"threads", row.threads},
                         {"vertices", row.vertices},
                         {"triangles", row.triangles},
                         {"groups", row.groups},
                         {"samples", row.samples},
                         {"dof", row.degrees_of_freedom},
                         {"radius", row.radius},
                         {"build_ms", row.build_ms},
                         {"setup_ms", row.setup_ms},
                         {"prefactor_ms", row.prefactor_ms},
                         {"solve5_ms", row.solve5_ms},
                         {"lift_ms", row.lift_ms},
                         {"lift_floor_ms", row.lift_floor_ms},
                         {"lift_bytes", row.lift_bytes},
                         {"paper_vertices", row.paper.vertices},
                         {"paper_triangles", row.paper.triangles},
                         {"paper_groups", row.paper.groups},
                         {"paper_samples", row.paper.samples},
                         {"paper_dof", row.paper.degrees_of_freedom},
                         {"paper_prefactor_ms", row.paper.prefactor_ms},
                         {"paper_solve5_ms", row.paper.solve5_ms},
                         {"paper_lift_ms", row.paper.lift_ms},
                         {"field_residual", row.field_residual},
                         {"mesh_residual", row.mesh_residual},
                         {"handle_error", row.handle_error}};
    if (row.arap) {
      entry["arap_prefactor_ms"] = row.arap->prefactor_ms ? nlohmann::json(*row.arap->prefactor_ms) : nlohmann::json();
      entry["arap_solve5_ms"] = row.arap->solve5_ms ? nlohmann::json(*row.arap->solve5_ms) : nlohmann::json();
      entry["arap_note"] = row.arap->note;
    }
    if (!row.soft.empty()) {
      const SoftRow& middle = row.soft[row.soft.size() / 2];
      entry["soft_prefactor_ms"] = middle.prefactor_ms;
      entry["soft_solve5_ms"] = middle.solve5_ms;
      entry["soft"] = nlohmann::json::array();
      for (const SoftRow& soft : row.soft) {
        entry["soft"].push_back({{"weight", soft.weight},
                                 {"prefactor_ms", soft.prefactor_ms},
                                 {"solve5_ms", soft.solve5_ms},
                                 {"residual", soft.residual}});
      }
    }
    list.push_back(std::move(entry));
  }
  return list.dump(2) + "\n";
}

}  // namespace orbifit::benchmarks
