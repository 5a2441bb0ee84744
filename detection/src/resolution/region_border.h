#pragma once

#include <vector>

#include "orbifit/model/run_context.h"

#include "resolution/coarse_mesh.h"
#include "support/found_region.h"
#include "surface/surface_patch.h"

namespace orbifit {

/// Says which faces of a fine mesh a region of its coarse mesh has: those for which its faces stand, but where it ends
/// within a smooth surface those that its group keeps on it. Coarse faces on both sides of such a border are looked at
/// in pieces of half a tolerance.
class RegionBorder {
 public:
  /// All kept by reference. \param prepared the coarse mesh, made ready; in another frame than `fine`
  RegionBorder(const PreparedMesh& fine, const CoarseMesh& coarse, const PreparedMesh& prepared, double tolerance);

  /// The faces of the fine mesh for which these stand, ascending.
  std::vector<int> fine_faces(const std::vector<int>& coarse) const;

  /// \param region of the coarse mesh, in its frame \return faces of the fine mesh, ascending
  /// Costs O(R + B M) for R faces, B pieces along the border and M motions that judge the group.
  std::vector<int> refined(const FoundRegion& region, const RunContext& context) const;

 private:
  struct Piece {
    Eigen::Vector3d point;  // in the coarse mesh's frame
    Eigen::Vector3d normal;
    std::vector<int> faces;  // of the fine mesh
  };
  // Coarse faces of the region at its border, and their smooth neighbours beyond.
  std::vector<int> along_border(const FoundRegion& region, std::vector<char>& in) const;
  std::vector<Piece> pieces_of(const std::vector<int>& coarse) const;

  const PreparedMesh& fine_;
  const PreparedMesh& prepared_;
  double tolerance_;
  Similarity coarse_of_fine_;               // from the prepared fine mesh's frame to that of the prepared coarse one
  std::vector<std::vector<int>> faces_of_;  // by coarse face: the fine ones for which it stands
};

}  // namespace orbifit
