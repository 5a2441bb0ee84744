#pragma once

#include <string>
#include <vector>

#include "orbifit/fitting/fit.h"

namespace orbifit {

/// What a person should know of a fit, a sentence each, the most important first: whether to rely on it, which
/// connected part of the scan it leaves unexplained and where, what was not seen, which other poses the scan supports
/// as well and where to look to tell them apart, and which groups the scan contradicts. Places are in the scan's frame
/// and units.
std::vector<std::string> fit_verdict(const FitResult& result);

}  // namespace orbifit
