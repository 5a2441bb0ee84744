#pragma once

#include <string>
#include <vector>

#include "cases/fit_cases.h"

namespace orbifit::benchmarks {

/// One method on one case.
struct FittingRow {
  std::string family, level, method;
  bool fitted = false;  ///< it found the template and explains the scan, by its own account
  std::string failure;  ///< why not
  FitScore score;
  double symmetry = 0;  ///< worst residual that the fit added, with respect to the carried motions
  double seconds = 0;
  double placing = 0;    ///< of these, until the pose was found
  double iteration = 0;  ///< of one iteration
  int degrees_of_freedom = 0;
};

/// The tables for people, at most 120 columns wide.
std::string fitting_text(const std::vector<FittingRow>& rows);

/// An object: "rows", and "means" by level and method.
std::string fitting_json(const std::vector<FittingRow>& rows);

}  // namespace orbifit::benchmarks
