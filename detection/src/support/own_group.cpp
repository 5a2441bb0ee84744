#include "support/own_group.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "group/axis_orders.h"
#include "support/region_growth.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kGroupSamples = 96;
constexpr std::size_t kMaxRotations = 40;  // axes: I has 31; beyond, the patch is nearly a ball
constexpr int kMaxFailures = 40;           // to fit a rotation: so many look right on nearly a ball only
constexpr double kClassifyTolerance = 0.02;
constexpr double kNegligible = 0.02;  // tolerances: residuals below are none

Matrix3d mirror(const Vector3d& normal) {
  return Matrix3d::Identity() - 2 * normal * normal.transpose();
}

// For comparing groups by size: continuous ones exceed all finite ones.
int size_of(const PointGroup& group) {
  constexpr int kContinuous = 100000;
  if (!group.continuous()) return group.order();
  if (group.family == Family::Kh) return kContinuous + 2;
  return group.family == Family::Dinfh ? kContinuous + 1 : kContinuous;
}

bool same_line(const Vector3d& a, const Vector3d& b) {
  return a.cross(b).norm() < kSameDirection;
}

double largest_residual(const SurfacePatch& patch, const GroupPlacement& placement, const RunContext& context) {
  constexpr std::size_t kQueries = 4000;
  return measure_residual(patch, judged_motions(placement.group, placement.frame, placement.centre), context, kQueries)
      .rms;
}

// How far facets of a surface turned about the axis lie inside it, at most, rms over the patch: the sagitta
// R (1 - cos(phi / 2)) of the longest chord of each face, at the distance R, across the angle phi, in the direction of
// the face's normal: chords of an end's plane lie in the surface.
double sagitta(const SurfacePatch& patch, const GroupPlacement& placement) {
  const PreparedMesh& prepared = *patch.prepared;
  const bool round = !placement.group.has_axis();
  double square = 0;
  double area = 0;
  for (const int face : patch.faces) {
    std::array<Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const int vertex = prepared.mesh.faces(face, static_cast<Eigen::Index>(k));
      corners[k] = prepared.mesh.vertices.row(vertex).transpose() - placement.centre;
      const Vector3d axis = placement.frame.col(2);
      if (!round) corners[k] -= axis.dot(corners[k]) * axis;
    }
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d& a = corners[k];
      const Vector3d& b = corners[(k + 1) % 3];
      const double product = a.norm() * b.norm();
      if (product <= 0) continue;
      const double cosine = std::clamp(a.dot(b) / product, -1.0, 1.0);
      most = std::max(most, std::max(a.norm(), b.norm()) * (1 - std::sqrt(0.5 * (1 + cosine))));
    }
    const double along = round ? 0 : placement.frame.col(2).dot(prepared.normals.row(face));
    square += prepared.areas[face] * most * most * std::max(0.0, 1 - along * along);
    area += prepared.areas[face];
  }
  return std::sqrt(square / std::max(area, 1e-300));
}

/// The search for one patch: directions found so far, and the best group.
class GroupSearch {
 public:
  /// \param thorough every attempt on all samples \param finite no continuous groups
  GroupSearch(const SurfacePatch& patch, const RunContext& context, bool thorough, bool finite)
      : patch_(patch), context_(context), thorough_(thorough), finite_(finite), centre_(patch.moments.centroid) {}

  std::optional<OwnGroup> run(const DirectionSet* screen, const GroupHints& hints) {
    const CandidateDirections candidates = find_candidates(patch_, screen, context_);
    if (!try_sphere(candidates)) {
      collect(candidates, hints);
      for (std::size_t a = 0; a < axes_.size(); ++a) {
        if (continuous() || rotations_.size() >= kMaxRotations || failures_ >= kMaxFailures) break;
        find_rotations(axes_[a], look_about(a));
      }
      if (!continuous()) {
        try_polyhedral();
        std::ranges::stable_sort(rotations_, std::greater<>(), &Rotation::order);
        for (const Rotation& rotation : rotations_) try_axial(rotation);
        if (!best_) try_simple();
      }
    }
    if (!best_) return best_;
    if (polish()) return continuous() ? no_treads(screen, hints) : best_;
    if (thorough_) return std::nullopt;
    // The quick look was deceived: every attempt again, on all samples.
    return GroupSearch(patch_, context_, true, finite_).run(screen, hints);
  }

