#pragma once

#include <array>
#include <vector>

#include "orbifit/detection/explanation.h"
#include "orbifit/model/run_context.h"

#include "support/found_region.h"
#include "surface/face_sides.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// What a region has of planes across its axis, most of whose borders meet faces that the region has not: any plane has
/// discs about any axis across it. A plane of the region's own ends where other faces of the region begin, in circles
/// about the axis, or where the surface ends.
class CutDiscs {
 public:
  /// O(F log F). \param prepared kept by reference
  explicit CutDiscs(const PreparedMesh& prepared) : CutDiscs(prepared, face_sides(prepared)) {}
  /// \param sides of all faces, where they are known
  CutDiscs(const PreparedMesh& prepared, std::vector<std::array<FaceSide, 3>> sides);

  /// The faces of a region without such discs and the specks they leave, ascending; all faces where its group has no
  /// axis. O(#faces of the region and of those planes)
  std::vector<int> without(const FoundRegion& region);

  /// Whether a turned region is little else than such discs.
  bool little_else(const FoundRegion& region) { return little_else(region, without(region)); }
  /// \param rest what without() gives
  bool little_else(const FoundRegion& region, const std::vector<int>& rest) const;

  /// Of all faces.
  const std::vector<std::array<FaceSide, 3>>& sides() const { return sides_; }

 private:
  bool round(const FaceSide& side, const GroupPlacement& placement) const;

  enum class Kind : char { outside, inside, across, seen };

  const PreparedMesh& prepared_;
  std::vector<std::array<FaceSide, 3>> sides_;
  std::vector<Kind> kinds_;  // by face; all outside between calls
};

/// Takes cut discs out of regions. A turned one that is little else, or does not turn without them, goes; one of a
/// finite group keeps them unless it is mostly discs and has its group without them: bolts stand on plates. What then
/// fades as the tolerance shrinks goes.
/// \param tolerance of the detector, a fraction of the diagonal
void drop_cut_discs(const PreparedMesh& prepared, double tolerance, const RunContext& context,
                    std::vector<FoundRegion>& regions, Explanation* explanation = nullptr);

}  // namespace orbifit
