#pragma once

#include <vector>

#include "orbifit/apps/report.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// The template where the fit put it, the fit, its distances and what it completed. All in the scan's frame, as
/// large as the template there, from about where the scan was seen; the last one from behind.
/// \param mesh  the template \param up  unit, the template's
std::vector<ReportPicture> fit_pictures(const Mesh& mesh, const PointCloud& scan, const FitResult& result,
                                        const Eigen::Vector3d& up, const RunContext& run);

}  // namespace orbifit
