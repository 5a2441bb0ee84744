#include "rest_shape/ring_average.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t kMinOfRing = 3;
// A ring whose profile is wider than this many links is a chain of rings that run into one another.
constexpr double kWidest = 4;

class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }

  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

// The rows of `profile` (#P by 2) in sets that hang together by steps of at most `link`. Rows that are the same up to
// rounding count as one, so that the many places of a ring cost no more than one.
std::vector<std::vector<Index>> linked(const Eigen::MatrixX2d& profile, double link) {
  const auto count = static_cast<std::size_t>(profile.rows());
  Sets sets(count);
  const double rounding = std::max(1e-3 * link, 1e-12 * profile.cwiseAbs().maxCoeff());
  std::map<std::pair<double, double>, std::size_t> cells;
  std::vector<std::size_t> distinct;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::RowVector2d cell = (profile.row(static_cast<Index>(i)) / rounding).array().floor();
    bool known = false;
    for (int step = 0; step < 9 && !known; ++step) {
      const auto entry = cells.find({cell[1] + step / 3 - 1, cell[0] + step % 3 - 1});
      if (entry == cells.end()) continue;
      sets.join(i, entry->second);
      known = true;
    }
    if (known) continue;
    cells.emplace(std::pair{cell[1], cell[0]}, i);
    distinct.push_back(i);
  }
  const auto row = [&](std::size_t i) { return profile.row(static_cast<Index>(i)); };
  std::ranges::sort(distinct, [&](std::size_t a, std::size_t b) {
    return std::pair(row(a)[1], row(a)[0]) < std::pair(row(b)[1], row(b)[0]);
  });
  for (std::size_t i = 0; i < distinct.size(); ++i) {
    for (std::size_t j = i + 1; j < distinct.size() && row(distinct[j])[1] - row(distinct[i])[1] <= link; ++j) {
      if ((row(distinct[j]) - row(distinct[i])).norm() <= link) sets.join(distinct[i], distinct[j]);
    }
  }
  std::vector<std::vector<Index>> result(count);
  for (std::size_t i = 0; i < count; ++i) result[sets.find(i)].push_back(static_cast<Index>(i));
  std::erase_if(result, [](const auto& set) { return set.empty(); });
  return result;
}

}  // namespace

Rings ring_average(const Region& region, double link, Points& places) {
  const bool axial = region.group.has_axis();
  const Vector3d axis = region.axis.normalized();
  Eigen::MatrixX2d profile(places.rows(), 2);  // distance from the axis and height; distance from the centre and 0
  for (Index i = 0; i < places.rows(); ++i) {
    const Vector3d offset = places.row(i).transpose() - region.centre;
    const double height = axial ? offset.dot(axis) : 0;
    profile.row(i) << (axial ? Vector3d(offset - height * axis).norm() : offset.norm()), height;
  }
  Rings result;
  double sum = 0;
  for (const std::vector<Index>& set : linked(profile, link)) {
    if (set.size() < kMinOfRing) continue;
    const Eigen::MatrixX2d here = profile(set, Eigen::all);
    if ((here.colwise().maxCoeff() - here.colwise().minCoeff()).maxCoeff() > kWidest * link) continue;
    const Eigen::RowVector2d mean = here.colwise().mean();
    ++result.rings;
    result.places += static_cast<int>(set.size());
    for (const Index i : set) {
      const Vector3d offset = places.row(i).transpose() - region.centre;
      Vector3d across = axial ? Vector3d(offset - profile(i, 1) * axis) : offset;
      // A place on the axis has no direction to go.
      if (across.norm() > 1e-9 * mean[0]) across *= mean[0] / across.norm();
      const Vector3d moved = region.centre + across + (axial ? Vector3d(mean[1] * axis) : Vector3d::Zero());
      sum += (moved - places.row(i).transpose()).squaredNorm();
      places.row(i) = moved.transpose();
    }
  }
  if (result.places > 0) result.scatter = std::sqrt(sum / result.places);
  return result;
}

}  // namespace orbifit
