#include "remeshing/surface_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

#include "remeshing/plane_fit.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kReach = 2;      // cells from a triangle to its surface
constexpr double kFacing = 0.2;   // cosine between a triangle and the face that it stands for
constexpr double kUpright = 0.1;  // cosine below which a triangle counts as turned over
constexpr double kFlat = 1e-3;    // cells off the plane: a quadrangle is cut by its shape alone
constexpr double kPull = 2e-3;    // towards the middle of the neighbours, against 1 towards the planes
constexpr int kMaxRetreats = 4;

struct Plane {
  Vector3d point = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();
};

// Twice the area, along the normal.
Vector3d area_vector(const Points& vertices, int a, int b, int c) {
  const Vector3d from = vertices.row(a);
  return (vertices.row(b).transpose() - from).cross(vertices.row(c).transpose() - from);
}

// 4 sqrt(3) area / sum of squared sides: 1 for an equilateral triangle.
double shape_of(const Points& vertices, int a, int b, int c) {
  const double sides = (vertices.row(a) - vertices.row(b)).squaredNorm() +
                       (vertices.row(b) - vertices.row(c)).squaredNorm() +
                       (vertices.row(c) - vertices.row(a)).squaredNorm();
  return sides > 0 ? 2 * std::sqrt(3.0) * area_vector(vertices, a, b, c).norm() / sides : 0;
}

class Fitter {
 public:
  Fitter(const DualSurface& surface, const SurfaceIndex& target, const Points& normals, RunContext& context)
      : quads_(surface.quads),
        crossings_(surface.crossings),
        target_(target),
        normals_(normals),
        context_(context),
        first_(surface.vertices),
        vertices_(surface.vertices),
        triangles_(2 * static_cast<Index>(surface.quads.size()), 3) {
    count_faces();
  }

  Mesh operator()(int passes) {
    cut_quads();
    for (int pass = 0; pass < passes; ++pass) {
      context_.progress("fit", static_cast<double>(pass) / passes);
      find_planes();
      move_vertices();
      cut_quads();
    }
    part_coincident();
    return {vertices_, triangles_, {}};
  }

 private:
  // How many quadrangles each vertex has, to weigh its neighbours.
  void count_faces() {
    degree_.assign(static_cast<std::size_t>(vertices_.rows()), 0);
    for (const auto& quad : quads_) {
      for (const int v : quad) ++degree_[static_cast<std::size_t>(v)];
    }
  }

  double distance_to_target(const Vector3d& point) const { return target_.nearest(point, kReach).distance; }

  bool cut_from_first(const std::array<int, 4>& quad) const {
    const Vector3d a = vertices_.row(quad[0]);
    const Vector3d b = vertices_.row(quad[1]);
    const Vector3d c = vertices_.row(quad[2]);
    const Vector3d d = vertices_.row(quad[3]);
    const Vector3d across = (c - a).cross(d - b);
    const Vector3d n1 = area_vector(vertices_, quad[0], quad[1], quad[2]);
    const Vector3d n2 = area_vector(vertices_, quad[0], quad[2], quad[3]);
    const Vector3d m1 = area_vector(vertices_, quad[1], quad[2], quad[3]);
    const Vector3d m2 = area_vector(vertices_, quad[1], quad[3], quad[0]);
    // A quadrangle that is not convex has one diagonal that does not turn a triangle over.
    const bool first_turns = n1.dot(across) <= 0 || n2.dot(across) <= 0;
    const bool second_turns = m1.dot(across) <= 0 || m2.dot(across) <= 0;
    if (first_turns != second_turns) return second_turns;
    const double off_plane = std::abs((b - a).dot(across)) / std::max(across.norm(), 1e-12);
    if (off_plane > kFlat) {
      const double first = distance_to_target(0.5 * (a + c));
      const double second = distance_to_target(0.5 * (b + d));
      if (std::abs(first - second) > 0.1 * off_plane) return first < second;
    }
    const double first =
        std::min(shape_of(vertices_, quad[0], quad[1], quad[2]), shape_of(vertices_, quad[0], quad[2], quad[3]));
    const double second =
        std::min(shape_of(vertices_, quad[1], quad[2], quad[3]), shape_of(vertices_, quad[1], quad[3], quad[0]));
    return first >= second;
  }

