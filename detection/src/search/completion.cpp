#include "search/completion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "geometry/point_index.h"
#include "group/axis_orders.h"
#include "group/verification.h"
#include "support/own_group.h"
#include "support/region_growth.h"
#include "surface/face_points.h"
#include "surface/near_cells.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr int kMaxElements = 120;
constexpr int kSpreadSamples = 500;
constexpr double kSameMotion = 0.5;  // tolerances
constexpr double kSameFaces = 0.85;  // of two regions' faces: common area by that of the union

/// Regions, and which of them are images of which.
class Completion {
 public:
  Completion(const PreparedMesh& prepared, const SurfaceIndex& whole, const CompletionOptions& options,
             const RunContext& context, std::vector<FoundRegion>& regions)
      : prepared_(prepared),
        whole_(whole),
        options_(options),
        context_(context),
        regions_(regions),
        centroids_(face_centroids(prepared.mesh)),
        near_(centroids_) {}

  void run() {
    std::ranges::stable_sort(regions_, std::greater<>(), &FoundRegion::area);
    for (const FoundRegion& region : regions_) moments_.push_back(surface_moments(prepared_, region.faces));
    for (std::size_t r = 0; r < regions_.size() && !late(); ++r) {
      const PointGroup& group = regions_[r].placement.group;
      if (group.continuous() || group.order() > kMaxElements) continue;
      carry_within(r);
    }
  }

 private:
  bool late() const { return options_.late && options_.late(); }

