#include "surface/components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <ranges>

#include <Eigen/Geometry>

#include "base/dense.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kCongruentShare = 0.96;
constexpr int kRepresentativeSamples = 400;
constexpr double kReach = 0.25;  // of the fit at its start, radii
constexpr int kTurns = 48;       // about one free axis
constexpr int kRotations = 400;  // where moments leave all axes open

struct Invariants {
  double area = 0;
  Vector3d deviations = Vector3d::Zero();  // square roots of the principal variances, ascending
  double radius = 0;
};

Invariants invariants(const SurfaceMoments& moments) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(moments.covariance, Eigen::EigenvaluesOnly);
  return {moments.area, solver.eigenvalues().cwiseMax(0).cwiseSqrt(), moments.radius};
}

// Of two components, at most 1 where one may be a copy of the other.
double difference(const Invariants& a, const Invariants& b, double tolerance, double noise) {
  const double size = std::max(a.radius, 1e-12);
  const double thickness = std::max(a.deviations[0], 1e-12);  // of which noise adds to the area of the sides
  const double relative = std::max({2 * tolerance / size, noise / thickness, 1e-4});
  return std::max({std::abs(a.area - b.area) / (2 * relative * a.area), std::abs(a.radius - b.radius) / (2 * tolerance),
                   (a.deviations - b.deviations).cwiseAbs().maxCoeff() / tolerance});
}

// Vertices of the faces in the order in which the faces name them.
Points corners_in_order(const PreparedMesh& prepared, const std::vector<int>& faces) {
  Points result(static_cast<Eigen::Index>(3 * faces.size()), 3);
  Eigen::Index row = 0;
  for (const int f : faces) {
    for (int k = 0; k < 3; ++k) result.row(row++) = prepared.mesh.vertices.row(prepared.mesh.faces(f, k));
  }
  return result;
}

// Least-squares motion of given determinant from rows of `from` to rows of `to` (Kabsch 1976).
Motion best_motion(const Points& from, const Points& to, int determinant) {
  const Vector3d a = from.colwise().mean();
  const Vector3d b = to.colwise().mean();
  const Matrix3d cross = (to.rowwise() - b.transpose()).transpose() * (from.rowwise() - a.transpose());
  const Eigen::JacobiSVD<Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d signs = Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() * determinant < 0) signs[2] = -1;
  const Matrix3d linear = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {linear, b - linear * a};
}

// Share of the patch's samples that the motion brings onto `target`, and the other way round, whichever is less.
double carried_share(const SurfacePatch& patch, const SurfaceIndex& target, const Motion& motion, double tolerance,
                     int count) {
  const Eigen::Index total = patch.samples.points.rows();
  const Eigen::Index chosen = std::min<Eigen::Index>(total, count);
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < chosen; ++i) {
    const Eigen::Index s = i * total / chosen;
    const Vector3d image = motion(patch.samples.points.row(s));
    const Vector3d normal = motion.linear * patch.samples.normals.row(s).transpose();
    const bool free = patch.at_crease[static_cast<std::size_t>(s)] != 0;
    const bool on =
        free ? target.within(image, tolerance) : target.within_facing(image, normal, kNearNormals, tolerance);
    if (on) ++kept;
  }
  return static_cast<double>(kept) / static_cast<double>(std::max<Eigen::Index>(1, chosen));
}

double mean_distance(const SurfacePatch& patch, const SurfaceIndex& target, const Motion& motion, int count,
                     double cap) {
  const Eigen::Index total = patch.samples.points.rows();
  const Eigen::Index chosen = std::min<Eigen::Index>(total, count);
  double sum = 0;
  for (Eigen::Index i = 0; i < chosen; ++i) {
    const SurfaceIndex::Nearest near = target.nearest(motion(patch.samples.points.row(i * total / chosen)), cap);
    sum += near.face < 0 ? cap : near.distance;
  }
  return sum / static_cast<double>(std::max<Eigen::Index>(1, chosen));
}

