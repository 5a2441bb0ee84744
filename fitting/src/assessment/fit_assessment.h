#pragma once

#include "orbifit/fitting/fit.h"

#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// Root mean square distance of landmarks' and handles' vertices from where they belong, of the fitted mesh's diagonal;
/// 0 without any. Reads `fitted` and `pose`.
double pulls_rms(const FitInput& input, const FitResult& result);

/// What the fitted surface explains of the scan, what the scan saw of it, and how far landmarks are off: fills
/// `inlier_ratio`, `rms`, `visible_coverage`, `cut_off`, `confidence`, `unexplained_part`, `seen`, `hidden_fraction`
/// and `landmark_rms` from `fitted` and `pose`, `overlap` and `torn_off`. \param seen  of the input's scan and the
/// points of this one
void assess_fit(const FitInput& input, const PreparedScan& scan, const SeenSurface& seen, const FitOptions& options,
                const RunContext& context, FitResult& result);

/// The same. \param surface  of `result.fitted`
void assess_fit(const FitInput& input, const PreparedScan& scan, const SeenSurface& seen, const MovingSurface& surface,
                const FitOptions& options, const RunContext& context, FitResult& result);

/// Share of the whole scan that a fit explains: what was left out as other things counts as unexplained. In [0, 1].
double explained_share(const FitResult& result);

/// Whether that is enough for a fit. \param placed  the pose was found, and what is not the template's there has been
/// taken from the scan: of what is left a fit explains more
bool explains_scan(const FitResult& result, bool placed, const FitOptions& options);

}  // namespace orbifit
