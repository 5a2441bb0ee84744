#include "vertex_rows.h"

namespace orbifit {

void VertexRows::prepare(const std::vector<int>& vertices, const RunContext& context) {
  std::vector<int> fresh;
  for (const int vertex : vertices) {
    char& known = known_[static_cast<std::size_t>(vertex)];
    if (known == 0) fresh.push_back(vertex);
    known = 1;
  }
  const Eigen::Index dof = basis_.degrees_of_freedom();
  parallel_for(context, fresh.size(), [&](std::size_t begin, std::size_t end) {
    Eigen::Matrix3Xd dense(3, dof);
    std::vector<int> columns;
    for (std::size_t i = begin; i < end; ++i) {
      dense.setZero();
      add_vertex_rows(subspace_, basis_, fresh[i], dense);
      columns.clear();
      for (Eigen::Index j = 0; j < dof; ++j) {
        if (!dense.col(j).isZero(0)) columns.push_back(static_cast<int>(j));
      }
      std::vector<Entry>& row = rows_[static_cast<std::size_t>(fresh[i])];
      row.reserve(columns.size());
      for (const int j : columns) row.push_back({j, dense.col(j)});
    }
  });
}

}  // namespace orbifit