 private:
  struct Rotation {
    Vector3d axis;
    int order;
  };

  // What turns by any angle to the tolerance may have a tread that turns exactly by some, but for noise. Facets are no
  // treads, nor is what noise makes.
  std::optional<OwnGroup> no_treads(const DirectionSet* screen, const GroupHints& hints) {
    constexpr double kFacets = 1.5;
    constexpr double kStrict = 0.3;
    const double any = largest_residual(patch_, best_->placement, context_);
    const double noise = patch_.prepared->noise;
    if (any < std::max(kFacets * sagitta(patch_, best_->placement), noise) + kNegligible * patch_.tolerance)
      return best_;
    SurfacePatch strict = patch_;
    const double share = std::min(1.0, std::max(kStrict * any, noise) / patch_.tolerance);
    strict.tolerance *= share;
    strict.relative_tolerance *= share;
    const std::optional<OwnGroup> some = GroupSearch(strict, context_, thorough_, true).run(screen, hints);
    return some && far_less(largest_residual(patch_, some->placement, context_), any) ? some : best_;
  }

  // Whether one group's residual is far below another's, but for what is left of noise that was taken out.
  bool far_less(double residual, double other) const {
    constexpr double kFarLess = 0.1;
    const double noise = patch_.prepared->noise;
    return other > noise && residual < kFarLess * other + kLeftOfNoise * noise;
  }

  bool continuous() const { return best_ && best_->placement.group.continuous(); }

  bool screen_passes(const Matrix3d& linear) const {
    return kept_share(patch_, Motion::about(linear, centre_), kScreenSlack * patch_.tolerance, kGroupSamples,
                      kScreenShare) >= kScreenShare;
  }

  GroupPlacement coarse(const PointGroup& group, const Vector3d& axis) const {
    RefinementOptions options;
    options.samples = 120;
    options.iterations = 5;
    options.first_width = 12;
    options.last_width = 3;
    return refine(patch_, {group, frame_about(axis), centre_}, context_, options);
  }

  GroupPlacement fitted(const PointGroup& group, const GroupFrame& frame) const {
    RefinementOptions options;
    options.samples = 250;
    options.first_width = 6;
    return refine(patch_, {group, frame, centre_}, context_, options);
  }

  static void add_line(std::vector<Vector3d>& lines, const Vector3d& line) {
    const Vector3d unit = line.normalized();
    if (std::ranges::none_of(lines, [&](const Vector3d& known) { return same_line(known, unit); })) {
      lines.push_back(unit);
    }
  }

  void collect(const CandidateDirections& candidates, const GroupHints& hints) {
    std::vector<Vector3d> normals = candidates.principal;
    normals.insert(normals.end(), hints.axes.begin(), hints.axes.end());
    const std::vector<Vector3d> axes = normals;
    normals.insert(normals.end(), candidates.mirrors.begin(), candidates.mirrors.end());
    for (const Vector3d& normal : normals) {
      const Vector3d better = coarse({Family::Cs, 1}, normal).frame.col(2);
      if (screen_passes(mirror(better))) {
        add_line(mirrors_, better);
      } else if (screen_passes(mirror(normal))) {
        add_line(mirrors_, normal);
      }
    }
    for (const Vector3d& normal : candidates.corner_mirrors) {
      if (screen_passes(mirror(normal))) add_line(mirrors_, normal);
    }
    for (const Vector3d& axis : axes) add_line(axes_, axis);
    for (std::size_t i = 0; i < mirrors_.size() && i < 8; ++i) {
      for (std::size_t j = i + 1; j < mirrors_.size() && j < 8; ++j) {
        const Vector3d line = mirrors_[i].cross(mirrors_[j]);
        if (line.norm() > 0.05) add_line(axes_, line);
      }
    }
    for (const Vector3d& axis : candidates.corner_axes) {
      for (const int order : {2, 3, 5}) {
        if (screen_passes(axis_rotation(axis, 2 * std::numbers::pi / order))) add_line(axes_, axis);
      }
    }
    for (const auto& [list, order] : {std::pair{&candidates.twofold, 2}, std::pair{&candidates.threefold, 3}}) {
      for (const Vector3d& axis : *list) {
        const Vector3d better = coarse({Family::Cn, order}, axis).frame.col(2);
        if (screen_passes(axis_rotation(better, 2 * std::numbers::pi / order))) add_line(axes_, better);
      }
    }
  }

