#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"

namespace orbifit {

/// How a surface has turned where some of its faces meet: the mean normal of the faces at rest and after the edit. A
/// normal that a file has there, which need not be the mean, turns as the mean does, the short way; so smooth places
/// stay smooth and sharp ones sharp.
class NormalTurn {
 public:
  /// \param rest, edited  twice the face's area along its normal
  void add(const Eigen::Vector3d& rest, const Eigen::Vector3d& edited);

  /// The normal as it is after the edit, as long as it was; the same where the faces have no mean normal.
  Eigen::Vector3d apply(const Eigen::Vector3d& normal) const;

 private:
  Eigen::Vector3d rest_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d edited_ = Eigen::Vector3d::Zero();
};

/// Twice each face's area along its normal, #F by 3.
Points face_area_vectors(const Mesh& mesh);

/// The turn of the faces around each vertex, #V. \param edited  `rest` with other positions
std::vector<NormalTurn> vertex_normal_turns(const Mesh& rest, const Mesh& edited);

}  // namespace orbifit
