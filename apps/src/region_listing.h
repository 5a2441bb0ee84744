#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "orbifit/detection/surface_colours.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// Tables of the regions and patterns that `mesh` has: shares of the area and residuals in percent.
/// \param broken  what of the shape's symmetries the colours break
std::string listing(const SymmetryAnnotation& found, const std::vector<BrokenByColours>& broken, const Mesh& mesh);

/// The same for programs; shares and residuals are fractions.
nlohmann::ordered_json listing_json(const SymmetryAnnotation& found, const std::vector<BrokenByColours>& broken,
                                    const Mesh& mesh);

/// The annotation as its file has it; what colours break stands under a key of its own, which readers pass over.
std::string annotation_text(const SymmetryAnnotation& found, const std::vector<BrokenByColours>& broken);

/// The same of regions of a scan, whose faces are its points.
std::string point_listing(const SymmetryAnnotation& found);
nlohmann::ordered_json point_listing_json(const SymmetryAnnotation& found);

}  // namespace orbifit
