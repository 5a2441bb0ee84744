#include "orbifit/detection/own_group.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kSlack = 2.5;         // tolerances, while directions are not refined yet
constexpr double kScreenShare = 0.80;  // of the samples, likewise
constexpr int kScreenSamples = 96;
constexpr double kSameDirection = 0.03;  // radians
constexpr double kPerpendicular = 0.06;
constexpr int kHighestOrder = 180;
// A rotation that moves no point by more than this many tolerances cannot be told from none.
constexpr double kLeastMove = 6;

bool same_line(const Vector3d& a, const Vector3d& b) {
  return a.cross(b).norm() < kSameDirection;
}

double radius_about(const SurfacePatch& patch, const Vector3d& axis, const Vector3d& centre) {
  double largest = 0;
  for (Eigen::Index i = 0; i < patch.samples.points.rows(); ++i) {
    const Vector3d from = patch.samples.points.row(i).transpose() - centre;
    largest = std::max(largest, (from - axis * axis.dot(from)).norm());
  }
  return largest;
}

/// The search for one patch: directions found so far, and the best group.
class Search {
 public:
  Search(const SurfacePatch& patch, const RunContext& context)
      : patch_(patch), context_(context), centre_(patch.moments.centroid) {}

  std::optional<OwnGroup> run(const DirectionSet* screen, const GroupHints& hints) {
    const CandidateDirections candidates = find_candidates(patch_, screen, context_);
    if (try_sphere(candidates)) return best_;
    collect(candidates, hints);
    for (const Vector3d& axis : axes_) try_axis(axis);
    try_polyhedral();
    if (!best_) try_simple();
    if (best_) polish();
    return best_;
  }

 private:
  bool screen_passes(const Matrix3d& linear, double slack = kSlack) const {
    return kept_share(patch_, Motion::about(linear, centre_), slack * patch_.tolerance, kScreenSamples, kScreenShare) >=
           kScreenShare;
  }

  GroupPlacement coarse(const PointGroup& group, const Vector3d& axis) const {
    RefinementOptions options;
    options.samples = 120;
    options.iterations = 5;
    options.first_width = 12;
    options.last_width = 3;
    return refine(patch_, {group, frame_about(axis), centre_}, options);
  }

  static void add_line(std::vector<Vector3d>& lines, const Vector3d& line) {
    const Vector3d unit = line.normalized();
    if (std::ranges::none_of(lines, [&](const Vector3d& known) { return same_line(known, unit); }))
      lines.push_back(unit);
  }

  void collect(const CandidateDirections& candidates, const GroupHints& hints) {
    const auto refined = [&](const PointGroup& group, const Vector3d& direction) -> Vector3d {
      return coarse(group, direction).frame.col(2);
    };
    std::vector<Vector3d> normals = candidates.principal;
    normals.insert(normals.end(), hints.axes.begin(), hints.axes.end());
    std::vector<Vector3d> axes = normals;
    normals.insert(normals.end(), candidates.mirrors.begin(), candidates.mirrors.end());
    const PointGroup mirror{Family::Cs, 1};
    for (const Vector3d& normal : normals) {
      Vector3d better = refined(mirror, normal);
      if (screen_passes(Matrix3d::Identity() - 2 * better * better.transpose())) {
        add_line(mirrors_, better);
      } else if (screen_passes(Matrix3d::Identity() - 2 * normal * normal.transpose())) {
        add_line(mirrors_, normal);
      }
    }
    for (const Vector3d& axis : axes) add_line(axes_, axis);
    for (std::size_t i = 0; i < mirrors_.size() && i < 8; ++i) {
      for (std::size_t j = i + 1; j < mirrors_.size() && j < 8; ++j) {
        const Vector3d line = mirrors_[i].cross(mirrors_[j]);
        if (line.norm() > 0.05) add_line(axes_, line);
      }
    }
    for (const auto& [list, order] : {std::pair{&candidates.twofold, 2}, std::pair{&candidates.threefold, 3}}) {
      for (const Vector3d& axis : *list) {
        const Vector3d better = refined({Family::Cn, order}, axis);
        if (screen_passes(axis_rotation(better, 2 * std::numbers::pi / order))) add_line(axes_, better);
      }
    }
  }

