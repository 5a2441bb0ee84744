#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "basis/subspace_parts.h"

namespace orbifit {

/// Displacements of vertices as linear forms in a basis' coordinates, kept once they were asked for: a fit asks for
/// those of much the same vertices in each iteration. u(vertex) = along * own(representative) + shift() + more, so that
/// images of one another share what is kept of their representative, and what one word carries is kept once.
class VertexRows {
 public:
  /// Three linear forms, on the columns where they are not zero.
  struct Rows {
    std::vector<int> columns;  ///< ascending
    std::vector<Eigen::Vector3d> factors;

    /// Calls visit(column, direction . factor) for each.
    template <class Visit>
    void visit(const Eigen::Vector3d& direction, const Visit& visit) const {
      for (std::size_t i = 0; i < columns.size(); ++i) visit(columns[i], direction.dot(factors[i]));
    }
  };
  struct Way {
    int representative = 0;
    int shift = 0;  ///< what it is carried by, which many vertices share
    Eigen::Matrix3d along;
    Rows more;  ///< extend()
  };

  /// References are kept.
  VertexRows(const Subspace& subspace, const ConjugatedBasis& basis);

  /// Makes the rows of these vertices, in parallel. \param vertices  any order, repeated ones too
  void prepare(const std::vector<int>& vertices, const RunContext& context);

  /// Adds columns after those there are to a vertex, once. \pre prepared
  void extend(int vertex, int first_column, const Eigen::Matrix<double, 3, Eigen::Dynamic>& factors);

  /// \pre prepared
  const Way& way(int vertex) const { return ways_[static_cast<std::size_t>(vertex)]; }
  const Rows& own(int representative) const { return own_[static_cast<std::size_t>(representative)]; }
  const Rows& shift(int number) const { return shifts_[static_cast<std::size_t>(number)]; }
  std::size_t representatives() const { return own_.size(); }

 private:
  const Subspace& subspace_;
  const ConjugatedBasis& basis_;
  std::vector<Rows> own_, shifts_;
  std::vector<Way> ways_;
  std::vector<char> known_, own_known_;
  std::map<std::array<int, 3>, int> shift_of_;  // word, binding, turn
};

}  // namespace orbifit
