#include "group/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

#include <Eigen/Dense>

#include "base/dense.h"
#include "group/verification.h"

namespace orbifit {

using Eigen::Matrix3d;
using Eigen::Vector3d;

CopyFit fit_of_copy(const SurfacePatch& patch, const Motion& motion, const std::vector<int>& faces) {
  const SurfaceIndex surface(patch.prepared->mesh, faces);
  CopyFit copy;
  for (Eigen::Index s = 0; s < patch.samples.points.rows(); ++s) {
    const double distance = surface.nearest(motion(patch.samples.points.row(s))).distance;
    if (distance <= patch.tolerance) copy.kept += 1;
    copy.square += distance * distance;
    copy.largest = std::max(copy.largest, distance);
  }
  copy.kept /= static_cast<double>(std::max<Eigen::Index>(1, patch.samples.points.rows()));
  return copy;
}

Motion straightened(const Motion& motion, const GroupPlacement& own) {
  const auto turn_of = [](const Motion& m) { return (m.linear - Matrix3d::Identity()).norm(); };
  if (own.group.family == PointGroup::Family::K || own.group.family == PointGroup::Family::Kh) {
    return {Matrix3d::Identity(), motion(own.centre) - own.centre};
  }
  Motion best = motion;
  std::vector<Motion> cosets{Motion{}};
  if (own.group.continuous()) {
    const Vector3d x = own.frame.col(0);
    const Vector3d z = own.frame.col(2);
    using Family = PointGroup::Family;
    const Matrix3d vertical = Matrix3d::Identity() - 2 * x * x.transpose();
    const Matrix3d horizontal = Matrix3d::Identity() - 2 * z * z.transpose();
    if (own.group.family == Family::Cinfv || own.group.family == Family::Dinfh) {
      cosets.push_back(Motion::about(vertical, own.centre));
    }
    if (own.group.family == Family::Cinfh || own.group.family == Family::Dinfh) {
      cosets.push_back(Motion::about(horizontal, own.centre));
    }
    if (own.group.family == Family::Dinf || own.group.family == Family::Dinfh) {
      cosets.push_back(Motion::about(2 * x * x.transpose() - Matrix3d::Identity(), own.centre));
    }
    for (const Motion& coset : cosets) {
      const Motion start = motion * coset;
      // tr(L R(z, a)) = a cos + b sin + c: the turn that brings it nearest to the identity is atan2(b, a).
      const Matrix3d cross = axis_rotation(z, std::numbers::pi / 2) - z * z.transpose();
      const Matrix3d across = Matrix3d::Identity() - z * z.transpose();
      const double angle = std::atan2((start.linear * cross).trace(), (start.linear * across).trace());
      const Motion turned = start * Motion::rotation(z, angle, own.centre);
      if (turn_of(turned) < turn_of(best) - 1e-9) best = turned;
    }
    return best;
  }
  for (const Motion& element : judged_motions(own.group, own.frame, own.centre)) {
    const Motion turned = motion * element;
    if (turn_of(turned) < turn_of(best) - 1e-9) best = turned;
  }
  return best;
}

namespace {

constexpr int kMinInstances = 3;
constexpr int kMaxSteps = 400;

struct Lattice {
  std::vector<Vector3d> steps;
  std::vector<Eigen::Vector3i> places;
  double filled = 0;
};

// Whether all offsets are whole combinations of the steps; refines the steps by least squares.
std::optional<Lattice> fit_lattice(const std::vector<Vector3d>& offsets, std::vector<Vector3d> steps,
                                   double tolerance) {
  const auto dimension = static_cast<Eigen::Index>(steps.size());
  Eigen::MatrixXd basis(3, dimension);
  Eigen::MatrixXd places(dimension, static_cast<Eigen::Index>(offsets.size()));
  Eigen::MatrixXd points(3, static_cast<Eigen::Index>(offsets.size()));
  for (std::size_t i = 0; i < offsets.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = offsets[i];
  for (int round = 0; round < 3; ++round) {
    for (Eigen::Index k = 0; k < dimension; ++k) basis.col(k) = steps[static_cast<std::size_t>(k)];
    const Eigen::MatrixXd exact = shortest_solution(basis, points, 1e-12);
    places = exact.array().round().matrix();
    // Before they are fitted the steps are off, and the more so the more of them are taken.
    const double slack = (round == 0 ? 3 : 1) * tolerance;
    if ((basis * exact - points).colwise().norm().maxCoeff() > slack) return std::nullopt;
    if ((basis * places - points).colwise().norm().maxCoeff() > slack) return std::nullopt;
    const Eigen::MatrixXd fitted = shortest_solution(places.transpose(), points.transpose(), 1e-12).transpose();
    for (Eigen::Index k = 0; k < dimension; ++k) steps[static_cast<std::size_t>(k)] = fitted.col(k);
  }
  Lattice result{steps, {}, 0};
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    Eigen::Vector3i place = Eigen::Vector3i::Zero();
    for (Eigen::Index k = 0; k < dimension; ++k) place[k] = static_cast<int>(places(k, i));
    result.places.push_back(place);
  }
  // A lattice of which little is filled is a coincidence: at least half of the box of places must hold a copy,
  // and any three points span some lattice of two steps.
  if (offsets.size() < (std::size_t{1} << steps.size())) return std::nullopt;
  double box = 1;
  for (Eigen::Index k = 0; k < dimension; ++k) {
    const double extent = places.row(k).maxCoeff() - places.row(k).minCoeff();
    if (extent < 1) return std::nullopt;
    box *= extent + 1;
  }
  result.filled = static_cast<double>(offsets.size()) / box;
  if (result.filled < 0.5) return std::nullopt;
  return result;
}

std::optional<Lattice> find_lattice(const std::vector<Vector3d>& offsets, double tolerance) {
  // Steps are differences of copies: short ones first.
  std::vector<Vector3d> differences;
  for (std::size_t i = 0; i < offsets.size() && i < 60; ++i) {
    for (std::size_t j = i + 1; j < offsets.size(); ++j) {
      Vector3d d = offsets[j] - offsets[i];
      if (d.norm() < 3 * tolerance) return std::nullopt;  // two copies at one place
      const bool known = std::ranges::any_of(differences, [&](const Vector3d& e) {
        return (e - d).norm() < 2 * tolerance || (e + d).norm() < 2 * tolerance;
      });
      if (!known) differences.push_back(d);
    }
  }
  std::ranges::stable_sort(differences, {}, [](const Vector3d& d) { return d.norm(); });
  if (differences.size() > 12) differences.resize(12);
  const auto parallel = [&](const Vector3d& a, const Vector3d& b) {
    return a.normalized().cross(b.normalized()).norm() < 0.05;
  };
  for (const Vector3d& a : differences) {
    if (std::optional<Lattice> found = fit_lattice(offsets, {a}, tolerance)) return found;
  }
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = i + 1; j < differences.size(); ++j) {
      if (parallel(differences[i], differences[j])) continue;
      if (auto found = fit_lattice(offsets, {differences[i], differences[j]}, tolerance)) return found;
    }
  }
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = i + 1; j < differences.size(); ++j) {
      for (std::size_t k = j + 1; k < differences.size(); ++k) {
        Matrix3d basis;
        basis << differences[i].normalized(), differences[j].normalized(), differences[k].normalized();
        if (std::abs(basis.determinant()) < 0.1) continue;
        if (auto found = fit_lattice(offsets, {differences[i], differences[j], differences[k]}, tolerance))
          return found;
      }
    }
  }
  return std::nullopt;
}

