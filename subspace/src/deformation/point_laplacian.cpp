#include "deformation/point_laplacian.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orbifit {

namespace {

constexpr double kMinWeight = 0.01;

// The median distance of each sample's neighbours; of an even number the mean of the middle two.
Eigen::VectorXd local_scales(const Points& samples, const SampleEdges& edges) {
  std::vector<std::vector<double>> lengths(static_cast<std::size_t>(samples.rows()));
  for (const auto& [i, j] : edges) {
    const double length = (samples.row(i) - samples.row(j)).norm();
    lengths[static_cast<std::size_t>(i)].push_back(length);
    lengths[static_cast<std::size_t>(j)].push_back(length);
  }
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(samples.rows());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    std::vector<double>& list = lengths[i];
    if (list.empty()) continue;
    std::ranges::sort(list);
    const double median = (list[(list.size() - 1) / 2] + list[list.size() / 2]) / 2;
    if (median > 0) scales[static_cast<Eigen::Index>(i)] = median;
  }
  return scales;
}

}  // namespace

Eigen::SparseMatrix<double> point_laplacian(const Points& samples, const SampleEdges& edges) {
  const Eigen::VectorXd scales = local_scales(samples, edges);
  const auto closeness = [&](int i, int j) {
    return std::exp(-(samples.row(i) - samples.row(j)).squaredNorm() / (scales[i] * scales[j]));
  };
  // A sample counts itself and its neighbours within its Gaussian, which spans an area of h^2.
  Eigen::VectorXd crowd = Eigen::VectorXd::Ones(samples.rows());
  for (const auto& [i, j] : edges) {
    crowd[i] += closeness(i, j);
    crowd[j] += closeness(i, j);
  }
  const Eigen::VectorXd areas = scales.array().square() / crowd.array();

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * edges.size());
  double total = 0;
  for (const auto& [i, j] : edges) {
    // Belkin's factor 1 / h^4: energies do not depend on the local scale.
    const double weight =
        areas[i] * areas[j] * std::max(kMinWeight, closeness(i, j)) / (scales[i] * scales[i] * scales[j] * scales[j]);
    entries.emplace_back(i, i, weight);
    entries.emplace_back(j, j, weight);
    entries.emplace_back(i, j, -weight);
    entries.emplace_back(j, i, -weight);
    total += weight;
  }
  Eigen::SparseMatrix<double> laplacian(samples.rows(), samples.rows());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  if (total > 0) laplacian *= static_cast<double>(edges.size()) / total;
  return laplacian;
}

}  // namespace orbifit
