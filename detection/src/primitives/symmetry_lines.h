#pragma once

#include <vector>

#include "primitives/revolution.h"
#include "surface/components.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// A line that may be an axis of symmetry, or a plane (through the line's point, across its direction).
struct CandidateLine {
  Line line;
  double weight = 0;  ///< area of what speaks for it
};

struct SymmetryLines {
  std::vector<CandidateLine> axes;    ///< the heaviest first
  std::vector<CandidateLine> planes;  ///< mirrors, likewise
};

/// Where parts say that symmetry may lie: axes of parts that are surfaces of revolution or flat with a round or regular
/// outline; axes through the centres of circles on which three copies of a part stand at equal steps; half-turn axes
/// and mirror planes between two copies. Directions of the parts' area vectors and their second moments must agree.
/// Votes for one line or plane are added up. \param tolerance of the detector, a fraction of the diagonal
SymmetryLines find_symmetry_lines(const PreparedMesh& prepared, const ComponentSurvey& survey, double tolerance);

}  // namespace orbifit
