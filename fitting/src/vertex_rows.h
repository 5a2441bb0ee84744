#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// Displacements of vertices as linear forms in the subspace's coordinates, kept once they were asked for: a fit asks
/// for those of much the same vertices in each iteration.
class VertexRows {
 public:
  explicit VertexRows(const Subspace& subspace)
      : subspace_(subspace), rows_(subspace.orbits.followers.size()), known_(rows_.size(), 0) {}

  /// u(vertex) = sum over the entries of q[column] * factor.
  struct Entry {
    int column;
    Eigen::Vector3d factor;
  };

  /// Makes the rows of these vertices, in parallel. \param vertices  any order, repeated ones too
  void prepare(const std::vector<int>& vertices, const RunContext& context);

  /// Entries by ascending column. \pre prepared
  const std::vector<Entry>& of(int vertex) const { return rows_[static_cast<std::size_t>(vertex)]; }

 private:
  const Subspace& subspace_;
  std::vector<std::vector<Entry>> rows_;
  std::vector<char> known_;
};

}  // namespace orbifit
