#include "orbifit/subspace/contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "orbifit/model/random.h"
#include "orbifit/model/topology.h"
#include "orbifit/subspace/moving_surface.h"

#include "touching_points.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr int kContactTrials = 2;      // random displacements
constexpr double kSameContact = 1e-9;  // of a random displacement: two contacts that differ less are images
constexpr double kNoGap = 1e-9;        // of the diagonal: what lies nearer is one place

using Looks = std::array<double, 4>;

// What no symmetry changes of a contact: of its gap at rest, and of what random displacements make of it.
struct LookAtContact {
  Looks looks;
  int number;
};

Vector3d difference(const TouchingPoints& touching, const Mesh& mesh, const Points& of_vertices) {
  Vector3d result = Vector3d::Zero();
  for (std::size_t side = 0; side < 2; ++side) {
    const FacePoint& point = touching.points[side];
    for (int k = 0; k < 3; ++k) {
      result += (side == 0 ? 1 : -1) * point.barycentric[k] * of_vertices.row(mesh.faces(point.face, k)).transpose();
    }
  }
  return result;
}

// Those whose gap displacements open, with what is looked at, in the order of the latter.
std::vector<LookAtContact> look_at(const std::vector<TouchingPoints>& touching, const Subspace& subspace,
                                   const Mesh& mesh, const RunContext& context) {
  Random random(11, "contacts");
  std::array<Points, kContactTrials> moved;
  double size = 0;
  for (Points& each : moved) {
    Eigen::VectorXd q(subspace.degrees_of_freedom());
    for (double& coordinate : q) coordinate = random.normal();
    each = vertex_displacements(subspace, {q, nullptr}, context);
    size = std::max(size, each.rowwise().norm().maxCoeff());
  }
  std::vector<LookAtContact> result;
  if (!(size > 0)) return result;
  for (std::size_t i = 0; i < touching.size(); ++i) {
    const Vector3d first = difference(touching[i], mesh, moved[0]) / size;
    const Vector3d second = difference(touching[i], mesh, moved[1]) / size;
    if (first.norm() < kSameContact && second.norm() < kSameContact) continue;
    result.push_back(
        {{first.norm(), second.norm(), (first - second).norm(), touching[i].gap.norm() / subspace.diagonal},
         static_cast<int>(i)});
  }
  std::ranges::stable_sort(result, {}, &LookAtContact::looks);
  return result;
}

bool alike(const Looks& a, const Looks& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most <= kSameContact;
}

// Orbits: contacts that look alike, each list ascending; those with the smaller gaps first, then by number.
std::vector<std::vector<int>> orbits_of(const std::vector<LookAtContact>& looks) {
  struct Found {
    double gap;
    std::vector<int> numbers;
  };
  std::vector<Found> found;
  std::vector<char> taken(looks.size(), 0);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (taken[i] != 0) continue;
    const double gap = looks[i].looks[3];
    Found& orbit = found.emplace_back(Found{gap < kNoGap ? 0 : gap, {}});
    for (std::size_t j = i; j < looks.size() && looks[j].looks[0] - looks[i].looks[0] <= kSameContact; ++j) {
      if (taken[j] != 0 || !alike(looks[i].looks, looks[j].looks)) continue;
      taken[j] = 1;
      orbit.numbers.push_back(looks[j].number);
    }
    std::ranges::sort(orbit.numbers);
  }
  std::ranges::stable_sort(found, [](const Found& a, const Found& b) {
    return a.gap != b.gap ? a.gap < b.gap : a.numbers.front() < b.numbers.front();
  });
  std::vector<std::vector<int>> result;
  for (Found& orbit : found) result.push_back(std::move(orbit.numbers));
  return result;
}

// Points kept so far, pair of parts by pair.
class Kept {
 public:
  /// \param spacing  of each of the touching points: how far from it the next is kept
  Kept(const std::vector<TouchingPoints>& touching, const std::vector<double>& spacing)
      : touching_(touching), spacing_(spacing) {}

  bool near(int number) const { return distance(number) < spacing_[static_cast<std::size_t>(number)]; }

  void add(int number) { by_parts_[at(number).parts].push_back(number); }

  /// From a point to the nearest one kept, which is told as well.
  double distance(int number, int* nearest = nullptr) const {
    double least = std::numeric_limits<double>::infinity();
    const auto pair = by_parts_.find(at(number).parts);
    if (pair == by_parts_.end()) return least;
    for (const int other : pair->second) {
      const double here = (at(other).middle - at(number).middle).norm();
      if (here >= least) continue;
      least = here;
      if (nearest != nullptr) *nearest = other;
    }
    return least;
  }

 private:
  const TouchingPoints& at(int number) const { return touching_[static_cast<std::size_t>(number)]; }

  const std::vector<TouchingPoints>& touching_;
  const std::vector<double>& spacing_;
  std::map<std::array<int, 2>, std::vector<int>> by_parts_;
};

using Orbits = std::vector<std::vector<int>>;

// Whole orbits, those nearer to others than the spacing left out, and of each what is not too near to itself.
Orbits thinned(const Orbits& orbits, Kept& kept) {
  Orbits result;
  for (const std::vector<int>& orbit : orbits) {
    if (kept.near(orbit.front())) continue;
    std::vector<int>& apart = result.emplace_back();
    for (const int number : orbit) {
      if (kept.near(number)) continue;
      kept.add(number);
      apart.push_back(number);
    }
  }
  return result;
}

