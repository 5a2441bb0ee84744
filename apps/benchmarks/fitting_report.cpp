#include <algorithm>
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "command.h"
#include "fitting.h"

namespace orbifit::benchmarks {

namespace {

std::string percent(double fraction) {
  return short_number(100 * fraction, 3);
}

std::vector<std::string> cells(const FittingRow& row) {
  std::vector<std::string> result{row.family, row.level, row.method, row.fitted ? "yes" : "no"};
  const FitScore& score = row.score;
  for (const double value : {score.visible, score.hidden, score.correspondence.value_or(0), score.f_score}) {
    result.push_back(percent(value));
  }
  result.push_back(short_number(row.symmetry, 2));
  result.push_back(std::to_string(row.degrees_of_freedom));
  result.push_back(short_number(1000 * row.iteration, 3));
  result.push_back(short_number(row.placing, 3));
  result.push_back(short_number(row.seconds, 3));
  return result;
}

// The means over the families of each level and method, in the order in which they come.
std::vector<FittingRow> means_of(const std::vector<FittingRow>& rows) {
  std::vector<FittingRow> means;
  std::vector<int> counts, successes;
  for (const FittingRow& row : rows) {
    const auto at = std::ranges::find_if(
        means, [&](const FittingRow& mean) { return mean.level == row.level && mean.method == row.method; });
    const auto index = static_cast<std::size_t>(at - means.begin());
    if (at == means.end()) {
      means.push_back({"all", row.level, row.method, false, "", {}, 0, 0, 0, 0, 0});
      counts.push_back(0);
      successes.push_back(0);
    }
    FittingRow& mean = means[index];
    ++counts[index];
    successes[index] += row.fitted ? 1 : 0;
    mean.score.visible += row.score.visible;
    mean.score.hidden += row.score.hidden;
    mean.score.correspondence = mean.score.correspondence.value_or(0) + row.score.correspondence.value_or(0);
    mean.score.f_score += row.score.f_score;
    mean.symmetry = std::max(mean.symmetry, row.symmetry);
    mean.seconds += row.seconds;
    mean.placing += row.placing;
    mean.iteration += row.iteration;
    mean.degrees_of_freedom = std::max(mean.degrees_of_freedom, row.degrees_of_freedom);
  }
  for (std::size_t i = 0; i < means.size(); ++i) {
    FittingRow& mean = means[i];
    mean.family = std::to_string(successes[i]) + " of " + std::to_string(counts[i]);
    mean.fitted = successes[i] == counts[i];
    for (double* value : {&mean.score.visible, &mean.score.hidden, &*mean.score.correspondence, &mean.score.f_score,
                          &mean.seconds, &mean.placing, &mean.iteration}) {
      *value /= counts[i];
    }
  }
  return means;
}

nlohmann::ordered_json to_json(const FittingRow& row) {
  return {{"family", row.family},
          {"level", row.level},
          {"method", row.method},
          {"fitted", row.fitted},
          {"failure", row.failure},
          {"visible", row.score.visible},
          {"hidden", row.score.hidden},
          {"hidden_correspondence", row.score.correspondence.value_or(0)},
          {"f_score", row.score.f_score},
          {"symmetry_residual", row.symmetry},
          {"degrees_of_freedom", row.degrees_of_freedom},
          {"seconds_an_iteration", row.iteration},
          {"seconds_placing", row.placing},
          {"seconds", row.seconds}};
}

}  // namespace

std::string fitting_text(const std::vector<FittingRow>& rows) {
  const std::vector<std::string> columns{"family", "level",    "method", "fits",  "visible", "hidden", "corr.",
                                         "F 1 %",  "symmetry", "DoF",    "ms/it", "place s", "s"};
  TextTable table(columns);
  for (const FittingRow& row : rows) table.add(cells(row));
  TextTable means(columns);
  for (const FittingRow& row : means_of(rows)) means.add(cells(row));
  return "Templates fitted to scans of other shapes of their kind\n" + table.text() +
         "visible, hidden: mean distance from the truth's surface, seen by the scan and not, to the fitted one;\n"
         "corr.: of the fitted hidden vertices from where they belong; percent of the diagonal. symmetry: worst "
         "residual\n"
         "that the fit added, a fraction of the diagonal. s: seconds in all, place s: until the pose is found.\n"
         "In 'anywhere' all methods find the pose in the same way, but for pcl, which places the template, of known "
         "size, by\n"
         "FPFH, SampleConsensusPrerejective and ICP and leaves it as it is.\n\n"
         "Means by level and method\n" +
         means.text();
}

std::string fitting_json(const std::vector<FittingRow>& rows) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const FittingRow& row : rows) all.push_back(to_json(row));
  nlohmann::ordered_json means = nlohmann::ordered_json::array();
  for (const FittingRow& row : means_of(rows)) means.push_back(to_json(row));
  return nlohmann::ordered_json{{"rows", all}, {"means", means}}.dump(2) + "\n";
}

}  // namespace orbifit::benchmarks
