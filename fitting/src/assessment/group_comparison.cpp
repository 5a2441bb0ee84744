#include "assessment/group_comparison.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "base/random.h"
#include "geometry/point_index.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "registration/correspondences.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kSeen = 0.01;        // of the diagonal: a scan point this near to the free fit
constexpr double kNear = 0.01;        // of the diagonal: an image this near to the surface is on it
constexpr double kMaxApart = 0.1;     // of the diagonal: what differences and distances count as at most
constexpr double kFirstScale = 0.2;   // of the diagonal, while the region's motion is estimated: at the start
constexpr double kLastRobust = 0.01;  // and at the end
constexpr double kMin = 0.008;        // of the diagonal: a disagreement,
constexpr double kTimesFree = 1.5;    // where the group's fit is worse than the free one by this factor
constexpr int kMinPlaces = 40;        // that say anything
constexpr int kMaxPairs = 1000;       // root means square of as many are known to a fortieth

struct Place {
  Vector3d point, normal;  // of the surface of the fit with groups
  double height = 0;       // of the free fit over it, of the diagonal
};

// A fit with groups, one without where there is one, and the scan, with what it takes to look at a place of all three.
class Comparison {
 public:
  /// \param free  null: the scan stands for it, as it lies over the fit with groups
  Comparison(const Mesh& fitted, const Mesh* free, const PreparedScan& scan, const RunContext& context)
      : fitted_(fitted),
        free_(free),
        size_(diagonal(fitted.vertices)),
        surface_(fitted),
        scan_(scan),
        scan_index_(scan.points),
        face_of_point_(static_cast<std::size_t>(scan.points.rows())),
        held_(face_of_point_.size()),
        height_(face_of_point_.size()) {
    parallel_for(context, held_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vector3d point = scan.points.row(static_cast<Eigen::Index>(i));
        const auto there = surface_.index.nearest(point);
        face_of_point_[i] = there.face;
        held_[i] = there.distance / size_;
        height_[i] = (surface_.normal(there.face).dot(point - there.point) < 0 ? -1 : 1) * held_[i];
      }
    });
    for (const double distance : held_) free_distance_.push_back(std::min(distance, kMaxApart));
    if (free == nullptr) return;
    const SurfaceIndex free_surface(*free);
    parallel_for(context, held_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto there = free_surface.nearest(scan.points.row(static_cast<Eigen::Index>(i)));
        face_of_point_[i] = there.face;
        free_distance_[i] = there.distance / size_;
      }
    });
  }

  double size() const { return size_; }
  const Mesh& fitted() const { return fitted_; }

  // False where the scan has nothing near the free fit.
  bool look(int face, const Vector3d& barycentric, Place& place) const {
    constexpr int kOverPlace = 4;  // points whose mean height is the scan's, where there is no free fit
    const auto at = [&](const Mesh& mesh) -> Vector3d {
      return mesh.vertices(mesh.faces.row(face), Eigen::all).transpose() * barycentric;
    };
    place.point = at(fitted_);
    place.normal = surface_.normal(face);
    const Vector3d free = free_ != nullptr ? at(*free_) : place.point;
    const auto near = scan_index_.nearest(free, free_ != nullptr ? 1 : kOverPlace);
    if (near.front().distance > std::max(kSeen * size_, 2 * scan_.spacing)) return false;
    if (free_ != nullptr) {
      place.height = place.normal.dot(free - place.point) / size_;
      return true;
    }
    place.height = 0;
    for (const auto& each : near) {
      place.height += height_[static_cast<std::size_t>(each.index)] / static_cast<double>(near.size());
    }
    return true;
  }

  // Where the surface is nearest to a point that an element has taken there; false where it is not, or not seen.
  bool image(const Vector3d& point, const Vector3d& normal, Place& place) const {
    constexpr double kLikeNormal = 0.85;
    const auto near = surface_.index.nearest_facing(point, normal, kLikeNormal, kNear * size_);
    return near.face >= 0 && look(near.face, near.barycentric, place);
  }

  // Root mean square distances of the scan's points whose nearest face of the free fit is one of these.
  void distances(const std::vector<char>& own, GroupAgreement& result) const {
    double held = 0;
    double free = 0;
    double count = 0;
    for (std::size_t i = 0; i < held_.size(); ++i) {
      if (own[static_cast<std::size_t>(face_of_point_[i])] == 0 || free_distance_[i] > kMaxApart) continue;
      const double there = std::min(held_[i], kMaxApart);
      held += there * there;
      free += free_distance_[i] * free_distance_[i];
      count += 1;
    }
    if (count == 0) return;
    result.held = std::sqrt(held / count);
    result.free = std::sqrt(free / count);
  }

 private:
  const Mesh& fitted_;
  const Mesh* free_;
  double size_;
  MatchSurface surface_;
  const PreparedScan& scan_;
  PointIndex scan_index_;
  std::vector<int> face_of_point_;                     // of the free fit
  std::vector<double> held_, height_, free_distance_;  // of the diagonal; the height is a distance with its side
};

