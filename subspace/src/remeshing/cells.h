#pragma once

#include <optional>
#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "geometry/topology.h"
#include "remeshing/finite_group.h"

namespace orbifit {

/// Components that a motion takes to components: of a region the same ones, of a pattern another instance's.
struct ComponentMotion {
  Motion motion;
  std::vector<int> from, to;  ///< components, ascending
};

/// What a region or a pattern asks.
struct Demand {
  std::vector<ComponentMotion> motions;
};

/// A component, or several that the same demands hold and that cannot be told apart by their images.
struct MeshCell {
  std::vector<int> components;
  int source = 0;  ///< the cell that this one is an image of; itself where it is made anew
  Motion from_source;
  FiniteGroup group;  ///< of a cell that is its own source
};

struct Cells {
  std::vector<MeshCell> cells;
  std::vector<std::optional<std::string>> refused;  ///< by demand: why it cannot be kept beside those before it
};

/// \param reach  mesh units: how far an image may be from the surface
Cells find_cells(const Mesh& mesh, const Components& components, const std::vector<Demand>& demands, double reach,
                 const RunContext& context);

}  // namespace orbifit