  double tolerance_of(std::size_t region) const {
    return tolerance_of_part(options_.tolerance, moments_[region].diagonal);
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

  // How far from a region a point may be for an image to hold it.
  double image_reach(std::size_t region) const { return 1.5 * tolerance_of(region); }

  struct Surface {
    SurfacePatch patch;
    std::optional<NearCells> cells;  // of its faces, once images are made
    std::optional<double> fit;       // rms distance under the region's group where it is now
  };

  // What is known of a region's image under a motion before anything is changed.
  struct Image {
    std::optional<std::size_t> same;    // the region of the same group that it is
    std::optional<std::size_t> within;  // one that holds it and its group
    std::vector<int> faces;             // where neither is known: the faces; empty where there is no such surface
  };

  // Motions that differ by elements of a region's own group: the region has one image under all of them.
  struct Coset {
    std::vector<Motion> motions;
    bool keeps;  // those elements themselves
  };

  std::vector<Coset> cosets_of(std::size_t q, const std::vector<Motion>& motions) const {
    const GroupElements own(regions_[q].placement);
    const SurfaceMoments& mine = moments_[q];
    std::vector<Coset> result;
    const auto in_own = [&](const Motion& motion) {
      return own.hold(motion, mine.centroid, mine.radius, kSameMotion * tolerance_of(q));
    };
    for (const Motion& motion : motions) {
      const auto known = std::ranges::find_if(result, [&](const Coset& coset) {
        return coset.keeps ? in_own(motion) : in_own(inverse(coset.motions.front()) * motion);
      });
      if (known == result.end()) {
        result.push_back({{motion}, in_own(motion)});
      } else {
        known->motions.push_back(motion);
      }
    }
    return result;
  }

  // Motions by which the region has not been carried before: regions within one another share many.
  std::vector<Motion> untried(std::size_t q, const std::vector<Motion>& motions) {
    tried_.resize(regions_.size());
    const SurfaceMoments& mine = moments_[q];
    std::vector<Motion> fresh;
    std::ranges::copy_if(motions, std::back_inserter(fresh), [&](const Motion& motion) {
      return std::ranges::none_of(tried_[q], [&](const Motion& known) {
        return motion_distance(motion, known, mine.centroid, mine.radius) <= kSameMotion * tolerance_of(q);
      });
    });
    tried_[q].insert(tried_[q].end(), fresh.begin(), fresh.end());
    return fresh;
  }

  // Makes all images of region q; their numbers.
  std::vector<std::size_t> carry(std::size_t q, const std::vector<Motion>& all) {
    const std::vector<Coset> cosets = cosets_of(q, untried(q, all));
    std::vector<Image> images(cosets.size());
    parallel_for(context_, cosets.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!cosets[i].keeps) images[i] = look(q, cosets[i].motions.front());
      }
    });
    std::vector<Motion> stabiliser;
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < cosets.size(); ++i) {
      const Image& image = images[i];
      const bool itself =
          cosets[i].keeps ||
          (image.same ? *image.same == q : !image.within && overlap(image.faces, regions_[q].faces) > kSameFaces);
      if (itself) stabiliser.insert(stabiliser.end(), cosets[i].motions.begin(), cosets[i].motions.end());
      motions.push_back(cosets[i].motions.front());
    }
    symmetrise_placement(q, stabiliser);
    std::vector<std::size_t> result;
    const auto take = [&](std::size_t known, const GroupPlacement& goal) {
      const bool fresh = known != q && std::ranges::find(result, known) == result.end();
      if (!fresh) return;
      if (regions_[known].placement.group == goal.group) place(known, goal);
      result.push_back(known);
    };
    // What is the region itself moved comes before what only lies within something.
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (images[i].same) take(*images[i].same, carried(regions_[q].placement, motions[i]));
    }
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const std::vector<int>& faces = images[i].faces;
      const GroupPlacement goal = carried(regions_[q].placement, motions[i]);
      if (images[i].within) take(*images[i].within, goal);
      if (faces.empty() || overlap(faces, regions_[q].faces) > kSameFaces) continue;
      if (const std::optional<std::size_t> known = find(goal, faces)) {
        take(*known, goal);
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

  // Cheap answers first: most images are known, or there is no surface where they would be.
  Image look(std::size_t q, const Motion& motion) {
    constexpr double kNearlyAll = 0.9;  // of the looks
    constexpr double kMax = 0.7;
    Image image;
    if (late()) return image;
    const GroupPlacement goal = carried(regions_[q].placement, motion);
    const SurfaceMoments& mine = moments_[q];
    const Vector3d centroid = motion(mine.centroid);
    const double reach = image_reach(q);
    const auto contains = [&](std::size_t k) {
      return contains_group(regions_[k].placement, goal, centroid, mine.radius, reach);
    };
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      const bool same = regions_[k].placement.group == goal.group &&
                        (moments_[k].centroid - centroid).norm() <= 2 * reach &&
                        std::abs(regions_[k].area - regions_[q].area) <= 0.05 * regions_[q].area;
      if (!same || !contains(k) || share_on(q, index_of(k), motion) < kNearlyAll) continue;
      image.same = k;
      return image;
    }
    if (share_on(q, whole_, motion) < kMax) return image;
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      if (k == q || regions_[k].area < 0.95 * regions_[q].area || !contains(k)) continue;
      if (share_on(q, index_of(k), motion) < kNearlyAll) continue;
      image.within = k;
      return image;
    }
    image.faces = image_of(q, motion);
    return image;
  }

  // The share of a few faces of the region that the motion carries onto the surface.
  double share_on(std::size_t q, const SurfaceIndex& surface, const Motion& motion) const {
    constexpr std::size_t kLooks = 24;
    const double reach = image_reach(q);
    const std::vector<int>& faces = regions_[q].faces;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < kLooks; ++i) {
      const int face = faces[i * faces.size() / kLooks];
      const Vector3d normal = motion.linear * prepared_.normals.row(face).transpose();
      if (surface.within_facing(motion(centroids_.row(face)), normal, kFacetNormals, reach)) ++hits;
    }
    return static_cast<double>(hits) / kLooks;
  }

  Surface& surface_of(std::size_t region) {
    const std::lock_guard lock(surfaces_mutex_);
    if (surfaces_.size() <= region) surfaces_.resize(region + 1);
    if (!surfaces_[region]) {
      const std::vector<int>& faces = regions_[region].faces;
      RunContext alone = context_;  // see parallel_for: the lock is held
      alone.threads = 1;
      surfaces_[region] = std::make_unique<Surface>(
          Surface{make_patch(prepared_, faces, kSpreadSamples, options_.tolerance, alone, "completion"), {}, {}});
    }
    return *surfaces_[region];
  }

  const SurfaceIndex& index_of(std::size_t region) { return *surface_of(region).patch.index; }

  const NearCells& cells_of(std::size_t region) {
    std::optional<NearCells>& cells = surface_of(region).cells;
    const std::lock_guard lock(surfaces_mutex_);
    if (!cells) cells.emplace(prepared_, regions_[region].faces, image_reach(region));
    return *cells;
  }

  // The faces that the motion carries the region onto; empty where there is no such surface.
  std::vector<int> image_of(std::size_t q, const Motion& motion) {
    const Motion back = inverse(motion);
    const SurfaceMoments& moments = moments_[q];
    const double reach = image_reach(q);
    const SurfaceIndex& surface = index_of(q);
    const NearCells& cells = cells_of(q);
    std::vector<int> faces;
    double area = 0;
    for (const PointIndex::Neighbour& near : near_.within(motion(moments.centroid), moments.radius + reach)) {
      const int face = near.index;
      if (prepared_.areas[face] <= 0) continue;
      const Vector3d normal = back.linear * prepared_.normals.row(face).transpose();
      const bool most = most_of_face(prepared_, face, [&](const Vector3d& point) {
        const Vector3d origin = back(point);
        return cells.may_reach(origin) && surface.within_facing(origin, normal, kFacetNormals, reach);
      });
      if (!most) continue;
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
    const double tolerance = 1.5 * tolerance_of_part(options_.tolerance, moments.diagonal);
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      if (regions_[k].area < 0.8 * moments.area) continue;
      if (area_outside(prepared_, faces, regions_[k].faces) > 0.1 * moments.area) continue;
      if (contains_group(regions_[k].placement, goal, moments.centroid, moments.radius, tolerance)) return k;
    }
    return std::nullopt;
  }

  bool holds(const GroupPlacement& placement, const std::vector<int>& faces) const {
    return holds(placement, make_patch(prepared_, faces, kSpreadSamples, options_.tolerance, context_, "completion"));
  }

  // Of a region that was verified where it was found: fewer samples tell whether anything was lost on the way.
  bool holds(const GroupPlacement& placement, const SurfacePatch& patch) const {
    constexpr int kPairs = 6000;
    constexpr int kMin = 150;
    const auto motions = judged_motions(placement.group, placement.frame, placement.centre).size();
    return verified(patch, placement, context_, std::max(kMin, kPairs / static_cast<int>(motions)));
  }

  // Moves the region's placement to the mean of its images under motions that keep the region.
  void symmetrise_placement(std::size_t q, const std::vector<Motion>& stabiliser) {
    if (stabiliser.empty()) return;
    GroupPlacement placement = regions_[q].placement;
    for (int round = 0; round < 4; ++round) placement = mean_of_images(placement, stabiliser);
    place(q, placement);
  }

  // Moves a region's group, unless the region fits it far less well there: a group that is exact by itself is not bent
  // to one around it that is not.
  void place(std::size_t region, const GroupPlacement& goal) {
    constexpr double kSamePlacement = 1e-9;
    constexpr std::size_t kQueries = 1500;
    const FoundRegion& now = regions_[region];
    const SurfaceMoments& moments = moments_[region];
    if (!contains_group(now.placement, goal, moments.centroid, moments.radius, kSamePlacement)) {
      Surface& surface = surface_of(region);
      const auto fit = [&](const GroupPlacement& placement) {
        const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
        return measure_residual(surface.patch, motions, context_, kQueries).rms;
      };
      if (!surface.fit) surface.fit = fit(now.placement);
      const double there = fit(goal);
      if (!fits_as_well(there, *surface.fit) || !holds(goal, surface.patch)) return;
      surface.fit = there;
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
  const SurfaceIndex& whole_;
  const CompletionOptions& options_;
  const RunContext& context_;
  std::vector<FoundRegion>& regions_;
  std::vector<SurfaceMoments> moments_;
  std::vector<std::vector<Motion>> tried_;  // by region
  std::mutex surfaces_mutex_;
  std::vector<std::unique_ptr<Surface>> surfaces_;  // of the regions, built when first needed
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

void complete_regions(const PreparedMesh& prepared, const SurfaceIndex& whole, const CompletionOptions& options,
                      const RunContext& context, std::vector<FoundRegion>& regions) {
  Completion(prepared, whole, options, context, regions).run();
}

}  // namespace orbifit
