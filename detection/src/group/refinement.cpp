#include "group/refinement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "geometry/point_index.h"
#include "group/verification.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;
using Jacobian = Eigen::Matrix<double, 3, 6>;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// The motions that the refinement looks at. Generators and their inverses constrain the placement as all elements do.
std::vector<Motion> fitted_motions(const GroupPlacement& placement) {
  std::vector<Motion> result;
  if (placement.group.continuous()) {
    const std::vector<Motion> all = judged_motions(placement.group, placement.frame, placement.centre);
    const std::size_t step = std::max<std::size_t>(1, all.size() / 10);
    for (std::size_t i = 0; i < all.size(); i += step) result.push_back(all[i]);
    return result;
  }
  for (const Matrix3d& linear : generators(placement.group, placement.frame)) {
    const Motion motion = Motion::about(linear, placement.centre);
    result.push_back(motion);
    // A generator of high order moves little; a power of it that turns by about a quarter holds the axis better.
    const AxisAngle turn = axis_angle(linear);
    if (turn.angle > 1e-6 && turn.angle < 1.2) {
      const int power = static_cast<int>(std::lround(std::acos(-0.3) / turn.angle));
      Matrix3d raised = Matrix3d::Identity();
      for (int k = 0; k < power; ++k) raised = raised * linear;
      result.push_back(Motion::about(raised, placement.centre));
    }
  }
  return result;
}

// How the image of `point` under `motion` moves with a small rotation of the frame (in units of 1 / scale) and with a
// shift of the centre: d(O x + c - O c) = [a] O x - O [a] x + (1 - O) dc with x measured from the centre.
Jacobian image_jacobian(const Motion& motion, const Vector3d& from_centre, double scale) {
  Jacobian jacobian;
  jacobian.leftCols<3>() =
      (motion.linear * cross_matrix(from_centre) - cross_matrix(motion.linear * from_centre)) / scale;
  jacobian.rightCols<3>() = Matrix3d::Identity() - motion.linear;
  return jacobian;
}

struct NormalEquations {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  double weight = 0;
};

// Takes the step; directions that the data leave free (along an axis, within a plane) stay where they are.
double apply(const NormalEquations& equations, double scale, GroupPlacement& placement) {
  const double damping = 1e-9 * std::max(equations.matrix.trace(), 1e-300);
  const Vector6d step =
      solve_semidefinite(Matrix6d(equations.matrix + damping * Matrix6d::Identity()), Vector6d(-equations.right));
  Vector3d turn = step.head<3>() / scale;
  if (turn.norm() > 0.3) turn *= 0.3 / turn.norm();
  if (turn.norm() > 0) {
    placement.frame = axis_rotation(turn.normalized(), turn.norm()) * placement.frame;
    placement.frame = nearest_orthogonal(placement.frame);
  }
  placement.centre += step.tail<3>();
  return turn.norm() * scale + step.tail<3>().norm();
}

}  // namespace

namespace {

/// Samples of a patch and their images: what one step of the refinement is fitted to.
struct Pairs {
  const SurfacePatch& patch;
  const GroupPlacement& placement;
  double width;
  double scale;
  Eigen::Index count;        // of the samples that are looked at
  std::vector<int>& likely;  // by pair: the place of the face that was nearest in the step before, -1 for none

  void add(const Motion& motion, Eigen::Index i, int& place, NormalEquations& equations) const {
    const Eigen::Index s = i * patch.samples.points.rows() / count;
    const Vector3d point = patch.samples.points.row(s);
    const Vector3d image = motion(point);
    const Vector3d normal = motion.linear * patch.samples.normals.row(s).transpose();
    const SurfaceIndex::Nearest near = patch.index->nearest_facing(image, normal, kNearNormals, width, true, place);
    place = near.place;
    if (near.face < 0) return;
    const Vector3d facing = patch.prepared->normals.row(near.face);
    const double residual = facing.dot(image - near.point);
    const double ratio = near.distance / width;
    const double weight = (1 - ratio * ratio) * (1 - ratio * ratio);
    const Vector6d row = image_jacobian(motion, point - placement.centre, scale).transpose() * facing;
    equations.matrix += weight * row * row.transpose();
    equations.right += weight * residual * row;
    equations.weight += weight;
  }

  // Summed block by block, so that rounding does not depend on the number of threads.
  NormalEquations sum(const std::vector<Motion>& motions, const RunContext& context) const {
    constexpr Eigen::Index kBlock = 256;
    constexpr std::size_t kMinShare = 1;  // blocks
    const auto pairs = static_cast<Eigen::Index>(motions.size()) * count;
    likely.resize(static_cast<std::size_t>(pairs), -1);
    std::vector<NormalEquations> blocks(static_cast<std::size_t>((pairs + kBlock - 1) / kBlock));
    const auto body = [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        const Eigen::Index first = static_cast<Eigen::Index>(b) * kBlock;
        for (Eigen::Index i = first; i < std::min(pairs, first + kBlock); ++i) {
          add(motions[static_cast<std::size_t>(i / count)], i % count, likely[static_cast<std::size_t>(i)], blocks[b]);
        }
      }
    };
    parallel_for(context, blocks.size(), body, kMinShare);
    NormalEquations total;
    for (const NormalEquations& block : blocks) {
      total.matrix += block.matrix;
      total.right += block.right;
      total.weight += block.weight;
    }
    return total;
  }
};

}  // namespace

