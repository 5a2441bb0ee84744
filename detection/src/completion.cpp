#include "orbifit/detection/completion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "orbifit/detection/axis_orders.h"
#include "orbifit/detection/own_group.h"
#include "orbifit/detection/region_growth.h"
#include "orbifit/detection/verification.h"
#include "orbifit/model/point_index.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kNormalCosine = 0.64;  // 50 degrees: the facets of small round parts differ by more than 25
constexpr int kMostElements = 120;
constexpr int kSamples = 500;

/// Regions, and which of them are images of which.
class Completion {
 public:
  Completion(const PreparedMesh& prepared, const CompletionOptions& options, const RunContext& context,
             std::vector<FoundRegion>& regions)
      : prepared_(prepared),
        options_(options),
        context_(context),
        regions_(regions),
        centroids_(face_centroids(prepared.mesh)),
        near_(centroids_) {
    for (const FoundRegion& region : regions) moments_.push_back(surface_moments(prepared, region.faces));
  }

  void run() {
    std::ranges::stable_sort(regions_, std::greater<>(), &FoundRegion::area);
    moments_.clear();
    for (const FoundRegion& region : regions_) moments_.push_back(surface_moments(prepared_, region.faces));
    for (std::size_t r = 0; r < regions_.size() && !late(); ++r) {
      const PointGroup& group = regions_[r].placement.group;
      if (group.continuous() || group.order() > kMostElements) continue;
      carry_within(r);
    }
  }

 private:
  bool late() const { return options_.late && options_.late(); }

  double tolerance_of(std::size_t region) const {
    return options_.tolerance * std::min(1.0, 4 * moments_[region].diagonal);
  }

  void carry_within(std::size_t outer) {
    const GroupPlacement around = regions_[outer].placement;
    std::vector<char> done(regions_.size(), 0);
    for (std::size_t q = 0; q < regions_.size() && !late(); ++q) {
      context_.check();
      if (q == outer || (q < done.size() && done[q] != 0)) continue;
      if (regions_[q].area > 0.95 * regions_[outer].area) continue;
      if (area_outside(prepared_, regions_[q].faces, regions_[outer].faces) > 0.05 * regions_[q].area) continue;
      for (const std::size_t image : carry(q, judged_motions(around.group, around.frame, around.centre))) {
        if (image >= done.size()) done.resize(image + 1, 0);
        done[image] = 1;
      }
    }
  }

  // Makes all images of region q; their numbers.
  std::vector<std::size_t> carry(std::size_t q, const std::vector<Motion>& motions) {
    const SurfaceIndex& surface = surface_of(q);
    std::vector<Motion> stabiliser;
    std::vector<std::pair<std::size_t, Motion>> images;
    std::vector<std::pair<Motion, std::vector<int>>> elsewhere;
    std::vector<std::size_t> result;
    for (const Motion& motion : motions) {
      if (const std::optional<std::size_t> known = known_image(q, motion)) {
        if (*known == q) {
          stabiliser.push_back(motion);
        } else if (std::ranges::find(result, *known) == result.end()) {
          result.push_back(*known);
          images.emplace_back(*known, motion);
        }
        continue;
      }
      std::vector<int> image = image_of(q, surface, motion);
      if (image.empty()) continue;
      if (overlap(image, regions_[q].faces) > 0.85) {
        stabiliser.push_back(motion);
      } else {
        elsewhere.emplace_back(motion, std::move(image));
      }
    }
    settle(q, stabiliser);
    for (const auto& [image, motion] : images) place(image, carried(regions_[q].placement, motion));
    for (const auto& [motion, faces] : elsewhere) {
      const GroupPlacement goal = carried(regions_[q].placement, motion);
      const std::optional<std::size_t> known = find(goal, faces);
      if (known) {
        const bool fresh = std::ranges::find(result, *known) == result.end();
        if (fresh && *known != q && regions_[*known].placement.group == goal.group) place(*known, goal);
        result.push_back(*known);
      } else if (regions_.size() < options_.most && holds(goal, faces)) {
        note(goal, regions_[q], true, "image of a region under a larger region's group");
        const SurfaceMoments moments = surface_moments(prepared_, faces);
        regions_.push_back({goal, faces, moments.area, "image of " + regions_[q].name, regions_[q].of_pieces});
        moments_.push_back(moments);
        result.push_back(regions_.size() - 1);
      }
    }
    return result;
  }

