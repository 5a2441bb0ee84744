#include "symmetry/region_map.h"

#include <algorithm>
#include <limits>
#include <string>

#include "symmetry/lattice.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<Lattice> lattices_of(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context) {
  std::vector<Lattice> result;
  for (const Pattern& pattern : annotation.patterns) {
    result.push_back(lattice_of(mesh, pattern));
    if (!result.back().regular && pattern.kind != Pattern::Kind::congruent) {
      context.message("pattern \"" + pattern.name + "\": its instances miss the lattice; they are kept as copies");
    }
  }
  return result;
}

std::vector<std::vector<Motion>> motions_of(const std::vector<Lattice>& lattices) {
  std::vector<std::vector<Motion>> result;
  for (const Lattice& lattice : lattices) result.push_back(lattice.motions);
  return result;
}

}  // namespace

Carried carried_sum(const Carried& a, const Matrix3d& factor, const Carried& b) {
  Carried result;
  result.reserve(a.size() + b.size());
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() || j != b.end()) {
    if (j == b.end() || (i != a.end() && i->first < j->first)) {
      result.push_back(*i++);
    } else if (i == a.end() || j->first < i->first) {
      result.emplace_back(j->first, factor * j->second);
      ++j;
    } else {
      result.emplace_back(i->first, i->second + factor * j->second);
      ++i;
      ++j;
    }
  }
  return result;
}

RegionMap::RegionMap(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context)
    : RegionMap(mesh, annotation, lattices_of(mesh, annotation, context)) {}

RegionMap::RegionMap(const Mesh& mesh, const SymmetryAnnotation& annotation, const std::vector<Lattice>& lattices)
    : DomainMap(mesh, annotation, motions_of(lattices)),
      shifts_(static_cast<std::size_t>(places())),
      carriers_(count()),
      surfaces_(static_cast<std::size_t>(places())) {
  for (std::size_t p = 0; p < lattices.size(); ++p) {
    const Lattice& lattice = lattices[p];
    first_step_.push_back(lattice.regular ? carriers_ : -1);
    for (std::size_t a = 0; a < lattice.shifts.size(); ++a) {
      Carried& shift = shifts_[static_cast<std::size_t>(first_place_of_pattern(static_cast<int>(p))) + a];
      for (const auto& [variable, matrix] : lattice.shifts[a]) shift.emplace_back(carriers_ + variable, matrix);
    }
    carriers_ += lattice.variables;
  }
  for (int place = 0; place < places(); ++place) {
    if (whole(place)) continue;
    mesh_ = mesh;
    break;
  }
}

Carried RegionMap::carried(int place, int element, const Matrix3d& linear) const {
  if (at(place).pattern_first < 0) return {{place, Matrix3d::Identity() - linear}};
  // u_b = O (u_a - tau_a) + tau_b
  return carried_sum(instance_shift(at(place).pattern_first + element), -linear, instance_shift(place));
}

Carried RegionMap::generator_shift(int pattern, int generator) const {
  const int first = first_step_[static_cast<std::size_t>(pattern)];
  if (first < 0) return {};
  return {{first + generator, Matrix3d::Identity()}};
}

std::vector<Motion> RegionMap::test_elements(int region) const {
  const Place& place = at(region);
  if (!place.continuum) return place.motions;
  std::vector<Motion> result;
  for (const double angle : {0.0, 0.3, 1.7, 4.4}) {
    Motion turn = Motion::rotation(place.continuum->axis, angle, place.continuum->centre);
    if (place.continuum->spherical) {
      turn = Motion::rotation(Vector3d(1, 2, -2) / 3, 2 * angle, place.continuum->centre) * turn;
    }
    if (angle == 0) turn = Motion{};
    for (const Motion& component : place.motions) result.push_back(turn * component);
  }
  return result;
}

const MovingSurface& RegionMap::surface(int place) const {
  auto& surface = surfaces_[static_cast<std::size_t>(place)];
  if (!surface) surface = std::make_unique<MovingSurface>(mesh_, at(place).faces);
  return *surface;
}

void RegionMap::prepare(const RunContext& context) const {
  parallel_for(context, static_cast<std::size_t>(places()), [&](std::size_t begin, std::size_t end) {
    for (auto place = static_cast<int>(begin); place < static_cast<int>(end); ++place) {
      if (!whole(place) && !at(place).faces.empty()) surface(place);
    }
  });
}

double RegionMap::distance(const Vector3d& point, int place, double most, int* likely) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (at(place).faces.empty() || at(place).box.exteriorDistance(point) > most) return kFar;
  const auto nearest = surface(place).nearest(point, most, likely != nullptr ? *likely : -1);
  if (likely != nullptr && nearest.face >= 0) *likely = nearest.place;
  return nearest.distance;
}

}  // namespace orbifit
