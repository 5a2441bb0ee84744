#pragma once

#include <map>
#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// A model with its symmetries, true by construction.
struct GeneratedModel {
  Mesh mesh;
  SymmetryAnnotation truth;
};

/// A parameter of a generator, for --help and for validation.
struct GeneratorParameter {
  std::string name;
  double value = 0;  ///< default
  double minimum = 0, maximum = 0;
  bool integer = false;
  std::string meaning;  ///< with unit
};

struct Generator {
  std::string name;
  std::string meaning;  ///< one line
  std::vector<GeneratorParameter> parameters;
};

/// The models that generate() knows, in the order of their names.
const std::vector<Generator>& generators();

/// Builds the model `name`; parameters not given take their defaults. In every model the region's vertices map onto
/// vertices under every element of its group, to 1e-14 of the diagonal; parts are closed and face outwards
/// (a two-sided armchair's also inwards). The residuals of models above a million vertices are not measured but 0.
/// Lengths and angles do not change the connectivity: a model with other lengths and the same counts (`detail`, numbers
/// of parts) is a deformation of the default one, vertex by vertex. Where lengths that agree give a larger group (a
/// chair's square seat), other lengths may declare a smaller one.
/// \throw UsageError for an unknown model or parameter, or a value out of range
GeneratedModel generate(const std::string& name, const std::map<std::string, double>& parameters = {});

}  // namespace orbifit
