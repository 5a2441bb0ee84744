#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "comparison.h"

namespace orbifit {

/// The methods' figures as a table for people.
std::string comparison_text(const Comparison& comparison);

/// The same, comma-separated with a header line, full digits; and everything as JSON.
std::string comparison_csv(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison);

/// One run's figures, as comparison_json() has them.
nlohmann::ordered_json run_json(const MethodRun& run);

/// The same with charts, and pictures of each method's result: over the scan, and its symmetry error in colour.
/// \param up unit, of the scan's frame
std::string comparison_html(const Comparison& comparison, const PointCloud& scan, const Eigen::Vector3d& up,
                            const RunContext& context);

}  // namespace orbifit