std::vector<Motion> motions_of(const Region& region) {
  if (!region.elements.empty()) return {region.elements.begin() + 1, region.elements.end()};
  std::vector<Motion> result;
  const Vector3d axis = region.axis.norm() > 0.5 ? region.axis : Vector3d::UnitZ();
  constexpr int kRotations = 8;
  for (int k = 1; k <= kRotations; ++k) {  // not of the tessellation's order
    result.push_back(Motion::rotation(axis, 2 * std::numbers::pi * k / (kRotations + 0.618), region.centre));
  }
  return result;
}

// Where a region disagrees the fit with groups is off within it, which says nothing of the regions inside.
void blame_outermost(const SymmetryAnnotation& annotation, std::vector<GroupAgreement>& groups) {
  const auto index_of = [&](int id) {
    const auto at = std::ranges::find(annotation.regions, id, &Region::id);
    return static_cast<std::size_t>(at - annotation.regions.begin());
  };
  const std::vector<GroupAgreement> found = groups;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    std::optional<int> parent = annotation.regions[i].parent;
    for (std::size_t depth = 0; parent && depth < groups.size(); ++depth) {
      const std::size_t above = index_of(*parent);
      if (above == groups.size()) break;
      if (found[above].disagrees) groups[i].disagrees = false;
      parent = annotation.regions[above].parent;
    }
  }
}

// Two places whose heights should be the same.
struct Pair {
  Place first, second;

  double apart() const { return second.height - first.height; }
};

std::vector<Pair> pairs_of(const Comparison& comparison, const Region& region, Random& random,
                           const RunContext& context) {
  const std::vector<Motion> motions = motions_of(region);
  std::vector<Pair> result;
  if (motions.empty()) return result;
  const int count = std::max(kMinPlaces, kMaxPairs / static_cast<int>(motions.size()));
  const Mesh& mesh = comparison.fitted();
  const SurfaceSamples samples = sample_surface(mesh, count, random, region.faces);
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    context.check();
    const int face = samples.faces[static_cast<std::size_t>(i)];
    const auto corner = [&](int k) -> Vector3d { return mesh.vertices.row(mesh.faces(face, k)); };
    Pair pair;
    const Vector3d weights = nearest_on_triangle(samples.points.row(i), corner(0), corner(1), corner(2));
    if (!comparison.look(face, weights, pair.first)) continue;
    for (const Motion& motion : motions) {
      if (static_cast<int>(result.size()) >= kMaxPairs) return result;
      if (!comparison.image(motion(pair.first.point), motion.linear * pair.first.normal, pair.second)) continue;
      // A point on a mirror's plane is its own image.
      if ((pair.first.point - pair.second.point).norm() > kNear * comparison.size()) result.push_back(pair);
    }
  }
  return result;
}

