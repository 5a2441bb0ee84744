#include "group/axis_orders.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "group/verification.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kOrderSamples = 96;
constexpr int kHighestScreenedOrder = 180;
// A rotation that moves no point by more than this many tolerances cannot be told from none.
constexpr double kMinMove = 6;
// Low orders move far around the axis what they move little along it: for them less will do.
constexpr double kLowOrder = 6;
constexpr double kMinMoveLow = 2;

// A small turn keeps flat sides within the tolerance; its larger multiples do not.
std::vector<int> judged_powers(int n) {
  std::vector<int> powers{1};
  for (const double share : {0.5, 0.382, 0.236, 0.146, 0.472}) {
    const int k = static_cast<int>(std::lround(share * n));
    if (k > 1 && k < n) powers.push_back(k);
  }
  return powers;
}

}  // namespace

double radius_about(const SurfacePatch& patch, const Vector3d& axis, const Vector3d& centre) {
  double largest = 0;
  for (Eigen::Index i = 0; i < patch.samples.points.rows(); ++i) {
    const Vector3d from = patch.samples.points.row(i).transpose() - centre;
    largest = std::max(largest, (from - axis * axis.dot(from)).norm());
  }
  return largest;
}

std::vector<int> rotation_orders(const SurfacePatch& patch, const Vector3d& axis, const Vector3d& centre,
                                 double slack) {
  std::vector<int> result;
  const double around = 2 * std::numbers::pi * radius_about(patch, axis, centre) / patch.tolerance;
  const int highest = static_cast<int>(
      std::min<double>(kHighestScreenedOrder, std::max(around / kMinMove, std::min(around / kMinMoveLow, kLowOrder))));
  const auto kept = [&](int k, int n) {
    const Motion turn = Motion::rotation(axis, 2 * std::numbers::pi * k / n, centre);
    return kept_share(patch, turn, slack * patch.tolerance, kOrderSamples, kScreenShare) >= kScreenShare;
  };
  constexpr std::size_t kNearlyRound = 16;  // orders: with so many, those between say nothing more
  constexpr int kLow = 12;
  for (int n = highest; n >= 2; --n) {
    if (result.size() >= kNearlyRound && n > kLow) continue;
    const std::vector<int> powers = judged_powers(n);
    if (std::ranges::all_of(powers, [&](int k) { return kept(k, n); })) result.push_back(n);
  }
  return result;
}

std::vector<RankedOrder> rank_orders(const SurfacePatch& patch, const std::vector<int>& orders, const Vector3d& axis,
                                     const Vector3d& centre) {
  constexpr int kRankSamples = 250;
  constexpr double kMinShare = 0.88;
  constexpr double kNearlyPerfect = 0.985;
  std::vector<RankedOrder> result;
  for (const int n : orders) {
    double share = 1;
    for (const int k : judged_powers(n)) {
      const Motion turn = Motion::rotation(axis, 2 * std::numbers::pi * k / n, centre);
      share = std::min(share, kept_share(patch, turn, 1.2 * patch.tolerance, kRankSamples, kMinShare));
      if (share < kMinShare) break;
    }
    if (share >= kMinShare) result.push_back({n, share});
  }
  std::stable_partition(result.begin(), result.end(), [](const RankedOrder& r) { return r.share >= kNearlyPerfect; });
  return result;
}

double continuous_tolerance(const SurfacePatch& patch) {
  return patch.relative_tolerance * std::min(1.0, 2.5 * patch.moments.diagonal);
}

bool continuous_about(const SurfacePatch& patch, const Vector3d& axis, const Vector3d& centre) {
  const double tolerance = 1.5 * continuous_tolerance(patch);
  for (const double turns : {0.1180, 0.2918, 0.3820, 0.4721, 0.0557, 0.0213}) {
    const Motion motion = Motion::rotation(axis, 2 * std::numbers::pi * turns, centre);
    if (kept_share(patch, motion, tolerance, 150, 0.9) < 0.9) return false;
  }
  return true;
}

}  // namespace orbifit
