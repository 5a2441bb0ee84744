#include "symmetry_quadrature.h"

#include <algorithm>
#include <string>

#include "base/random.h"
#include "geometry/sampling.h"
#include "symmetry/lattice.h"

namespace orbifit {

namespace {

constexpr int kMin = 64;  // points of a part, however small

struct Quadrature {
  Points points;
  double weight = 0;
};

Quadrature quadrature(const Mesh& mesh, const Eigen::VectorXd& shares, const std::vector<int>& faces, int points,
                      Random& random) {
  double share = 0;
  for (const int face : faces) share += shares[face];
  const int count = std::max(kMin, static_cast<int>(std::ceil(points * share)));
  return {sample_surface(mesh, count, random, faces).points, share / count};
}

Points images_of(const Motion& motion, const Points& points) {
  return (points * motion.linear.transpose()).rowwise() + motion.translation.transpose();
}

bool is_identity(const Motion& motion) {
  return motion.linear.isIdentity(1e-12) && motion.translation.isZero(1e-12);
}

}  // namespace

SymmetryDemands symmetry_demands(const Mesh& mesh, const SymmetryAnnotation& annotation, int points, GroupMode mode,
                                 const RunContext& context) {
  const Eigen::VectorXd areas = face_areas(mesh);
  const Eigen::VectorXd shares = areas / areas.sum();
  const bool carried = mode != GroupMode::fixed;
  Random random(context.seed, "quadrature of symmetries");
  SymmetryDemands result;
  for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
    const Region& region = annotation.regions[r];
    const Quadrature each = quadrature(mesh, shares, region.faces, points, random);
    result.carrier_of_region.push_back(carried ? result.carriers++ : -1);
    for (const Motion& generator : region.generators) {
      if (is_identity(generator)) continue;
      SymmetryDemand demand{
          static_cast<int>(r), generator, region.centre, {}, each.points, images_of(generator, each.points),
          each.weight};
      if (carried) demand.shift = {{result.carrier_of_region.back(), Eigen::Matrix3d::Identity() - generator.linear}};
      result.demands.push_back(std::move(demand));
    }
  }
  for (const Pattern& pattern : annotation.patterns) {
    const Lattice lattice = lattice_of(mesh, pattern);
    result.first_carrier_of_pattern.push_back(carried ? result.carriers : -1);
    if (pattern.instances.empty()) continue;
    const Quadrature each = quadrature(mesh, shares, pattern.instances[0].faces, points, random);
    for (std::size_t i = 1; i < pattern.instances.size(); ++i) {
      const Motion& motion = lattice.motions[i];
      SymmetryDemand demand{
          -1, motion, Eigen::Vector3d::Zero(), {}, each.points, images_of(motion, each.points), each.weight};
      for (const auto& [variable, matrix] : lattice.shifts[i]) {
        if (carried) demand.shift.emplace_back(result.carriers + variable, matrix);
      }
      result.demands.push_back(std::move(demand));
    }
    if (carried) result.carriers += lattice.variables;
  }
  return result;
}

Eigen::Matrix3d carried_linear(const SymmetryDemand& demand, const std::vector<Eigen::Matrix3d>& rotations) {
  if (demand.region < 0) return demand.motion.linear;
  const Eigen::Matrix3d& rotation = rotations[static_cast<std::size_t>(demand.region)];
  return rotation * demand.motion.linear * rotation.transpose();
}

Carried carried_shift(const SymmetryDemand& demand, const Eigen::Matrix3d& linear) {
  if (demand.region < 0 || demand.shift.empty()) return demand.shift;
  return {{demand.shift.front().first, Eigen::Matrix3d::Identity() - linear}};
}

Eigen::Vector3d uncarried_translation(const SymmetryDemand& demand, const Eigen::Matrix3d& linear) {
  return demand.region < 0 ? demand.motion.translation : Eigen::Vector3d(demand.centre - linear * demand.centre);
}

Points symmetry_differences(const SymmetryDemand& demand, const std::vector<Eigen::Matrix3d>& rotations,
                            const Points& carriers, const Points& from, const Points& to) {
  const Eigen::Matrix3d linear = carried_linear(demand, rotations);
  Eigen::Vector3d translation = uncarried_translation(demand, linear);
  for (const auto& [carrier, matrix] : carried_shift(demand, linear)) {
    translation += matrix * carriers.row(carrier).transpose();
  }
  return (from * linear.transpose() - to).rowwise() + translation.transpose();
}

}  // namespace orbifit