// Takes out of the heights what a small rigid motion of the region explains of their differences.
void take_out_motion(std::vector<Pair>& pairs, double size) {
  constexpr int kRounds = 8;
  if (pairs.empty()) return;
  const Vector3d centre = pairs.front().first.point;
  const auto row_of = [&](const Place& place) {
    Vector6d row;
    row << ((place.point - centre) / size).cross(place.normal), place.normal;
    return row;
  };
  for (int round = 0; round < kRounds; ++round) {
    const double robust = kFirstScale * std::pow(kLastRobust / kFirstScale, double(round) / (kRounds - 1));
    Matrix6d matrix = Matrix6d::Zero();
    Vector6d side = Vector6d::Zero();
    for (const Pair& pair : pairs) {
      const Vector6d row = row_of(pair.second) - row_of(pair.first);
      const double weight = robust_weight(pair.apart(), robust);
      matrix += weight * row * row.transpose();
      side += weight * pair.apart() * row;
    }
    matrix.diagonal().array() += 1e-3 * matrix.trace() + 1e-12;
    const Vector6d motion = solve_semidefinite(matrix, side);
    for (Pair& pair : pairs) {
      pair.first.height -= motion.dot(row_of(pair.first));
      pair.second.height -= motion.dot(row_of(pair.second));
    }
  }
}

std::vector<GroupAgreement> agreement(const Comparison& comparison, const SymmetryAnnotation& carried,
                                      const RunContext& context) {
  std::vector<GroupAgreement> result(carried.regions.size());
  parallel_for(context, result.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<char> own(static_cast<std::size_t>(comparison.fitted().faces.rows()));
    for (std::size_t i = begin; i < end; ++i) {
      const Region& region = carried.regions[i];
      GroupAgreement& agreement = result[i];
      agreement.region = region.id;
      Random random(context.seed, "agreement");
      std::vector<Pair> pairs = pairs_of(comparison, region, random, context);
      take_out_motion(pairs, comparison.size());
      agreement.pairs = static_cast<int>(pairs.size());
      double squares = 0;
      for (const Pair& pair : pairs) squares += std::pow(std::min(kMaxApart, std::abs(pair.apart())), 2);
      if (!pairs.empty()) agreement.disagreement = std::sqrt(squares / static_cast<double>(pairs.size()));
      for (const int face : region.faces) own[static_cast<std::size_t>(face)] = 1;
      comparison.distances(own, agreement);
      for (const int face : region.faces) own[static_cast<std::size_t>(face)] = 0;
      agreement.disagrees = agreement.pairs >= kMinPlaces && agreement.disagreement > kMin &&
                            agreement.held > kTimesFree * agreement.free;
    }
  });
  blame_outermost(carried, result);
  return result;
}

}  // namespace

std::vector<GroupAgreement> group_agreement(const Mesh& fitted, const Mesh& free, const SymmetryAnnotation& carried,
                                            const PreparedScan& scan, const RunContext& context) {
  return agreement(Comparison(fitted, &free, scan, context), carried, context);
}

std::optional<std::vector<GroupAgreement>> agreement_beyond_doubt(const Mesh& fitted, const SymmetryAnnotation& carried,
                                                                  const PreparedScan& scan, const RunContext& context) {
  const Comparison comparison(fitted, nullptr, scan, context);
  std::vector<char> own(static_cast<std::size_t>(fitted.faces.rows()), 1);
  const auto may_disagree = [&] {
    GroupAgreement agreement;
    comparison.distances(own, agreement);
    return 2 * agreement.held > kMin;
  };
  if (may_disagree()) return std::nullopt;
  std::ranges::fill(own, 0);
  for (const Region& region : carried.regions) {
    for (const int face : region.faces) own[static_cast<std::size_t>(face)] = 1;
    if (may_disagree()) return std::nullopt;
    for (const int face : region.faces) own[static_cast<std::size_t>(face)] = 0;
  }
  return agreement(comparison, carried, context);
}

}  // namespace orbifit
