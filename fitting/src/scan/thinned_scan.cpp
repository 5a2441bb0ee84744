#include "scan/thinned_scan.h"

#include <vector>

#include "base/random.h"

namespace orbifit {

namespace {

// Ascending: each is drawn as likely as any other of those that are left.
std::vector<int> drawn(Eigen::Index total, int most, std::uint64_t seed) {
  Random random(seed, "points of a large scan");
  std::vector<int> chosen;
  chosen.reserve(static_cast<std::size_t>(most));
  for (Eigen::Index i = 0; i < total && static_cast<int>(chosen.size()) < most; ++i) {
    const auto wanted = static_cast<std::uint64_t>(most) - chosen.size();
    if (random.below(static_cast<std::uint64_t>(total - i)) < wanted) chosen.push_back(static_cast<int>(i));
  }
  return chosen;
}

}  // namespace

PointCloud thinned(const PointCloud& scan, int most, std::uint64_t seed) {
  if (scan.points.rows() <= most) return scan;
  const std::vector<int> kept = drawn(scan.points.rows(), most, seed);
  const auto rows_of = [&](const Points& all) -> Points {
    return all.rows() == scan.points.rows() ? Points(all(kept, Eigen::all)) : all;
  };
  return {rows_of(scan.points), rows_of(scan.normals), rows_of(scan.viewpoints), scan.dropped};
}

}  // namespace orbifit
