#include "search/plane_regions.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "search/line_region_search.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kSlides = 0.2;        // sine of the angle between a normal and the mirror plane
constexpr double kMinSpeaking = 0.05;  // of what a mirror keeps: else the mirror may be anywhere
constexpr Eigen::Index kVoters = 700;
constexpr double kNormals = 0.15;  // by how much mirrored normals may differ
constexpr Eigen::Index kFirstLook = 64;
constexpr Eigen::Index kSecondLook = 400;
constexpr std::size_t kMaxFound = 400;
constexpr std::size_t kMaxClimbed = 100;
constexpr std::size_t kMaxPlanes = 24;
constexpr double kSamePlace = 1.5;  // tolerances

/// The share of some samples that speak for a mirror.
class Mirrored {
 public:
  explicit Mirrored(const ScreenedSurface& surface) : surface_(surface) {}

  bool keeps(Eigen::Index i, const Line& plane, bool& slides) const {
    const Vector3d point = surface_.samples.points.row(i);
    const Vector3d normal = surface_.samples.normals.row(i);
    const double across = plane.direction.dot(normal);
    slides = std::abs(across) <= kSlides || holds_ball_of(i, plane);
    const Vector3d image = point - 2 * plane.direction.dot(point - plane.point) * plane.direction;
    return surface_.grid.holds(image, normal - 2 * across * plane.direction);
  }

  // Spread evenly over the samples; gives up where the share cannot be reached any more.
  double share(const Line& plane, Eigen::Index looks, double least) const {
    const Eigen::Index count = surface_.samples.points.rows();
    looks = std::min(looks, count);
    Eigen::Index kept = 0;
    for (Eigen::Index k = 0; k < looks; ++k) {
      bool slides = false;
      if (keeps(k * count / looks, plane, slides) && !slides) ++kept;
      if (static_cast<double>(kept + looks - k - 1) < least * static_cast<double>(looks)) return 0;
    }
    return static_cast<double>(kept) / static_cast<double>(looks);
  }

  // How many of some samples the mirror keeps, whether they speak for it or not.
  int kept(const Line& plane, Eigen::Index looks) const {
    const Eigen::Index count = surface_.samples.points.rows();
    looks = std::min(looks, count);
    int result = 0;
    for (Eigen::Index k = 0; k < looks; ++k) {
      bool slides = false;
      result += keeps(k * count / looks, plane, slides) ? 1 : 0;
    }
    return result;
  }

  // Whether the sample is one of a ball that the mirror keeps anyhow.
  bool holds_ball_of(Eigen::Index i, const Line& plane) const {
    constexpr double kNear = 2;  // tolerances
    const Ball* ball = ball_of(i);
    return ball != nullptr && std::abs(plane.direction.dot(ball->centre - plane.point)) < kNear * surface_.tolerance;
  }

  const Ball* ball_of(Eigen::Index i) const {
    const auto face = static_cast<std::size_t>(surface_.samples.faces[static_cast<std::size_t>(i)]);
    const int ball = surface_.balls.ball_of_face[face];
    return ball < 0 ? nullptr : &surface_.balls.all[static_cast<std::size_t>(ball)];
  }

 private:
  const ScreenedSurface& surface_;
};

// Whether the axis lies in the plane, roughly.
bool holds(const Line& plane, const Line& axis, double tolerance) {
  return std::abs(plane.direction.dot(axis.direction)) <= kSameDirection &&
         std::abs(plane.direction.dot(axis.point - plane.point)) <= 2 * tolerance;
}

// Tilts and shifts the plane a little wherever that keeps more of the samples, by smaller and smaller steps.
Line climbed(const Mirrored& mirrored, Line plane, double tolerance) {
  int best = mirrored.kept(plane, kSecondLook);
  for (double step = 3 * tolerance; step >= 0.4 * tolerance; step *= 0.5) {
    for (bool better = true; better;) {
      better = false;
      const GroupFrame frame = frame_about(plane.direction);
      for (const Vector3d& way : {Vector3d(0, 0, step), Vector3d(0, 0, -step), Vector3d(2 * step, 0, 0),
                                  Vector3d(-2 * step, 0, 0), Vector3d(0, 2 * step, 0), Vector3d(0, -2 * step, 0)}) {
        const Vector3d direction = (frame * Vector3d(way[0], way[1], 1)).normalized();
        const Line next{plane.point + way[2] * plane.direction, direction};
        const int kept = mirrored.kept(next, kSecondLook);
        if (kept <= best) continue;
        best = kept;
        plane = next;
        better = true;
        break;
      }
    }
  }
  return plane;
}

