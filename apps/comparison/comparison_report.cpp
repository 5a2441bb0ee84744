#include "comparison_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include <nlohmann/json.hpp>

#include "orbifit/apps/render.h"
#include "orbifit/apps/report.h"

#include "command.h"

namespace orbifit {

namespace {

/// A column of the table: what it is called, and its figure.
struct Figure {
  const char* name;   // in CSV and JSON
  const char* title;  // for people
  double factor;      // from the one to the other
  std::optional<double> (*value)(const MethodRun&);
};

constexpr double kDegrees = 180 / std::numbers::pi;

std::optional<double> if_iterated(const MethodRun& run, double value) {
  return run.result.iterations.empty() ? std::nullopt : std::optional(value);
}

constexpr std::array kFigures{
    Figure{"symmetry_residual", "symmetry residual %", 100,
           [](const MethodRun& run) { return std::optional(run.symmetry); }},
    Figure{"visible", "visible error %", 100,
           [](const MethodRun& run) { return run.score ? std::optional(run.score->visible) : std::nullopt; }},
    Figure{"hidden", "hidden error %", 100,
           [](const MethodRun& run) { return run.score ? std::optional(run.score->hidden) : std::nullopt; }},
    Figure{"hidden_correspondence", "hidden correspondence error %", 100,
           [](const MethodRun& run) { return run.score ? run.score->correspondence : std::nullopt; }},
    Figure{"inlier_fraction", "inlier ratio %", 100,
           [](const MethodRun& run) { return run.scanned ? std::optional(run.result.inlier_ratio) : std::nullopt; }},
    Figure{"handle_error", "handle error %", 100,
           [](const MethodRun& run) { return std::optional(run.result.landmark_rms); }},
    Figure{"bending", "bending, degrees", kDegrees,
           [](const MethodRun& run) { return std::optional(run.bending.rms); }},
    Figure{"seconds_to_prepare", "preparation, s", 1, [](const MethodRun& run) { return std::optional(run.prepare); }},
    Figure{"seconds_per_iteration", "iteration, ms", 1000,
           [](const MethodRun& run) { return if_iterated(run, run.iteration); }},
    Figure{"iterations", "iterations", 1,
           [](const MethodRun& run) { return if_iterated(run, double(run.result.iterations_in_all)); }},
    Figure{"unknowns", "unknowns", 1,
           [](const MethodRun& run) { return std::optional(double(run.result.degrees_of_freedom)); }},
    Figure{"condition", "condition number", 1,
           [](const MethodRun& run) {
             return run.result.condition > 0 ? std::optional(run.result.condition) : std::nullopt;
           }},
};

std::string cell(const MethodRun& run, const Figure& figure) {
  const std::optional<double> value = run.failure.empty() ? figure.value(run) : std::nullopt;
  return value ? short_number(figure.factor * *value, 3) : "-";
}

std::vector<std::string> headers() {
  std::vector<std::string> result{"method"};
  for (const Figure& figure : kFigures) result.emplace_back(figure.title);
  result.emplace_back("worst region");
  return result;
}

std::vector<std::string> cells(const MethodRun& run) {
  std::vector<std::string> result{run.method};
  for (const Figure& figure : kFigures) result.push_back(cell(run, figure));
  result.push_back(run.failure.empty() ? run.worst_region : run.failure);
  return result;
}

nlohmann::ordered_json to_json(const std::vector<MethodRun>& runs) {
  nlohmann::ordered_json result = nlohmann::ordered_json::array();
  for (const MethodRun& run : runs) result.push_back(run_json(run));
  return result;
}

// Of the method in all charts.
int colour_of(const MethodRun& run) {
  return static_cast<int>(std::ranges::find(methods(), run.method, &Method::name) - methods().begin());
}

// One curve a method, of the runs in their order.
template <typename Of, typename What>
std::vector<Chart::Series> curves(const std::vector<MethodRun>& runs, const Of& horizontal, const What& vertical) {
  std::vector<Chart::Series> result;
  for (const MethodRun& run : runs) {
    if (!run.failure.empty()) continue;
    if (result.empty() || result.back().name != run.method) result.push_back({run.method, {}, colour_of(run)});
    result.back().points.emplace_back(horizontal(run), vertical(run));
  }
  return result;
}

std::vector<Chart> charts(const Comparison& comparison) {
  const auto weight = [](const MethodRun& run) { return run.weight; };
  const auto milliseconds = [](const MethodRun& run) { return 1000 * run.iteration; };
  std::vector<Chart> result;
  if (!comparison.weights.empty()) {
    auto residuals = curves(comparison.weights, weight, [](const MethodRun& run) { return run.symmetry; });
    auto conditions = curves(comparison.weights, weight, [](const MethodRun& run) { return run.result.condition; });
    const auto [least, most] = std::ranges::minmax(comparison.weights, {}, &MethodRun::weight);
    for (const MethodRun& run : comparison.runs) {  // without a weight: level lines
      if (run.weight > 0 || !run.failure.empty() || run.method == "similarity" || run.method == "none") continue;
      residuals.push_back({run.method, {{least.weight, run.symmetry}, {most.weight, run.symmetry}}, colour_of(run)});
      conditions.push_back(
          {run.method, {{least.weight, run.result.condition}, {most.weight, run.result.condition}}, colour_of(run)});
    }
    result.push_back({"Largest symmetry residual against the weight of the symmetry penalty", "weight of the penalty",
                      "symmetry residual, fraction of the diagonal", residuals});
    result.push_back({"Condition number of the system against the weight of the symmetry penalty",
                      "weight of the penalty", "condition number", conditions});
  }
  if (!comparison.samples.empty()) {
    result.push_back(
        {"Time of an iteration against the number of surface samples", "samples", "milliseconds",
         curves(
             comparison.samples, [](const MethodRun& run) { return double(run.result.samples); }, milliseconds)});
  }
  if (!comparison.meshes.empty()) {
    result.push_back({"Time of an iteration against the number of the template's faces", "faces", "milliseconds",
                      curves(
                          comparison.meshes, [](const MethodRun& run) { return double(run.faces); }, milliseconds)});
  }
  return result;
}

// White where a vertex is symmetric to 1e-6 of the diagonal, deepest red at 1e-2.
Colour error_colour(double excess) {
  constexpr double kMin = -6;
  constexpr double kMax = -2;
  const double power = std::log10(std::max(excess, 1e-30));
  return heat_colour(0.5 + 0.5 * std::clamp((power - kMin) / (kMax - kMin), 0.0, 1.0));
}

Colour bending_colour(double change) {
  constexpr double kMax = 8;  // degrees
  return heat_colour(0.5 + 0.5 * std::min(1.0, kDegrees * change / kMax));
}

}  // namespace

nlohmann::ordered_json run_json(const MethodRun& run) {
  nlohmann::ordered_json result{
      {"method", run.method}, {"weight", run.weight}, {"samples", run.result.samples}, {"faces", run.faces}};
  for (const Figure& figure : kFigures) {
    const std::optional<double> value = run.failure.empty() ? figure.value(run) : std::nullopt;
    if (value) {
      result[figure.name] = *value;
    } else {
      result[figure.name] = nullptr;
    }
  }
  result["worst_region"] = run.worst_region;
  result["stopped_because"] = run.result.stopped_because;
  result["failure"] = run.failure;
  return result;
}

std::string comparison_text(const Comparison& comparison) {
  TextTable table(headers());
  for (const MethodRun& run : comparison.runs) table.add(cells(run));
  return table.text();
}

std::string comparison_csv(const Comparison& comparison) {
  const auto quoted = [](const std::string& text) {
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
    return result + "\"";
  };
  std::string text = "method";
  for (const Figure& figure : kFigures) text += std::string(",") + figure.name;
  text += ",worst_region,failure\n";
  for (const MethodRun& run : comparison.runs) {
    text += run.method;
    for (const Figure& figure : kFigures) {
      const std::optional<double> value = run.failure.empty() ? figure.value(run) : std::nullopt;
      text += "," + (value ? short_number(*value, 17) : "");
    }
    text += "," + quoted(run.worst_region) + "," + quoted(run.failure) + "\n";
  }
  return text;
}

std::string comparison_json(const Comparison& comparison) {
  const nlohmann::ordered_json all{{"methods", to_json(comparison.runs)},
                                   {"weights", to_json(comparison.weights)},
                                   {"samples", to_json(comparison.samples)},
                                   {"meshes", to_json(comparison.meshes)}};
  return all.dump(2) + "\n";
}

std::string comparison_html(const Comparison& comparison, const PointCloud& scan, const Eigen::Vector3d& up,
                            const RunContext& context) {
  ViewOptions view;
  view.up = up;
  view.width = 560;
  view.height = 420;
  Report report;
  report.title = "Compare with least-squares baselines";
  report.intro =
      "All methods are given the same template, the same scan or handles, and the same start. Lengths are in percent "
      "of "
      "the diagonal. The symmetry residual is the largest over all regions, each region with the rigid motion of its "
      "group that fits best.";
  ReportSection figures{"Figures", "", {}, {{headers(), {}}}};
  for (const MethodRun& run : comparison.runs) figures.tables.front().rows.push_back(cells(run));
  for (const Method& method : methods()) {
    const bool there = std::ranges::any_of(comparison.runs, [&](const auto& run) { return run.method == method.name; });
    if (there) figures.notes.push_back(method.name + ": " + method.summary);
  }
  ReportSection pictures{"Fitted shapes", "", {}, {}};
  ReportSection errors{
      "Symmetry residual on the surface", "White: at most 0.0001 % of the diagonal. Red: 1 % or more.", {}, {}};
  ReportSection bends{
      "Bending", "Change of the angle between neighbouring faces. White: none. Red: 8 degrees or more.", {}, {}};
  const auto coloured = [&](const MethodRun& run, const Eigen::VectorXd& values, Colour (*colour)(double)) {
    Scene scene;
    SurfaceLayer& layer = scene.surfaces.emplace_back();
    layer.mesh = run.result.fitted;
    for (const double value : values) layer.vertex_colours.push_back(colour(value));
    return encode_png(render(scene, view, context));
  };
  for (const MethodRun& run : comparison.runs) {
    if (!run.failure.empty()) continue;
    Scene fitted;
    fitted.surfaces.emplace_back().mesh = run.result.fitted;
    if (scan.points.rows() > 0) fitted.points.emplace_back().points = scan.points;
    pictures.pictures.push_back({encode_png(render(fitted, view, context)), run.method});
    errors.pictures.push_back({coloured(run, run.vertex_excess, error_colour),
                               run.method + ": at most " + short_number(100 * run.symmetry, 2) + " % of the diagonal"});
    bends.pictures.push_back({coloured(run, run.bending.of_vertex, bending_colour),
                              run.method + ": " + short_number(kDegrees * run.bending.rms, 2) + " degrees"});
  }
  report.sections = {figures, pictures, errors, bends};
  ReportSection plots{"Weights and sizes", "", {}, {}};
  plots.charts = charts(comparison);
  if (!plots.charts.empty()) report.sections.push_back(plots);
  return to_html(report);
}

}  // namespace orbifit
