#include "symmetry/lattice.h"

#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "base/dense.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSameStep = 2e-3;  // of the diagonal, on an instance

struct Powers {
  Motion motion;
  Carried shift;
};

// Instance = generator^k, sought outwards from the identity.
std::optional<Powers> power(const Motion& generator, const Motion& instance, const Vector3d& centre, double reach,
                            double tolerance, int most) {
  Powers up;
  Powers down;
  up.shift = down.shift = {{0, Matrix3d::Zero()}};
  const Motion back = inverse(generator);
  for (int k = 0; k <= most; ++k) {
    if (motion_distance(up.motion, instance, centre, reach) < tolerance) return up;
    if (motion_distance(down.motion, instance, centre, reach) < tolerance) return down;
    // tau_{k+1} = tau_k + O^k tau; tau_{k-1} = tau_k - O^{k-1} tau
    up.shift[0].second += up.motion.linear;
    up.motion = up.motion * generator;
    down.motion = down.motion * back;
    down.shift[0].second -= down.motion.linear;
  }
  return std::nullopt;
}

std::optional<Powers> combination(const std::vector<Motion>& generators, const Motion& instance, const Vector3d& centre,
                                  double reach, double tolerance) {
  Eigen::MatrixXd steps(3, static_cast<Eigen::Index>(generators.size()));
  for (std::size_t g = 0; g < generators.size(); ++g) {
    if ((generators[g].linear - Matrix3d::Identity()).norm() > 1e-6) return std::nullopt;
    steps.col(static_cast<Eigen::Index>(g)) = generators[g].translation;
  }
  const Eigen::VectorXd counts = shortest_solution(steps, instance.translation, 1e-12);
  Powers result;
  for (Eigen::Index g = 0; g < counts.size(); ++g) {
    const double count = std::round(counts[g]);
    result.motion.translation += count * steps.col(g);
    result.shift.emplace_back(static_cast<int>(g), count * Matrix3d::Identity());
  }
  if (motion_distance(result.motion, instance, centre, reach) >= tolerance) return std::nullopt;
  return result;
}

}  // namespace

Lattice lattice_of(const Mesh& mesh, const Pattern& pattern) {
  Lattice lattice;
  const double tolerance = kSameStep * diagonal(mesh.vertices);
  Vector3d centre = Vector3d::Zero();
  double reach = 0;
  if (!pattern.instances.empty() && !pattern.instances[0].faces.empty()) {
    const Mesh part = submesh(mesh, pattern.instances[0].faces);
    centre = part.vertices.colwise().mean();
    reach = (part.vertices.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
  }
  const int most = 2 * static_cast<int>(pattern.instances.size()) + 2;
  lattice.regular = pattern.kind != Pattern::Kind::congruent && !pattern.generators.empty();
  for (const PatternInstance& instance : pattern.instances) {
    if (!lattice.regular) break;
    const bool translations = pattern.generators.size() > 1;
    const auto found = translations ? combination(pattern.generators, instance.motion, centre, reach, tolerance)
                                    : power(pattern.generators[0], instance.motion, centre, reach, tolerance, most);
    lattice.regular = found.has_value();
    if (!found) break;
    lattice.motions.push_back(found->motion);
    lattice.shifts.push_back(found->shift);
  }
  lattice.variables = static_cast<int>(pattern.generators.size());
  if (lattice.regular) return lattice;
  lattice.motions.clear();
  lattice.shifts.clear();
  lattice.variables = 0;
  for (const PatternInstance& instance : pattern.instances) {
    lattice.motions.push_back(instance.motion);
    lattice.shifts.emplace_back();
    if (lattice.motions.size() > 1) lattice.shifts.back().emplace_back(lattice.variables++, Matrix3d::Identity());
  }
  return lattice;
}

}  // namespace orbifit
