#include "orbifit/datasets_tools/generate.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "orbifit/model/errors.h"

#include "models/models.h"

namespace orbifit {

namespace {

const std::vector<ModelDefinition>& definitions() {
  static const std::vector<ModelDefinition> all{armchair_model(), bar_model(),      car_model(),   centre_piece_model(),
                                                chair_model(),    desk_fan_model(), fan_model(),   plane_model(),
                                                stool_model(),    table_model(),    wheel_model(), wind_mill_model(),
                                                yard_tool_model()};
  return all;
}

template <typename Named>
std::string names(const std::vector<Named>& all) {
  std::string text;
  for (const Named& one : all) text.append(text.empty() ? "" : ", ").append(one.name);
  return text;
}

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void check(const std::string& model, const GeneratorParameter& parameter, double value) {
  const std::string what = model + ": " + parameter.name + " = " + number(value);
  if (!(value >= parameter.minimum && value <= parameter.maximum)) {
    throw UsageError(what + ": must be from " + number(parameter.minimum) + " to " + number(parameter.maximum));
  }
  if (parameter.integer && value != std::floor(value)) throw UsageError(what + ": must be a whole number");
}

}  // namespace

const std::vector<Generator>& generators() {
  static const std::vector<Generator> all = [] {
    std::vector<Generator> result;
    for (const ModelDefinition& definition : definitions()) result.push_back(definition.generator);
    return result;
  }();
  return all;
}

GeneratedModel generate(const std::string& name, const std::map<std::string, double>& parameters) {
  const auto& all = definitions();
  const auto model = std::ranges::find(all, name, [](const ModelDefinition& each) { return each.generator.name; });
  if (model == all.end()) throw UsageError("unknown model '" + name + "'; there are " + names(generators()));
  const std::vector<GeneratorParameter>& known = model->generator.parameters;
  std::map<std::string, double> values;
  for (const GeneratorParameter& parameter : known) values[parameter.name] = parameter.value;
  for (const auto& [key, value] : parameters) {
    const auto parameter = std::ranges::find(known, key, &GeneratorParameter::name);
    if (parameter == known.end()) {
      std::string text = name;
      text += ": unknown parameter '";
      text += key;
      text += "'; there are ";
      throw UsageError(text.append(names(known)));
    }
    check(name, *parameter, value);
    values[key] = value;
  }
  return model->build(ModelValues(std::move(values)));
}

}  // namespace orbifit
