#include "basis/lift.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/point_index.h"

namespace orbifit {

namespace {
constexpr double kCutOff = 0.001;
constexpr std::size_t kAtOnce = 256;  // points between two looks at the time
}  // namespace

LiftWeights lift_weights(const Points& points, const Points& samples, double sigma, const RunContext& context) {
  const PointIndex index(samples);
  const double reach = sigma * std::sqrt(-2 * std::log(kCutOff));
  const auto count = static_cast<std::size_t>(points.rows());
  std::vector<std::vector<Eigen::Triplet<double>>> rows(count);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (p % kAtOnce == 0) context.check();
      const auto row = static_cast<Eigen::Index>(p);
      const Eigen::Vector3d point = points.row(row);
      double total = 0;
      for (const auto& [sample, distance] : index.within(point, reach)) {
        const double weight = std::exp(-distance * distance / (2 * sigma * sigma)) - kCutOff;
        if (weight <= 0) continue;
        rows[p].emplace_back(row, sample, weight);
        total += weight;
      }
      if (rows[p].empty()) {
        rows[p].emplace_back(row, index.nearest(point).index, 1);
        total = 1;
      }
      for (auto& entry : rows[p]) entry = Eigen::Triplet<double>(row, entry.col(), entry.value() / total);
      std::ranges::sort(rows[p], {}, [](const auto& entry) { return entry.col(); });
    }
  });
  LiftWeights weights(points.rows(), samples.rows());
  if (count == 0) return weights;  // Eigen 3.4 reads beyond the end of what it compresses there
  Eigen::VectorXi sizes(points.rows());
  for (std::size_t p = 0; p < count; ++p) sizes[static_cast<Eigen::Index>(p)] = static_cast<int>(rows[p].size());
  weights.reserve(sizes);
  for (const auto& row : rows) {
    for (const auto& entry : row) weights.insert(entry.row(), entry.col()) = entry.value();  // at the row's end
  }
  weights.makeCompressed();
  return weights;
}

}  // namespace orbifit
