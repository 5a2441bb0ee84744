#pragma once

#include <utility>
#include <vector>

#include "orbifit/model/mesh.h"

namespace orbifit::scoring {

/// A set of faces as runs [first, end), ascending, not touching.
struct FaceSet {
  std::vector<std::pair<int, int>> runs;

  bool empty() const { return runs.empty(); }
  int size() const;
};

/// \param faces ascending
FaceSet face_set(const std::vector<int>& faces);
FaceSet intersection(const FaceSet& a, const FaceSet& b);
FaceSet united(const FaceSet& a, const FaceSet& b);
std::vector<int> members(const FaceSet& set);

/// A mesh with what all scores need. Keeps a reference to the mesh.
struct MeasuredMesh {
  explicit MeasuredMesh(const Mesh& given);

  const Mesh& mesh;
  Points normals;                   ///< #F by 3
  Eigen::VectorXd areas;            ///< #F
  std::vector<double> area_before;  ///< #F + 1: sums of the areas of all earlier faces
  double area = 0;
  double diagonal = 0;

  double area_of(const FaceSet& set) const;

  /// Shared area by the area of both; 0 where neither has any.
  double iou(const FaceSet& a, const FaceSet& b) const;

  /// Diagonal of the bounding box of the faces' corners.
  double diagonal_of(const std::vector<int>& faces) const;

  /// What counts as on these faces: min(0.5 % of the mesh's diagonal, 2 % of theirs).
  double tolerance_of(const std::vector<int>& faces) const;

  /// Mean over the faces of their corners' mean.
  Eigen::Vector3d middle_of(const std::vector<int>& faces) const;
};

}  // namespace orbifit::scoring
