#include "evidence/coloured_group.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Eigenvalues>

#include "base/random.h"
#include "evidence/policy.h"
#include "group/subgroups_within.h"
#include "group/verification.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

std::vector<char> mask_of(Eigen::Index faces, const std::vector<int>& chosen) {
  std::vector<char> mask(static_cast<std::size_t>(faces), 0);
  for (const int f : chosen) mask[static_cast<std::size_t>(f)] = 1;
  return mask;
}

Region with_group(const Region& region, const PointGroup& group, const GroupFrame& frame) {
  Region result = make_region(group, region.centre, frame, region.faces, region.name);
  result.id = region.id;
  result.residual = region.residual;
  return result;
}

// Whether the marked elements are a group.
bool is_subgroup(const std::vector<Motion>& elements, const std::vector<char>& mask) {
  std::vector<Motion> marked;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (mask[e] != 0) marked.push_back({elements[e].linear, Vector3d::Zero()});
  }
  return closed(marked, 1, kColourPolicy.same_motion);
}

ColouredGroup of_finite(const Region& region, const std::vector<Motion>& elements, const ColourJudge& judge) {
  ColouredGroup result;
  std::vector<char> mask{1};
  std::vector<Matrix3d> linear{elements.front().linear};
  for (std::size_t e = 1; e < elements.size(); ++e) {
    const double differing = judge.differing(elements[e]);
    result.differing = std::max(result.differing, differing);
    mask.push_back(differing <= kColourPolicy.share ? 1 : 0);
    linear.push_back(elements[e].linear);
  }
  result.whole = std::ranges::count(mask, 0) == 0;
  if (result.whole) {
    result.region = region;
    return result;
  }
  if (!is_subgroup(elements, mask)) {
    const std::vector<std::vector<char>> within = subgroups_within(linear, {mask});
    if (within.empty()) return result;
    mask = within.front();
  }
  std::vector<Matrix3d> kept;
  for (std::size_t e = 0; e < linear.size(); ++e) {
    if (mask[e] != 0) kept.push_back(linear[e]);
  }
  const std::optional<ClassifiedGroup> group = kept.size() > 1 ? classify(kept) : std::nullopt;
  if (group) result.region = with_group(region, group->group, group->frame);
  return result;
}

// What of an axial group the colours keep, found by its rotations first, then by its mirrors and half-turns.
class AxialColours {
 public:
  AxialColours(const Region& region, const PointGroup& group, const Vector3d& axis, const ColourJudge& judge,
               double reach)
      : region_(region), group_(group), frame_(frame_about(axis)), judge_(judge) {
    double radius = 0;
    for (const int sample : judge.chosen()) {
      radius = std::max(radius, axis.cross(judge.samples().point(sample) - region.centre).norm());
    }
    // Steps that move nothing by more than the reach.
    steps_ = static_cast<int>(
        std::clamp(2 * std::numbers::pi * radius / reach, kColourPolicy.least_steps, kColourPolicy.most_steps));
  }

  ColouredGroup run() {
    ColouredGroup result;
    const std::vector<Motion> judged = judged_motions(group_, frame_, region_.centre);
    for (const Motion& motion : judged) result.differing = std::max(result.differing, judge_.differing(motion));
    result.whole = result.differing <= kColourPolicy.share;
    if (result.whole) {
      result.region = with_group(region_, group_, frame_);
      return result;
    }
    if (const auto round = continuous_subgroup()) {
      result.region = with_group(region_, *round, frame_);
      return result;
    }
    // Every subgroup that has these rotations lies in the group of twice as many about the right frame.
    const int order = 2 * rotations();
    if (flips_or_mirrors()) align();
    const Region candidate = with_group(region_, finite_counterpart(group_, order), frame_);
    const ColouredGroup kept = of_finite(candidate, candidate.elements, judge_);
    result.region = kept.region;
    return result;
  }

 private:
  Motion about(const Matrix3d& local) const {
    return Motion::about(frame_ * local * frame_.transpose(), region_.centre);
  }
  Motion turn(double angle) const { return about(axis_rotation(Vector3d::UnitZ(), angle)); }
  Motion mirror(double angle) const {
    const Vector3d normal(std::cos(angle), std::sin(angle), 0);
    return about(Matrix3d::Identity() - 2 * normal * normal.transpose());
  }
  Motion flip(double angle) const {
    return about(axis_rotation(Vector3d(std::cos(angle), std::sin(angle), 0), std::numbers::pi));
  }

  // The rotations alone, or with a mirror or half-turn that any rotation brings to any other.
  std::optional<PointGroup> continuous_subgroup() const {
    const PointGroup spin{Family::Cinf, 1};
    for (const Motion& motion : judged_motions(spin, frame_, region_.centre)) {
      if (!judge_.keeps(motion)) return std::nullopt;
    }
    const Family family = group_.family;
    const bool all = family == Family::Dinfh;
    if ((all || family == Family::Cinfv) && judge_.keeps(mirror(0))) return PointGroup{Family::Cinfv, 1};
    if ((all || family == Family::Dinf) && judge_.keeps(flip(0))) return PointGroup{Family::Dinf, 1};
    if ((all || family == Family::Cinfh) && judge_.keeps(about(Vector3d(1, 1, -1).asDiagonal()))) {
      return PointGroup{Family::Cinfh, 1};
    }
    return spin;
  }