  double tolerance_of(const PointGroup& group) const {
    return group.continuous() ? continuous_tolerance(patch_) : patch_.tolerance;
  }

  // Verifies on fewer samples the larger the group; the winner is verified on all of them in the end. How large a blot
  // is, of which few samples see two or three, all decide.
  bool check(const GroupPlacement& placement) const {
    if ((placement.centre - centre_).norm() > 0.1 * patch_.moments.radius) return false;
    const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
    const VerificationLimits limits = limits_of(patch_);
    const auto verified = [&](int samples) {
      return verify(patch_, motions, tolerance_of(placement.group), samples, limits.joint, context_);
    };
    const int samples = std::max(250, 12000 / static_cast<int>(motions.size()));
    if (thorough_ || static_cast<std::size_t>(samples) >= patch_.at_crease.size()) return passes(verified(0), limits);
    const Verification few = verified(samples);
    return passes(few, limits) || (only_a_blot_fails(few, limits) && passes(verified(0), limits));
  }

  // Refines and verifies a template; keeps it if it is larger than the best.
  bool attempt(const PointGroup& group, const GroupFrame& frame) {
    context_.check();
    if (best_ && size_of(best_->placement.group) >= size_of(group)) return false;
    const GroupPlacement placement = fitted(group, frame);
    if (!check(placement)) {
      ++failures_;
      return false;
    }
    best_ = OwnGroup{placement, {}};
    return true;
  }

  // About an axis about which the patch seems to turn by any angle. Seldom does it: a second look, once the axis is
  // roughly refined, spares two fits.
  void attempt_continuous(const Vector3d& axis) {
    const GroupPlacement better = coarse({Family::Cinfv, 1}, axis);
    if (!continuous_about(patch_, better.frame.col(2), better.centre)) return;
    const GroupFrame frame = frame_about(axis);
    if (!attempt({Family::Dinfh, 1}, frame)) attempt({Family::Cinfv, 1}, frame);
  }

  bool try_sphere(const CandidateDirections& candidates) {
    const auto [low, high] = std::ranges::minmax(candidates.variances);
    if (finite_ || high <= 0 || std::sqrt(high) - std::sqrt(std::max(low, 0.0)) > patch_.tolerance) return false;
    return attempt({Family::Kh, 1}, GroupFrame::Identity());
  }