// A rotation with a rise along its axis, to any power.
struct Screw {
  Vector3d axis, centre;
  double angle, rise;

  Motion power(int k) const {
    Motion motion = Motion::rotation(axis, k * angle, centre);
    motion.translation += k * rise * axis;
    return motion;
  }
};

std::optional<Screw> screw_of(const Motion& motion) {
  constexpr double kMinTurn = 0.02;
  const AxisAngle turn = axis_angle(motion.linear);
  if (turn.determinant < 0 || turn.angle < kMinTurn) return std::nullopt;
  const double rise = turn.axis.dot(motion.translation);
  const Vector3d across = motion.translation - rise * turn.axis;
  return Screw{turn.axis, shortest_solution(Matrix3d::Identity() - motion.linear, across, 1e-12), turn.angle, rise};
}

// The powers of the step that the motions are, up to the own group; empty unless they all are, and fill half of what
// they span.
std::vector<int> powers_of(const Screw& step, const std::vector<Motion>& motions, const GroupPlacement* own,
                           const Vector3d& centroid, double reach, double tolerance) {
  const bool closes = std::abs(step.rise) <= tolerance;
  const int most = closes ? static_cast<int>(2 * std::numbers::pi / step.angle) + 1 : kMaxSteps;
  std::vector<int> powers;
  for (const Motion& motion : motions) {
    const Vector3d goal = motion(centroid);
    std::optional<int> found;
    for (int i = 0; i <= 2 * std::min(most, kMaxSteps) && !found; ++i) {
      const int k = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
      const Motion power = step.power(k);
      if ((power(centroid) - goal).norm() > 3 * tolerance) continue;
      Motion rest = inverse(power) * motion;
      if (own != nullptr) rest = straightened(rest, *own);
      if (motion_distance(rest, Motion{}, centroid, reach) <= 3 * tolerance) found = k;
    }
    if (!found || std::ranges::find(powers, *found) != powers.end()) return {};
    powers.push_back(*found);
  }
  const auto [lowest, highest] = std::ranges::minmax(powers);
  return 2 * std::ssize(powers) < highest - lowest + 1 ? std::vector<int>{} : powers;
}

