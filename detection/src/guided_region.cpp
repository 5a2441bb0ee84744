#include "orbifit/detection/guided_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "group/axis_orders.h"
#include "group/candidates.h"
#include "group/surroundings.h"
#include "group/verification.h"
#include "support/found_region.h"
#include "support/orbit_region.h"
#include "support/own_group.h"
#include "support/region_growth.h"
#include "surface/surface_patch.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;
using About = RegionHint::About;

bool polyhedral(const PointGroup& group) {
  return !group.has_axis() && group.order() >= 12;
}

// Of a group about an axis what needs no direction across it.
PointGroup rotations_of(const PointGroup& group) {
  if (group.continuous()) return {Family::Cinfv, 1};  // a surface that all rotations keep has these mirrors as well
  return {Family::Cn, group.family == Family::Sn ? group.n / 2 : group.n};
}

// A region grown from a hint, in the normalised mesh's frame.
struct GrownRegion {
  FoundRegion region;
  Verification verification;
  Residual residual;
  bool holds = false;
};

/// Follows one hint.
class Guide {
 public:
  Guide(const PreparedMesh& prepared, const std::shared_ptr<const SurfaceIndex>& whole, const RegionHint& hint,
        const GuidedRegionOptions& options, const RunContext& context)
      : prepared_(prepared), whole_(whole), hint_(hint), options_(options), context_(context) {
    const Similarity& input = prepared.input_of_normalised;
    point_ = (hint.point - input.translation) / input.scale;
    refines_ = hint.refine;
  }

  GrownRegion run() {
    if (hint_.group && polyhedral(*hint_.group)) return finished(solid());
    GroupPlacement placement{start(), frame_about(hint_.direction), point_};
    placement = refined(placement);
    const std::vector<int> faces = faces_;
    const bool found = found_;
    const GroupPlacement larger = hint_.about == About::axis && found ? grown(placement) : placement;
    GrownRegion result = finished(larger);
    if (result.holds || hint_.group || larger.group == placement.group) return result;
    faces_ = faces;
    found_ = found;
    return finished(placement);
  }

 private:
  double tolerance_of(const PointGroup& group, const SurfacePatch& patch) const {
    return group.continuous() ? continuous_tolerance(patch) : patch.tolerance;
  }

  std::vector<Motion> motions(const GroupPlacement& placement) const {
    return judged_motions(placement.group, placement.frame, placement.centre);
  }

  // The group before it is grown.
  PointGroup start() {
    if (hint_.about == About::plane) return {Family::Cs, 1};
    if (hint_.about == About::centre) return hint_.group.value_or(PointGroup{Family::Ci, 1});
    if (hint_.group) return rotations_of(*hint_.group);
    if (hint_.order) {
      return *hint_.order == RegionHint::kContinuous ? PointGroup{Family::Cinfv, 1}
                                                     : PointGroup{Family::Cn, *hint_.order};
    }
    const GroupPlacement any{{Family::Cinfv, 1}, frame_about(hint_.direction), point_};
    const SurfacePatch patch = surroundings(prepared_, whole_, any, hint_.seeds, options_.tolerance, context_);
    if (continuous_about(patch, hint_.direction, point_)) return any.group;
    const std::vector<int> orders = rotation_orders(patch, hint_.direction, point_, kScreenSlack);
    const std::vector<RankedOrder> ranked = rank_orders(patch, orders, hint_.direction, point_);
    if (!ranked.empty()) return {Family::Cn, ranked.front().order};
    return {Family::Cn, orders.empty() ? 2 : orders.front()};
  }

  std::vector<int> region(const GroupPlacement& placement, double tolerance) const {
    return connected_orbit(prepared_, placement, symmetric_faces(prepared_, *whole_, placement, tolerance, context_),
                           hint_.seeds, tolerance, context_);
  }

  SurfacePatch patch_of(const std::vector<int>& faces, int samples) const {
    return make_patch(prepared_, faces, samples, options_.tolerance, context_, "guided");
  }

