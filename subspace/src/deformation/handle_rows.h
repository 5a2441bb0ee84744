#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// The handles' rows A of equation (4): one handle's points share the coordinates that they touch.
class HandleRows {
 public:
  HandleRows() = default;
  HandleRows(const std::vector<Handle>& handles, const Subspace& subspace, const Mesh& mesh);

  std::size_t handles() const { return parts_.size(); }

  /// The lower half of A^T W A.
  Eigen::SparseMatrix<double> gram(Eigen::Index freedom) const;

  /// The displacements that the motions ask for, stacked as the rows are.
  Eigen::VectorXd targets(const std::vector<Motion>& motions) const;

  /// A^T W a, DoF.
  Eigen::VectorXd pull(const Eigen::VectorXd& targets, Eigen::Index freedom) const;

  /// W-weighted mean square of |A u - a|, with the displacements at q; and the total weight.
  double squared_error(const Eigen::VectorXd& q, const Eigen::VectorXd& targets) const;
  double total_weight() const { return total_; }

  /// The points' vertices, their weights.
  const std::vector<int>& vertices() const { return vertices_; }
  const std::vector<double>& weights() const { return weights_; }
  const Points& rest() const { return rest_; }

 private:
  struct Part {
    std::size_t first = 0, count = 0;   // points
    std::vector<Eigen::Index> columns;  // touched
    Eigen::MatrixXd rows;               // 3 count by touched
    double weight = 0;                  // of each point
  };
  std::vector<Part> parts_;
  std::vector<int> vertices_;
  std::vector<double> weights_;
  Points rest_;
  double total_ = 0;
};

}  // namespace orbifit
