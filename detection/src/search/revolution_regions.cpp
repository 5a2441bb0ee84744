#include "search/revolution_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "evidence/cut_discs.h"
#include "group/axis_orders.h"
#include "group/verification.h"
#include "primitives/balls.h"
#include "primitives/line_orbits.h"
#include "support/own_group.h"
#include "support/region_growth.h"
#include "surface/face_points.h"
#include "surface/face_sides.h"
#include "surface/segments.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kFirstAngles = 12;
constexpr int kAngles = 48;  // once the axis is known: what interrupts a circle may be thin
constexpr int kPatchSamples = 700;
constexpr double kFacesSlack = 1.2;  // of the tolerance, for faces that are collected
constexpr double kMaxOfFlat = 0.8;   // of a flat piece's area
constexpr double kNothingNew = 0.1;  // of the region's area outside of one that says the same

/// The faces about one axis.
class Turned {
 public:
  Turned(const PreparedMesh& prepared, const SurfaceIndex& surface, const Line& axis, double tolerance, int angles)
      : prepared_(prepared), surface_(surface), axis_(axis), tolerance_(tolerance) {
    for (int k = 1; k < angles; ++k) {
      const double turns = k / std::numbers::phi;
      turns_.push_back(
          Motion::rotation(axis.direction, 2 * std::numbers::pi * (turns - std::floor(turns)), axis.point));
    }
  }

  // Whether the normal meets the axis, as on every surface turned about it.
  bool may_turn(int face) const {
    return meets(axis_, face_centroid(prepared_, face), prepared_.normals.row(face), tolerance_);
  }

  // Whether the whole circle of the face's centroid lies on the surface.
  bool turns(int face) const {
    const Vector3d centroid = face_centroid(prepared_, face);
    const Vector3d normal = prepared_.normals.row(face);
    return std::ranges::all_of(turns_, [&](const Motion& motion) {
      return surface_.within_facing(motion(centroid), motion.linear * normal, kAlikeNormals, tolerance_);
    });
  }

 private:
  const PreparedMesh& prepared_;
  const SurfaceIndex& surface_;
  Line axis_;
  double tolerance_;
  std::vector<Motion> turns_;
};

class RevolutionSearch {
 public:
  RevolutionSearch(const PreparedMesh& prepared, const SurfaceIndex& whole, const std::vector<FoundRegion>& known,
                   const RevolutionRegionOptions& options, const RunContext& context)
      : prepared_(prepared),
        whole_(whole),
        known_(known),
        options_(options),
        context_(context),
        discs_(prepared),
        balls_(find_balls(prepared, options.tolerance)) {
    for (const std::vector<int>& faces : prepared.components.faces) {
      areas_.push_back(area_of(prepared, faces));
      flat_.push_back(flat_piece(prepared, faces) ? 1 : 0);
    }
  }

  // Whether a region was found.
  bool look_at(const Line& axis) {
    const std::size_t before = found_.size();
    collect_about(axis);
    return found_.size() > before;
  }

  RevolutionRegions take() { return {std::move(found_), std::move(axes_)}; }

 private:
  // Collects faces about the axis and fits it to them; where the surface is fine, or only a blot fails, again with the
  // better axis and more angles, and then within what was collected, until what is left turns.
  void collect_about(const Line& axis) {
    constexpr int kRounds = 6;
    RefinementOptions quick;  // all rotations move the axis together: few samples of each will do
    quick.samples = 160;
    quick.iterations = 6;
    GroupPlacement turn{{Family::Cinfv, 1}, frame_about(axis.direction), axis.point};
    FoundRegion region{turn, faces_about(axis, whole_, kFacesSlack * options_.tolerance, kFirstAngles), 0,
                       "turned about an axis"};
    std::string reason = "does not turn into itself closely enough";
    for (int round = 0; round < kRounds; ++round) {
      region.area = area_of(prepared_, region.faces);
      if (region.area < options_.least_share * prepared_.area || says_nothing_new(region)) return;
      const SurfacePatch patch =
          make_patch(prepared_, region.faces, kPatchSamples, options_.tolerance, context_, "turned");
      if (round == 0 && !continuous_about(patch, axis.direction, axis.point)) break;
      region.placement = refine(patch, region.placement, context_, quick);
      const Verification verification = verify_group(patch, region.placement, context_);
      reason = objection(verification);
      if (reason.empty()) return take_out_discs(patch, std::move(region));
      if (!options_.fine && !only_a_blot_fails(verification)) break;
      const Line better{region.placement.centre, region.placement.frame.col(2)};
      std::vector<int> fewer =
          faces_about(better, round == 0 ? whole_ : *patch.index, kFacesSlack * continuous_tolerance(patch), kAngles);
      if (fewer == region.faces) break;
      region.faces = std::move(fewer);
    }
    note(region, false, reason);
  }