  // By turns the faces that the group keeps, and the placement that suits them, ever stricter.
  GroupPlacement refined(const GroupPlacement& given) {
    const SurfacePatch around = surroundings(prepared_, whole_, given, hint_.seeds, options_.tolerance, context_);
    GroupPlacement placement = given;
    if (refines_) {
      RefinementOptions options;
      options.samples = 700;
      options.iterations = 20;
      options.first_width = 8;
      placement = refine(around, given, context_, options);
    }
    faces_ = around.faces;
    double tolerance = tolerance_of(placement.group, around);
    for (const double slack : {2.0, 1.0, 1.0}) {
      context_.progress("region", 0);
      if (!refines_ && slack > 1) continue;
      const std::vector<int> faces = region(placement, slack * tolerance);
      found_ = !faces.empty();
      if (!found_) continue;
      const bool same = faces == faces_ && slack == 1;
      faces_ = faces;
      const SurfacePatch patch = patch_of(faces_, 1000);
      tolerance = tolerance_of(placement.group, patch);
      if (same) break;
      if (!refines_) continue;
      RefinementOptions options;
      options.first_width = slack;
      placement = refine(patch, placement, context_, options);
    }
    return placement;
  }

  // From the rotations alone to the group wanted, or to the largest that the region has.
  GroupPlacement grown(const GroupPlacement& core) {
    if (hint_.group && *hint_.group == core.group) return core;
    const SurfacePatch patch = patch_of(faces_, options_.samples);
    if (hint_.group) return refined(placed(*hint_.group, core, patch));
    if (!refines_) return core;
    GroupHints hints;
    hints.axes.push_back(core.frame.col(2));
    const std::optional<OwnGroup> own = find_own_group(patch, nullptr, hints, context_);
    if (!own || own->placement.group == core.group) return core;
    const bool holds =
        contains_group(own->placement, core, patch.moments.centroid, patch.moments.radius, 2 * patch.tolerance);
    if (!holds) return core;
    return refined(own->placement);
  }

  // The group about the core's axis: its centre there and its direction across are looked for.
  GroupPlacement placed(const PointGroup& group, const GroupPlacement& core, const SurfacePatch& patch) const {
    const Vector3d axis = core.frame.col(2);
    const Vector3d along = axis * axis.dot(patch.moments.centroid - core.centre);
    GroupPlacement best{group, core.frame, core.centre};
    double most = -1;
    std::vector<Vector3d> centres{core.centre + along};
    if ((point_ - centres.front()).norm() > patch.tolerance) {
      centres.emplace_back(core.centre + axis * axis.dot(point_ - core.centre));
    }
    for (const Vector3d& centre : centres) {
      for (const GroupFrame& frame : phases(group, core.frame, patch)) {
        const GroupPlacement placement{group, frame, centre};
        double least = 1;
        for (const Matrix3d& linear : generators(group, frame)) {
          least =
              std::min(least, kept_share(patch, Motion::about(linear, centre), kScreenSlack * patch.tolerance, 300));
        }
        if (least <= most) continue;
        most = least;
        best = placement;
      }
    }
    return best;
  }

  // Frames about the axis whose first directions are fine enough to be refined from.
  static std::vector<GroupFrame> phases(const PointGroup& group, const GroupFrame& frame, const SurfacePatch& patch) {
    const bool free = group.continuous() || group.family == Family::Cnh || group.family == Family::Sn;
    if (free) return {frame};
    const Vector3d axis = frame.col(2);
    const double period = std::numbers::pi / group.n;
    const double around = period * radius_about(patch, axis, patch.moments.centroid) / patch.tolerance;
    const int steps = std::clamp(static_cast<int>(std::ceil(around)), 8, 400);
    std::vector<GroupFrame> result;
    for (int k = 0; k < steps; ++k) {
      result.emplace_back(frame_about(axis, Vector3d(axis_rotation(axis, period * k / steps) * frame.col(0))));
    }
    return result;
  }

