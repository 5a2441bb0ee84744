#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// Area, mean and second moments of a piece of surface: two pieces with the same ones are taken to be the same.
struct PieceMoments {
  double area = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   ///< integral of x
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< integral of x x^T

  PieceMoments& operator+=(const PieceMoments& other);
};

/// Of some faces. Positions are told from `origin`.
PieceMoments moments_of_faces(const Mesh& mesh, const std::vector<int>& faces, const Eigen::Vector3d& origin);

/// Of each set of faces: entry s sums up the faces whose set is s. Positions are told from `origin`.
std::vector<PieceMoments> moments_of_sets(const Mesh& mesh, const std::vector<int>& set_of_face, int sets,
                                          const Eigen::Vector3d& origin);

/// How far apart `motion` of the one piece and the other are, as a fraction of `size`: the distance of their means, and
/// the differences of their spreads and of their sides as squares of the same area. Infinite where one has no area.
/// Costs no more the more triangles they have.
double separation(const PieceMoments& piece, const Motion& motion, const PieceMoments& other, double size);

}  // namespace orbifit