  // Refines and verifies a template; keeps it if it is larger than the best.
  bool attempt(const PointGroup& group, const GroupFrame& frame) {
    context_.check();
    const auto order = [](const PointGroup& g) {
      return g.continuous() ? 100000 + (g.family == Family::Dinfh ? 1 : 0) : g.order();
    };
    if (best_ && order(best_->placement.group) >= order(group)) return false;
    RefinementOptions options;
    options.samples = 250;
    options.first_width = 6;
    const GroupPlacement placement = refine(patch_, {group, frame, centre_}, options);
    if ((placement.centre - centre_).norm() > 0.1 * patch_.moments.radius) return false;
    const VerificationLimits limits;
    const double tolerance =
        group.continuous() ? continuous_tolerance(patch_, placement.frame.col(2), placement.centre) : patch_.tolerance;
    Verification verification =
        verify(patch_, judged_motions(group, placement.frame, placement.centre), tolerance, 0, limits.joint, context_);
    if (!passes(verification, limits)) return false;
    best_ = OwnGroup{placement, std::move(verification)};
    return true;
  }

  bool try_sphere(const CandidateDirections& candidates) {
    const auto [low, high] = std::ranges::minmax(candidates.variances);
    if (high <= 0 || std::sqrt(high) - std::sqrt(std::max(low, 0.0)) > patch_.tolerance) return false;
    return attempt({Family::Kh, 1}, GroupFrame::Identity());
  }

