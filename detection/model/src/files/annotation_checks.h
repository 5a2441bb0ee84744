#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"

namespace orbifit {

class JsonReader;

/// How closely the motions of an annotation must form a group: of linear parts, and of translations as a fraction of
/// the mesh's diagonal.
inline constexpr double kClosedToWithin = 1e-5;

/// Refuses a region at `where` whose generators or elements move its centre, or whose elements do not form its group.
/// \param diagonal  of the mesh, mesh units
/// \throw InputError
void check_group(const Region& region, const std::string& where, double diagonal, const JsonReader& json);

/// Refuses ids given twice and regions that are their own ancestors. Where a parent has been taken out of the file by
/// hand, all parents are found anew.
/// \throw InputError
void check_parents(std::vector<Region>& regions, const JsonReader& json);

}  // namespace orbifit
