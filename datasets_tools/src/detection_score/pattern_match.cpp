#include "detection_score/pattern_match.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "detection_score/assignment.h"
#include "detection_score/scored_surface.h"

namespace orbifit::scoring {

namespace {

using Eigen::Vector3d;

constexpr double kSameTurn = std::numbers::pi / 180;
constexpr double kSamePlace = 0.01;    // of the diagonal
constexpr double kNearPlace = 0.02;    // likewise: an element worth trying
constexpr double kMapsAsWell = 0.9;    // of an instance's area
constexpr double kPaired = 0.3;        // IoU
constexpr double kFound = 0.5;         // IoU
constexpr double kShareFound = 0.6;    // of the instances
constexpr double kStrictMedian = 0.7;  // IoU
constexpr double kRepeats = 0.9;       // IoU
constexpr double kHeldByRegion = 0.7;  // of an instance's area
constexpr std::size_t kMaxInstances = 40;

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Two motions from instance a to instance b that are equal, or equal up to a symmetry of the instance.
bool motions_agree(const MeasuredMesh& measured, const Motion& truth, const Motion& given, const std::vector<int>& a,
                   const std::vector<int>& b, Random& random, const RunContext& context) {
  const Vector3d middle = measured.middle_of(a);
  const AxisAngle between = axis_angle(truth.linear.transpose() * given.linear);
  const double apart = (truth(middle) - given(middle)).norm();
  if (between.determinant > 0 && between.angle <= kSameTurn && apart <= kSamePlace * measured.diagonal) return true;
  return instance_fit(measured, given, a, b, random, context) >= kMapsAsWell;
}

Motion relative(const Pattern& pattern, int from, int to) {
  return pattern.instances[static_cast<std::size_t>(to)].motion *
         inverse(pattern.instances[static_cast<std::size_t>(from)].motion);
}

}  // namespace

PlacedPattern::PlacedPattern(const MeasuredMesh& measured, const Pattern& given) : pattern(given) {
  for (const PatternInstance& instance : given.instances) {
    sets.push_back(face_set(instance.faces));
    area += measured.area_of(sets.back());
  }
}

bool PatternMatch::better_than(const PatternMatch& other) const {
  return std::tie(strict, loose, median_iou) > std::tie(other.strict, other.loose, other.median_iou);
}

PatternMatch match_patterns(const MeasuredMesh& measured, const PlacedPattern& truth, const PlacedPattern& predicted,
                            Random& random, const RunContext& context) {
  const std::size_t count = truth.sets.size();
  Eigen::MatrixXd iou(count, predicted.sets.size());
  for (Eigen::Index i = 0; i < iou.rows(); ++i) {
    for (Eigen::Index j = 0; j < iou.cols(); ++j) {
      iou(i, j) = measured.iou(truth.sets[static_cast<std::size_t>(i)], predicted.sets[static_cast<std::size_t>(j)]);
    }
  }
  std::vector<double> best(count, 0.0);
  std::vector<std::pair<int, int>> pairs = best_assignment(iou);
  for (const auto& [i, j] : pairs) best[static_cast<std::size_t>(i)] = iou(i, j);
  PatternMatch match;
  match.median_iou = median(best);
  const auto share = [&](auto number) { return static_cast<double>(number) / static_cast<double>(count); };
  if (share(std::ranges::count_if(best, [](double v) { return v >= kFound; })) < kShareFound) return match;

  // Motions from the instance that is found best to all others.
  std::erase_if(pairs, [&](const auto& pair) { return iou(pair.first, pair.second) < kPaired; });
  const auto [i0, j0] =
      *std::ranges::max_element(pairs, {}, [&](const auto& pair) { return iou(pair.first, pair.second); });
  std::size_t good = 0;
  for (const auto& [i, j] : pairs) {
    const bool agrees =
        i == i0 || motions_agree(measured, relative(truth.pattern, i0, i), relative(predicted.pattern, j0, j),
                                 truth.pattern.instances[static_cast<std::size_t>(i0)].faces,
                                 truth.pattern.instances[static_cast<std::size_t>(i)].faces, random, context);
    if (agrees) ++good;
  }
  match.loose = share(good) >= kShareFound;
  match.strict = predicted.sets.size() == count && match.median_iou >= kStrictMedian && good == count;
  return match;
}

bool region_relates(const MeasuredMesh& measured, const PlacedPattern& truth, const Region& region, const FaceSet& set,
                    Random& random, const RunContext& context) {
  const bool held = std::ranges::all_of(truth.sets, [&](const FaceSet& instance) {
    return measured.area_of(intersection(instance, set)) >= kHeldByRegion * measured.area_of(instance);
  });
  if (!held || region.group.continuous()) return false;
  const std::vector<PatternInstance>& instances = truth.pattern.instances;
  const Vector3d middle = measured.middle_of(instances.front().faces);
  for (std::size_t j = 1; j < instances.size(); ++j) {
    const Motion wanted = relative(truth.pattern, 0, static_cast<int>(j));
    const bool related = std::ranges::any_of(region.elements, [&](const Motion& element) {
      return (element(middle) - wanted(middle)).norm() <= kNearPlace * measured.diagonal &&
             motions_agree(measured, wanted, element, instances.front().faces, instances[j].faces, random, context);
    });
    if (!related) return false;
  }
  return true;
}

double pattern_validity(const MeasuredMesh& measured, const Pattern& pattern, Random& random,
                        const RunContext& context) {
  std::vector<std::size_t> tried(pattern.instances.size() - 1);
  std::iota(tried.begin(), tried.end(), 1);
  if (tried.size() > kMaxInstances) {
    for (std::size_t i = 0; i < kMaxInstances; ++i) std::swap(tried[i], tried[i + random.below(tried.size() - i)]);
    tried.resize(kMaxInstances);
    std::ranges::sort(tried);
  }
  const std::vector<int>& first = pattern.instances.front().faces;
  double sum = 0;
  for (const std::size_t j : tried) {
    const PatternInstance& instance = pattern.instances[j];
    sum += std::min(instance_fit(measured, instance.motion, first, instance.faces, random, context),
                    instance_fit(measured, inverse(instance.motion), instance.faces, first, random, context));
  }
  return tried.empty() ? 0 : sum / static_cast<double>(tried.size());
}

bool repeats(const MeasuredMesh& measured, const PlacedPattern& pattern, const PlacedPattern& earlier) {
  if (pattern.sets.size() != earlier.sets.size()) return false;
  std::vector<double> best;
  for (const FaceSet& set : pattern.sets) {
    double most = 0;
    for (const FaceSet& other : earlier.sets) most = std::max(most, measured.iou(set, other));
    best.push_back(most);
  }
  return median(best) > kRepeats;
}

}  // namespace orbifit::scoring