// The motion that carries the patch onto a copy whose faces name their corners in the same order; nothing where they do
// not.
std::optional<Motion> motion_by_order(const SurfacePatch& patch, const PreparedMesh& prepared,
                                      const std::vector<int>& part) {
  if (part.size() != patch.faces.size()) return std::nullopt;
  const Points from = corners_in_order(prepared, patch.faces);
  const Points to = corners_in_order(prepared, part);
  for (const int determinant : {1, -1}) {
    const Motion motion = best_motion(from, to, determinant);
    const Points moved = ((from * motion.linear.transpose()).rowwise() + motion.translation.transpose()) - to;
    if (moved.rowwise().norm().maxCoeff() < 0.2 * patch.tolerance) return motion;
  }
  return std::nullopt;
}

// Point-to-plane ICP of all six degrees of freedom; the determinant stays as it is.
// \param reach at the start, of the patch's radius
Motion fit_motion(const SurfacePatch& patch, const PreparedMesh& prepared, const SurfaceIndex& target, Motion motion,
                  double reach) {
  const Eigen::Index total = patch.samples.points.rows();
  const Eigen::Index count = std::min<Eigen::Index>(total, 150);
  const double size = std::max(patch.moments.radius, 1e-12);
  constexpr int kIterations = 14;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double width =
        iteration < 8 ? std::max(2 * patch.tolerance, reach * size * std::pow(0.6, iteration)) : 2 * patch.tolerance;
    const Vector3d centre = motion(patch.moments.centroid);
    Matrix6d matrix = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index s = i * total / count;
      const Vector3d image = motion(patch.samples.points.row(s));
      const Vector3d normal = motion.linear * patch.samples.normals.row(s).transpose();
      const SurfaceIndex::Nearest near = target.nearest_facing(image, normal, kNearNormals, width, true);
      if (near.face < 0) continue;
      const Vector3d facing = prepared.normals.row(near.face);
      Vector6d row;
      row << (image - centre).cross(facing) / size, facing;
      const double ratio = near.distance / width;
      const double weight = (1 - ratio * ratio) * (1 - ratio * ratio);
      matrix += weight * row * row.transpose();
      right += weight * facing.dot(image - near.point) * row;
    }
    matrix += 1e-9 * std::max(matrix.trace(), 1e-300) * Matrix6d::Identity();
    const Vector6d step = solve_semidefinite(matrix, -right);
    Vector3d turn = step.head<3>() / size;
    if (turn.norm() > 0.3) turn *= 0.3 / turn.norm();
    if (turn.norm() > 0) motion = Motion::rotation(turn.normalized(), turn.norm(), centre) * motion;
    motion.linear = nearest_orthogonal(motion.linear);
    motion.translation = centre + step.tail<3>() - motion.linear * patch.moments.centroid;
    if (iteration > 8 && step.norm() < 1e-12 * size) break;
  }
  return motion;
}

// Linear parts to start from: frames of the moments in all signs, sampled where variances coincide.
std::vector<Matrix3d> starting_turns(const SurfaceMoments& from, const SurfaceMoments& to, double tolerance) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> a(from.covariance);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> b(to.covariance);
  const Vector3d deviations = a.eigenvalues().cwiseMax(0).cwiseSqrt();
  const double close = std::max(0.02 * deviations[2], tolerance);
  const bool low = deviations[1] - deviations[0] < close;
  const bool high = deviations[2] - deviations[1] < close;
  std::vector<Matrix3d> result;
  const auto add = [&](const Matrix3d& inner) {
    result.emplace_back(b.eigenvectors() * inner * a.eigenvectors().transpose());
  };
  if (low && high) {
    for (int k = 0; k < kRotations; ++k) {  // a low-discrepancy sequence of quaternions (Shoemake 1992)
      const double u = (k + 0.5) / kRotations;
      const double v = 2 * std::numbers::pi * std::fmod(k * 0.7548776662466927, 1.0);
      const double w = 2 * std::numbers::pi * std::fmod(k * 0.5698402909980532, 1.0);
      const Eigen::Quaterniond turn(std::sqrt(u) * std::cos(w), std::sqrt(1 - u) * std::sin(v),
                                    std::sqrt(1 - u) * std::cos(v), std::sqrt(u) * std::sin(w));
      add(turn.toRotationMatrix());
      add(-turn.toRotationMatrix());
    }
    return result;
  }
  const int free = low ? 2 : (high ? 0 : -1);  // the axis that the moments do fix
  for (int signs = 0; signs < 8; ++signs) {
    const Vector3d sign((signs & 1) != 0 ? -1 : 1, (signs & 2) != 0 ? -1 : 1, (signs & 4) != 0 ? -1 : 1);
    if (free < 0) {
      add(sign.asDiagonal());
      continue;
    }
    if (sign[(free + 2) % 3] < 0) continue;  // half a turn about the free axis is among the turns
    for (int k = 0; k < kTurns; ++k) {
      add(axis_rotation(Vector3d::Unit(free), 2 * std::numbers::pi * k / kTurns) * sign.asDiagonal());
    }
  }
  return result;
}

