#include "support/kept_samples.h"

#include <cmath>

#include "orbifit/model/point_group.h"

#include "primitives/revolution.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kMaterial = 0.02;    // of the samples, by which a group must keep more than is known
constexpr double kRelative = 0.05;    // of what it keeps, likewise
constexpr double kKeptPiece = 0.9;    // of a piece's samples
constexpr double kWholeFlat = 0.97;   // of a flat piece's: a polygon keeps much of itself turned a little
constexpr double kAlongItself = 0.2;  // sine of the angle between a normal and the mirror's plane

}  // namespace

KeptSamples::KeptSamples(const ScreenedSurface& surface, const GroupPlacement& placement, const RunContext& context)
    : surface_(surface), placement_(placement), linear_(elements(placement.group, placement.frame)) {
  const auto count = static_cast<std::size_t>(surface.samples.points.rows());
  elements_of_sample_.resize(count);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) elements_of_sample_[i] = elements_keeping(static_cast<Eigen::Index>(i));
  });
}

KeptSamples::Elements KeptSamples::all() const {
  Elements result;
  for (std::size_t g = 0; g < linear_.size(); ++g) result.set(g);
  return result;
}

KeptSamples::Elements KeptSamples::elements_keeping(Eigen::Index sample) const {
  Elements result;
  result.set(0);
  const Vector3d from = surface_.samples.points.row(sample).transpose() - placement_.centre;
  const Vector3d normal = surface_.samples.normals.row(sample);
  for (std::size_t g = 1; g < linear_.size(); ++g) {
    result[g] = surface_.grid.holds(placement_.centre + linear_[g] * from, linear_[g] * normal);
  }
  return result;
}

std::vector<char> KeptSamples::kept_by(const Elements& some) const {
  std::vector<char> kept(elements_of_sample_.size(), 0);
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = (some & ~elements_of_sample_[i]).none() ? 1 : 0;
  return kept;
}

bool KeptSamples::material(const std::vector<char>& kept, const std::vector<char>& known,
                           const Elements& subgroup) const {
  std::vector<int> of_piece(surface_.piece_areas.size(), 0);
  std::vector<int> kept_of_piece(surface_.piece_areas.size(), 0);
  int all_kept = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto piece = static_cast<std::size_t>(surface_.piece_of_sample[i]);
    ++of_piece[piece];
    kept_of_piece[piece] += kept[i];
    all_kept += kept[i];
  }
  int more = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == 0 || known[i] != 0) continue;
    const auto piece = static_cast<std::size_t>(surface_.piece_of_sample[i]);
    const bool flat = surface_.piece_flat[piece] != 0;
    const bool whole = kept_of_piece[piece] >= (flat ? kWholeFlat : kKeptPiece) * of_piece[piece];
    const bool speaks = !flat && !slides(i, subgroup);
    if (whole || speaks) ++more;
  }
  return more >= kMaterial * static_cast<double>(kept.size()) && more >= kRelative * all_kept;
}

// Whether every element moves the surface along itself at the sample.
bool KeptSamples::slides(std::size_t sample, const Elements& subgroup) const {
  const Vector3d point = surface_.samples.points.row(static_cast<Eigen::Index>(sample));
  const Vector3d normal = surface_.samples.normals.row(static_cast<Eigen::Index>(sample));
  for (std::size_t g = 1; g < linear_.size(); ++g) {
    if (!subgroup[g]) continue;
    const AxisAngle turn = axis_angle(linear_[g]);
    if (turn.determinant < 0) {
      const Vector3d image = linear_[g] * (point - placement_.centre) + placement_.centre;
      const Vector3d apart = image - point;
      if (std::abs(apart.dot(normal)) > kAlongItself * apart.norm()) return false;
    } else if (!meets({placement_.centre, turn.axis}, point, normal)) {
      return false;
    }
  }
  return true;
}

}  // namespace orbifit