  // Angles phi in [0, period) about the axis for which `element(direction)` keeps the patch, direction turning with
  // phi.
  template <typename Element>
  std::vector<Vector3d> phases(const Vector3d& axis, double period, const Element& element) const {
    constexpr double kPhaseShare = 0.7;
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
        shares[k] = kept_share(patch_, motion, kScreenSlack * patch_.tolerance, kGroupSamples, kPhaseShare);
      }
    });
    std::vector<std::pair<double, int>> peaks;
    for (int k = 0; k < steps; ++k) {
      const double here = shares[static_cast<std::size_t>(k)];
      const double before = shares[static_cast<std::size_t>((k + steps - 1) % steps)];
      const double after = shares[static_cast<std::size_t>((k + 1) % steps)];
      if (here >= kPhaseShare && here >= before && here >= after) peaks.emplace_back(-here, k);
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

  // What a first look about an axis tells.
  struct AxisLook {
    bool continuous = false;
    std::vector<int> orders;  // where it is not
  };

  std::vector<int> orders_about(const Vector3d& axis) const {
    return rotation_orders(patch_, axis, centre_, kScreenSlack);
  }

  // Of axis number a. Several threads look about those after it as well.
  const AxisLook& look_about(std::size_t a) {
    const std::size_t ahead = context_.threads > 1 ? 2 * static_cast<std::size_t>(context_.threads) : 1;
    const std::size_t first = looks_.size();
    if (a < first) return looks_[a];
    looks_.resize(std::min(axes_.size(), a + ahead));
    parallel_for(context_, looks_.size() - first, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = first + begin; i < first + end; ++i) {
        looks_[i].continuous = !finite_ && continuous_about(patch_, axes_[i], centre_);
        if (!looks_[i].continuous) looks_[i].orders = orders_about(axes_[i]);
      }
    });
    return looks_[a];
  }

  void find_rotations(const Vector3d& axis, const AxisLook& look) {
    context_.check();
    if (look.continuous) {
      attempt_continuous(axis);
      if (continuous()) return;
    }
    const std::vector<int> orders = look.continuous ? orders_about(axis) : look.orders;
    if (orders.empty()) return;
    // The axis is better known once the rotations that fit best have been fitted; the orders are then ranked.
    const std::vector<RankedOrder> first = rank_orders(patch_, orders, axis, centre_);
    const Vector3d better =
        coarse({Family::Cn, first.empty() ? orders.back() : first.front().order}, axis).frame.col(2);
    std::vector<RankedOrder> ranking = rank_orders(patch_, orders, better, centre_);
    Vector3d chosen = better;
    if (ranking.empty() || (!first.empty() && first.front().share > ranking.front().share + 0.02)) {
      ranking = first;
      chosen = axis;
    }
    constexpr std::size_t kMaxTries = 6;
    if (ranking.size() > kMaxTries) ranking.resize(kMaxTries);
    for (const RankedOrder& order : ranking) {
      if (add_rotation(chosen, order.order, ranking)) return;
    }
  }

  // \param others  orders that may hold as well
  bool add_rotation(const Vector3d& axis, int n, const std::vector<RankedOrder>& others) {
    GroupPlacement placement = fitted({Family::Cn, n}, frame_about(axis));
    const bool known = std::ranges::any_of(
        rotations_, [&](const Rotation& r) { return r.order >= n && same_line(r.axis, placement.frame.col(2)); });
    if (known) return true;
    if (!check(placement)) {
      ++failures_;
      return false;
    }
    placement = far_more_exact(placement, others);
    const int order = placement.group.order();
    rotations_.push_back({placement.frame.col(2), order});
    if (!best_ || size_of(best_->placement.group) < order) best_ = OwnGroup{placement, {}};
    return true;
  }

  // Of what is so small that a hexagon turns by ninths to the tolerance, the order that it has.
  GroupPlacement far_more_exact(const GroupPlacement& placement, const std::vector<RankedOrder>& others) const {
    const int n = placement.group.order();
    const auto may_be = [&](int order) { return order < n && n % order != 0; };
    if (std::ranges::none_of(others, may_be, &RankedOrder::order)) return placement;
    const double off = largest_residual(patch_, placement, context_);
    if (off < kNegligible * patch_.tolerance) return placement;
    for (const RankedOrder& other : others) {
      if (!may_be(other.order)) continue;
      GroupPlacement lower = fitted({Family::Cn, other.order}, frame_about(placement.frame.col(2)));
      if (far_less(largest_residual(patch_, lower, context_), off) && check(lower)) return lower;
    }
    return placement;
  }

  void try_axial(const Rotation& rotation) {
    const int n = rotation.order;
    const Vector3d axis = rotation.axis;
    if (best_ && size_of(best_->placement.group) >= 4 * n) return;
    const bool horizontal = screen_passes(mirror(axis));
    const bool roto = screen_passes(axis_rotation(axis, std::numbers::pi / n) * mirror(axis));
    const double period = std::numbers::pi / n;
    const std::vector<Vector3d> verticals = phases(axis, period, mirror);
    const std::vector<Vector3d> halves = phases(axis, period, [](const Vector3d& d) -> Matrix3d { return -mirror(d); });
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
    std::vector<GroupPlacement> failed;  // many pairs say the same
    const auto attempt_once = [&](Family family, const GroupFrame& frame) {
      constexpr int kTries = 3;  // from other pairs the fit begins elsewhere
      const GroupPlacement placement{{family, 1}, frame, Vector3d::Zero()};
      const auto same = [&](const GroupPlacement& other) {
        return other.group.family == family && contains_group(other, placement, Vector3d::Zero(), 1, kSameDirection);
      };
      if (std::ranges::count_if(failed, same) >= kTries) return;
      if (!attempt(placement.group, frame)) failed.push_back(placement);
    };
    for (std::size_t i = 0; i < rotations_.size(); ++i) {
      for (std::size_t j = i + 1; j < rotations_.size(); ++j) {
        const Rotation& a = rotations_[i];
        const Rotation& b = rotations_[j];
        if (std::max(a.order, b.order) < 3 || std::max(a.order, b.order) > 5) continue;
        if (same_line(a.axis, b.axis)) continue;
        const std::optional<ClassifiedGroup> known = classify(generate(a, b), kClassifyTolerance);
        if (!known) continue;
        const Family family = known->group.family;
        if (family == Family::I) {
          attempt_once(Family::Ih, known->frame);
          attempt_once(Family::I, known->frame);
        }
        if (family != Family::T && family != Family::O) continue;
        for (const Family larger : {Family::Oh, Family::O, Family::Td, Family::Th, Family::T}) {
          attempt_once(larger, known->frame);
        }
        if (family != Family::T) continue;
        // T sits in I in two ways.
        GroupFrame turned = known->frame;
        turned.col(0) = known->frame.col(1);
        turned.col(1) = -known->frame.col(0);
        for (const GroupFrame& each : {known->frame, turned}) {
          if (!screen_passes(generators({Family::I, 1}, each)[2])) continue;
          attempt_once(Family::Ih, each);
          attempt_once(Family::I, each);
        }
      }
    }
  }

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

  // Last refinement, and the verification that counts: on all samples. Whether the group stands.
  bool polish() {
    const GroupPlacement before = best_->placement;
    RefinementOptions options;
    options.samples = std::clamp(static_cast<int>(patch_.at_crease.size() * 2 / 5), 300, 1500);
    options.iterations = 12;
    options.first_width = 1.5;
    options.last_width = 1;
    for (const GroupPlacement& placement :
         {refine_on_vertices(patch_, refine(patch_, before, context_, options)), before}) {
      Verification verification = verify(patch_, judged_motions(placement.group, placement.frame, placement.centre),
                                         tolerance_of(placement.group), 0, 0, context_);
      if (!passes(verification, limits_of(patch_))) continue;
      best_ = OwnGroup{placement, std::move(verification)};
      return true;
    }
    return false;
  }

  const SurfacePatch& patch_;
  const RunContext& context_;
  bool thorough_;
  bool finite_;
  Vector3d centre_;
  int failures_ = 0;  // fits of rotations that did not hold
  std::vector<Vector3d> mirrors_;
  std::vector<Vector3d> axes_;
  std::vector<AxisLook> looks_;  // about the first of them
  std::vector<Rotation> rotations_;
  std::optional<OwnGroup> best_;
};

}  // namespace

Verification verify_group(const SurfacePatch& patch, const GroupPlacement& placement, const RunContext& context,
                          int samples) {
  constexpr double kHopeless = 0.75;
  const double tolerance = placement.group.continuous() ? continuous_tolerance(patch) : patch.tolerance;
  return verify(patch, judged_motions(placement.group, placement.frame, placement.centre), tolerance, samples,
                kHopeless, context);
}

bool verified(const SurfacePatch& patch, const GroupPlacement& placement, const RunContext& context, int samples) {
  return passes(verify_group(patch, placement, context, samples), limits_of(patch));
}

std::optional<OwnGroup> find_own_group(const SurfacePatch& patch, const DirectionSet* screen, const GroupHints& hints,
                                       const RunContext& context) {
  return GroupSearch(patch, context, false, false).run(screen, hints);
}

}  // namespace orbifit
