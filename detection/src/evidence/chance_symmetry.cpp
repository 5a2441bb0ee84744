#include "evidence/chance_symmetry.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/dense.h"
#include "group/verification.h"
#include "surface/thresholds.h"

namespace orbifit {

bool flat(const SurfaceMoments& moments, double tolerance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] < std::pow(0.25 * tolerance_of_part(tolerance, moments.diagonal), 2);
}

bool flat_mirror_only(const SurfaceMoments& moments, const GroupPlacement& placement, double tolerance) {
  if (placement.group.family != PointGroup::Family::Cs) return false;
  const Eigen::Vector3d normal = placement.frame.col(2);
  return normal.dot(moments.covariance * normal) < std::pow(0.5 * tolerance * moments.diagonal, 2);
}

bool mere_pair(const std::vector<int>& parts, const std::vector<CongruenceClass>& kinds) {
  if (parts.size() != 2) return false;
  return std::ranges::any_of(kinds, [&](const CongruenceClass& kind) {
    return kind.members.size() > 2 && std::ranges::includes(kind.members, parts);
  });
}

std::vector<std::size_t> kinds_of_a_row(const std::vector<int>& parts, const std::vector<CongruenceClass>& kinds,
                                        const std::vector<SurfaceMoments>& moments) {
  constexpr std::size_t kRow = 5;
  constexpr double kMax = 0.5;
  const auto area_of = [&](int part) { return moments[static_cast<std::size_t>(part)].area; };
  double all = 0;
  for (const int part : parts) all += area_of(part);
  double in_rows = 0;
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const std::vector<int>& members = kinds[k].members;
    if (members.size() < kRow) continue;
    std::vector<int> common;
    std::ranges::set_intersection(parts, members, std::back_inserter(common));
    if (common.size() < 2 || common.size() == members.size()) continue;
    for (const int part : common) in_rows += area_of(part);
    result.push_back(k);
  }
  if (in_rows <= kMax * all) result.clear();
  return result;
}

bool some_of_a_grid(const PointGroup& group, const std::vector<int>& parts, const std::vector<CongruenceClass>& kinds,
                    const std::vector<SurfaceMoments>& moments) {
  constexpr std::size_t kGrid = 8;    // members of a kind
  constexpr std::size_t kFew = 6;     // of them in the region
  constexpr double kNearlyAll = 0.8;  // of them
  constexpr double kMax = 0.7;        // of the region's area
  if (group.continuous() || !group.has_axis() || group.n > 2 || group.order() > 8) return false;
  const auto area_of = [&](int part) { return moments[static_cast<std::size_t>(part)].area; };
  double all = 0;
  for (const int part : parts) all += area_of(part);
  double scattered = 0;
  for (const CongruenceClass& kind : kinds) {
    if (kind.members.size() < kGrid) continue;
    std::vector<int> common;
    std::ranges::set_intersection(parts, kind.members, std::back_inserter(common));
    if (common.size() < kFew ||
        static_cast<double>(common.size()) >= kNearlyAll * static_cast<double>(kind.members.size()))
      continue;
    for (const int part : common) scattered += area_of(part);
  }
  return scattered > kMax * all;
}

std::optional<RevolutionFit> revolution_of(const SurfacePatch& patch) {
  return fit_axis_of_revolution(patch.samples.points, patch.samples.normals, {}, kRevolutionAngle);
}

bool turned(const RevolutionFit& fit) {
  constexpr double kTurned = 0.95;
  return fit.inliers > kTurned;
}

bool mere_border(const PreparedMesh& prepared, const std::vector<int>& faces, const SurfaceMoments& moments,
                 const GroupPlacement& placement, double tolerance, const RunContext& context) {
  if (flat(moments, tolerance)) return true;
  if (placement.group.continuous()) return false;
  constexpr int kSamples = 300;
  const std::optional<RevolutionFit> fit =
      revolution_of(sample_patch(prepared, faces, kSamples, tolerance, context, "slip"));
  return fit && (fit->planar || turned(*fit));
}

bool fades(const SurfacePatch& patch, const GroupPlacement& placement, const RunContext& context) {
  constexpr int kSamples = 600;
  constexpr double kStays = 0.88;        // chance leaves 0.7 to 0.86 of what it kept, symmetry 0.9 to 1
  constexpr double kStaysSurely = 0.95;  // chance has left 0.94 at half and then 0.52 at an eighth
  constexpr double kStaysInFine = 0.58;  // at an eighth: symmetry 0.64 to 1
  if (placement.group.continuous()) return false;
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  const double full = std::max(verify(patch, motions, patch.tolerance, kSamples, 0, context).joint, 1e-9);
  const auto stays = [&](double share_of_tolerance) {
    return verify(patch, motions, share_of_tolerance * patch.tolerance, kSamples, 0, context).joint / full;
  };
  const double at_half = stays(0.5);
  if (at_half < kStays || at_half >= kStaysSurely || patch.prepared->noise > 0) return at_half < kStays;
  return stays(0.125) < kStaysInFine;
}

void drop_siblings(std::vector<int>& parts, int part, const std::vector<CongruenceClass>& kinds) {
  const auto kind = std::ranges::find_if(
      kinds, [&](const CongruenceClass& each) { return std::ranges::binary_search(each.members, part); });
  if (kind == kinds.end()) return;
  std::erase_if(parts, [&](int c) { return c != part && std::ranges::binary_search(kind->members, c); });
}

}  // namespace orbifit
