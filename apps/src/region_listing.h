#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// Tables of the regions and patterns that `mesh` has: shares of the area and residuals in percent.
std::string listing(const SymmetryAnnotation& found, const Mesh& mesh);

/// The same for programs; shares and residuals are fractions.
nlohmann::ordered_json listing_json(const SymmetryAnnotation& found, const Mesh& mesh);

/// The same of regions of a scan, whose faces are its points.
std::string point_listing(const SymmetryAnnotation& found);
nlohmann::ordered_json point_listing_json(const SymmetryAnnotation& found);

}  // namespace orbifit