  // The largest order of a rotation that is kept; 1 for none.
  int rotations() const {
    for (int n = kColourPolicy.largest_order; n > 1; --n) {
      if (judge_.keeps(turn(2 * std::numbers::pi / n))) return n;
    }
    return 1;
  }

  bool flips_or_mirrors() const { return group_.family != Family::Cinf && group_.family != Family::Cinfh; }

  // Turns the frame so that its first direction is the normal of a mirror, or the axis of a half-turn, that is kept.
  void align() {
    if (group_.family != Family::Dinf && turn_to([&](double angle) { return mirror(angle); })) return;
    if (group_.family != Family::Cinfv) turn_to([&](double angle) { return flip(angle); });
  }

  template <class Element>
  bool turn_to(const Element& element) {
    double best = kColourPolicy.share;
    std::vector<double> angles;  // of those that keep most
    for (int i = 0; i < steps_; ++i) {
      const double angle = std::numbers::pi * i / steps_;
      const double differing = judge_.differing(element(angle), best);
      if (differing > best) continue;
      if (differing < best) angles.clear();
      best = differing;
      angles.push_back(angle);
    }
    if (angles.empty()) return false;
    // The middle of the first run of neighbours.
    std::size_t last = 0;
    while (last + 1 < angles.size() && angles[last + 1] - angles[last] < 1.5 * std::numbers::pi / steps_) ++last;
    const double angle = (angles.front() + angles[last]) / 2;
    frame_ = frame_ * axis_rotation(Vector3d::UnitZ(), angle);
    return true;
  }

  const Region& region_;
  PointGroup group_;
  GroupFrame frame_;
  const ColourJudge& judge_;
  int steps_;
};

// Axes about which a sphere's colours may be symmetric: of their mean direction and of their second moment.
std::vector<Vector3d> axes_of_colours(const Region& region, const ColourJudge& judge) {
  Vector3d mean_colour = Vector3d::Zero();
  for (const int sample : judge.chosen()) mean_colour += judge.samples().colour(sample);
  mean_colour /= std::max<double>(1, static_cast<double>(judge.chosen().size()));
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const int sample : judge.chosen()) {
    const Vector3d direction = (judge.samples().point(sample) - region.centre).normalized();
    const double contrast = (judge.samples().colour(sample) - mean_colour).norm();
    first += contrast * direction;
    second += contrast * direction * direction.transpose();
  }
  std::vector<Vector3d> axes;
  if (first.norm() > 0) axes.push_back(first.normalized());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(second);
  for (int k = 0; k < 3; ++k) axes.emplace_back(solver.eigenvectors().col(k));
  return axes;
}

ColouredGroup of_sphere(const Region& region, const ColourJudge& judge, double reach) {
  ColouredGroup result;
  for (const Motion& motion : judged_motions(region.group, GroupFrame::Identity(), region.centre)) {
    result.differing = std::max(result.differing, judge.differing(motion));
  }
  result.whole = result.differing <= kColourPolicy.share;
  if (result.whole) {
    result.region = region;
    return result;
  }
  const PointGroup group{region.group.family == Family::Kh ? Family::Dinfh : Family::Dinf, 1};
  const auto size = [](const Region& each) { return each.group.continuous() ? 1000 : each.group.order(); };
  for (const Vector3d& axis : axes_of_colours(region, judge)) {
    ColouredGroup about = AxialColours(region, group, axis, judge, reach).run();
    if (about.region && (!result.region || size(*about.region) > size(*result.region))) {
      result.region = std::move(about.region);
    }
  }
  return result;
}

}  // namespace

ColourJudge::ColourJudge(const ColourSamples& samples, Eigen::Index faces, const std::vector<int>& from,
                         const std::vector<int>& to)
    : samples_(samples), to_(mask_of(faces, to)), chosen_(samples.chosen(mask_of(faces, from), kColourPolicy.samples)) {
  Random random(1, "colour judge");
  for (std::size_t i = chosen_.size(); i > 1; --i) std::swap(chosen_[i - 1], chosen_[random.below(i)]);
}

double ColourJudge::differing(const Motion& motion, double enough) const {
  const double all = static_cast<double>(chosen_.size());
  int known = 0;
  int other = 0;
  for (const int sample : chosen_) {
    const std::optional<double> difference = samples_.difference(sample, motion, to_);
    if (!difference) continue;
    ++known;
    other += *difference > kColourPolicy.difference ? 1 : 0;
    if (other > enough * all) return other / static_cast<double>(known);
  }
  return known == 0 ? 0 : static_cast<double>(other) / known;
}

bool ColourJudge::keeps(const Motion& motion) const {
  return differing(motion, kColourPolicy.share) <= kColourPolicy.share;
}

ColouredGroup coloured_group(const Region& region, const ColourJudge& judge, double reach) {
  if (!region.group.continuous()) return of_finite(region, region.elements, judge);
  if (!region.group.has_axis()) return of_sphere(region, judge, reach);
  return AxialColours(region, region.group, region.axis, judge, reach).run();
}

}  // namespace orbifit
