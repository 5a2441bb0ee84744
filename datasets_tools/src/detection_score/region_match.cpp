#include "detection_score/region_match.h"

#include <algorithm>
#include <tuple>

namespace orbifit::scoring {

namespace {

using Eigen::Vector3d;

constexpr double kSameFaces = 0.9;      // IoU of repeated regions
constexpr double kInside = 0.95;        // of the area of a region that another one holds
constexpr double kAboutAsLarge = 0.98;  // of the area of the region that holds it
constexpr double kComparable = 0.3;     // IoU below which groups are not compared

// What agrees in direction (degrees), place (fraction of the diagonal) and faces.
struct Agreement {
  double degrees, offset, iou;
};
constexpr Agreement kStrict{1, 0.01, 0.8};
constexpr Agreement kLoose{3, 0.03, 0.6};

bool same_place(const MeasuredMesh& measured, const GroupComparison& groups) {
  return groups.axis_error <= kStrict.degrees && groups.offset <= kStrict.offset * measured.diagonal;
}

// Inside another region whose group says it all already.
bool subsumed(const MeasuredMesh& measured, const ScoredRegion& region, const ScoredRegion& large) {
  if (region.area <= 0 || large.area <= 0 || region.area > 1.02 * large.area) return false;
  if (measured.area_of(intersection(region.set, large.set)) < kInside * region.area) return false;
  const GroupComparison groups = compare_groups(region.group, large.group, region.centroid);
  return groups.contains && same_place(measured, groups);
}

}  // namespace

ScoredRegion::ScoredRegion(const MeasuredMesh& measured, const Region& given)
    : region(given), group(given), set(face_set(given.faces)), area(measured.area_of(set)) {
  const Mesh& mesh = measured.mesh;
  for (const int face : given.faces) {
    for (int k = 0; k < 3; ++k) {
      centroid += measured.areas[face] / 3 * mesh.vertices.row(mesh.faces(face, k)).transpose();
    }
  }
  centroid /= std::max(area, 1e-300);
}

double AcceptedFaces::iou(const MeasuredMesh& measured, const FaceSet& found) const {
  const double needed = measured.area_of(core);
  const double all = measured.area_of(united(core, found));
  if (sets.size() == 1 || needed <= 0 || all <= 0) {
    double best = 0;
    for (const FaceSet& set : sets) best = std::max(best, measured.iou(set, found));
    return best;
  }
  return std::min(measured.area_of(intersection(found, full)) / all,
                  measured.area_of(intersection(found, core)) / needed);
}

AcceptedFaces accepted_faces(const Region& region, const DetectionTruth& truth) {
  AcceptedFaces result;
  result.sets.push_back(face_set(region.faces));
  if (const auto further = truth.also_accepted.find(region.id); further != truth.also_accepted.end()) {
    for (const std::vector<int>& faces : further->second) result.sets.push_back(face_set(faces));
  }
  result.core = result.full = result.sets.front();
  for (const FaceSet& set : result.sets) {
    result.core = intersection(result.core, set);
    result.full = united(result.full, set);
  }
  return result;
}

bool RegionMatch::better_than(const RegionMatch& other) const {
  return std::tie(strict, loose, iou) > std::tie(other.strict, other.loose, other.iou);
}

RegionMatch match_regions(const MeasuredMesh& measured, const ScoredRegion& expected, const AcceptedFaces& accepted,
                          const ScoredRegion& found) {
  RegionMatch match;
  match.iou = accepted.iou(measured, found.set);
  if (match.iou < kComparable) return match;
  const GroupComparison groups = compare_groups(expected.group, found.group, expected.centroid);
  const double offset = groups.offset / measured.diagonal;
  match.axis_error = groups.axis_error;
  match.offset_error = offset;
  const auto within = [&](const Agreement& limits) {
    return groups.axis_error <= limits.degrees && offset <= limits.offset && match.iou >= limits.iou;
  };
  match.strict = groups.same && within(kStrict);
  match.loose = (groups.contains || groups.half) && within(kLoose);
  match.modest = match.loose && (groups.same || groups.half);
  return match;
}

bool repeats(const MeasuredMesh& measured, const ScoredRegion& region, const ScoredRegion& other,
             bool other_is_earlier) {
  const bool same_group = region.region.group == other.region.group;
  if (other_is_earlier && same_group && measured.iou(region.set, other.set) > kSameFaces &&
      same_place(measured, compare_groups(region.group, other.group, region.centroid))) {
    return true;
  }
  const bool first_of_equals = !other_is_earlier && same_group && region.area >= kAboutAsLarge * other.area;
  return !first_of_equals && subsumed(measured, region, other);
}

}  // namespace orbifit::scoring