  // A region that is little but discs of planes that go on beyond it is what else there is, if that turns as well.
  void take_out_discs(const SurfacePatch& patch, FoundRegion region) {
    std::vector<int> rest = discs_.without(region);
    if (!discs_.little_else(region, rest)) return add(patch, std::move(region));
    note(region, false, "little but discs that end within planes");
    axes_.push_back({region.placement.centre, region.placement.frame.col(2)});
    region.area = area_of(prepared_, rest);
    region.faces = std::move(rest);
    if (region.area < options_.least_share * prepared_.area || says_nothing_new(region)) return;
    const SurfacePatch fewer =
        make_patch(prepared_, region.faces, kPatchSamples, options_.tolerance, context_, "without discs");
    region.placement = refine(fewer, region.placement, context_);
    const std::string reason = objection(verify_group(fewer, region.placement, context_));
    if (reason.empty()) return add(fewer, std::move(region));
    note(region, false, reason);
  }

  // With the largest group that the region has.
  void add(const SurfacePatch& patch, FoundRegion region) {
    const std::optional<OwnGroup> group = find_own_group(patch, nullptr, {{region.placement.frame.col(2)}}, context_);
    const bool known = group && group->placement.group.continuous();
    if (known) region.placement = group->placement;
    if (!known && !options_.fine) return note(region, false, "only a finite group holds");
    if (little_but_cut_balls(prepared_, balls_, region.faces, region.placement, options_.tolerance)) {
      return note(region, false, "little but balls about whose centres it turns");
    }
    if (says_nothing_new(region)) return;
    note(region, true, "verified");
    found_.push_back(std::move(region));
  }

  bool says_nothing_new(const FoundRegion& region) const {
    return says_nothing_new_beside(prepared_, known_, region, options_.tolerance, kNothingNew) ||
           says_nothing_new_beside(prepared_, found_, region, options_.tolerance, kNothingNew);
  }

  void note(const FoundRegion& region, bool kept, const std::string& reason) const {
    if (options_.explanation == nullptr) return;
    options_.explanation->notes.push_back(
        {"revolution", region.placement.group.symbol() + " on " + std::to_string(region.faces.size()) + " faces", kept,
         reason});
  }

  // Those whose circles lie on the surface to the tolerance. Of a flat piece only where it turns as a whole, or but for
  // what stands on it: where most of its border is that of other pieces that turn.
  std::vector<int> faces_about(const Line& axis, const SurfaceIndex& surface, double tolerance, int angles) const {
    const Turned turned(prepared_, surface, axis, tolerance, angles);
    std::vector<char> in(static_cast<std::size_t>(prepared_.mesh.faces.rows()), 0);
    std::vector<int> result;
    const auto take = [&](const std::vector<int>& faces) {
      for (const int face : faces) in[static_cast<std::size_t>(face)] = 1;
      result.insert(result.end(), faces.begin(), faces.end());
    };
    std::vector<std::pair<std::size_t, std::vector<int>>> rest;  // what turns of flat pieces
    for (std::size_t s = 0; s < prepared_.components.faces.size(); ++s) {
      std::vector<int> kept = faces_of_piece(s, turned);
      if (kept.empty()) continue;
      if (flat_[s] == 0 || area_of(prepared_, kept) >= kMaxOfFlat * areas_[s]) {
        take(kept);
      } else {
        rest.emplace_back(s, std::move(kept));
      }
    }
    for (const auto& [s, kept] : rest) {
      if (bounded(s, in)) take(kept);
    }
    std::ranges::sort(result);
    return result;
  }

  // The faces of a piece that turn; all if nearly all do.
  std::vector<int> faces_of_piece(std::size_t s, const Turned& turned) const {
    constexpr std::size_t kMinShare = 64;  // faces worth a thread
    constexpr double kNearlyAll = 0.97;
    if (areas_[s] <= 0) return {};
    const std::vector<int>& faces = prepared_.components.faces[s];
    std::vector<int> candidates;
    double area = 0;
    for (const int f : faces) {
      if (prepared_.areas[f] <= 0 || !turned.may_turn(f)) continue;
      candidates.push_back(f);
      area += prepared_.areas[f];
    }
    if (area < 0.05 * areas_[s] || (flat_[s] != 0 && area < 0.9 * areas_[s])) return {};
    if (few_turn(turned, candidates)) return {};
    std::vector<char> turns(candidates.size(), 0);
    parallel_for(
        context_, candidates.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) turns[i] = turned.turns(candidates[i]) ? 1 : 0;
        },
        kMinShare);
    std::vector<int> kept;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (turns[i] != 0) kept.push_back(candidates[i]);
    }
    return area_of(prepared_, kept) > kNearlyAll * areas_[s] ? faces : kept;
  }

  // Whether most of the border of a piece is that of faces that are in.
  bool bounded(std::size_t s, const std::vector<char>& in) const {
    constexpr double kMax = 0.6;
    double border = 0;
    double inside = 0;
    for (const int face : prepared_.components.faces[s]) {
      for (const FaceSide& side : discs_.sides()[static_cast<std::size_t>(face)]) {
        if (side.face < 0) continue;
        const auto other = static_cast<std::size_t>(side.face);
        if (prepared_.components.component_of_face[other] == static_cast<int>(s)) continue;
        border += side.length;
        if (in[other] != 0) inside += side.length;
      }
    }
    return inside > kMax * border;
  }

  static bool few_turn(const Turned& turned, const std::vector<int>& candidates) {
    constexpr std::size_t kLooks = 40;
    if (candidates.size() <= 2 * kLooks) return false;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < kLooks; ++i) {
      if (turned.turns(candidates[i * candidates.size() / kLooks])) ++hits;
    }
    return hits < 2;
  }

  const PreparedMesh& prepared_;
  const SurfaceIndex& whole_;
  const std::vector<FoundRegion>& known_;
  const RevolutionRegionOptions& options_;
  const RunContext& context_;
  std::vector<double> areas_;
  std::vector<char> flat_;
  CutDiscs discs_;
  Balls balls_;
  std::vector<FoundRegion> found_;
  std::vector<Line> axes_;
};

