#include "basis/orbit_lift.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Where a sample, or its part about an axis, goes: an affine function of its orbit's seed.
Transport place_of(const LiftAtom& atom, const RegionMap& regions, const std::vector<Transport>& words,
                   const std::vector<Transport>& samples, bool floating, const std::vector<Matrix3d>& rotations) {
  Transport result;
  if (atom.kind != LiftAtom::Kind::centre) result = samples[static_cast<std::size_t>(atom.sample)];
  const Transport& word = words[static_cast<std::size_t>(atom.word)];
  if (atom.kind == LiftAtom::Kind::full) return composed(inverse(word), result);
  const Continuum& continuum = *regions.continuum(atom.place);
  Transport centre;
  centre.frame.setZero();
  centre.shift = continuum.centre;
  if (floating) centre.carried = {{atom.place, Matrix3d::Identity()}};
  if (atom.kind == LiftAtom::Kind::centre) return composed(inverse(word), centre);
  const Vector3d axis =
      rotations.empty() ? continuum.axis : Vector3d(rotations[static_cast<std::size_t>(atom.place)] * continuum.axis);
  Matrix3d part = axis * axis.transpose();
  if (atom.kind == LiftAtom::Kind::across) part = Matrix3d::Identity() - part;
  // Relative to the centre, so the word's frame alone pulls it back.
  const Matrix3d pulled = word.frame.transpose() * part;
  Transport relative;
  relative.frame = pulled * result.frame;
  relative.shift = pulled * (result.shift - centre.shift);
  relative.carried = carried_sum({}, pulled, carried_sum(result.carried, -Matrix3d::Identity(), centre.carried));
  return relative;
}

}  // namespace

AtomMap atom_map(const LiftAtom& atom, const SymmetricSampling& sampling, const RegionMap& regions,
                 const CarriedTransports& transports, bool floating, const std::vector<Matrix3d>& rotations) {
  const Transport now = place_of(atom, regions, transports.words, transports.samples, floating, rotations);
  const Transport rest =
      transports.turned() ? place_of(atom, regions, transports.rest_words, transports.rest_samples, floating, {}) : now;
  AtomMap map;
  map.frame = now.frame;
  map.carried = now.carried;
  Vector3d seed = Vector3d::Zero();
  if (atom.sample >= 0) {
    map.orbit = sampling.orbit_of_sample[static_cast<std::size_t>(atom.sample)];
    seed = sampling.points.row(sampling.first_sample[static_cast<std::size_t>(map.orbit)]).transpose();
  }
  map.position = rest.frame * seed + rest.shift;
  if (transports.turned()) map.offset = now.frame * seed + now.shift - map.position;
  return map;
}

}  // namespace orbifit