struct Start {
  double distance;
  std::size_t number;
  Motion motion;
};

}  // namespace

std::optional<Motion> align(const SurfacePatch& patch, const PreparedMesh& prepared, const std::vector<int>& part,
                            const SurfaceMoments& part_moments, const RunContext& context) {
  context.check();
  const SurfaceIndex target(prepared.mesh, part);
  const auto verified = [&](const Motion& motion) {
    return carried_share(patch, target, motion, patch.tolerance, 200) >= kCongruentShare;
  };
  // Copies made by a modelling program keep the order of their faces: try that correspondence first.
  if (const std::optional<Motion> motion = motion_by_order(patch, prepared, part)) return motion;
  for (const int determinant : {1, -1}) {
    std::vector<Start> starts;
    std::vector<Matrix3d> turns = starting_turns(patch.moments, part_moments, patch.tolerance);
    for (std::size_t i = 0; i < turns.size(); ++i) {
      if (turns[i].determinant() * determinant < 0) continue;
      const Motion motion{turns[i], part_moments.centroid - turns[i] * patch.moments.centroid};
      starts.push_back({mean_distance(patch, target, motion, 40, 0.5 * patch.moments.radius), i, motion});
    }
    std::ranges::sort(starts, {}, [](const Start& s) { return std::pair(s.distance, s.number); });
    if (starts.size() > 4) starts.resize(4);
    for (const Start& start : starts) {
      const Motion motion = fit_motion(patch, prepared, target, start.motion, kReach);
      if (!verified(motion)) continue;
      // Along what slides on itself, such as a round bar, the fit leaves it open; the centroid does not.
      Motion centred = motion;
      centred.translation += part_moments.centroid - motion(patch.moments.centroid);
      const bool slid = (centred.translation - motion.translation).norm() > 0.25 * patch.tolerance;
      return slid && verified(centred) ? centred : motion;
    }
  }
  return std::nullopt;
}

Motion refined_motion(const SurfacePatch& patch, const PreparedMesh& prepared, const std::vector<int>& part,
                      const Motion& start) {
  const std::optional<Motion> motion = motion_by_order(patch, prepared, part);
  const double off = motion ? motion_distance(*motion, start, patch.moments.centroid, patch.moments.radius) : 1;
  if (off <= patch.tolerance) return *motion;
  return fit_motion(patch, prepared, prepared.index->part(part), start, 0);
}

