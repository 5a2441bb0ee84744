// The models of generate(), as coarse as they come.

#include <map>
#include <string>

#include "orbifit/datasets_tools/generate.h"

#include "suite_builder.h"
#include "suite_lists.h"

namespace orbifit {

namespace {

TruthModel generated(const std::string& name, const std::map<std::string, double>& parameters) {
  GeneratedModel model = generate(name, parameters);
  TruthModel result{std::move(model.mesh), {}};
  result.truth.expected = std::move(model.truth);
  leave_out_repeated(result.mesh, result.truth);
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