  void cut_quads() {
    parallel_for(context_, quads_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t q = begin; q < end; ++q) {
        const auto& quad = quads_[q];
        const auto row = static_cast<Index>(2 * q);
        if (cut_from_first(quad)) {
          triangles_.row(row) << quad[0], quad[1], quad[2];
          triangles_.row(row + 1) << quad[0], quad[2], quad[3];
        } else {
          triangles_.row(row) << quad[1], quad[2], quad[3];
          triangles_.row(row + 1) << quad[1], quad[3], quad[0];
        }
      }
    });
  }

  Vector3d triangle_area(Index t) const {
    return area_vector(vertices_, triangles_(t, 0), triangles_(t, 1), triangles_(t, 2));
  }

  // The target's plane nearest to the middle of each triangle.
  void find_planes() {
    planes_.assign(static_cast<std::size_t>(triangles_.rows()), {});
    parallel_for(context_, planes_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        const auto row = static_cast<Index>(t);
        const Vector3d normal = triangle_area(row).stableNormalized();
        const Vector3d middle = (vertices_.row(triangles_(row, 0)) + vertices_.row(triangles_(row, 1)) +
                                 vertices_.row(triangles_(row, 2))) /
                                3;
        const SurfaceIndex::Nearest nearest = target_.nearest_facing(middle, normal, kFacing, kReach);
        if (nearest.face >= 0) planes_[t] = {nearest.point, normals_.row(nearest.face)};
      }
    });
  }

  void move_vertices() {
    const auto count = static_cast<std::size_t>(vertices_.rows());
    std::vector<PlaneFit> fits(count);
    Points neighbours = Points::Zero(vertices_.rows(), 3);
    for (std::size_t q = 0; q < quads_.size(); ++q) {
      for (std::size_t k = 0; k < 4; ++k) {
        const int v = quads_[q][k];
        neighbours.row(v) += 0.5 * (vertices_.row(quads_[q][(k + 1) % 4]) + vertices_.row(quads_[q][(k + 3) % 4]));
      }
    }
    for (std::size_t t = 0; t < planes_.size(); ++t) {
      if (planes_[t].normal.isZero()) continue;
      const double weight = std::clamp(0.5 * triangle_area(static_cast<Index>(t)).norm(), 0.05, 1.0);
      for (Index k = 0; k < 3; ++k) {
        fits[static_cast<std::size_t>(triangles_(static_cast<Index>(t), k))].add(planes_[t].point, planes_[t].normal,
                                                                                 weight);
      }
    }
    Points moved = vertices_;
    parallel_for(context_, count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (!(fits[v].weight() > 0)) continue;
        const auto row = static_cast<Index>(v);
        const Vector3d middle = neighbours.row(row) / degree_[v];
        const Vector3d start = 0.5 * (vertices_.row(row).transpose() + middle);
        const Vector3d at = first_.row(row);
        moved.row(row) = fits[v].nearest_to(start, at - Vector3d::Ones(), at + Vector3d::Ones(), kPull);
      }
    });
    retreat(moved);
    vertices_ = moved;
  }

  // Takes back what would turn a triangle over.
  void retreat(Points& moved) const {
    for (int pass = 0; pass < kMaxRetreats; ++pass) {
      std::vector<int> back;
      for (Index t = 0; t < triangles_.rows(); ++t) {
        const Vector3d& normal = planes_[static_cast<std::size_t>(t)].normal;
        const Vector3d area = area_vector(moved, triangles_(t, 0), triangles_(t, 1), triangles_(t, 2));
        if (normal.isZero() || area.dot(normal) > kUpright * area.norm()) continue;
        for (Index k = 0; k < 3; ++k) back.push_back(triangles_(t, k));
      }
      if (back.empty()) return;
      const double share = pass + 1 < kMaxRetreats ? 0.5 : 0;
      std::ranges::sort(back);
      back.erase(std::unique(back.begin(), back.end()), back.end());
      for (const int v : back) moved.row(v) = vertices_.row(v) + share * (moved.row(v) - vertices_.row(v));
    }
  }

  // Two vertices at the very same place would be one for whoever welds: move the later one towards its neighbours.
  void part_coincident() {
    std::vector<int> order(static_cast<std::size_t>(vertices_.rows()));
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](int v) { return std::array{vertices_(v, 0), vertices_(v, 1), vertices_(v, 2), double(v)}; };
    std::ranges::sort(order, {}, key);
    std::vector<bool> coincident(order.size(), false);
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (vertices_.row(order[i]) == vertices_.row(order[i - 1])) {
        coincident[static_cast<std::size_t>(order[i])] = true;
      }
    }
    for (std::size_t q = 0; q < quads_.size(); ++q) {
      for (const int v : quads_[q]) {
        if (!coincident[static_cast<std::size_t>(v)]) continue;
        vertices_.row(v) += 1e-3 * (crossings_[q].transpose() - vertices_.row(v));
      }
    }
  }

  const std::vector<std::array<int, 4>>& quads_;
  const std::vector<Vector3d>& crossings_;
  const SurfaceIndex& target_;
  const Points& normals_;
  RunContext& context_;
  Points first_;
  Points vertices_;
  Triangles triangles_;
  std::vector<int> degree_;    // quadrangles at each vertex
  std::vector<Plane> planes_;  // of each triangle
};

}  // namespace

Mesh fitted_triangles(const DualSurface& surface, const SurfaceIndex& target, const Points& normals, int passes,
                      RunContext& context) {
  return Fitter(surface, target, normals, context)(passes);
}

}  // namespace orbifit
