#pragma once

#include <Eigen/Core>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

#include "stage_clock.h"
#include "start/placed_scan.h"

namespace orbifit {

/// Whether the handles alone say what to do. \throw InputError where there is neither a scan nor a handle
bool by_handles_alone(const FitInput& input);

/// Where a baseline starts: the one of fit()'s starts that it tries first.
PlacedScan baseline_start(const FitInput& input, const FitOptions& options, const RunContext& context);

/// \throw UsageError naming what is not as an edit by handles needs it
void validate_editing(double alpha, int iterations);

/// The subspace that the options say, with the paper's lift.
Subspace plain_subspace(const FitInput& input, const FitOptions& options, const RunContext& context);

/// Edits by the input's handles in a subspace, as Deformer does: fills in `q` and `iterations`, each with its share of
/// the time, and notes the stage "prepare" when all is factorised.
SubspaceState edit_in_subspace(const Subspace& subspace, const FitInput& input, double alpha, int iterations,
                               const RunContext& context, StageClock& clock, FitResult& result);

/// Fills in what follows from the vertices' displacements (#V by 3, template's frame) and result.pose: the fitted mesh,
/// what it explains of the scan (`start`, null where there is none), and whether that is enough.
void finish_baseline(const FitInput& input, const FitOptions& options, const Points& displacements,
                     const PlacedScan* start, const RunContext& context, FitResult& result);

/// The template's annotation with regions and patterns carried by translations t (3 #carriers; empty: as they are),
/// then posed by result.pose, as result.annotation; and as it is, as result.rest_annotation.
void carry_annotation(const FitInput& input, const Subspace* subspace, const Eigen::VectorXd& carriers,
                      FitResult& result);

}  // namespace orbifit