namespace {

// Classes of components of alike invariants, of which there may be several: each round peels off the copies of the
// first.
std::vector<CongruenceClass> congruent_members(const PreparedMesh& prepared, const std::vector<int>& group,
                                               const std::vector<SurfaceMoments>& moments, double tolerance,
                                               const RunContext& context) {
  constexpr int kMaxRounds = 8;
  const std::vector<std::vector<int>>& faces = prepared.components.faces;
  std::vector<CongruenceClass> result;
  std::vector<int> open = group;
  for (int round = 0; !open.empty() && round < kMaxRounds; ++round) {
    const int first = open.front();
    CongruenceClass found{{first}, {Motion{}}};
    std::vector<std::optional<Motion>> motions(open.size());
    if (open.size() > 1) {
      const SurfacePatch patch = make_patch(prepared, faces[static_cast<std::size_t>(first)], kRepresentativeSamples,
                                            tolerance, context, "congruence");
      parallel_for(context, open.size() - 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin + 1; i < end + 1; ++i) {
          const auto c = static_cast<std::size_t>(open[i]);
          motions[i] = align(patch, prepared, faces[c], moments[c], context);
        }
      });
    }
    std::vector<int> rest;
    for (std::size_t i = 1; i < open.size(); ++i) {
      if (motions[i]) {
        found.members.push_back(open[i]);
        found.motions.push_back(*motions[i]);
      } else {
        rest.push_back(open[i]);
      }
    }
    result.push_back(std::move(found));
    open = std::move(rest);
  }
  for (const int c : open) result.push_back({{c}, {Motion{}}});
  return result;
}

}  // namespace

ComponentSurvey survey_components(const PreparedMesh& prepared, double tolerance, double least_share,
                                  const RunContext& context) {
  ComponentSurvey result;
  const std::vector<std::vector<int>>& faces = prepared.components.faces;
  std::vector<Invariants> known;
  for (const std::vector<int>& component : faces) {
    result.moments.push_back(surface_moments(prepared, component));
    known.push_back(invariants(result.moments.back()));
  }
  // Groups of alike invariants first: cheap, and it tells which small parts come in numbers.
  std::vector<int> order(faces.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<int>> groups;
  std::ranges::stable_sort(order, std::greater<>(), [&](int c) { return known[static_cast<std::size_t>(c)].area; });
  for (const int c : order) {
    const Invariants& mine = known[static_cast<std::size_t>(c)];
    if (mine.area <= 0) continue;
    const double close = tolerance_of_part(tolerance, result.moments[static_cast<std::size_t>(c)].diagonal);
    double least = std::numeric_limits<double>::infinity();
    std::vector<int>* likest = nullptr;
    for (std::vector<int>& group : std::views::reverse(groups)) {
      const Invariants& first = known[static_cast<std::size_t>(group.front())];
      if (first.area > 1.3 * mine.area) break;
      const double off = difference(first, mine, close, prepared.noise);
      if (off > 1 || off >= least) continue;
      least = off;
      likest = &group;
    }
    if (likest != nullptr) {
      likest->push_back(c);
    } else {
      groups.push_back({c});
    }
  }
  std::erase_if(groups, [&](const std::vector<int>& group) {
    double area = 0;
    for (const int c : group) area += known[static_cast<std::size_t>(c)].area;
    return area < least_share * prepared.area;
  });
  // Large groups one after the other on all threads, then the small ones side by side.
  constexpr std::size_t kLarge = 8;
  std::vector<std::vector<CongruenceClass>> classes(groups.size());
  const auto split = [&](std::size_t g, const RunContext& how) {
    std::ranges::sort(groups[g]);
    classes[g] = congruent_members(prepared, groups[g], result.moments, tolerance, how);
  };
  for (std::size_t g = 0; g < groups.size(); ++g) {
    context.progress("components", static_cast<double>(g) / static_cast<double>(groups.size()));
    if (groups[g].size() >= kLarge) split(g, context);
  }
  RunContext alone = context;
  alone.threads = 1;
  parallel_for(context, groups.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      if (groups[g].size() < kLarge) split(g, alone);
    }
  });
  for (std::vector<CongruenceClass>& of_group : classes)
    std::ranges::move(of_group, std::back_inserter(result.classes));
  std::ranges::stable_sort(result.classes, std::greater<>(), [&](const CongruenceClass& each) {
    double area = 0;
    for (const int c : each.members) area += known[static_cast<std::size_t>(c)].area;
    return area;
  });
  return result;
}

}  // namespace orbifit