  // A polyhedral group: that of the seeds' parts, which tells its axes.
  GroupPlacement solid() {
    std::vector<int> faces;
    for (const int seed : hint_.seeds) {
      const int part = prepared_.components.component_of_face[static_cast<std::size_t>(seed)];
      const std::vector<int>& more = prepared_.components.faces[static_cast<std::size_t>(part)];
      faces.insert(faces.end(), more.begin(), more.end());
    }
    std::ranges::sort(faces);
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    faces_ = faces;
    const SurfacePatch patch = patch_of(faces, options_.samples);
    const DirectionSet screen = hemisphere_directions(kScreenDirections);
    const std::optional<OwnGroup> own = find_own_group(patch, &screen, {}, context_);
    GroupPlacement placement{*hint_.group, GroupFrame::Identity(), point_};
    if (own && polyhedral(own->placement.group)) placement.frame = own->placement.frame;
    if (own && refines_) placement.centre = own->placement.centre;
    return refined(placement);
  }

  GrownRegion finished(const GroupPlacement& placement) {
    context_.progress("verification", 0);
    const SurfacePatch patch = patch_of(faces_, options_.samples);
    const double tolerance = tolerance_of(placement.group, patch);
    std::vector<GroupPlacement> tries;
    if (refines_) {
      RefinementOptions options;
      options.samples = 1500;
      options.first_width = 1.5;
      tries.push_back(refine_on_vertices(patch, refine(patch, placement, context_, options)));
    }
    tries.push_back(placement);
    GrownRegion result;
    for (const GroupPlacement& each : tries) {
      Verification verification = verify(patch, motions(each), tolerance, 0, 0, context_);
      const bool better = result.region.faces.empty() || verification.joint > result.verification.joint;
      const bool holds = passes(verification);
      if (!holds && !better) continue;
      result.region = {each, faces_, patch.moments.area, ""};
      result.verification = std::move(verification);
      if (holds) break;
    }
    const bool seeded = std::ranges::any_of(
        hint_.seeds, [&](int seed) { return std::ranges::binary_search(result.region.faces, seed); });
    result.residual = measure_residual(patch, motions(result.region.placement), context_);
    result.holds = seeded && found_ && passes(result.verification);
    return result;
  }

  const PreparedMesh& prepared_;
  const std::shared_ptr<const SurfaceIndex>& whole_;
  const RegionHint& hint_;
  const GuidedRegionOptions& options_;
  const RunContext& context_;
  Vector3d point_;
  bool refines_;
  bool found_ = false;
  std::vector<int> faces_;
};

std::string with_digits(double number, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, number);
  return text.data();
}

std::string percent(double fraction) {
  return with_digits(100 * fraction, 3) + " %";
}

// What of a verification falls short, and of how much.
std::string shortfall_of(const GrownRegion& found) {
  const Verification& got = found.verification;
  const VerificationLimits asked;
  const std::string faces = std::to_string(found.region.faces.size()) + " faces";
  if (found.region.faces.empty()) return "the surface around the seed faces is empty";
  if (passes(got)) return "it holds on " + faces + " elsewhere, but not where the seed faces are";
  if (!got.complete || got.joint < asked.joint) {
    return percent(got.joint) + " of the area of " + faces + " fits, at least " + percent(asked.joint) + " must";
  }
  if (got.worst < asked.worst) {
    return "one of its motions fits " + percent(got.worst) + " of the area of " + faces + ", each must fit " +
           percent(asked.worst);
  }
  if (got.cluster > asked.cluster) {
    return "a piece of " + percent(got.cluster) + " of the area of " + faces + " has no image, at most " +
           percent(asked.cluster) + " may be without";
  }
  return "of one part " + percent(got.part) + " of the area fits, at least " + percent(asked.part) + " must";
}

