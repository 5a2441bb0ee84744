#pragma once

#include <string>
#include <vector>

#include "comparison.h"

namespace orbifit::benchmarks {

/// What one method did in one case at one size.
struct BaselineRow {
  std::string family;
  std::string task;  ///< "scan", "handles" or "conflict"
  MethodRun run;
};

std::string baselines_text(const std::vector<BaselineRow>& rows);
std::string baselines_json(const std::vector<BaselineRow>& rows);

}  // namespace orbifit::benchmarks