// The planes through an axis that mirror most of what does not turn about it: angles are tried one by one. A handle on
// a cup has few samples of which two are mirror images, but the axis is known.
std::vector<CandidateLine> planes_through(const ScreenedSurface& surface, const Mirrored& mirrored, const Line& axis,
                                          double least_share, const RunContext& context) {
  constexpr std::size_t kMaxLooks = 400;
  constexpr std::size_t kMaxOfAxis = 4;
  constexpr double kStep = 0.5;     // tolerances, at the farthest
  constexpr double kRoughly = 0.5;  // of the least share: planes that are a little off keep less
  constexpr double kMostly = 0.4;   // of what does not turn: one plane of many keeps something by chance;
  constexpr double kSome = 0.15;    // where most of the surface turns about the axis, this is no chance
  std::vector<Eigen::Index> open;
  double radius = 0;
  const Eigen::Index count = surface.samples.points.rows();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector3d point = surface.samples.points.row(i);
    if (meets(axis, point, surface.samples.normals.row(i))) continue;
    open.push_back(i);
    radius = std::max(radius, axis.direction.cross(point - axis.point).norm());
  }
  const double each = surface.prepared.area / static_cast<double>(count);  // area of a sample
  if (static_cast<double>(open.size()) * each < least_share * surface.prepared.area) return {};
  const std::size_t looks = std::min(open.size(), kMaxLooks);
  const double weight = static_cast<double>(open.size()) / static_cast<double>(looks) * each;
  const auto steps = static_cast<std::size_t>(std::ceil(std::numbers::pi * radius / (kStep * surface.tolerance)));
  const bool mostly_turned = 2 * static_cast<Eigen::Index>(open.size()) < count;
  const double least_kept = (mostly_turned ? kSome : kMostly) * static_cast<double>(looks);
  const GroupFrame frame = frame_about(axis.direction);
  const auto plane_at = [&](std::size_t step) {
    const double angle = std::numbers::pi * static_cast<double>(step) / static_cast<double>(steps);
    return Line{axis.point, frame.col(0) * std::cos(angle) + frame.col(1) * std::sin(angle)};
  };
  std::vector<std::size_t> kept(steps, 0);
  parallel_for(context, steps, [&](std::size_t begin, std::size_t end) {
    for (std::size_t step = begin; step < end; ++step) {
      const Line plane = plane_at(step);
      for (std::size_t k = 0; k < looks; ++k) {
        bool slides = false;
        if (mirrored.keeps(open[k * open.size() / looks], plane, slides) && !slides) ++kept[step];
      }
    }
  });
  std::vector<CandidateLine> result;
  while (steps > 0 && result.size() < kMaxOfAxis) {
    const auto best = static_cast<std::size_t>(std::ranges::max_element(kept) - kept.begin());
    const double area = weight * static_cast<double>(kept[best]);
    if (static_cast<double>(kept[best]) < least_kept) break;
    if (area < kRoughly * least_share * surface.prepared.area) break;
    result.push_back({plane_at(best), area});
    constexpr std::size_t kBeside = 5;  // steps, to either side
    for (std::size_t k = steps - std::min(kBeside, steps - 1); k <= steps + kBeside; ++k) kept[(best + k) % steps] = 0;
  }
  return result;
}

bool same_plane(const Line& a, const Line& b, double tolerance) {
  return a.direction.cross(b.direction).norm() < kSameDirection &&
         std::abs((a.point - b.point).dot(b.direction)) < kSamePlace * tolerance;
}

// Planes midway between one of the samples that vote and later ones, where both are mirror images and the first samples
// do not deny it.
std::vector<Line> planes_of_voter(const ScreenedSurface& surface, const Mirrored& mirrored,
                                  const std::vector<Line>& turning, double least_share, Eigen::Index a,
                                  Eigen::Index voters) {
  const Eigen::Index count = surface.samples.points.rows();
  std::vector<Line> result;
  const Vector3d p = surface.samples.points.row(a * count / voters);
  const Vector3d m = surface.samples.normals.row(a * count / voters);
  for (Eigen::Index b = a + 1; b < voters; ++b) {
    const Vector3d apart = surface.samples.points.row(b * count / voters).transpose() - p;
    const double distance = apart.norm();
    if (distance < 10 * surface.tolerance) continue;
    const Vector3d normal = apart / distance;
    const double across = normal.dot(m);
    if (std::abs(across) <= kSlides) continue;
    const Vector3d other = surface.samples.normals.row(b * count / voters);
    if ((m - 2 * across * normal - other).squaredNorm() > kNormals * kNormals) continue;
    const Line plane{p + 0.5 * apart, normal};
    if (mirrored.holds_ball_of(a * count / voters, plane)) continue;
    // That a surface turned about an axis is mirrored in planes through it is no news.
    if (std::ranges::any_of(
            turning, [&](const Line& axis) { return holds(plane, axis, surface.tolerance) && meets(axis, p, m); })) {
      continue;
    }
    if (mirrored.share(plane, kFirstLook, least_share) > 0) result.push_back(plane);
  }
  return result;
}