  // The region of the same group onto which the motion carries this one, told by a few of its faces.
  std::optional<std::size_t> known_image(std::size_t q, const Motion& motion) {
    constexpr std::size_t kLooks = 24;
    const double reach = 1.5 * tolerance_of(q);
    const Vector3d goal = motion(moments_[q].centroid);
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      if (regions_[k].placement.group != regions_[q].placement.group) continue;
      if ((moments_[k].centroid - goal).norm() > 2 * reach) continue;
      if (std::abs(regions_[k].area - regions_[q].area) > 0.05 * regions_[q].area) continue;
      if (!contains_group(regions_[k].placement, carried(regions_[q].placement, motion), goal, moments_[q].radius,
                          reach)) {
        continue;
      }
      const SurfaceIndex& surface = surface_of(k);
      const std::vector<int>& faces = regions_[q].faces;
      std::size_t hits = 0;
      for (std::size_t i = 0; i < kLooks; ++i) {
        const int face = faces[i * faces.size() / kLooks];
        const Vector3d normal = motion.linear * prepared_.normals.row(face).transpose();
        if (surface.within_facing(motion(centroids_.row(face)), normal, kNormalCosine, reach)) ++hits;
      }
      if (hits >= kLooks - 2) return k;
    }
    return std::nullopt;
  }

  const SurfaceIndex& surface_of(std::size_t region) {
    if (surfaces_.size() <= region) surfaces_.resize(region + 1);
    if (!surfaces_[region]) surfaces_[region] = std::make_unique<SurfaceIndex>(prepared_.mesh, regions_[region].faces);
    return *surfaces_[region];
  }

  // The faces that the motion carries the region onto; empty where there is no such surface.
  std::vector<int> image_of(std::size_t q, const SurfaceIndex& surface, const Motion& motion) const {
    const Motion back = inverse(motion);
    const SurfaceMoments& moments = moments_[q];
    const double reach = 1.5 * tolerance_of(q);
    std::vector<int> faces;
    double area = 0;
    for (const PointIndex::Neighbour& near : near_.within(motion(moments.centroid), moments.radius + reach)) {
      const int face = near.index;
      if (prepared_.areas[face] <= 0) continue;
      const Vector3d normal = back.linear * prepared_.normals.row(face).transpose();
      const Vector3d centroid = centroids_.row(face);
      // Of four points in the face three must be on it.
      int hits = 0;
      int misses = 0;
      for (int k = 3; k >= 0 && hits < 3 && misses < 2; --k) {
        Vector3d point = centroid;
        if (k < 3) point = 0.5 * (centroid + prepared_.mesh.vertices.row(prepared_.mesh.faces(face, k)).transpose());
        const bool hit = surface.within_facing(back(point), normal, kNormalCosine, reach);
        ++(hit ? hits : misses);
      }
      if (hits < 3) continue;
      faces.push_back(face);
      area += prepared_.areas[face];
    }
    if (std::abs(area - moments.area) > 0.1 * moments.area) return {};
    std::ranges::sort(faces);
    return faces;
  }

  // Area of the common part by that of the union.
  double overlap(const std::vector<int>& a, const std::vector<int>& b) const {
    double first = 0;
    for (const int face : a) first += prepared_.areas[face];
    const double only_a = area_outside(prepared_, a, b);
    const double only_b = area_outside(prepared_, b, a);
    return (first - only_a) / std::max(first + only_b, 1e-300);
  }

  // A region on these faces whose group holds all elements.
  std::optional<std::size_t> find(const GroupPlacement& goal, const std::vector<int>& faces) const {
    const SurfaceMoments moments = surface_moments(prepared_, faces);
    const double tolerance = 1.5 * options_.tolerance * std::min(1.0, 4 * moments.diagonal);
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      if (regions_[k].area < 0.8 * moments.area) continue;
      if (area_outside(prepared_, faces, regions_[k].faces) > 0.1 * moments.area) continue;
      if (contains_group(regions_[k].placement, goal, moments.centroid, moments.radius, tolerance)) return k;
    }
    return std::nullopt;
  }

  bool holds(const GroupPlacement& placement, const std::vector<int>& faces) const {
    return holds(placement, make_patch(prepared_, faces, kSamples, options_.tolerance, context_, "completion"));
  }

  // Of a region that was verified where it was found: fewer samples tell whether anything was lost on the way.
  bool holds(const GroupPlacement& placement, const SurfacePatch& patch) const {
    constexpr int kPairs = 6000;
    constexpr int kFewest = 150;
    const auto motions = judged_motions(placement.group, placement.frame, placement.centre).size();
    return verified(patch, placement, context_, std::max(kFewest, kPairs / static_cast<int>(motions)));
  }

  // Moves the region's placement to the mean of its images under motions that keep the region.
  void settle(std::size_t q, const std::vector<Motion>& stabiliser) {
    if (stabiliser.empty()) return;
    GroupPlacement placement = regions_[q].placement;
    for (int round = 0; round < 4; ++round) placement = mean_of_images(placement, stabiliser);
    place(q, placement);
  }

  // Moves a region's group, unless the region fits it far less well there: a group that is exact by itself is not bent
  // to one around it that is not.
  void place(std::size_t region, const GroupPlacement& goal) {
    constexpr double kNothing = 1e-9;
    constexpr double kAsWell = 1.5;
    constexpr std::size_t kQueries = 1500;
    const FoundRegion& now = regions_[region];
    const SurfaceMoments& moments = moments_[region];
    if (!contains_group(now.placement, goal, moments.centroid, moments.radius, kNothing)) {
      const SurfacePatch patch = make_patch(prepared_, now.faces, kSamples, options_.tolerance, context_, "completion");
      const auto fit = [&](const GroupPlacement& placement) {
        const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
        return measure_residual(patch, motions, context_, kQueries).rms;
      };
      if (fit(goal) > kAsWell * fit(now.placement) + kNothing || !holds(goal, patch)) return;
    }
    regions_[region].placement = goal;
  }

  static GroupPlacement mean_of_images(const GroupPlacement& placement, const std::vector<Motion>& stabiliser) {
    GroupPlacement result = placement;
    const double count = static_cast<double>(stabiliser.size()) + 1;
    Vector3d centre = placement.centre;
    for (const Motion& motion : stabiliser) centre += motion(placement.centre);
    result.centre = centre / count;
    if (placement.group.family == Family::K || placement.group.family == Family::Kh) return result;
    if (placement.group.continuous() || placement.group.family == Family::Cs) {
      const Vector3d axis = placement.frame.col(2);
      Vector3d sum = axis;
      for (const Motion& motion : stabiliser) {
        const Vector3d image = motion.linear * axis;
        sum += image.dot(axis) < 0 ? Vector3d(-image) : image;
      }
      result.frame = frame_about(sum.normalized(), placement.frame.col(0));
      return result;
    }
    // Frames that differ by an element of the group, or by one that maps the group to itself, say the same: the turn
    // from the frame to the nearest image by an element is what is averaged.
    const std::vector<Matrix3d> group = elements(placement.group, placement.frame);
    Vector3d turns = Vector3d::Zero();
    for (const Motion& motion : stabiliser) {
      double least = 10;
      Vector3d nearest = Vector3d::Zero();
      for (const Matrix3d& element : group) {
        const AxisAngle turn = axis_angle(motion.linear * element);
        if (turn.determinant < 0 || turn.angle >= least) continue;
        least = turn.angle;
        nearest = turn.angle * turn.axis;
      }
      // No element of the group is near this one: it maps the group to itself in another way, and says nothing here.
      if (least < 0.2) turns += nearest;
    }
    turns /= count;
    if (turns.norm() > 1e-15) {
      result.frame = nearest_orthogonal(axis_rotation(turns.normalized(), turns.norm()) * placement.frame);
    }
    return result;
  }

  void note(const GroupPlacement& placement, const FoundRegion& of, bool kept, const std::string& reason) const {
    if (options_.explanation == nullptr) return;
    options_.explanation->notes.push_back(
        {"completion", placement.group.symbol() + " image of " + of.name, kept, reason});
  }

  const PreparedMesh& prepared_;
  const CompletionOptions& options_;
  const RunContext& context_;
  std::vector<FoundRegion>& regions_;
  std::vector<SurfaceMoments> moments_;
  std::vector<std::unique_ptr<SurfaceIndex>> surfaces_;  // of the regions, built when first needed
  Points centroids_;
  PointIndex near_;
};

}  // namespace

GroupPlacement carried(const GroupPlacement& placement, const Motion& motion) {
  GroupPlacement result = placement;
  result.frame = motion.linear * placement.frame;
  // A frame stays right-handed: turning its second column over changes no group written in it but by a mirror image of
  // its twist, and the elements of a group come with their inverses.
  if (result.frame.determinant() < 0) result.frame.col(1) = -result.frame.col(1);
  result.centre = motion(placement.centre);
  return result;
}

void complete_regions(const PreparedMesh& prepared, const CompletionOptions& options, const RunContext& context,
                      std::vector<FoundRegion>& regions) {
  Completion(prepared, options, context, regions).run();
}

}  // namespace orbifit