// A mesh and what a hint asks of it, made ready once.
class Hinted {
 public:
  Hinted(const Mesh& mesh, const RegionHint& hint, const RunContext& context)
      : prepared_(prepare(mesh)),
        whole_(std::make_shared<const SurfaceIndex>(prepared_.mesh)),
        hint_(hint),
        context_(context) {
    if (hint.near) {
      const Similarity& input = prepared_.input_of_normalised;
      hint_.seeds.push_back(whole_->nearest((*hint.near - input.translation) / input.scale).face);
    }
    hint_.validate(static_cast<int>(mesh.faces.rows()));
  }

  GrownRegion grown(const GuidedRegionOptions& options) const {
    return Guide(prepared_, whole_, hint_, options, context_).run();
  }

  const PreparedMesh& prepared() const { return prepared_; }

 private:
  PreparedMesh prepared_;
  std::shared_ptr<const SurfaceIndex> whole_;
  RegionHint hint_;
  const RunContext& context_;
};

}  // namespace

void RegionHint::validate(int faces) const {
  const auto refuse = [](const std::string& field, const std::string& value, const std::string& rule) {
    throw UsageError(field + " is " + value + ": " + rule);
  };
  if (seeds.empty()) throw UsageError("a seed face is needed");
  for (const int seed : seeds) {
    if (seed < 0 || seed >= faces) {
      refuse("the seed face", std::to_string(seed), "must be from 0 to " + std::to_string(faces - 1));
    }
  }
  if (order && *order != kContinuous && *order < 2) {
    refuse("the order", std::to_string(*order), "must be at least 2, or inf");
  }
  if (order && about != About::axis) refuse("the order", std::to_string(*order), "only an axis has one");
  if (!group) return;
  const bool across = group->family == Family::Cnv || group->family == Family::Dn || group->family == Family::Dnh ||
                      group->family == Family::Dnd || polyhedral(*group);
  if (!refine && across) {
    refuse("the group", group->symbol(), "its directions across the axis are only known once refined");
  }
  if (order) refuse("the order", std::to_string(*order), "the group " + group->symbol() + " says it already");
  const bool plane = group->family == Family::Cs;
  const bool axis = group->has_axis() && !plane;
  if (about == About::plane && !plane) refuse("the group", group->symbol(), "a plane's group is Cs");
  if (about == About::axis && !axis) refuse("the group", group->symbol(), "must have an axis of rotation");
  if (about == About::centre && (group->has_axis() || group->family == Family::C1)) {
    refuse("the group", group->symbol(), "about a centre there are Ci, T, Td, Th, O, Oh, I, Ih, K and Kh");
  }
}

GuidedRegion guided_region(const Mesh& mesh, const RegionHint& hint, const GuidedRegionOptions& options,
                           const RunContext& context) {
  const Hinted hinted(mesh, hint, context);
  const GrownRegion found = hinted.grown(options);
  const GroupPlacement& placement = found.region.placement;
  GuidedRegion result;
  result.region = make_region(placement.group, hinted.prepared().input_of_normalised(placement.centre), placement.frame,
                              found.region.faces, "");
  result.region.residual = found.residual;
  result.kept = found.verification.joint;
  result.holds = found.holds;
  if (!found.holds) result.shortfall = shortfall_of(found);
  return result;
}

std::optional<double> passing_tolerance(const Mesh& mesh, const RegionHint& hint, const GuidedRegionOptions& options,
                                        const RunContext& context) {
  constexpr double kStep = 1.5;
  constexpr double kMaxTolerance = 0.1;  // DetectOptions::tolerance
  const Hinted hinted(mesh, hint, context);
  GuidedRegionOptions tried = options;
  while (tried.tolerance * kStep <= kMaxTolerance) {
    tried.tolerance = std::stod(with_digits(tried.tolerance * kStep, 2));  // as a person would give it
    if (hinted.grown(tried).holds) return tried.tolerance;
  }
  return std::nullopt;
}

}  // namespace orbifit
