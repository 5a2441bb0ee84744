#include "support/axial_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "group/verification.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kMaxAngles = 200;
constexpr int kMaxHeights = 800;
constexpr std::size_t kLooks = 160;  // samples that judge an angle or a height
constexpr std::size_t kAngles = 2;
constexpr std::size_t kHeights = 2;

class AxialSearch {
 public:
  AxialSearch(const ScreenedSurface& surface, const Line& axis, int n, const std::vector<int>& samples,
              const std::vector<int>& kept, double least_share)
      : surface_(surface),
        n_(n),
        samples_(samples),
        kept_(kept),
        least_(least_share * static_cast<double>(surface.samples.faces.size())),
        frame_(frame_about(axis.direction)),
        foot_(axis.point) {
    for (const int i : samples) {
      const Vector3d from = surface.samples.points.row(i).transpose() - foot_;
      reach_ = std::max(reach_, (from - from.dot(frame_.col(2)) * frame_.col(2)).norm());
    }
  }

  std::vector<AxialGroup> run() {
    if (static_cast<double>(samples_.size()) < least_) return {};
    // Mirrors whose planes hold the axis: their angles repeat after half of 1/n of a turn.
    const double period = std::numbers::pi / n_;
    const std::vector<double> angles =
        best(samples_, 0, period, true, surface_.tolerance / std::max(reach_, 1e-9), kMaxAngles, kAngles,
             [&](double angle) { return Motion::about(mirror(across(angle)), foot_); });
    std::vector<GroupPlacement> placements;
    placements.reserve(angles.size());
    for (const double angle : angles) placements.push_back({{Family::Cnv, n_}, frame(across(angle)), foot_});
    const Matrix3d flip = mirror(frame_.col(2));
    for (const double height : heights(flip)) {
      const Vector3d middle = foot_ + height * frame_.col(2);
      placements.push_back({{Family::Cnh, n_}, frame_, middle});
      for (const double angle : angles) placements.push_back({{Family::Dnh, n_}, frame(along(angle)), middle});
    }
    const Matrix3d improper = flip * axis_rotation(frame_.col(2), period);
    for (const double height : heights(improper)) {
      const Vector3d middle = foot_ + height * frame_.col(2);
      for (const double angle : angles) {
        placements.push_back({{Family::Dnd, n_}, frame(along(angle + 0.5 * period)), middle});
      }
    }
    std::vector<AxialGroup> result;
    for (const GroupPlacement& placement : placements) {
      const int kept = kept_by(judged_motions(placement.group, placement.frame, placement.centre));
      if (kept >= least_) result.push_back({placement, kept});
    }
    std::ranges::stable_sort(result, [](const AxialGroup& a, const AxialGroup& b) {
      const int order_a = a.placement.group.order();
      const int order_b = b.placement.group.order();
      return order_a != order_b ? order_a > order_b : a.kept > b.kept;
    });
    return result;
  }

  // Places on the axis across which samples are mirrored.
  std::vector<Vector3d> middles() const {
    std::vector<Vector3d> result;
    if (static_cast<double>(samples_.size()) < least_) return result;
    for (const double height : heights(mirror(frame_.col(2)))) result.emplace_back(foot_ + height * frame_.col(2));
    return result;
  }

 private:
  static Matrix3d mirror(const Vector3d& normal) { return Matrix3d::Identity() - 2 * normal * normal.transpose(); }

  Vector3d along(double angle) const { return std::cos(angle) * frame_.col(0) + std::sin(angle) * frame_.col(1); }
  Vector3d across(double angle) const { return along(angle + 0.5 * std::numbers::pi); }
  GroupFrame frame(const Vector3d& first) const { return frame_about(frame_.col(2), first); }

  std::vector<double> heights(const Matrix3d& linear) const {
    constexpr double kSame = 2;  // tolerances
    const auto motion_at = [&](double height) { return Motion::about(linear, foot_ + height * frame_.col(2)); };
    std::vector<double> result;
    const auto add = [&](const std::vector<int>& samples) {
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (const int i : samples) {
        const double at = height_of(i);
        low = std::min(low, at);
        high = std::max(high, at);
      }
      for (const double height :
           best(samples, low, high, false, surface_.tolerance, kMaxHeights, kHeights, motion_at)) {
        const bool known = std::ranges::any_of(
            result, [&](double other) { return std::abs(height - other) < kSame * surface_.tolerance; });
        if (!known && !mere_plate(height, motion_at(height))) result.push_back(height);
      }
    };
    if (!samples_.empty()) add(samples_);
    if (kept_.size() > samples_.size()) add(kept_);
    return result;
  }

  double height_of(int i) const { return frame_.col(2).dot(surface_.samples.points.row(i).transpose() - foot_); }

  bool holds(int i, const Motion& motion) const {
    const Vector3d normal = surface_.samples.normals.row(i);
    return surface_.grid.holds(motion(Vector3d(surface_.samples.points.row(i))), motion.linear * normal);
  }

