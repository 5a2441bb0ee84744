#include "evidence/claim_quotient.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "base/random.h"
#include "evidence/policy.h"
#include "geometry/sampling.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

}  // namespace

ClaimQuotient::ClaimQuotient(const PreparedMesh& prepared, const std::vector<SymmetryClaim>& claims,
                             const ClaimAtoms& atoms, double tolerance, const RunContext& context)
    : prepared_(prepared), claims_(claims), atoms_(atoms), tolerance_(tolerance), context_(context) {
  std::vector<double> areas(atoms.count(), 0);  // of the atoms
  std::vector<double> named(claims.size(), 0);
  for (std::size_t atom = 0; atom < atoms.count(); ++atom) {
    if (!atoms.faces(atom).empty()) areas[atom] = area_of(prepared, atoms.faces(atom));
    for (std::size_t claim = 0; claim < claims.size(); ++claim) {
      if (atoms.piece(claim, static_cast<int>(atom)) >= 0) named[claim] += areas[atom];
    }
  }
  // Where borders that are drawn face by face differ: of next to nothing of each claim that names it.
  const auto is_sliver = [&](std::size_t atom) {
    for (std::size_t claim = 0; claim < claims.size(); ++claim) {
      if (atoms.piece(claim, static_cast<int>(atom)) < 0) continue;
      if (areas[atom] > kEvidencePolicy.sliver * named[claim]) return false;
    }
    return true;
  };
  Random random(context.seed, "quotient");
  for (std::size_t atom = 0; atom < atoms.count(); ++atom) {
    const double area = areas[atom];
    if (!(area > 0)) continue;
    const int least = is_sliver(atom) ? 1 : kQuotientResolution.samples_of_atom;
    const int count =
        std::max(least, static_cast<int>(std::lround(kQuotientResolution.samples * area / prepared.area)));
    const SurfaceSamples samples =
        sample_surface(prepared.mesh, prepared.areas, prepared.normals, count, random, atoms.faces(atom));
    for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
      Sample& sample = samples_.emplace_back(Sample{area / count, NearPoints(0.5 * tolerance), {}, {}});
      sample.points.add(samples.points.row(i));
      sample.orbit.push_back({static_cast<int>(atom), std::vector<bool>(claims.size(), false)});
    }
  }
}

double ClaimQuotient::area() const {
  double sum = 0;
  for (const Sample& sample : samples_) sum += sample.weight / static_cast<double>(sample.orbit.size());
  return sum;
}

ClaimQuotient::NamedArea ClaimQuotient::named_area(const std::vector<std::size_t>& family) const {
  NamedArea result;
  for (const Sample& sample : samples_) {
    const auto named = [&](const Site& site) {
      return std::ranges::any_of(family, [&](std::size_t claim) { return atoms_.piece(claim, site.atom) >= 0; });
    };
    if (named(sample.orbit.front())) result.all += sample.weight;
    if (std::ranges::any_of(sample.orbit, named)) {
      result.left += sample.weight / static_cast<double>(sample.orbit.size());
    }
  }
  return result;
}

bool ClaimQuotient::lies_within_accepted(const std::vector<std::size_t>& family) const {
  return std::ranges::all_of(family, [&](std::size_t claim) {
    const double area = named_area({claim}).all;
    const bool whole = std::ranges::all_of(
        samples_, [&](const Sample& sample) { return atoms_.piece(claim, sample.orbit.front().atom) >= 0; });
    return std::ranges::any_of(accepted_, [&](std::size_t known) {
      double outside = 0;
      for (const Sample& sample : samples_) {
        const int atom = sample.orbit.front().atom;
        if (atoms_.piece(claim, atom) >= 0 && atoms_.piece(known, atom) < 0) outside += sample.weight;
      }
      return outside <= (whole ? 0 : kEvidencePolicy.sliver * area);
    });
  });
}

bool ClaimQuotient::near(const Vector3d& a, const Vector3d& b) const {
  return (a - b).squaredNorm() <= 0.25 * tolerance_ * tolerance_;
}

// Of a continuous group: whether its rotations take the points to one another. Mirrors through the axis and across it
// are among the motions.
bool ClaimQuotient::on_one_circle(std::size_t claim, const Vector3d& a, const Vector3d& b) const {
  const Region& region = *claims_[claim].region;
  const Vector3d from = a - region.centre;
  const Vector3d to = b - region.centre;
  if (!region.group.has_axis()) return std::abs(from.norm() - to.norm()) <= 0.5 * tolerance_;
  const double up_from = region.axis.dot(from);
  const double up_to = region.axis.dot(to);
  const double along = up_from - up_to;
  const double most = 0.25 * tolerance_ * tolerance_;
  if (along * along > most) return false;
  const double apart = (from - up_from * region.axis).norm() - (to - up_to * region.axis).norm();
  return apart * apart + along * along <= most;
}

// Of continuous groups: whether what the second turns into itself the first does too.
bool ClaimQuotient::turns_alike(std::size_t known, std::size_t claim) const {
  const Region& a = *claims_[known].region;
  const Region& b = *claims_[claim].region;
  const Vector3d apart = b.centre - a.centre;
  if (!a.group.has_axis()) {
    return b.group.has_axis() ? apart.cross(b.axis).norm() <= 0.5 * tolerance_ : near(a.centre, b.centre);
  }
  return b.group.has_axis() && a.axis.cross(b.axis).norm() <= tolerance_ &&
         apart.cross(a.axis).norm() <= 0.5 * tolerance_;
}

