#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// The finite subgroup that the tessellation of a continuous region nearly has: as region.group, with a rotation of
/// order n <= 256, the finest that moves the places onto places as well as any does, and mirrors or half turns
/// likewise. Mirrors and half turns among `known`, such as those of the whole, are taken as they are, so that groups
/// fit. Nothing for K and Kh, and where places miss places by more than `reach`. \param places of the region's
/// vertices, #P by 3 \param reach  mesh units
std::optional<Region> turning_region(const Region& region, const Points& places, double reach,
                                     const std::vector<Motion>& known);

/// The same with a rotation of order 24, whatever the tessellation: a round surface lies on its images under any.
/// Nothing for K and Kh. \param scale  the mesh's diagonal
std::optional<Region> even_region(const Region& region, double scale, const std::vector<Motion>& known);

/// The same group about another region's axis, where one of `known` takes axis and centre there: related parts get
/// related groups.
std::optional<Region> conjugated_region(const Region& from, const Region& to, const std::vector<Motion>& known,
                                        double scale);

}  // namespace orbifit