// Centroids, normals and areas of at most `most` of the faces.
struct Oriented {
  Points points, normals;
  Eigen::VectorXd weights;
};

Oriented oriented_points(const PreparedMesh& prepared, const std::vector<int>& faces, std::size_t most) {
  const std::size_t count = std::min(faces.size(), most);
  Oriented result{Points(static_cast<Eigen::Index>(count), 3), Points(static_cast<Eigen::Index>(count), 3),
                  Eigen::VectorXd(static_cast<Eigen::Index>(count))};
  for (std::size_t i = 0; i < count; ++i) {
    const int f = faces[i * faces.size() / count];
    const auto row = static_cast<Eigen::Index>(i);
    result.points.row(row) = face_centroid(prepared, f);
    result.normals.row(row) = prepared.normals.row(f);
    result.weights[row] = prepared.areas[f];
  }
  return result;
}

bool same_axis(const Line& a, const Line& b, double tolerance) {
  return a.direction.cross(b.direction).norm() < 0.02 &&
         (b.point - a.point).cross(a.direction).norm() < 0.5 * tolerance;
}

}  // namespace

std::vector<Line> revolution_axes(const PreparedMesh& prepared, double tolerance, const RunContext& context) {
  constexpr double kAngle = 0.08;       // radians
  constexpr double kMinShare = 0.004;   // of the mesh's area
  constexpr double kLocalShare = 0.05;  // pieces this large are looked at place by place
  constexpr double kReach = 0.12;       // of the diagonal
  constexpr int kSeeds = 16;
  constexpr std::size_t kMaxAxes = 48;
  std::vector<Line> result;
  const auto add = [&](const Line& line) {
    if (result.size() >= kMaxAxes || line.point.norm() > 2) return;
    if (std::ranges::none_of(result, [&](const Line& known) { return same_axis(known, line, tolerance); })) {
      result.push_back(line);
    }
  };
  for (const std::vector<int>& faces : prepared.components.faces) {
    context.check();
    const double area = area_of(prepared, faces);
    if (area < kMinShare * prepared.area) continue;
    const Oriented all = oriented_points(prepared, faces, 1500);
    const std::optional<RevolutionFit> fit = fit_axis_of_revolution(all.points, all.normals, all.weights, kAngle);
    if (fit && (fit->planar || fit->spherical)) continue;
    if (fit) add(fit->axis);
    if ((fit && fit->inliers > 0.9) || area < kLocalShare * prepared.area) continue;
    // Seeds far from one another.
    Eigen::VectorXd nearest = Eigen::VectorXd::Constant(all.points.rows(), 10);
    Eigen::Index seed = 0;
    for (int k = 0; k < kSeeds; ++k) {
      Eigen::VectorXd local = all.weights;
      for (Eigen::Index i = 0; i < all.points.rows(); ++i) {
        const double distance = (all.points.row(i) - all.points.row(seed)).norm();
        nearest[i] = std::min(nearest[i], distance);
        if (distance > kReach) local[i] = 0;
      }
      const std::optional<RevolutionFit> near = fit_axis_of_revolution(all.points, all.normals, local, kAngle);
      if (near && !near->planar && !near->spherical && near->inliers > 0.6) add(near->axis);
      nearest.maxCoeff(&seed);
    }
  }
  return result;
}

RevolutionRegions find_revolution_regions(const PreparedMesh& prepared, const SurfaceIndex& whole,
                                          const std::vector<Line>& axes, const std::vector<FoundRegion>& known,
                                          const RevolutionRegionOptions& options, const RunContext& context) {
  RevolutionSearch search(prepared, whole, known, options, context);
  LineOrbits orbits(axes, options.of_whole, options.tolerance);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (options.late && options.late()) break;
    if (!orbits.worth_a_look(i)) continue;
    context.check();
    context.progress("turned regions", static_cast<double>(i) / static_cast<double>(axes.size()));
    if (search.look_at(axes[i])) orbits.found(i);
  }
  return search.take();
}

}  // namespace orbifit
