#pragma once

#include <cstdint>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// The points of a scan that anything looks at: fifty for each that a fit uses by default tell its neighbourhood, and
/// what a fit costs does not grow with a scan beyond them.
inline constexpr int kScanPointsRead = 200000;

/// As many points of a scan drawn at random, in their order, with normals and viewpoints; all where it has no more.
/// O(P). \pre most >= 0
PointCloud thinned(const PointCloud& scan, int most, std::uint64_t seed);

}  // namespace orbifit