  // Angles phi in [0, period) about the axis for which `element(direction)` keeps the patch, direction turning with
  // phi.
  template <typename Element>
  std::vector<Vector3d> phases(const Vector3d& axis, double period, const Element& element) const {
    const GroupFrame frame = frame_about(axis);
    const double radius = std::max(radius_about(patch_, axis, centre_), 1e-9);
    const int steps = std::clamp(static_cast<int>(std::ceil(period * radius / (1.5 * patch_.tolerance))), 4, 400);
    std::vector<double> shares(static_cast<std::size_t>(steps));
    const auto direction = [&](int k) -> Vector3d {
      const double phi = period * k / steps;
      return std::cos(phi) * frame.col(0) + std::sin(phi) * frame.col(1);
    };
    parallel_for(context_, shares.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Motion motion = Motion::about(element(direction(static_cast<int>(k))), centre_);
        shares[k] = kept_share(patch_, motion, kSlack * patch_.tolerance, kScreenSamples, 0.7);
      }
    });
    std::vector<std::pair<double, int>> peaks;
    for (int k = 0; k < steps; ++k) {
      const double here = shares[static_cast<std::size_t>(k)];
      const double before = shares[static_cast<std::size_t>((k + steps - 1) % steps)];
      const double after = shares[static_cast<std::size_t>((k + 1) % steps)];
      if (here >= 0.7 && here >= before && here >= after) peaks.emplace_back(-here, k);
    }
    std::ranges::sort(peaks);
    std::vector<Vector3d> result;
    for (const auto& [share, k] : peaks) {
      const Vector3d d = direction(k);
      const bool apart = std::ranges::none_of(
          result, [&](const Vector3d& known) { return known.cross(d).norm() < 3 * period / steps; });
      if (apart) result.push_back(d);
      if (result.size() == 3) break;
    }
    return result;
  }

  void try_axis(const Vector3d& axis) {
    context_.check();
    if (continuous_about(patch_, axis, centre_, context_)) {
      const GroupFrame frame = frame_about(axis);
      if (attempt({Family::Dinfh, 1}, frame) || attempt({Family::Cinfv, 1}, frame)) return;
    }
    if (best_ && best_->placement.group.continuous()) return;
    std::vector<int> orders = rotation_orders(patch_, axis, centre_, kSlack);
    if (orders.empty()) return;
    // The axis is better known once its rotations have been fitted; the orders are then asked again.
    const Vector3d better = coarse({Family::Cn, orders.back()}, axis).frame.col(2);
    if (better.cross(axis).norm() < 0.15) {
      std::vector<int> again = rotation_orders(patch_, better, centre_, kSlack);
      if (!again.empty() && again.front() >= orders.front()) {
        orders = std::move(again);
        try_orders(better, orders);
        return;
      }
    }
    try_orders(axis, orders);
  }

  void try_orders(const Vector3d& axis, const std::vector<int>& orders) {
    int tried = 0;
    for (const int n : orders) {
      if (best_ && best_->placement.group.order() >= 4 * n) break;
      if (!attempt_cyclic(axis, n)) {
        if (++tried == 6) break;
        continue;
      }
      try_axial(axis, n);
      break;
    }
  }

  // Whether the rotation alone verifies; remembers the axis for the polyhedral groups.
  bool attempt_cyclic(const Vector3d& axis, int n) {
    RefinementOptions options;
    options.samples = 250;
    options.first_width = 6;
    const PointGroup group{Family::Cn, n};
    const GroupPlacement placement = refine(patch_, {group, frame_about(axis), centre_}, options);
    const VerificationLimits limits;
    const Verification verification = verify(patch_, judged_motions(group, placement.frame, placement.centre),
                                             patch_.tolerance, 0, limits.joint, context_);
    if (!passes(verification, limits)) return false;
    rotations_.push_back({placement.frame.col(2), n});
    if (!best_ || best_->placement.group.order() < n) best_ = OwnGroup{placement, verification};
    return true;
  }

  void try_axial(const Vector3d& start, int n) {
    const Vector3d axis =
        rotations_.back().axis.dot(start) < 0 ? Vector3d(-rotations_.back().axis) : rotations_.back().axis;
    const bool horizontal = screen_passes(Matrix3d::Identity() - 2 * axis * axis.transpose());
    const Matrix3d half_step =
        axis_rotation(axis, std::numbers::pi / n) * (Matrix3d::Identity() - 2 * axis * axis.transpose());
    const bool roto = screen_passes(half_step);
    const double period = std::numbers::pi / n;
    const std::vector<Vector3d> verticals = phases(
        axis, period, [](const Vector3d& d) -> Matrix3d { return Matrix3d::Identity() - 2 * d * d.transpose(); });
    const std::vector<Vector3d> halves = phases(
        axis, period, [](const Vector3d& d) -> Matrix3d { return 2 * d * d.transpose() - Matrix3d::Identity(); });
    if (horizontal) {
      for (const Vector3d& d : halves) {
        if (attempt({Family::Dnh, n}, frame_about(axis, d))) return;
      }
      for (const Vector3d& d : verticals) {
        if (attempt({Family::Dnh, n}, frame_about(axis, axis.cross(d)))) return;
      }
    }
    if (roto) {
      for (const Vector3d& d : halves) {
        if (attempt({Family::Dnd, n}, frame_about(axis, d))) return;
      }
    }
    for (const Vector3d& d : halves) {
      if (attempt({Family::Dn, n}, frame_about(axis, d))) break;
    }
    for (const Vector3d& d : verticals) {
      if (attempt({Family::Cnv, n}, frame_about(axis, d))) break;
    }
    if (horizontal) attempt({Family::Cnh, n}, frame_about(axis));
    if (roto) attempt({Family::Sn, 2 * n}, frame_about(axis));
  }

  // Two rotation axes that are neither parallel nor perpendicular generate T, O or I, or nothing finite.
  void try_polyhedral() {
    if (best_ && best_->placement.group.continuous()) return;
    for (std::size_t i = 0; i < rotations_.size(); ++i) {
      for (std::size_t j = i + 1; j < rotations_.size(); ++j) {
        const Rotation& a = rotations_[i];
        const Rotation& b = rotations_[j];
        if (std::max(a.order, b.order) < 3 || std::max(a.order, b.order) > 5) continue;
        if (same_line(a.axis, b.axis)) continue;
        const std::vector<Matrix3d> generated = generate(a, b);
        const std::optional<ClassifiedGroup> known = classify(generated, 0.02);
        if (!known) continue;
        const Family family = known->group.family;
        if (family == Family::I) {
          attempt({Family::Ih, 1}, known->frame);
          attempt({Family::I, 1}, known->frame);
        }
        if (family != Family::T && family != Family::O) continue;
        for (const Family larger : {Family::Oh, Family::O, Family::Td, Family::Th, Family::T}) {
          attempt({larger, 1}, known->frame);
        }
        if (family == Family::T) try_icosahedral(known->frame);
      }
    }
  }

  // T sits in I in two ways.
  void try_icosahedral(const GroupFrame& frame) {
    GroupFrame turned = frame;
    turned.col(0) = frame.col(1);
    turned.col(1) = -frame.col(0);
    for (const GroupFrame& each : {frame, turned}) {
      const Motion fifth = Motion::about(generators({Family::I, 1}, each)[2], centre_);
      if (kept_share(patch_, fifth, kSlack * patch_.tolerance, kScreenSamples) < kScreenShare) continue;
      attempt({Family::Ih, 1}, each);
      attempt({Family::I, 1}, each);
    }
  }

  struct Rotation {
    Vector3d axis;
    int order;
  };

  static std::vector<Matrix3d> generate(const Rotation& a, const Rotation& b) {
    const std::array<Matrix3d, 2> seeds{axis_rotation(a.axis, 2 * std::numbers::pi / a.order),
                                        axis_rotation(b.axis, 2 * std::numbers::pi / b.order)};
    std::vector<Matrix3d> result{Matrix3d::Identity()};
    for (std::size_t i = 0; i < result.size() && result.size() <= 60; ++i) {
      for (const Matrix3d& seed : seeds) {
        const Matrix3d product = seed * result[i];
        const bool known = std::ranges::any_of(result, [&](const Matrix3d& m) { return (m - product).norm() < 0.3; });
        if (!known) result.push_back(product);
      }
    }
    return result;
  }

  void try_simple() {
    for (const Vector3d& normal : mirrors_) {
      if (attempt({Family::Cs, 1}, frame_about(normal))) return;
    }
    if (screen_passes(-Matrix3d::Identity())) attempt({Family::Ci, 1}, GroupFrame::Identity());
  }

  void polish() {
    const OwnGroup before = *best_;
    RefinementOptions options;
    options.samples = 1500;
    options.iterations = 20;
    options.first_width = 1.5;
    options.last_width = 1;
    GroupPlacement placement = refine(patch_, before.placement, options);
    placement = refine_on_vertices(patch_, placement);
    const VerificationLimits limits;
    const double tolerance = placement.group.continuous()
                                 ? continuous_tolerance(patch_, placement.frame.col(2), placement.centre)
                                 : patch_.tolerance;
    Verification verification =
        verify(patch_, judged_motions(placement.group, placement.frame, placement.centre), tolerance, 0, 0, context_);
    if (passes(verification, limits)) best_ = OwnGroup{placement, std::move(verification)};
  }

  const SurfacePatch& patch_;
  const RunContext& context_;
  Vector3d centre_;
  std::vector<Vector3d> mirrors_;
  std::vector<Vector3d> axes_;
  std::vector<Rotation> rotations_;
  std::optional<OwnGroup> best_;
};

}  // namespace