// Of all who vote, in their order, those planes that keep enough of the surface.
std::vector<CandidateLine> voted_planes(const ScreenedSurface& surface, const Mirrored& mirrored,
                                        const std::vector<Line>& turning, double least_share,
                                        const RunContext& context) {
  const Eigen::Index voters = std::min(kVoters, surface.samples.points.rows());
  std::vector<std::vector<Line>> votes(static_cast<std::size_t>(voters));
  parallel_for(context, votes.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) {
      context.check();
      votes[a] = planes_of_voter(surface, mirrored, turning, least_share, static_cast<Eigen::Index>(a), voters);
    }
  });
  std::vector<CandidateLine> found;
  for (const std::vector<Line>& planes : votes) {
    context.check();
    for (const Line& plane : planes) {
      if (found.size() >= kMaxFound) return found;
      if (std::ranges::any_of(
              found, [&](const CandidateLine& known) { return same_plane(plane, known.line, surface.tolerance); })) {
        continue;
      }
      const double share = mirrored.share(plane, kSecondLook, least_share);
      if (share >= least_share) found.push_back({plane, share * surface.prepared.area});
    }
  }
  return found;
}

// Those of most weight, moved to where they keep most; by weight.
std::vector<CandidateLine> climbed_planes(std::vector<CandidateLine> found, const ScreenedSurface& surface,
                                          const Mirrored& mirrored, const RunContext& context) {
  std::ranges::stable_sort(found, std::greater<>(), &CandidateLine::weight);
  if (found.size() > kMaxClimbed) found.resize(kMaxClimbed);
  parallel_for(context, found.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      found[k].line = climbed(mirrored, found[k].line, surface.tolerance);
      found[k].weight = mirrored.share(found[k].line, kSecondLook, 0) * surface.prepared.area;
    }
  });
  std::ranges::stable_sort(found, std::greater<>(), &CandidateLine::weight);
  return found;
}

}  // namespace

std::vector<CandidateLine> mirror_planes(const ScreenedSurface& surface, const std::vector<Line>& turning,
                                         double least_share, const RunContext& context) {
  const Mirrored mirrored(surface);
  const std::vector<CandidateLine> found =
      climbed_planes(voted_planes(surface, mirrored, turning, least_share, context), surface, mirrored, context);
  std::vector<CandidateLine> distinct;
  const auto is_known = [&](const CandidateLine& plane) {
    return std::ranges::any_of(distinct, [&](const CandidateLine& other) {
      return same_plane(plane.line, other.line, 2 * surface.tolerance);
    });
  };
  for (const Line& axis : turning) {
    context.check();
    for (const CandidateLine& plane : planes_through(surface, mirrored, axis, least_share, context)) {
      if (!is_known(plane)) distinct.push_back(plane);
    }
  }
  const std::size_t most = kMaxPlanes + distinct.size();
  for (const CandidateLine& plane : found) {
    if (distinct.size() >= most) break;
    // Climbed to where most turns: planes through an axis are there already.
    if (std::ranges::any_of(turning, [&](const Line& axis) { return holds(plane.line, axis, surface.tolerance); })) {
      continue;
    }
    if (!is_known(plane)) distinct.push_back(plane);
  }
  return distinct;
}

std::vector<FoundRegion> find_plane_regions(const ScreenedSurface& surface, const SurfaceIndex& whole,
                                            const std::vector<CandidateLine>& planes, const std::vector<Line>& turning,
                                            const std::vector<FoundRegion>& known, const LineRegionOptions& options,
                                            const RunContext& context) {
  LineRegionSearch search(surface, whole, known, options, context);
  for (const Line& axis : turning) search.add_turning_axis(axis);
  const Mirrored mirrored(surface);
  const Eigen::Index count = surface.samples.points.rows();
  // Whether enough of the surface speaks for the mirror that no region found says yet.
  const auto worth_a_look = [&](const Line& plane, const GroupPlacement& mirror) {
    const std::vector<char> explained = search.explained(mirror);
    Eigen::Index evidence = 0;
    Eigen::Index speaking = 0;
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      bool slides = false;
      if (!mirrored.keeps(i, plane, slides)) continue;
      ++kept;
      if (slides) continue;
      ++speaking;
      if (explained[static_cast<std::size_t>(i)] == 0) ++evidence;
    }
    return static_cast<double>(evidence) >= options.least_share * static_cast<double>(count) &&
           static_cast<double>(speaking) >= kMinSpeaking * static_cast<double>(kept);
  };
  search.consider_all<std::size_t>(0, [&](std::size_t& k) -> std::optional<LineRegionSearch::Candidate> {
    for (; k < planes.size(); ++k) {
      context.progress("planes", static_cast<double>(k) / static_cast<double>(planes.size()));
      const Line& plane = planes[k].line;
      const GroupPlacement mirror{{Family::Cs, 1}, frame_about(plane.direction), plane.point};
      if (!worth_a_look(plane, mirror)) continue;
      ++k;
      return LineRegionSearch::Candidate{"planes", mirror, true};
    }
    return std::nullopt;
  });
  return search.take();
}

}  // namespace orbifit
