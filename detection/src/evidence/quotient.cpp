#include "evidence/quotient.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/random.h"
#include "geometry/sampling.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kSamples = 400;        // of the whole surface, about
constexpr int kMinSamples = 3;          // of an atom
constexpr std::size_t kMaxOrbit = 400;  // points: groups that do not close
constexpr double kSurfaceReach = 3;     // tolerances within which an image finds its face

}  // namespace

Quotient::Quotient(const PreparedMesh& prepared, const std::vector<Claim>& claims, const ClaimAtoms& atoms,
                   double tolerance, const RunContext& context)
    : prepared_(prepared), claims_(claims), atoms_(atoms), tolerance_(tolerance), context_(context) {
  Random random(context.seed, "quotient");
  for (std::size_t atom = 0; atom < atoms.count(); ++atom) {
    if (atoms.faces(atom).empty()) continue;
    const double area = area_of(prepared, atoms.faces(atom));
    if (!(area > 0)) continue;
    const int count = std::max(kMinSamples, static_cast<int>(std::lround(kSamples * area / prepared.area)));
    const SurfaceSamples samples =
        sample_surface(prepared.mesh, prepared.areas, prepared.normals, count, random, atoms.faces(atom));
    for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
      Sample& sample = samples_.emplace_back();
      sample.weight = area / count;
      sample.orbit.push_back({samples.points.row(i), static_cast<int>(atom), std::vector<bool>(claims.size(), false)});
    }
  }
}

double Quotient::area() const {
  double sum = 0;
  for (const Sample& sample : samples_) sum += sample.weight / static_cast<double>(sample.orbit.size());
  return sum;
}

bool Quotient::near(const Vector3d& a, const Vector3d& b) const {
  return (a - b).squaredNorm() <= 0.25 * tolerance_ * tolerance_;
}

// Of a continuous group: whether its rotations take the points to one another. Mirrors through the axis and across it
// are among the motions.
bool Quotient::on_one_circle(std::size_t claim, const Vector3d& a, const Vector3d& b) const {
  const Region& region = *claims_[claim].region;
  const Vector3d from = a - region.centre;
  const Vector3d to = b - region.centre;
  if (!region.group.has_axis()) return std::abs(from.norm() - to.norm()) <= 0.5 * tolerance_;
  const double up_from = region.axis.dot(from);
  const double up_to = region.axis.dot(to);
  const double apart = (from - up_from * region.axis).norm() - (to - up_to * region.axis).norm();
  return std::hypot(apart, up_from - up_to) <= 0.5 * tolerance_;
}

int Quotient::find(const std::vector<Site>& orbit, const Vector3d& point) const {
  for (std::size_t i = 0; i < orbit.size(); ++i) {
    if (near(orbit[i].point, point)) return static_cast<int>(i);
    for (const std::size_t claim : continuous_) {
      if (orbit[i].complete[claim] && on_one_circle(claim, orbit[i].point, point)) return static_cast<int>(i);
    }
  }
  return -1;
}

int Quotient::atom_at(const Vector3d& point) const {
  const SurfaceIndex::Nearest nearest = prepared_.index->nearest(point, kSurfaceReach * tolerance_);
  return nearest.face < 0 ? -1 : atoms_.of_face(nearest.face);
}

// Of the orbit of the sample under the claim, n points of which e are known to be in one orbit: of n / e orbits one is
// left, and n points share what that saves.
double Quotient::saving(const Sample& sample, std::size_t claim) const {
  const int piece = atoms_.piece(claim, sample.orbit.front().atom);
  if (piece < 0) return 0;
  const Vector3d point = sample.orbit.front().point;
  const std::vector<Motion>& motions = claims_[claim].motions[static_cast<std::size_t>(piece)];
  const bool fills = continuous(claim);
  std::vector<Vector3d> images{point};
  std::size_t known = 1;
  for (const Motion& motion : motions) {
    const Vector3d image = motion(point);
    if (std::ranges::any_of(images, [&](const Vector3d& other) { return near(image, other); })) continue;
    if (!fills && find(sample.orbit, image) >= 0) ++known;
    images.push_back(image);
  }
  // The finite group in place of a continuous one need not hold the elements that are known.
  if (fills) {
    known = static_cast<std::size_t>(
        std::ranges::count_if(sample.orbit, [&](const Site& site) { return on_one_circle(claim, site.point, point); }));
  }
  return sample.weight * std::max(0.0, 1 / static_cast<double>(known) - 1 / static_cast<double>(images.size()));
}

double Quotient::saving(const std::vector<std::size_t>& family) const {
  double sum = 0;
  for (const Sample& sample : samples_) {
    double own = 0;
    for (const std::size_t claim : family) own += saving(sample, claim);
    if (own <= 0) continue;
    // Members that hold points of one orbit save the same.
    const auto meeting = std::ranges::count_if(family, [&](std::size_t claim) {
      return std::ranges::any_of(sample.orbit, [&](const Site& site) { return atoms_.piece(claim, site.atom) >= 0; });
    });
    sum += own / static_cast<double>(std::max<std::ptrdiff_t>(1, meeting));
  }
  return sum;
}

void Quotient::accept(const std::vector<std::size_t>& family) {
  accepted_.insert(accepted_.end(), family.begin(), family.end());
  std::ranges::copy_if(family, std::back_inserter(continuous_), [&](std::size_t claim) { return continuous(claim); });
  parallel_for(
      context_, samples_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) extend(samples_[s]);
      },
      16);
  context_.check();
}

void Quotient::extend(Sample& sample) const {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < sample.orbit.size(); ++i) open.push_back(i);
  for (std::size_t next = 0; next < open.size(); ++next) {
    for (const std::size_t claim : accepted_) {
      if (sample.orbit.size() >= kMaxOrbit) return;
      expand(sample, open[next], claim, open);
    }
  }
}

void Quotient::expand(Sample& sample, std::size_t site, std::size_t claim, std::vector<std::size_t>& open) const {
  if (sample.orbit[site].complete[claim]) return;
  const int piece = atoms_.piece(claim, sample.orbit[site].atom);
  if (piece < 0) return;
  const Vector3d point = sample.orbit[site].point;
  sample.orbit[site].complete[claim] = true;
  for (const Motion& motion : claims_[claim].motions[static_cast<std::size_t>(piece)]) {
    const Vector3d image = motion(point);
    const auto same = std::ranges::find_if(sample.orbit, [&](const Site& known) { return near(known.point, image); });
    int at = same == sample.orbit.end() ? -1 : static_cast<int>(same - sample.orbit.begin());
    if (at < 0 && !continuous(claim)) at = find(sample.orbit, image);
    if (at < 0) {
      at = static_cast<int>(sample.orbit.size());
      open.push_back(sample.orbit.size());
      sample.orbit.push_back({image, atom_at(image), std::vector<bool>(claims_.size(), false)});
    }
    sample.orbit[static_cast<std::size_t>(at)].complete[claim] = true;
  }
}

}  // namespace orbifit