GroupPlacement refine(const SurfacePatch& patch, const GroupPlacement& start, const RunContext& context,
                      const RefinementOptions& options) {
  constexpr double kStays = 0.02;      // tolerances
  constexpr double kConverged = 1e-4;  // tolerances
  GroupPlacement placement = start;
  const double scale = std::max(patch.moments.radius, 1e-9);
  const Eigen::Index count = std::min<Eigen::Index>(patch.samples.points.rows(), options.samples);
  std::vector<int> likely;
  bool stays = false;  // a narrower reach will hardly move it
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const double progress = stays ? 1 : std::min(1.0, iteration / std::max(1.0, 0.6 * options.iterations));
    const double width = patch.tolerance * std::exp((1 - progress) * std::log(options.first_width) +
                                                    progress * std::log(options.last_width));
    const Pairs pairs{patch, placement, width, scale, count, likely};
    const NormalEquations equations = pairs.sum(fitted_motions(placement), context);
    if (equations.weight < 20) break;
    const double moved = apply(equations, scale, placement);
    if (progress >= 1 && moved < kConverged * patch.tolerance) break;
    stays = stays || moved < kStays * patch.tolerance;
  }
  return placement;
}

namespace {

// A turned surface has facets: its vertices are images of one another under some of the rotations. Of those of prime
// order, with the mirror across the axis where there is one, which need no more of the frame than the axis.
std::vector<PointGroup> groups_of_facets(const PointGroup& group) {
  if (group.family == Family::K || group.family == Family::Kh) return {};
  const bool across = group.family == Family::Cinfh || group.family == Family::Dinfh;
  std::vector<PointGroup> result;
  for (const int n : {2, 3, 5, 7}) result.push_back({across ? Family::Cnh : Family::Cn, n});
  return result;
}

std::optional<GroupPlacement> fit_to_vertices(const SurfacePatch& patch, const GroupPlacement& start) {
  const PreparedMesh& prepared = *patch.prepared;
  std::vector<int> groups;
  for (const int f : patch.faces) {
    for (int k = 0; k < 3; ++k) {
      groups.push_back(prepared.weld.group_of_vertex[static_cast<std::size_t>(prepared.mesh.faces(f, k))]);
    }
  }
  std::ranges::sort(groups);
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  Points points(static_cast<Eigen::Index>(groups.size()), 3);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    points.row(static_cast<Eigen::Index>(i)) =
        prepared.mesh.vertices.row(prepared.weld.representative[static_cast<std::size_t>(groups[i])]);
  }
  const PointIndex index(points);
  const double scale = std::max(patch.moments.radius, 1e-9);
  constexpr Eigen::Index kMaxVertices = 2000;
  const Eigen::Index count = std::min(points.rows(), kMaxVertices);
  GroupPlacement placement = start;
  double reach = 0.3 * patch.tolerance;
  double rms = 0;
  for (int iteration = 0; iteration < 4; ++iteration) {
    NormalEquations equations;
    Eigen::Index matched = 0;
    double square = 0;
    const std::vector<Motion> motions = fitted_motions(placement);
    for (const Motion& motion : motions) {
      for (Eigen::Index i = 0; i < count; ++i) {
        const Vector3d point = points.row(i * points.rows() / count);
        const Vector3d image = motion(point);
        const PointIndex::Neighbour near = index.nearest(image, 1).front();
        if (near.distance > reach) continue;
        ++matched;
        square += near.distance * near.distance;
        const Jacobian jacobian = image_jacobian(motion, point - placement.centre, scale);
        const Vector3d residual = image - points.row(near.index).transpose();
        equations.matrix += jacobian.transpose() * jacobian;
        equations.right += jacobian.transpose() * residual;
      }
    }
    const auto pairs = static_cast<Eigen::Index>(motions.size()) * count;
    if (matched < static_cast<Eigen::Index>(0.9 * static_cast<double>(pairs)) || pairs == 0) return std::nullopt;
    apply(equations, scale, placement);
    rms = std::sqrt(square / static_cast<double>(matched));
    reach = std::max(1e-9, std::min(reach, 4 * rms + 1e-9));
  }
  // In a dense mesh some vertex is always near; only a true correspondence makes the distances vanish.
  if (rms >= 0.02 * patch.tolerance) return std::nullopt;
  return placement;
}

}  // namespace

GroupPlacement refine_on_vertices(const SurfacePatch& patch, const GroupPlacement& start) {
  if (!start.group.continuous()) return fit_to_vertices(patch, start).value_or(start);
  for (const PointGroup& group : groups_of_facets(start.group)) {
    std::optional<GroupPlacement> placement = fit_to_vertices(patch, {group, start.frame, start.centre});
    if (!placement) continue;
    placement->group = start.group;
    return *placement;
  }
  return start;
}

}  // namespace orbifit
