#pragma once

#include <vector>

#include "orbifit/detection/revolution.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// Of lines that motions of the whole carry onto one another, the first few: what is found about them has images about
/// the others, see complete_regions(). A few, as one line may be less well placed than the next.
/// \param motions of a group that keeps the whole mesh; none: every line stands for itself
/// \param tolerance of the detector, a length as the lines' points
/// \return by line: whether to look there
std::vector<char> few_of_each_orbit(const std::vector<Line>& lines, const std::vector<Motion>& motions,
                                    double tolerance);

}  // namespace orbifit
