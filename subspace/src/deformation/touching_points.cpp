#include "deformation/touching_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <unordered_set>

#include <Eigen/Geometry>

#include "symmetry/moving_surface.h"

namespace orbifit {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Vector3d;

constexpr int kMaxPieces = 16;  // into which a side of a large face is cut

AlignedBox3d box_of(const Mesh& mesh, int face) {
  AlignedBox3d box;
  for (int k = 0; k < 3; ++k) box.extend(mesh.vertices.row(mesh.faces(face, k)).transpose());
  return box;
}

AlignedBox3d grown(const AlignedBox3d& box, double by) {
  return {box.min().array() - by, box.max().array() + by};
}

// Pairs of parts whose boxes come within the tolerance of one another, ascending.
std::vector<std::array<int, 2>> near_pairs(const std::vector<AlignedBox3d>& boxes, double tolerance) {
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  const auto low = [&](int part) { return boxes[static_cast<std::size_t>(part)].min().x(); };
  std::ranges::stable_sort(order, [&](int a, int b) { return low(a) < low(b); });
  std::vector<std::array<int, 2>> pairs;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const AlignedBox3d reach = grown(boxes[static_cast<std::size_t>(order[i])], tolerance);
    for (std::size_t j = i + 1; j < order.size() && low(order[j]) <= reach.max().x(); ++j) {
      if (!reach.intersects(boxes[static_cast<std::size_t>(order[j])])) continue;
      pairs.push_back({std::min(order[i], order[j]), std::max(order[i], order[j])});
    }
  }
  std::ranges::sort(pairs);
  return pairs;
}

// Into how many pieces the sides of a face are cut.
int pieces_of(double longest, double spacing) {
  return std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, kMaxPieces);
}

}  // namespace

struct TouchingSearch::Part {
  std::vector<int> faces;
  AlignedBox3d box;
  std::unique_ptr<MovingSurface> surface;
};

// What two parts have of one another.
struct TouchingSearch::Found {
  double spacing = 0;
  std::vector<double> longest;  // side of each face that was looked from
  std::vector<TouchingPoints> touching;

  bool holds_for(double other) const {
    return spacing == other || (spacing > 0 && std::ranges::all_of(longest, [&](double length) {
                                  return pieces_of(length, spacing) == pieces_of(length, other);
                                }));
  }
};

// Looks from one part at another.
class TouchingSearch::OfPart {
 public:
  OfPart(const Mesh& mesh, const Part& from, const Part& to, double tolerance, double spacing, Found& found)
      : mesh_(mesh), from_(from), to_(to), tolerance_(tolerance), spacing_(spacing), found_(found) {}

  void run(const std::array<int, 2>& parts, bool swapped) {
    parts_ = parts;
    swapped_ = swapped;
    const AlignedBox3d reach = grown(to_.box, tolerance_);
    for (const int face : from_.faces) {
      if (!reach.intersects(box_of(mesh_, face)) || !near(face)) continue;
      look_from_points(face, reach);
      for (int k = 0; k < 3; ++k) look_along_edge(face, k);
    }
  }

 private:
  Vector3d corner(int face, int k) const { return mesh_.vertices.row(mesh_.faces(face, k)).transpose(); }

  Vector3d at(const FacePoint& point) const {
    return point.barycentric[0] * corner(point.face, 0) + point.barycentric[1] * corner(point.face, 1) +
           point.barycentric[2] * corner(point.face, 2);
  }

  void add(const FacePoint& own, const FacePoint& other) {
    TouchingPoints touching;
    touching.parts = parts_;
    touching.points = {own, other};
    if (swapped_) std::swap(touching.points[0], touching.points[1]);
    const Vector3d first = at(touching.points[0]);
    const Vector3d second = at(touching.points[1]);
    touching.middle = 0.5 * (first + second);
    touching.gap = first - second;
    found_.touching.push_back(touching);
  }

  // Whether any of the face may touch.
  bool near(int face) const {
    const Vector3d centre = (corner(face, 0) + corner(face, 1) + corner(face, 2)) / 3;
    double radius = 0;
    for (int k = 0; k < 3; ++k) radius = std::max(radius, (corner(face, k) - centre).norm());
    return to_.surface->within(centre, radius + tolerance_, likely_);
  }

