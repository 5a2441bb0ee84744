#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/mesh.h"

namespace orbifit::scoring {

/// Finds faces near a point that are turned away from a normal: a tree of boxes over some faces of a mesh.
class CreaseIndex {
 public:
  /// \param normals of all faces, #F by 3; kept by reference, as is the mesh
  CreaseIndex(const Mesh& mesh, const Points& normals, std::vector<int> faces);

  /// Whether a face within `reach` of the point has a normal n with |n . normal| <= cosine.
  bool turned_away(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double cosine, double reach) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0, end = 0;  // of the faces below
    int second_child = -1;   // the first one follows its parent; -1: a leaf
  };

  void build(int first, int end);

  const Mesh& mesh_;
  const Points& normals_;
  std::vector<int> faces_;
  std::vector<Eigen::Vector3d> middles_;  // by face of faces_ as given
  std::vector<Node> nodes_;
};

}  // namespace orbifit::scoring
