#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/run_context.h"

#include "group/candidates.h"
#include "support/found_region.h"
#include "surface/components.h"

namespace orbifit {

struct PartRegionOptions {
  double tolerance = 0.005;    ///< fraction of the mesh's diagonal
  double least_share = 0.002;  ///< of the mesh's area: smaller regions and patterns say little
  /// Whether the parts are pieces of larger surfaces: their borders alone then make no symmetry. Flat regions, and
  /// finite groups of planes and surfaces of revolution, are left out.
  bool pieces = false;
  Explanation* explanation = nullptr;  ///< notes are added to it; may be null
  std::function<bool()> late;          ///< whether time is up; may be empty
  /// That keep the whole mesh, in its normalised frame: what is found at one place has images at others. May be empty.
  std::vector<Motion> of_whole = {};
};

struct PartRegions {
  std::vector<FoundRegion> regions;
  ComponentSurvey survey;
  std::vector<std::optional<GroupPlacement>> own_groups;  ///< of the first member of each of the survey's classes
};

/// Regions made of whole parts (the prepared mesh's `components`): own groups of parts, of sets of congruent parts, and
/// of what turns or mirrors into itself about the lines and planes that parts suggest; each grown to all parts that its
/// group permutes; then the larger regions of their subgroups. Every group was verified.
/// \param survey of the parts, see survey_components(), with the same tolerance and least share; handed on in the
/// result \param whole index of the whole mesh \param known regions found before; their groups are not reported again
/// \param screen directions to search where moments leave all open
PartRegions find_part_regions(const PreparedMesh& prepared, ComponentSurvey survey, const SurfaceIndex& whole,
                              const std::vector<FoundRegion>& known, const DirectionSet& screen,
                              const PartRegionOptions& options, const RunContext& context);

/// "part 3", "parts 1, 4-7": numbers of the mesh's parts, for a name.
std::string name_of_parts(const std::vector<int>& parts);

}  // namespace orbifit