// All motions powers of one rotation whose powers do not close within them, or of one screw.
std::optional<Arrangement> find_arc(const std::vector<Motion>& motions, const GroupPlacement* own,
                                    const Vector3d& centroid, double reach, double tolerance) {
  constexpr std::size_t kTries = 6;
  std::vector<Screw> screws;
  for (std::size_t i = 1; i < motions.size(); ++i) {
    if (const std::optional<Screw> screw = screw_of(motions[i])) screws.push_back(*screw);
  }
  std::ranges::stable_sort(screws, {}, &Screw::angle);
  if (screws.size() > kTries) screws.resize(kTries);
  for (const Screw& screw : screws) {
    for (const int divisor : {1, 2, 3}) {
      const Screw step{screw.axis, screw.centre, screw.angle / divisor, screw.rise / divisor};
      const std::vector<int> powers = powers_of(step, motions, own, centroid, reach, tolerance);
      if (powers.empty()) continue;
      const bool level = std::abs(step.rise) <= tolerance;
      Arrangement found{level ? Pattern::Kind::rotation : Pattern::Kind::screw, {step.power(1)}, {}, 0};
      for (const int k : powers) found.motions.push_back(step.power(k));
      return found;
    }
  }
  return std::nullopt;
}

}  // namespace

Arrangement arrange(const std::vector<Motion>& given, const GroupPlacement* own, const Vector3d& centroid, double reach,
                    double tolerance) {
  std::vector<Motion> motions = given;
  if (own != nullptr) {
    for (std::size_t i = 1; i < motions.size(); ++i) motions[i] = straightened(motions[i], *own);
  }
  Arrangement result{Pattern::Kind::congruent, {}, motions, 0};
  if (motions.size() < kMinInstances) return result;
  const bool parallel = std::ranges::all_of(
      motions, [&](const Motion& m) { return (m.linear - Matrix3d::Identity()).norm() * reach <= 2 * tolerance; });
  if (parallel) {
    std::vector<Vector3d> offsets;
    offsets.reserve(motions.size());
    for (const Motion& motion : motions) offsets.emplace_back(motion(centroid) - centroid);
    const std::optional<Lattice> lattice = find_lattice(offsets, tolerance);
    if (!lattice) return result;
    constexpr std::array<Pattern::Kind, 3> kKinds{Pattern::Kind::translation_1d, Pattern::Kind::translation_2d,
                                                  Pattern::Kind::translation_3d};
    result.kind = kKinds[lattice->steps.size() - 1];
    result.filled = lattice->filled;
    for (const Vector3d& step : lattice->steps) result.generators.push_back({Matrix3d::Identity(), step});
    for (std::size_t i = 0; i < motions.size(); ++i) {
      Vector3d offset = Vector3d::Zero();
      for (std::size_t k = 0; k < lattice->steps.size(); ++k) {
        offset +=
            (lattice->places[i][static_cast<Eigen::Index>(k)] - lattice->places[0][static_cast<Eigen::Index>(k)]) *
            lattice->steps[k];
      }
      result.motions[i] = {Matrix3d::Identity(), offset};
    }
    return result;
  }
  if (std::optional<Arrangement> arc = find_arc(motions, own, centroid, reach, tolerance)) return *arc;
  return result;
}

}  // namespace orbifit
