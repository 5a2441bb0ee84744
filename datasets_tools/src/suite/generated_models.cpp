// The models of generate(), as coarse as they come.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "orbifit/datasets_tools/generate.h"

#include "suite/suite_builder.h"
#include "suite/suite_lists.h"

namespace orbifit {

namespace {

// So round, for their size, that a turned part's group is as right as theirs.
bool nearly_round(const std::string& model, const std::string& region) {
  if (model == "car") return region.find("light") != std::string::npos;
  return model == "centre_piece" && region.starts_with("candle");
}

TruthModel generated(const std::string& name, const std::map<std::string, double>& parameters) {
  GeneratedModel model = generate(name, parameters);
  TruthModel result{std::move(model.mesh), {}};
  DetectionTruth& truth = result.truth;
  std::vector<Region> regions = std::move(model.truth.regions);
  truth.expected = std::move(model.truth);
  truth.expected.regions.clear();
  const Eigen::VectorXd areas = face_areas(result.mesh);
  for (Region& region : regions) {
    const bool small = areas(region.faces).sum() < kSmallestShare * areas.sum();
    (small || nearly_round(name, region.name) ? truth.optional_regions : truth.expected.regions)
        .push_back(std::move(region));
  }
  leave_out_repeated(result.mesh, truth);
  return result;
}

}  // namespace

std::vector<SuiteModel> generated_suite() {
  std::vector<SuiteModel> models;
  const auto add = [&](const std::string& name, const std::map<std::string, double>& parameters = {}) {
    models.push_back({name, "nested", [name, parameters] { return generated(name, parameters); }});
  };
  const std::map<std::string, double> coarse{{"detail", 1}};
  for (const char* name : {"armchair", "car", "centre_piece", "chair", "desk_fan", "fan", "plane", "table", "wheel",
                           "wind_mill", "yard_tool"}) {
    add(name, coarse);
  }
  return models;
}

}  // namespace orbifit
