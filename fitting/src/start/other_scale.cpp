#include "start/other_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/dense.h"
#include "basis/subspace_parts.h"
#include "deformation/corotation.h"
#include "registration/alignment.h"

namespace orbifit {

bool of_one_kind(double scale, double other) {
  constexpr double kOneKind = 0.4;  // of the quotient's logarithm
  return std::abs(std::log(scale / other)) <= kOneKind;
}

std::optional<PlacedScan> at_other_scale(const FitInput& input, const PlacedScan& start, const RunContext& context) {
  constexpr double kMuchTheSame = 0.02;  // logarithms of the scales' quotient
  constexpr int kEnough = 1500;
  const auto count = static_cast<int>(start.scan.points.rows());
  std::vector<int> some;
  for (int i = 0; i < count; i += std::max(1, count / kEnough)) some.push_back(i);
  PlacedScan result = start;
  const auto align = [&](const MatchSurface& surface) {
    return align_with_scale(surface, start.scan, some, start.pose, {}, context);
  };
  result.pose = start.shared ? align(start.shared->surface()) : align(MatchSurface(input.mesh));
  const double growth = std::abs(std::log(result.pose.scale / start.pose.scale));
  if (growth < kMuchTheSame || !of_one_kind(result.pose.scale, start.pose.scale)) return std::nullopt;
  return result;
}

FitState with_scale(double scale, const Similarity& pose, const SubspaceState& state, const Subspace& subspace,
                    const Mesh& mesh) {
  FitState result;
  result.pose = rescaled(pose, scale, mesh);
  const Points& rest = subspace->sampling.points;
  const Points posed = rest + sample_displacements(subspace, state);
  Points target(rest.rows(), 3);
  const Similarity back = inverse(result.pose);
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    target.row(i) = (back(pose(posed.row(i).transpose())) - rest.row(i).transpose()).transpose();
  }
  const Eigen::SparseMatrix<double>& columns = subspace->basis.columns;
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  result.q = solve_semidefinite(gram, columns.transpose() * stacked(target));
  return result;
}

}  // namespace orbifit
