#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/subspace/subspace.h"

#include "basis/lift.h"

namespace orbifit {

/// The rotation nearest to a weighted sum of rotations; the identity where there is none.
Eigen::Matrix3d blended_rotation(const Eigen::Matrix3d& sum);

/// The rotation by |vector| radians about a vector.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& vector);

/// A matrix on points (x) I_3, applied to stacked displacements: 3 rows a point.
Eigen::MatrixXd applied(const LiftWeights& scalar, const Eigen::MatrixXd& stacked);

/// How the regions' groups may turn in mode `moving` (docs/method.md 2.2) without contradicting one another. Regions
/// that elements of larger ones, or motions of patterns, take to one another form a family: when g takes region i to j,
/// their rotations relative to the regions around them obey Q_j = g Q_i g^-1. What takes a region to itself leaves it
/// only the rotations that commute with it. Regions that overlap without nesting turn together. Ways of turning that
/// contradict one another all the same are found by trying them and given up, those of smaller regions first.
class ConjugatedRegions {
 public:
  explicit ConjugatedRegions(const Subspace& subspace, const RunContext& context = RunContext{});

  /// Number of ways in which families may turn: the length of the vectors below.
  int freedom() const { return freedom_; }

  /// Where each family's first member stands relative to the region around it.
  using Turns = std::vector<Eigen::Matrix3d>;
  Turns rest() const { return Turns(families_.size(), Eigen::Matrix3d::Identity()); }

  /// R of every region.
  std::vector<Eigen::Matrix3d> rotations(const Turns& turns) const;

  /// The turns behind rotations().
  Turns turns_of(const std::vector<Eigen::Matrix3d>& rotations) const;

  /// All turned as one body, as far as the outermost regions may turn at all.
  Turns as_one(const Eigen::Matrix3d& rotation) const;

  /// Turned on by small rotations in the free ways, radians.
  Turns turned(const Turns& turns, const Eigen::VectorXd& angles) const;

  /// How the samples start to move when one way of turning grows: 3#S by freedom(), mesh units a radian.
  /// \param samples   #S by 3, where they are now
  /// \param centres   #regions by 3, where the regions' centres are now
  Eigen::MatrixXd columns(const Turns& turns, const Points& samples, const Points& centres) const;

  /// The same of vertices: they turn with the regions that hold them. 3#vertices by freedom().
  /// \param points  of the vertices, where they are now
  Eigen::MatrixXd vertex_columns(const Turns& turns, const std::vector<int>& vertices, const Points& points,
                                 const Points& centres) const;

  /// How turning moves points that follow samples by weights, besides moving those: omega x (p - sum of w x), omega
  /// that of the samples, blended. 3#P by freedom().
  /// \param spread  #P by #S \param missing  p - sum of w x, #P by 3
  Eigen::MatrixXd arms(const Turns& turns, const LiftWeights& spread, const Points& missing) const;

 private:
  struct Member {
    int region;
    Eigen::Matrix3d from_first;  ///< rotation vectors of the first member -> of this one, at rest
  };
  struct Family {
    std::vector<Member> members;
    Eigen::MatrixXd free;  ///< 3 by 0..3, orthonormal: the first member's rotation vectors
  };
  using Held = std::vector<std::vector<int>>;  ///< by place, ascending
  Eigen::MatrixXd columns_of(const Turns& turns, const Held& held, const Points& points, const Points& centres) const;
  void keep_agreeing(const RunContext& context);
  void gather(std::size_t first, const std::vector<int>& order, const Points& centroids, double near,
              std::vector<char>& taken);
  bool nested(int inner, int outer) const;
  bool overlap(int a, int b) const;

  const Subspace& subspace_;
  Held samples_;                  ///< of each place: regions, then patterns' instances
  std::vector<int> around_;       ///< smallest region around each; -1: none
  std::vector<Family> families_;  ///< those of larger regions first
  int freedom_ = 0;
};

}  // namespace orbifit