// As wide as asked for, but joints smaller than that are held at several points: one alone would let a part roll.
std::vector<double> spacing_of(const Orbits& orbits, const std::vector<TouchingPoints>& touching, double widest) {
  constexpr double kOfExtent = 0.6;  // of how far a joint reaches from one of its points: about five about a round one
  std::vector<double> spacing(touching.size(), widest);
  Kept kept(touching, spacing);
  thinned(orbits, kept);
  std::vector<double> extent(touching.size(), 0);
  std::vector<int> nearest(touching.size(), -1);
  for (const std::vector<int>& orbit : orbits) {
    for (const int number : orbit) {
      const auto i = static_cast<std::size_t>(number);
      const double distance = kept.distance(number, &nearest[i]);
      double& reach = extent[static_cast<std::size_t>(nearest[i])];
      reach = std::max(reach, distance);
    }
  }
  for (std::size_t i = 0; i < touching.size(); ++i) {
    if (nearest[i] >= 0) spacing[i] = std::min(widest, kOfExtent * extent[static_cast<std::size_t>(nearest[i])]);
  }
  return spacing;
}

// The sample of a part nearest to a point; of all samples, where the part has none.
class NearestSample {
 public:
  NearestSample(const Points& samples, const Mesh& mesh, const std::vector<int>& part_of_face) : samples_(samples) {
    const MovingSurface surface(mesh);
    for (Index k = 0; k < samples.rows(); ++k) {
      const int face = surface.nearest(samples.row(k).transpose()).face;
      part_of_sample_.push_back(face < 0 ? -1 : part_of_face[static_cast<std::size_t>(face)]);
    }
  }

  int operator()(const Vector3d& point, int part) const {
    int best = 0;
    std::pair<bool, double> least{true, std::numeric_limits<double>::infinity()};
    for (Index k = 0; k < samples_.rows(); ++k) {
      const std::pair<bool, double> here{part_of_sample_[static_cast<std::size_t>(k)] != part,
                                         (samples_.row(k).transpose() - point).squaredNorm()};
      if (!(here < least)) continue;
      least = here;
      best = static_cast<int>(k);
    }
    return best;
  }

 private:
  const Points& samples_;
  std::vector<int> part_of_sample_;
};

Contact contact_of(const TouchingPoints& touching, const Mesh& mesh, const NearestSample& nearest, double count) {
  Contact contact;
  for (std::size_t side = 0; side < 2; ++side) {
    const FacePoint& point = touching.points[side];
    for (int k = 0; k < 3; ++k) contact.sides[side].vertices[static_cast<std::size_t>(k)] = mesh.faces(point.face, k);
    contact.sides[side].weights = point.barycentric;
    contact.sides[side].sample = nearest(touching.middle, touching.parts[side]);
  }
  contact.point = touching.middle;
  contact.gap = touching.gap;
  contact.count = count;
  return contact;
}

}  // namespace

std::vector<Contact> find_contacts(const Subspace& subspace, const Mesh& mesh, const ContactOptions& options,
                                   const RunContext& context) {
  const Components parts = touching_parts(mesh, weld_vertices(mesh.vertices));
  if (parts.faces.size() < 2) return {};
  const double spacing = options.spacing * subspace.sampling.radius;
  const std::vector<TouchingPoints> touching =
      touching_points(mesh, parts.component_of_face, options.tolerance * subspace.diagonal, spacing, context);
  if (touching.empty()) return {};
  const Orbits orbits = orbits_of(look_at(touching, subspace, mesh, context));
  const std::vector<double> spacings = spacing_of(orbits, touching, spacing);
  Kept kept(touching, spacings);
  const NearestSample nearest(subspace.sampling.points, mesh, parts.component_of_face);
  std::vector<Contact> contacts;
  for (const std::vector<int>& orbit : thinned(orbits, kept)) {
    const std::size_t rows = options.representatives ? 1 : orbit.size();
    const double count = static_cast<double>(orbit.size()) / static_cast<double>(rows);
    for (std::size_t i = 0; i < rows; ++i) {
      contacts.push_back(contact_of(touching[static_cast<std::size_t>(orbit[i])], mesh, nearest, count));
    }
  }
  return contacts;
}

Vector3d turned_gap(const Contact& contact, const std::array<Eigen::Matrix3d, 2>& turned) {
  return 0.5 * (turned[0] * contact.gap + turned[1] * contact.gap) - contact.gap;
}

Eigen::MatrixXd contact_rows(const std::vector<Contact>& contacts, const Subspace& subspace,
                             const CarriedBasis& basis) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * static_cast<Index>(contacts.size()), basis.degrees_of_freedom());
  Eigen::Matrix3Xd of_vertex(3, rows.cols());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      const Contact::Side& at = contacts[i].sides[side];
      for (std::size_t k = 0; k < 3; ++k) {
        const double weight = (side == 0 ? 1 : -1) * at.weights[static_cast<Index>(k)];
        if (weight == 0) continue;
        of_vertex.setZero();
        add_vertex_rows(subspace, basis, at.vertices[k], of_vertex);
        rows.middleRows<3>(3 * static_cast<Index>(i)) += weight * of_vertex;
      }
    }
  }
  return rows;
}

}  // namespace orbifit
