#pragma once

#include <functional>
#include <string>
#include <vector>

#include "orbifit/datasets_tools/truth.h"

namespace orbifit {

/// A model of the detection suite, built when asked for.
struct SuiteModel {
  std::string name;
  std::string kind;  ///< "group", "nested", "pattern", "continuous", "none" or "near miss"
  std::function<TruthModel()> build;
};

/// Models whose symmetries are known by construction: every finite family, nested and overlapping groups, turned parts,
/// patterns, shapes without any symmetry and shapes that just miss one. Each is an assembly of closed, outward-facing
/// parts that run into one another, in its own units and pose; names are unique. A part that is turned is called
/// Cinfv or Dinfh although it has facets: their sagitta is below 0.1 % of the diagonal.
std::vector<SuiteModel> detection_suite();

}  // namespace orbifit
