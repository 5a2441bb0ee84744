#pragma once

#include <array>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/detection/found_region.h"
#include "orbifit/detection/surface_patch.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Discs of planes across the axis of a region, most of whose border meets faces that the region has not: any plane has
/// such, about any axis across it. What has a symmetry ends where other faces begin that have it, or the surface ends.
class CutDiscs {
 public:
  /// O(F log F). \param prepared kept by reference
  explicit CutDiscs(const PreparedMesh& prepared);

  /// The faces of a region without such discs, ascending; all faces where its group has no axis. O(#faces)
  std::vector<int> without(const FoundRegion& region);

 private:
  struct Side {
    int face = -1;  // beyond the edge; -1 where not just one other face is
    double length = 0;
  };
  enum class Kind : char { outside, inside, across };

  const PreparedMesh& prepared_;
  std::vector<std::array<Side, 3>> sides_;  // by face
  std::vector<Kind> kinds_;                 // by face; all outside between calls
};

/// Takes cut discs out of regions. A turned one that is little else, or does not turn without them, goes; one of a
/// finite group keeps them unless it is mostly discs and has its group without them: bolts stand on plates.
/// \param tolerance of the detector, a fraction of the diagonal
void drop_cut_discs(const PreparedMesh& prepared, double tolerance, const RunContext& context,
                    std::vector<FoundRegion>& regions, Explanation* explanation = nullptr);

}  // namespace orbifit
