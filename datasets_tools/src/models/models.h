#pragma once

#include <map>
#include <string>

#include "orbifit/datasets_tools/generate.h"

namespace orbifit {

/// Every parameter of the model by its name, checked.
class ModelValues {
 public:
  explicit ModelValues(std::map<std::string, double> values) : values_(std::move(values)) {}

  double operator[](const std::string& name) const { return values_.at(name); }
  int count(const std::string& name) const { return static_cast<int>(values_.at(name)); }

 private:
  std::map<std::string, double> values_;
};

struct ModelDefinition {
  Generator generator;
  GeneratedModel (*build)(const ModelValues& values);
};

ModelDefinition armchair_model();
ModelDefinition bar_model();
ModelDefinition car_model();
ModelDefinition centre_piece_model();
ModelDefinition chair_model();
ModelDefinition desk_fan_model();
ModelDefinition fan_model();
ModelDefinition plane_model();
ModelDefinition stool_model();
ModelDefinition table_model();
ModelDefinition wheel_model();
ModelDefinition wind_mill_model();
ModelDefinition yard_tool_model();

}  // namespace orbifit
