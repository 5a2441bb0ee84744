#include "scan/seen_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMaxViews = 64;
// Of the reach: what stands nearer before a point is the same surface, which need not lie where it should. Where points
// are pulled less is: what any part of the template hides there must not be.
constexpr double kSameSurface = 0.5;
constexpr double kSameSurfacePulled = 0.05;

// The points of each viewpoint; viewpoints of moving scanners, one a point, are not told apart.
std::vector<std::pair<Vector3d, std::vector<int>>> points_by_viewpoint(const Points& points, const Points& viewpoints) {
  std::vector<std::pair<Vector3d, std::vector<int>>> result;
  if (viewpoints.rows() == 0) return result;
  std::map<std::tuple<double, double, double>, std::size_t> known;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Vector3d eye = viewpoints.row(viewpoints.rows() == 1 ? 0 : i);
    const auto [at, fresh] = known.try_emplace({eye.x(), eye.y(), eye.z()}, result.size());
    if (fresh) {
      if (result.size() == kMaxViews) return {};
      result.push_back({eye, {}});
    }
    result[at->second].second.push_back(static_cast<int>(i));
  }
  return result;
}

}  // namespace

SeenSurface::SeenSurface(const PointCloud& scan, const Points& kept) : index_(kept) {
  const Points& points = scan.points;
  constexpr double kPointsInAPixel = 4;
  for (const auto& [eye, seen] : points_by_viewpoint(points, scan.viewpoints)) {
    Vector3d forwards = Vector3d::Zero();
    for (const int i : seen) forwards += points.row(i).transpose() - eye;
    if (!(forwards.norm() > 0)) continue;
    View view;
    view.eye = eye;
    view.frame.col(2) = forwards.normalized();
    view.frame.col(0) = view.frame.col(2).unitOrthogonal();
    view.frame.col(1) = view.frame.col(2).cross(view.frame.col(0));
    view.half_width = 1e-6;
    for (const int i : seen) {
      const Vector3d local = view.frame.transpose() * (points.row(i).transpose() - eye);
      if (local.z() > 0)
        view.half_width = std::max({view.half_width, std::abs(local.x() / local.z()), std::abs(local.y() / local.z())});
    }
    view.half_width = std::min(view.half_width * 1.001, 3.0);
    view.pixels = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(seen.size()) / kPointsInAPixel)), 8, 160);
    const auto count = static_cast<std::size_t>(view.pixels) * static_cast<std::size_t>(view.pixels);
    view.nearest.assign(count, std::numeric_limits<float>::infinity());
    view.farthest.assign(count, 0);
    for (const int i : seen) {
      const int pixel = view.pixel_of(points.row(i));
      if (pixel < 0) continue;
      const auto depth = static_cast<float>((points.row(i).transpose() - eye).norm());
      float& nearest = view.nearest[static_cast<std::size_t>(pixel)];
      float& farthest = view.farthest[static_cast<std::size_t>(pixel)];
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
    views_.push_back(std::move(view));
  }
}

int SeenSurface::View::pixel_of(const Vector3d& point) const {
  const Vector3d local = frame.transpose() * (point - eye);
  if (!(local.z() > 0)) return -1;
  const auto place = [&](double tangent) {
    return static_cast<int>(std::floor((tangent / half_width + 1) / 2 * pixels));
  };
  const int x = place(local.x() / local.z());
  const int y = place(local.y() / local.z());
  return x < 0 || y < 0 || x >= pixels || y >= pixels ? -1 : y * pixels + x;
}

SeenSurface::Sight SeenSurface::look(const View& view, const Vector3d& point, double reach) const {
  const int pixel = view.pixel_of(point);
  if (pixel < 0) return Sight::hidden;  // out of the picture: nothing can be said
  const auto at = static_cast<std::size_t>(pixel);
  const double depth = (point - view.eye).norm();
  if (view.farthest[at] == 0) return Sight::nothing;
  return depth - reach > view.nearest[at] ? Sight::hidden : Sight::through;
}

bool SeenSurface::through(const Vector3d& point, double reach) const {
  return std::ranges::any_of(views_, [&](const View& view) { return look(view, point, reach) == Sight::through; });
}

// What viewpoints saw that have the point before them, and yet did not see it: the most certain. The template itself
// may stand in between.
SeenSurface::Sight SeenSurface::expected(const Vector3d& own, const Vector3d& normal, const Occluder& surface,
                                         const Similarity& pose, double reach, double same) const {
  constexpr double kGrazing = 0.25;  // cosine: flatter rays see little
  const Vector3d point = pose(own);
  const Similarity back = inverse(pose);
  Sight result = Sight::hidden;
  for (const View& view : views_) {
    const Vector3d ray = back(view.eye) - own;
    const double distance = ray.norm();
    if (std::abs(ray.dot(normal)) < kGrazing * distance) continue;
    const Sight sight = look(view, point, reach);
    if (sight <= result) continue;
    const double start = same * reach / pose.scale;
    if (start >= distance || !surface.occluded(own, ray, start, distance)) result = sight;
    if (result == Sight::through) break;
  }
  return result;
}

double SeenSurface::Coverage::share() const {
  if (seen == 0) return 0;
  // A corner of a template that is far too large may be all that is in the picture.
  constexpr double kFair = 0.2;
  return static_cast<double>(seen) / (seen + through + nothing) *
         std::min(1.0, static_cast<double>(seen) / (kFair * samples));
}

double SeenSurface::Coverage::cut_off() const {
  return nothing > kCutOff * seen && seen > 0 ? static_cast<double>(nothing) / (seen + through + nothing) : 0;
}

SeenSurface::Coverage SeenSurface::Coverage::without_cut_off() const {
  Coverage result = *this;
  if (cut_off() > 0) result.nothing = 0;
  return result;
}

SeenSurface::Coverage SeenSurface::coverage(const SurfaceSamples& samples, const Occluder& surface,
                                            const Similarity& pose, double reach) const {
  Coverage result;
  result.samples = static_cast<int>(samples.points.rows());
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    const Vector3d own = samples.points.row(i);
    if (index_.any_within(pose(own), reach)) {
      ++result.seen;
      continue;
    }
    const Sight sight =
        views_.empty() ? Sight::nothing : expected(own, samples.normals.row(i), surface, pose, reach, kSameSurface);
    if (sight == Sight::through) ++result.through;
    if (sight == Sight::nothing) ++result.nothing;
  }
  return result;
}

SeenSurface::Look SeenSurface::look(const SurfaceSamples& samples, const Occluder& surface, const Similarity& pose,
                                    double reach, const RunContext& context) const {
  if (views_.empty()) return {};
  std::vector<Missed> all(static_cast<std::size_t>(samples.points.rows()));
  std::vector<char> seen(all.size(), 0);
  parallel_for(context, all.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Vector3d own = samples.points.row(row);
      if (index_.any_within(pose(own), reach)) {
        seen[i] = 1;
        continue;
      }
      const Sight sight = expected(own, samples.normals.row(row), surface, pose, reach, kSameSurfacePulled);
      if (sight == Sight::hidden) continue;
      const PointIndex::Neighbour near = index_.nearest(pose(own));
      all[i] = {static_cast<int>(i), near.index, near.distance, sight == Sight::through};
    }
  });
  std::erase_if(all, [](const Missed& each) { return each.sample < 0; });
  return {std::move(all), static_cast<int>(std::ranges::count(seen, 1))};
}

}  // namespace orbifit
