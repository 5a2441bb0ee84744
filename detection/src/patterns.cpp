#include "orbifit/detection/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Dense>

#include "orbifit/detection/verification.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kLeastInstances = 3;
constexpr int kMostSteps = 400;

// motion * (rotation of a continuous own group) that turns least.
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

struct Lattice {
  std::vector<Vector3d> steps;
  std::vector<Eigen::Vector3i> places;
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
    const Eigen::MatrixXd exact = basis.colPivHouseholderQr().solve(points);
    places = exact.array().round().matrix();
    if ((basis * exact - points).colwise().norm().maxCoeff() > tolerance) return std::nullopt;
    if ((basis * places - points).colwise().norm().maxCoeff() > (round == 0 ? 3 : 1) * tolerance) return std::nullopt;
    const Eigen::MatrixXd fitted = places.transpose().colPivHouseholderQr().solve(points.transpose()).transpose();
    for (Eigen::Index k = 0; k < dimension; ++k) steps[static_cast<std::size_t>(k)] = fitted.col(k);
  }
  Lattice result{steps, {}};
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
  if (2 * static_cast<double>(offsets.size()) < box) return std::nullopt;
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

// All motions powers of one rotation whose powers do not close within them.
std::optional<Arrangement> find_arc(const std::vector<Motion>& motions, const Vector3d& centroid, double reach,
                                    double tolerance) {
  for (std::size_t first = 1; first < motions.size(); ++first) {
    const AxisAngle turn = axis_angle(motions[first].linear);
    if (turn.determinant < 0 || turn.angle < 0.02) continue;
    if (std::abs(turn.axis.dot(motions[first].translation)) > tolerance) continue;
    const Matrix3d singular = Matrix3d::Identity() - motions[first].linear;
    const Vector3d centre = singular.completeOrthogonalDecomposition().solve(motions[first].translation);
    for (const int divisor : {1, 2, 3}) {
      const Motion step = Motion::rotation(turn.axis, turn.angle / divisor, centre);
      Arrangement found{Pattern::Kind::rotation, {step}, {}};
      const int reachable = static_cast<int>(2 * std::numbers::pi * divisor / turn.angle) + 1;
      for (const Motion& motion : motions) {
        for (int k = -reachable; k <= reachable && std::abs(k) < kMostSteps; ++k) {
          const Motion power = Motion::rotation(turn.axis, k * turn.angle / divisor, centre);
          if (motion_distance(power, motion, centroid, reach) > 3 * tolerance) continue;
          found.motions.push_back(power);
          break;
        }
        if (found.motions.empty()) break;
      }
      if (found.motions.size() == motions.size()) return found;
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
  Arrangement result{Pattern::Kind::congruent, {}, motions};
  if (motions.size() < kLeastInstances) return result;
  const bool parallel = std::ranges::all_of(
      motions, [&](const Motion& m) { return (m.linear - Matrix3d::Identity()).norm() * reach <= 2 * tolerance; });
  if (parallel) {
    std::vector<Vector3d> offsets;
    for (const Motion& motion : motions) offsets.emplace_back(motion(centroid) - centroid);
    const std::optional<Lattice> lattice = find_lattice(offsets, tolerance);
    if (!lattice) return result;
    constexpr std::array<Pattern::Kind, 3> kKinds{Pattern::Kind::translation_1d, Pattern::Kind::translation_2d,
                                                  Pattern::Kind::translation_3d};
    result.kind = kKinds[lattice->steps.size() - 1];
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
  if (std::optional<Arrangement> arc = find_arc(motions, centroid, reach, tolerance)) return *arc;
  return result;
}

}  // namespace orbifit