int ClaimQuotient::find(const Sample& sample, const Vector3d& point) const {
  const int found = sample.points.first_near(point);
  if (found >= 0) return found;
  const auto circle = std::ranges::find_if(
      sample.circles, [&](const Circle& each) { return on_one_circle(each.claim, sample.points[each.site], point); });
  return circle == sample.circles.end() ? -1 : static_cast<int>(circle->site);
}

int ClaimQuotient::atom_at(const Vector3d& point) const {
  const SurfaceIndex::Nearest nearest = prepared_.index->nearest(point, kQuotientResolution.reach * tolerance_);
  return nearest.face < 0 ? -1 : atoms_.of_face(nearest.face);
}

// Of the orbit that the claim gives a point, n points of which e are known to be in one orbit: of n / e orbits one is
// left. Points on circles that are known to be filled count once for the circle.
double ClaimQuotient::saved_share(const Sample& sample, std::size_t number, std::size_t claim) const {
  const Site& site = sample.orbit[number];
  if (site.complete[claim]) return 0;
  std::vector<std::size_t> filled;  // continuous claims whose circles through the point are known
  std::ranges::copy_if(continuous_, std::back_inserter(filled),
                       [&](std::size_t known) { return site.complete[known]; });
  // Whether the claim turns the point along a circle that is not yet known.
  const bool fills =
      continuous(claim) && std::ranges::none_of(filled, [&](std::size_t known) { return turns_alike(known, claim); });
  NearPoints images(0.5 * tolerance_);
  images.add(sample.points[number]);
  std::size_t known = 1;
  for (const Motion& motion : claims_[claim].motions[static_cast<std::size_t>(atoms_.piece(claim, site.atom))]) {
    const Vector3d image = motion(sample.points[number]);
    bool repeated = images.first_near(image) >= 0;
    for (std::size_t i = 0; i < images.size() && !repeated && !filled.empty(); ++i) {
      repeated = std::ranges::any_of(filled, [&](std::size_t each) { return on_one_circle(each, images[i], image); });
    }
    if (repeated) continue;
    if (!fills && find(sample, image) >= 0) ++known;
    images.add(image);
  }
  // The finite group in place of a continuous one need not hold the elements that are known.
  if (fills) {
    known = 0;
    for (std::size_t i = 0; i < sample.points.size(); ++i) {
      known += on_one_circle(claim, sample.points[i], sample.points[number]) ? 1 : 0;
    }
  }
  return std::max(0.0, 1 - static_cast<double>(known) / static_cast<double>(images.size()));
}

double ClaimQuotient::saving(const std::vector<std::size_t>& family) const {
  std::vector<double> saved(samples_.size(), 0);
  const auto ask = [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Sample& sample = samples_[s];
      double share = 0;  // members that hold points of one orbit save the same
      for (const std::size_t claim : family) {
        const auto site =
            std::ranges::find_if(sample.orbit, [&](const Site& each) { return atoms_.piece(claim, each.atom) >= 0; });
        if (site == sample.orbit.end()) continue;
        share = std::max(share, saved_share(sample, static_cast<std::size_t>(site - sample.orbit.begin()), claim));
      }
      saved[s] = share * sample.weight / static_cast<double>(sample.orbit.size());
    }
  };
  parallel_for(context_, samples_.size(), ask, 16);
  return std::accumulate(saved.begin(), saved.end(), 0.0);
}

void ClaimQuotient::accept(const std::vector<std::size_t>& family) {
  accepted_.insert(accepted_.end(), family.begin(), family.end());
  std::ranges::copy_if(family, std::back_inserter(continuous_), [&](std::size_t claim) { return continuous(claim); });
  parallel_for(
      context_, samples_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) extend(samples_[s], family);
      },
      16);
  context_.check();
}

// The points that are known are complete under all that was accepted before.
void ClaimQuotient::extend(Sample& sample, const std::vector<std::size_t>& news) const {
  const std::size_t known = sample.orbit.size();
  for (std::size_t site = 0; site < sample.orbit.size(); ++site) {
    for (const std::size_t claim : site < known ? news : accepted_) {
      if (sample.orbit.size() >= kQuotientResolution.orbit) return;
      expand(sample, site, claim);
    }
  }
}

void ClaimQuotient::expand(Sample& sample, std::size_t site, std::size_t claim) const {
  if (sample.orbit[site].complete[claim]) return;
  const int piece = atoms_.piece(claim, sample.orbit[site].atom);
  if (piece < 0) return;
  const Vector3d point = sample.points[site];
  std::vector<std::size_t> arrived{site};
  for (const Motion& motion : claims_[claim].motions[static_cast<std::size_t>(piece)]) {
    const Vector3d image = motion(point);
    int at = find(sample, image);
    if (at < 0) {
      at = static_cast<int>(sample.orbit.size());
      sample.points.add(image);
      sample.orbit.push_back({atom_at(image), std::vector<bool>(claims_.size(), false)});
    }
    arrived.push_back(static_cast<std::size_t>(at));
  }
  for (const std::size_t each : arrived) sample.orbit[each].complete[claim] = true;
  if (!continuous(claim)) return;
  for (const std::size_t each : arrived) {
    const bool known = std::ranges::any_of(sample.circles, [&](const Circle& circle) {
      return circle.claim == claim && on_one_circle(claim, sample.points[circle.site], sample.points[each]);
    });
    if (!known) sample.circles.push_back({claim, each});
  }
  // The other points on the circles that are now filled.
  for (std::size_t i = 0; i < sample.orbit.size(); ++i) {
    Site& other = sample.orbit[i];
    if (other.complete[claim] || atoms_.piece(claim, other.atom) < 0) continue;
    other.complete[claim] = std::ranges::any_of(
        arrived, [&](std::size_t each) { return on_one_circle(claim, sample.points[each], sample.points[i]); });
  }
}

}  // namespace orbifit
