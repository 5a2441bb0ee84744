#pragma once

#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// Few of a region's elements that generate all of them: its generators where they do, else elements are added in their
/// order until they do. Products are looked up to 1e-6. O(|G|^2). \pre a finite group
std::vector<Motion> generating_set(const Region& region);

}  // namespace orbifit
