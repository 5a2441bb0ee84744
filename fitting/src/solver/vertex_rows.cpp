#include "solver/vertex_rows.h"

#include "basis/subspace_parts.h"

namespace orbifit {

namespace {

VertexRows::Rows rows_of(const Eigen::Matrix3Xd& dense) {
  VertexRows::Rows result;
  for (Eigen::Index j = 0; j < dense.cols(); ++j) {
    if (!dense.col(j).isZero(0)) result.columns.push_back(static_cast<int>(j));
  }
  result.factors.reserve(result.columns.size());
  for (const int j : result.columns) result.factors.emplace_back(dense.col(j));
  return result;
}

}  // namespace

VertexRows::VertexRows(const Subspace& subspace, const ConjugatedBasis& basis)
    : subspace_(subspace),
      basis_(basis),
      own_(static_cast<std::size_t>(subspace->orbits.representatives())),
      ways_(subspace->orbits.followers.size()),
      known_(ways_.size(), 0),
      own_known_(own_.size(), 0) {}

void VertexRows::prepare(const std::vector<int>& vertices, const RunContext& context) {
  const Eigen::Index dof = basis_.degrees_of_freedom();
  std::vector<int> fresh;
  for (const int vertex : vertices) {
    const auto v = static_cast<std::size_t>(vertex);
    if (known_[v] != 0) continue;
    known_[v] = 1;
    const VertexWay way = vertex_way(subspace_, basis_, vertex);
    const auto representative = static_cast<std::size_t>(way.representative);
    if (own_known_[representative] == 0) fresh.push_back(way.representative);
    own_known_[representative] = 1;
    const VertexOrbits::Follower& follower = subspace_->orbits.followers[v];
    const std::array<int, 3> carried_by{follower.word, subspace_->orbits.bound[representative], follower.turn};
    const auto [entry, added] = shift_of_.try_emplace(carried_by, static_cast<int>(shifts_.size()));
    if (added) {
      Eigen::Matrix3Xd dense = Eigen::Matrix3Xd::Zero(3, dof);
      for (const auto& [carrier, matrix] : way.carried) {
        dense.noalias() += matrix * basis_.carried.middleRows<3>(3 * carrier);
      }
      shifts_.push_back(rows_of(dense));
    }
    ways_[v].representative = way.representative;
    ways_[v].shift = entry->second;
    ways_[v].along = way.along;
  }
  parallel_for(context, fresh.size(), [&](std::size_t begin, std::size_t end) {
    Eigen::Matrix3Xd dense(3, dof);
    for (std::size_t i = begin; i < end; ++i) {
      dense.setZero();
      add_representative_rows(subspace_, basis_, fresh[i], dense);
      own_[static_cast<std::size_t>(fresh[i])] = rows_of(dense);
    }
  });
}

void VertexRows::extend(int vertex, int first_column, const Eigen::Matrix<double, 3, Eigen::Dynamic>& factors) {
  Rows& more = ways_[static_cast<std::size_t>(vertex)].more;
  for (Eigen::Index k = 0; k < factors.cols(); ++k) {
    more.columns.push_back(first_column + static_cast<int>(k));
    more.factors.emplace_back(factors.col(k));
  }
}

}  // namespace orbifit
