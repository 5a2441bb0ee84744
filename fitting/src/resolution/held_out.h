#pragma once

#include <cstdint>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// Every tenth patch of the scan, each of a width: depth cameras err alike at neighbouring points, so a point's own
/// neighbours do not tell shape from noise. As wide as what a finer fit has to bridge. #P, 1 for those chosen.
std::vector<char> some_patches(const Points& points, double width, std::uint64_t seed);

/// Those of the chosen points.
std::vector<double> of_chosen(const std::vector<double>& of_points, const std::vector<char>& chosen);

/// \pre not empty
double root_mean(const std::vector<double>& squares);

/// Whether the second of two paired samples is smaller in the mean, by more than chance.
bool smaller(const std::vector<double>& before, const std::vector<double>& after);

}  // namespace orbifit