std::optional<OwnGroup> find_own_group(const SurfacePatch& patch, const DirectionSet* screen, const GroupHints& hints,
                                       const RunContext& context) {
  return Search(patch, context).run(screen, hints);
}

std::vector<int> rotation_orders(const SurfacePatch& patch, const Vector3d& axis, const Vector3d& centre,
                                 double slack) {
  std::vector<int> result;
  const double radius = radius_about(patch, axis, centre);
  const auto highest =
      static_cast<int>(std::min<double>(kHighestOrder, 2 * std::numbers::pi * radius / (kLeastMove * patch.tolerance)));
  for (int n = highest; n >= 2; --n) {
    const Motion step = Motion::rotation(axis, 2 * std::numbers::pi / n, centre);
    if (kept_share(patch, step, slack * patch.tolerance, kScreenSamples, kScreenShare) < kScreenShare) continue;
    // Half a step must be worse, or the rotation says nothing about this order.
    result.push_back(n);
  }
  return result;
}

double continuous_tolerance(const SurfacePatch& patch, const Vector3d& axis, const Vector3d& centre) {
  return std::min(patch.tolerance, 2 * patch.relative_tolerance * radius_about(patch, axis, centre));
}

bool continuous_about(const SurfacePatch& patch, const Vector3d& axis, const Vector3d& centre,
                      const RunContext& context) {
  (void)context;
  const double tolerance = 1.5 * continuous_tolerance(patch, axis, centre);
  for (const double turns : {0.1180, 0.2918, 0.3820, 0.4721, 0.0557, 0.0213}) {
    const Motion motion = Motion::rotation(axis, 2 * std::numbers::pi * turns, centre);
    if (kept_share(patch, motion, tolerance, 150, 0.9) < 0.9) return false;
  }
  return true;
}

}  // namespace orbifit
