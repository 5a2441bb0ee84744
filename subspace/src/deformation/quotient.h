#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/subspace/subspace.h"

#include "deformation/corotation.h"

namespace orbifit {

/// The Laplace energy and its co-rotation in coordinates q, once for samples that behave alike (docs/method.md
/// 4). Samples of one orbit whose neighbourhoods are images of one another have rotations that are conjugates and
/// Laplace rows that are images, so one of them stands for all, weighted by their number. Which do is found by
/// comparing them under random displacements, so where a border makes neighbourhoods differ they are kept apart.
class Quotient {
 public:
  Quotient(const Subspace& subspace, const Corotation& corotation);

  Eigen::Index classes() const { return static_cast<Eigen::Index>(counts_.size()); }

  /// U^T L^T L U, DoF by DoF, both halves. A row of L touches the coordinates of the samples near its own.
  Eigen::SparseMatrix<double> stiffness() const;

  /// One rotation a class, #classes of 3 by 3, that take its rest neighbourhood nearest to that at q. Starts from the
  /// rotations given, which decide what the neighbourhood leaves open.
  void rotate(const Eigen::VectorXd& q, std::vector<Eigen::Matrix3d>& rotations) const;

  /// The rotation of any sample, given those of the classes.
  Eigen::Matrix3d rotation_of(int sample, const std::vector<Eigen::Matrix3d>& rotations) const;

  /// U^T L^T (R delta - delta), DoF: the right-hand side of equation (4) without the handles.
  void pull(const std::vector<Eigen::Matrix3d>& rotations, Eigen::VectorXd& result) const;

  /// |L (x + U q) - R delta|^2.
  double energy(const Eigen::VectorXd& q, const std::vector<Eigen::Matrix3d>& rotations) const;

 private:
  /// \return the first sample of each class
  std::vector<int> find_classes(const Subspace& subspace, const Corotation& corotation);
  void add_columns(const Subspace& subspace, const Corotation& corotation, const std::vector<int>& representatives);

  std::vector<double> counts_;          // samples in each class
  std::vector<int> class_of_sample_;    // #S
  std::vector<Eigen::Matrix3d> frame_;  // #S, orthogonal: takes the class's rotation to the sample's by conjugation
  std::vector<double> sizes_;           // sum of squared lengths of the neighbourhood's edges
  std::vector<std::size_t> held_;       // classes with neighbours
  std::vector<Eigen::Matrix3d> rest_;   // covariance at rest
  std::vector<Eigen::Vector3d> delta_;  // Laplace coordinates at rest
  std::vector<int> first_;              // of each class's columns, and their number at the end
  std::vector<int> column_;
  std::vector<double> covariance_;  // 12 a column: what a unit of the coordinate adds, 9 column-major and padding
  std::vector<double> laplace_;     // 4 a column: Laplace coordinates of a unit of the coordinate, and padding
  Eigen::Index freedom_ = 0;
};

/// The rotation R in SO(3) nearest to a matrix, that is the largest trace of R^T C, by Newton's method on the group
/// from a rotation nearby; where that does not find the maximum, by singular values.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix, const Eigen::Matrix3d& start);

}  // namespace orbifit