  // Whether most of what the motion keeps lies at that height: any plate is its own mirror image.
  bool mere_plate(double height, const Motion& motion) const {
    constexpr double kThin = 1;  // tolerances
    int kept = 0;
    int thin = 0;
    for (const int i : kept_) {
      if (!holds(i, motion)) continue;
      ++kept;
      if (std::abs(height_of(i) - height) < kThin * surface_.tolerance) ++thin;
    }
    return 2 * thin > kept;
  }

  int kept_by(const std::vector<Motion>& motions) const {
    return static_cast<int>(std::ranges::count_if(samples_, [&](int i) {
      return std::ranges::all_of(motions, [&](const Motion& motion) { return holds(i, motion); });
    }));
  }

  // Parameters at which most samples are kept, the best first, none next to a better one.
  template <typename MotionAt>
  std::vector<double> best(const std::vector<int>& samples, double from, double to, bool periodic, double step,
                           int most_steps, std::size_t most, const MotionAt& motion_at) const {
    const int steps = std::clamp(static_cast<int>(std::ceil((to - from) / step)), 4, most_steps);
    const std::size_t looks = std::min(samples.size(), kLooks);
    std::vector<int> counts;
    for (int k = 0; k < steps; ++k) {
      const Motion motion = motion_at(from + (to - from) * k / steps);
      int count = 0;
      for (std::size_t i = 0; i < looks; ++i) count += holds(samples[i * samples.size() / looks], motion) ? 1 : 0;
      counts.push_back(count);
    }
    const auto at = [&](int k) {
      if (periodic) return counts[static_cast<std::size_t>((k + steps) % steps)];
      return k < 0 || k >= steps ? 0 : counts[static_cast<std::size_t>(k)];
    };
    const double least = 0.7 * least_ * static_cast<double>(looks) / static_cast<double>(samples.size());
    std::vector<std::pair<int, double>> peaks;
    for (int k = 0; k < steps; ++k) {
      if (at(k) < least || at(k) < at(k - 1) || at(k) <= at(k + 1)) continue;
      int first = k;  // of a plateau its middle
      while (k - first < steps && at(first - 1) == at(k)) --first;
      peaks.emplace_back(at(k), from + (to - from) * 0.5 * (first + k) / steps);
    }
    std::ranges::stable_sort(peaks, std::greater<>(), &std::pair<int, double>::first);
    std::vector<double> result;
    for (const auto& [count, value] : peaks) {
      if (result.size() < most) result.push_back(centred(samples, value, (to - from) / steps, motion_at));
    }
    return result;
  }

  // The middle of where nearly as many samples are kept as at best, near a parameter: what lies across the motion is
  // lost on either side alike. Planes along it, which say nothing of where it is, must not decide alone.
  template <typename MotionAt>
  double centred(const std::vector<int>& samples, double value, double step, const MotionAt& motion_at) const {
    constexpr int kFine = 4;  // steps in one
    constexpr int kReach = 2 * kFine;
    constexpr std::size_t kFineLooks = 400;
    constexpr double kNearly = 0.985;
    const std::size_t looks = std::min(samples.size(), kFineLooks);
    std::array<int, 2 * kReach + 1> counts{};
    for (std::size_t at = 0; at < counts.size(); ++at) {
      const Motion motion = motion_at(value + step * (static_cast<double>(at) - kReach) / kFine);
      for (std::size_t i = 0; i < looks; ++i) {
        counts[at] += holds(samples[i * samples.size() / looks], motion) ? 1 : 0;
      }
    }
    const auto best = std::ranges::max_element(counts);
    const auto near = [&](int count) { return count >= kNearly * *best; };
    const auto high = std::find_if_not(best, counts.end(), near);
    const auto low = std::find_if_not(std::make_reverse_iterator(best), counts.rend(), near).base();
    const double middle =
        0.5 * (static_cast<double>(low - counts.begin()) + static_cast<double>(high - counts.begin()) - 1);
    return value + step * (middle - kReach) / kFine;
  }

  const ScreenedSurface& surface_;
  int n_;
  const std::vector<int>& samples_;
  const std::vector<int>& kept_;
  double least_;
  GroupFrame frame_;
  Vector3d foot_;
  double reach_ = 0;
};

}  // namespace

std::vector<AxialGroup> larger_groups(const ScreenedSurface& surface, const Line& axis, int n,
                                      const std::vector<int>& samples, const std::vector<int>& kept,
                                      double least_share) {
  return AxialSearch(surface, axis, n, samples, kept, least_share).run();
}

std::vector<GroupPlacement> groups_with_middle(const ScreenedSurface& surface, const Line& axis,
                                               const std::vector<int>& samples, double least_share) {
  std::vector<GroupPlacement> result;
  for (const Vector3d& middle : AxialSearch(surface, axis, 1, samples, samples, least_share).middles()) {
    result.push_back({{Family::Dinfh, 1}, frame_about(axis.direction), middle});
  }
  return result;
}

}  // namespace orbifit
