#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// How near a fit came to the truth. Lengths are fractions of the truth's diagonal.
struct FitScore {
  double visible = 0;  ///< mean distance from the truth's visible surface to the fitted one
  double hidden = 0;   ///< likewise of what no view saw, though it can be seen from outside
  double f_score = 0;  ///< at 1 %: harmonic mean of the shares of either surface that lie near the other
  /// Mean distance of the fitted hidden vertices from where they belong; none where the truth has not the template's
  /// connectivity, or nothing is hidden.
  std::optional<double> correspondence;
};

/// For each vertex of a shape whether a scan has a point within 1 % of the shape's diagonal of it.
std::vector<char> visible_vertices(const Mesh& truth, const Points& scan);

/// Correspondences are those of the symmetric copy that fits best: a table turned by a quarter is the same table.
/// \param rest, annotation  the template and its symmetries
/// \param truth  the shape scanned, in the scan's frame
/// \param visible  of the truth's vertices
/// \param fitted  the template in the scan's frame
FitScore score_fit(const Mesh& rest, const SymmetryAnnotation& annotation, const Mesh& truth,
                   const std::vector<char>& visible, const Mesh& fitted, const RunContext& context);

}  // namespace orbifit
