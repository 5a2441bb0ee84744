#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Everything `fit` has to say, as `--report` writes it. \param verdict  fit_verdict()
nlohmann::ordered_json fit_to_json(const std::vector<std::string>& verdict, const FitResult& result,
                                   const SymmetryReport& symmetry);

/// The same with pictures, as `--html` writes it: see fit_pictures(). \param up  unit, the template's
std::string fit_to_html(const Mesh& mesh, const PointCloud& scan, const FitResult& result,
                        const std::vector<std::string>& verdict, const SymmetryReport& symmetry,
                        const Eigen::Vector3d& up, const RunContext& run);

}  // namespace orbifit