  // Corners, and a lattice of points between them where the face is large.
  void look_from_points(int face, const AlignedBox3d& reach) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (corner(face, k) - corner(face, (k + 1) % 3)).norm());
    found_.longest.push_back(longest);
    const int pieces = pieces_of(longest, spacing_);
    for (int i = 0; i <= pieces; ++i) {
      for (int j = 0; i + j <= pieces; ++j) {
        const FacePoint own{face, Vector3d(i, j, pieces - i - j) / pieces};
        Index corner_number = 0;
        if (own.barycentric.maxCoeff(&corner_number) == 1 &&
            !vertices_.insert(mesh_.faces(face, corner_number)).second) {
          continue;
        }
        const Vector3d point = at(own);
        if (!reach.contains(point)) continue;
        const MovingSurface::Nearest nearest = to_.surface->nearest(point, tolerance_, likely_);
        if (nearest.face < 0) continue;
        likely_ = nearest.place;
        add(own, {nearest.face, nearest.barycentric});
      }
    }
  }

  void look_along_edge(int face, int k) {
    constexpr int kMaxCrossings = 64;  // an edge that meets more lies along a surface
    const auto ends = std::minmax(mesh_.faces(face, k), mesh_.faces(face, (k + 1) % 3));
    if (!edges_.insert((static_cast<std::uint64_t>(ends.first) << 32) + static_cast<std::uint64_t>(ends.second))
             .second) {
      return;
    }
    const Vector3d start = corner(face, k);
    const Vector3d along = corner(face, (k + 1) % 3) - start;
    const double length = along.norm();
    if (!(length > 0)) return;
    double from = 0;
    for (int crossing = 0; crossing < kMaxCrossings && from <= length; ++crossing) {
      if (!to_.surface->occluded(start, along, from, length)) return;
      const int hit = to_.surface->first_hit(start, along, from);
      if (hit < 0) return;
      const Vector3d normal = face_normal(mesh_, hit);
      const double slope = normal.dot(along);
      const double share = std::clamp(normal.dot(corner(hit, 0) - start) / slope, 0.0, 1.0);
      if (!std::isfinite(share)) return;
      FacePoint own{face, Vector3d::Zero()};
      own.barycentric[k] = 1 - share;
      own.barycentric[(k + 1) % 3] = share;
      const Vector3d point = start + share * along;
      const Vector3d other = nearest_on_triangle(point, corner(hit, 0), corner(hit, 1), corner(hit, 2));
      add(own, {hit, other});
      from = std::max(from, share * length) + 1e-6 * length;
    }
  }

  const Mesh& mesh_;
  const Part& from_;
  const Part& to_;
  double tolerance_, spacing_;
  Found& found_;
  std::array<int, 2> parts_{};
  bool swapped_ = false;
  int likely_ = -1;
  std::unordered_set<int> vertices_;         // looked from
  std::unordered_set<std::uint64_t> edges_;  // looked along: both ends
};

TouchingSearch::TouchingSearch(const Mesh& mesh, const std::vector<int>& part_of_face, double tolerance,
                               const RunContext& context)
    : mesh_(mesh), tolerance_(tolerance) {
  std::vector<AlignedBox3d> boxes;
  for (std::size_t f = 0; f < part_of_face.size(); ++f) {
    const auto part = static_cast<std::size_t>(part_of_face[f]);
    if (parts_.size() <= part) parts_.resize(part + 1);
    parts_[part].faces.push_back(static_cast<int>(f));
    parts_[part].box.extend(box_of(mesh, static_cast<int>(f)));
  }
  for (const Part& part : parts_) boxes.push_back(part.box);
  pairs_ = near_pairs(boxes, tolerance);
  std::vector<char> asked(parts_.size(), 0);
  for (const auto& pair : pairs_) {
    for (const int part : pair) asked[static_cast<std::size_t>(part)] = 1;
  }
  parallel_for(context, parts_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (asked[p] != 0) parts_[p].surface = std::make_unique<MovingSurface>(mesh, parts_[p].faces);
    }
  });
  known_ = std::make_shared<const std::vector<Found>>(pairs_.size());
}

TouchingSearch::~TouchingSearch() = default;

std::vector<TouchingPoints> TouchingSearch::points(double spacing, const RunContext& context) const {
  std::shared_ptr<const std::vector<Found>> known;
  {
    const std::lock_guard lock(mutex_);
    known = known_;
  }
  auto found = std::make_shared<std::vector<Found>>(pairs_.size());
  parallel_for(context, pairs_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      context.check();
      Found& now = (*found)[i];
      if ((*known)[i].holds_for(spacing)) {
        now = (*known)[i];
        continue;
      }
      now.spacing = spacing;
      const Part& a = parts_[static_cast<std::size_t>(pairs_[i][0])];
      const Part& b = parts_[static_cast<std::size_t>(pairs_[i][1])];
      OfPart(mesh_, a, b, tolerance_, spacing, now).run(pairs_[i], false);
      OfPart(mesh_, b, a, tolerance_, spacing, now).run(pairs_[i], true);
    }
  });
  std::vector<TouchingPoints> result;
  for (const Found& some : *found) result.insert(result.end(), some.touching.begin(), some.touching.end());
  const std::lock_guard lock(mutex_);
  known_ = std::move(found);
  return result;
}

std::vector<TouchingPoints> touching_points(const Mesh& mesh, const std::vector<int>& part_of_face, double tolerance,
                                            double spacing, const RunContext& context) {
  return TouchingSearch(mesh, part_of_face, tolerance, context).points(spacing, context);
}

}  // namespace orbifit
