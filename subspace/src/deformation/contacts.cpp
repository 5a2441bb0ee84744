#include "deformation/contacts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/random.h"
#include "basis/subspace_parts.h"
#include "deformation/touching_points.h"
#include "geometry/grid_cell.h"
#include "geometry/topology.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr int kContactTrials = 2;      // random displacements
constexpr double kSameContact = 1e-9;  // of a random displacement: two contacts that differ less are images
constexpr double kNoGap = 1e-9;        // of the diagonal: what lies nearer is one place

using Numbers = std::vector<int>;

// A contact to be: one pair of touching points, or all of a joint.
struct Candidate {
  Numbers touching;
  std::array<int, 2> parts;
  Vector3d middle;
  Vector3d gap;
};

Candidate candidate_of(const std::vector<TouchingPoints>& touching, const Numbers& numbers) {
  Candidate result{numbers, touching[static_cast<std::size_t>(numbers.front())].parts, Vector3d::Zero(),
                   Vector3d::Zero()};
  for (const int number : numbers) {
    result.middle += touching[static_cast<std::size_t>(number)].middle;
    result.gap += touching[static_cast<std::size_t>(number)].gap;
  }
  result.middle /= static_cast<double>(numbers.size());
  result.gap /= static_cast<double>(numbers.size());
  return result;
}

// What no symmetry changes of a contact: what random displacements make of its gap, and the gap at rest.
using Looks = std::array<double, 4>;
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

// Looks at contacts under random displacements of a basis.
class ContactTrials {
 public:
  ContactTrials(const Subspace& subspace, const Mesh& mesh, const RunContext& context)
      : mesh_(mesh), diagonal_(subspace->diagonal) {
    Random random(11, "contacts");
    for (Points& each : moved_) {
      Eigen::VectorXd q(subspace.degrees_of_freedom());
      for (double& coordinate : q) coordinate = random.normal();
      each = vertex_displacements(subspace, {q, nullptr}, context);
      size_ = std::max(size_, each.rowwise().norm().maxCoeff());
    }
  }

  // Of those whose gap displacements open, in the order of what is seen.
  std::vector<LookAtContact> look_at(const std::vector<Candidate>& candidates,
                                     const std::vector<TouchingPoints>& touching) const {
    std::vector<LookAtContact> result;
    if (!(size_ > 0)) return result;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      std::array<Vector3d, kContactTrials> mean{Vector3d::Zero(), Vector3d::Zero()};
      for (std::size_t k = 0; k < mean.size(); ++k) {
        for (const int number : candidates[i].touching) {
          mean[k] += difference(touching[static_cast<std::size_t>(number)], mesh_, moved_[k]);
        }
        mean[k] /= size_ * static_cast<double>(candidates[i].touching.size());
      }
      if (mean[0].norm() < kSameContact && mean[1].norm() < kSameContact) continue;
      result.push_back(
          {{mean[0].norm(), mean[1].norm(), (mean[0] - mean[1]).norm(), candidates[i].gap.norm() / diagonal_},
           static_cast<int>(i)});
    }
    std::ranges::stable_sort(result, {}, &LookAtContact::looks);
    return result;
  }

 private:
  const Mesh& mesh_;
  double diagonal_;
  double size_ = 0;
  std::array<Points, kContactTrials> moved_;
};

bool alike(const Looks& a, const Looks& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most <= kSameContact;
}

using Orbits = std::vector<Numbers>;

// Contacts that look alike, each list ascending; those with the smaller gaps first, then by number.
Orbits orbits_of(const std::vector<LookAtContact>& looks) {
  struct Found {
    double gap;
    Numbers numbers;
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
  Orbits result;
  for (Found& orbit : found) result.push_back(std::move(orbit.numbers));
  return result;
}

// Candidates kept so far, by pair of parts and cell of a grid.
class Kept {
 public:
  // How far from each candidate the next is kept. The context is asked whether to stop.
  Kept(const std::vector<Candidate>& candidates, const std::vector<double>& spacing, const RunContext& context)
      : candidates_(candidates), spacing_(spacing), context_(context) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      double& width = width_[candidates[i].parts];
      width = std::max(width, spacing[i]);
    }
  }

  // Whether another one is kept nearer than the spacing.
  bool near(int number) const {
    constexpr double kRounding = 1e-9;  // of the spacing
    context_.check();
    const Candidate& here = at(number);
    const double spacing = spacing_[static_cast<std::size_t>(number)];
    const double width = width_.at(here.parts);
    const Cell low = cell_at(here.middle.array() - (1 + kRounding) * spacing, here.parts, width);
    const Cell high = cell_at(here.middle.array() + (1 + kRounding) * spacing, here.parts, width);
    Cell cell = low;
    for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) {
      for (cell[3] = low[3]; cell[3] <= high[3]; ++cell[3]) {
        for (cell[4] = low[4]; cell[4] <= high[4]; ++cell[4]) {
          const auto entry = by_cell_.find(cell);
          if (entry == by_cell_.end()) continue;
          const bool any = std::ranges::any_of(
              entry->second, [&](int other) { return (at(other).middle - here.middle).norm() < spacing; });
          if (any) return true;
        }
      }
    }
    return false;
  }

  void add(int number) {
    by_cell_[cell_of(number)].push_back(number);
    by_parts_[at(number).parts].push_back(number);
  }

  // The nearest one that is kept between the same parts, of several the first; the candidate itself where none is
  // within their widest spacing.
  int nearest(int number) const {
    context_.check();
    const Candidate& here = at(number);
    const double width = width_.at(here.parts);
    const Cell middle = cell_at(here.middle, here.parts, width);
    double least = std::numeric_limits<double>::infinity();
    int result = number;
    for (const int neighbour : kFromTheMiddle) {
      Cell cell = middle;
      double squared = 0;  // from there to the cell, in its widths
      for (int axis = 0, rest = neighbour; axis < 3; ++axis, rest /= 3) {
        const int step = rest % 3 - 1;
        const auto k = static_cast<std::size_t>(2 + axis);
        const double place = here.middle[axis] / width - static_cast<double>(middle[k]);
        const double gap = step == 0 ? 0 : step < 0 ? place : 1 - place;
        squared += gap * gap;
        cell[k] += step;
      }
      constexpr double kSure = 1 - 1e-9;  // whatever rounding does
      if (kSure * std::sqrt(squared) * width > least) continue;
      const auto entry = by_cell_.find(cell);
      if (entry == by_cell_.end()) continue;
      for (const int other : entry->second) {
        const double distance = (at(other).middle - here.middle).norm();
        if (distance > least || (distance == least && other > result)) continue;
        least = distance;
        result = other;
      }
    }
    return result;
  }

  const std::map<std::array<int, 2>, Numbers>& by_parts() const { return by_parts_; }

 private:
  using Cell = std::array<std::int64_t, 5>;  // both parts, and the cell in space

  const Candidate& at(int number) const { return candidates_[static_cast<std::size_t>(number)]; }

  // Numbers of neighbouring cells, each axis' step a digit of three: the cell itself, then those around it.
  static constexpr std::array<int, 27> kFromTheMiddle{13, 0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12,
                                                      14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};

  static Cell cell_at(const Vector3d& point, const std::array<int, 2>& parts, double width) {
    const auto [x, y, z] = grid_cell(point, width);
    return {parts[0], parts[1], x, y, z};
  }
  Cell cell_of(int number) const { return cell_at(at(number).middle, at(number).parts, width_.at(at(number).parts)); }

  const std::vector<Candidate>& candidates_;
  const std::vector<double>& spacing_;
  const RunContext& context_;
  std::map<std::array<int, 2>, double> width_;  // of cells
  std::unordered_map<Cell, Numbers, CellHash> by_cell_;
  std::map<std::array<int, 2>, Numbers> by_parts_;
};

// Whole orbits, those nearer to others than the spacing left out, and of each what is not too near to itself.
Orbits thinned(const Orbits& orbits, Kept& kept) {
  Orbits result;
  for (const Numbers& orbit : orbits) {
    if (kept.near(orbit.front())) continue;
    Numbers& apart = result.emplace_back();
    for (const int number : orbit) {
      if (kept.near(number)) continue;
      kept.add(number);
      apart.push_back(number);
    }
  }
  return result;
}

// Thinned out, ever more until there are few orbits.
Orbits few_of(const Orbits& orbits, const std::vector<Candidate>& candidates, std::vector<double>& spacing, int most,
              const RunContext& context) {
  constexpr double kWider = 1.4;  // half as many on a surface
  for (int round = 0;; ++round) {
    constexpr int kMaxRounds = 20;  // each pair of parts keeps one at least
    Kept kept(candidates, spacing, context);
    Orbits result = thinned(orbits, kept);
    if (result.size() <= static_cast<std::size_t>(most) || round == kMaxRounds) return result;
    for (double& each : spacing) each *= kWider;
  }
}

// Where candidates are: of which joint each is, and how far it should stay from others.
struct Joints {
  std::vector<Numbers> members;
  std::vector<char> small;      // whether a joint is one contact
  std::vector<double> spacing;  // by candidate
};

// Joints between two parts: candidates that hang together. Those smaller than the spacing are held at several points if
// they are not one contact: a single point would let a part roll.
Joints joints_of(const std::vector<Candidate>& candidates, const Orbits& orbits, const std::vector<double>& small_size,
                 double widest, const RunContext& context) {
  constexpr double kOfExtent = 0.6;  // of how far a joint reaches from one of its points: about five about a round one
  constexpr double kMinSpacing = 1e-3;  // of the widest
  Joints result;
  if (orbits.empty()) return result;
  result.spacing.assign(candidates.size(), widest);
  // As fine as the joints that are to be told apart.
  for (std::size_t i = 0; i < candidates.size(); ++i)
    result.spacing[i] = std::clamp(0.25 * small_size[i], kMinSpacing * widest, widest);
  Kept kept(candidates, result.spacing, context);
  thinned(orbits, kept);
  DisjointSets hanging(candidates.size());
  for (const auto& [parts, numbers] : kept.by_parts()) {
    for (std::size_t a = 0; a < numbers.size(); ++a) {
      context.check();
      for (std::size_t b = a + 1; b < numbers.size(); ++b) {
        const auto first = static_cast<std::size_t>(numbers[a]);
        const auto second = static_cast<std::size_t>(numbers[b]);
        if ((candidates[first].middle - candidates[second].middle).norm() <= small_size[first]) {
          hanging.unite(numbers[a], numbers[b]);
        }
      }
    }
  }
  std::map<int, std::size_t> number_of;
  for (const Numbers& orbit : orbits) {
    for (const int number : orbit) {
      const auto [entry, added] = number_of.try_emplace(hanging.root(kept.nearest(number)), result.members.size());
      if (added) result.members.emplace_back();
      result.members[entry->second].push_back(number);
    }
  }
  for (Numbers& joint : result.members) {
    std::ranges::sort(joint);
    const Candidate whole = [&] {
      Candidate mean{{}, {}, Vector3d::Zero(), Vector3d::Zero()};
      for (const int number : joint) mean.middle += candidates[static_cast<std::size_t>(number)].middle;
      mean.middle /= static_cast<double>(joint.size());
      return mean;
    }();
    double reach = 0;
    for (const int number : joint) {
      reach = std::max(reach, (candidates[static_cast<std::size_t>(number)].middle - whole.middle).norm());
    }
    result.small.push_back(2 * reach <= small_size[static_cast<std::size_t>(joint.front())] ? 1 : 0);
    for (const int number : joint) {
      result.spacing[static_cast<std::size_t>(number)] =
          std::clamp(2 * kOfExtent * reach, kMinSpacing * widest, widest);
    }
  }
  return result;
}

// One of those at each place, so that what many edges and faces share counts once.
Numbers at_different_places(Numbers numbers, const std::vector<TouchingPoints>& touching, double same) {
  const auto middle = [&](int number) { return touching[static_cast<std::size_t>(number)].middle; };
  std::ranges::stable_sort(numbers, [&](int a, int b) { return middle(a).x() < middle(b).x(); });
  Numbers result;
  for (const int number : numbers) {
    bool met = false;
    for (std::size_t k = result.size(); k > 0 && !met; --k) {
      const Vector3d off = middle(number) - middle(result[k - 1]);
      if (off.x() > same) break;
      met = off.norm() <= same;
    }
    if (!met) result.push_back(number);
  }
  std::ranges::sort(result);
  return result;
}

// Where the parts of a joint meet; where they only come near, if they meet nowhere.
Numbers places_of(const Numbers& joint, const std::vector<TouchingPoints>& touching, double no_gap) {
  Numbers meeting;
  std::ranges::copy_if(joint, std::back_inserter(meeting),
                       [&](int number) { return touching[static_cast<std::size_t>(number)].gap.norm() < no_gap; });
  return at_different_places(meeting.empty() ? joint : std::move(meeting), touching, no_gap);
}

// Twice the largest distance from the mean of a part's vertices, which turning does not change.
std::vector<double> part_lengths(const Mesh& mesh, const Components& parts) {
  std::vector<double> result;
  for (const std::vector<int>& faces : parts.faces) {
    const Points points = mesh.vertices(vertices_of_faces(mesh, faces), Eigen::all);
    const Eigen::RowVector3d mean = points.colwise().mean();
    result.push_back(2 * (points.rowwise() - mean).rowwise().norm().maxCoeff());
  }
  return result;
}

// The sample of a part nearest to a point, of several the first; of all samples, where the part has none.
class NearestSample {
 public:
  NearestSample(const Points& samples, const MovingSurface& surface, const std::vector<int>& part_of_face)
      : samples_(samples), all_(static_cast<std::size_t>(samples.rows())) {
    std::iota(all_.begin(), all_.end(), 0);
    for (const int k : all_) {
      const int face = surface.nearest(samples.row(k).transpose()).face;
      if (face >= 0) of_part_[part_of_face[static_cast<std::size_t>(face)]].push_back(k);
    }
  }

  int operator()(const Vector3d& point, int part) const {
    const auto own = of_part_.find(part);
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const int k : own != of_part_.end() ? own->second : all_) {
      const double squared = (samples_.row(k).transpose() - point).squaredNorm();
      if (!(squared < least)) continue;
      least = squared;
      best = k;
    }
    return best;
  }

 private:
  const Points& samples_;
  Numbers all_;
  std::unordered_map<int, Numbers> of_part_;
};

Contact contact_of(const Candidate& candidate, const std::vector<TouchingPoints>& touching, const Mesh& mesh,
                   const NearestSample& nearest, double count) {
  Contact contact;
  for (std::size_t side = 0; side < 2; ++side) {
    std::map<int, double> weights;
    for (const int number : candidate.touching) {
      const FacePoint& point = touching[static_cast<std::size_t>(number)].points[side];
      for (int k = 0; k < 3; ++k) {
        if (point.barycentric[k] == 0) continue;
        weights[mesh.faces(point.face, k)] += point.barycentric[k] / static_cast<double>(candidate.touching.size());
      }
    }
    contact.sides[side].vertices.assign(weights.begin(), weights.end());
    contact.sides[side].sample = nearest(candidate.middle, candidate.parts[side]);
  }
  contact.point = candidate.middle;
  contact.gap = candidate.gap;
  contact.count = count;
  return contact;
}

}  // namespace

struct ContactSearch::Parts {
  Parts(const Mesh& mesh, Components of_mesh, double tolerance, const RunContext& context)
      : parts(std::move(of_mesh)),
        lengths(part_lengths(mesh, parts)),
        touching(mesh, parts.component_of_face, tolerance, context) {}

  Components parts;
  std::vector<double> lengths;
  TouchingSearch touching;
};

ContactSearch::ContactSearch(const Mesh& mesh, std::shared_ptr<const MovingSurface> surface,
                             const ContactOptions& options, const RunContext& context)
    : mesh_(mesh), surface_(std::move(surface)), options_(options) {
  Components parts = touching_parts(mesh, weld_vertices(mesh.vertices));
  if (parts.faces.size() < 2) return;
  parts_ = std::make_unique<const Parts>(mesh, std::move(parts), options.tolerance * diagonal(mesh.vertices), context);
}

ContactSearch::~ContactSearch() = default;

std::vector<Contact> find_contacts(const Subspace& subspace, const Mesh& mesh, const ContactOptions& options,
                                   const RunContext& context) {
  return ContactSearch(mesh, std::make_shared<const MovingSurface>(mesh), options, context).in(subspace, context);
}

std::vector<Contact> ContactSearch::in(const Subspace& subspace, const RunContext& context) const {
  if (!parts_) return {};
  const Mesh& mesh = mesh_;
  const ContactOptions& options = options_;
  const double spacing = options.spacing * subspace->sampling.radius;
  const std::vector<TouchingPoints> touching = parts_->touching.points(spacing, context);
  if (touching.empty()) return {};
  const ContactTrials trials(subspace, mesh, context);
  const NearestSample nearest(subspace->sampling.points, *surface_, parts_->parts.component_of_face);
  std::vector<Contact> contacts;
  const auto keep = [&](const std::vector<Candidate>& candidates, const Orbits& orbits) {
    for (const Numbers& orbit : orbits) {
      const std::size_t rows = options.representatives ? 1 : orbit.size();
      const double each = static_cast<double>(orbit.size()) / static_cast<double>(rows);
      for (std::size_t i = 0; i < rows; ++i) {
        contacts.push_back(contact_of(candidates[static_cast<std::size_t>(orbit[i])], touching, mesh, nearest, each));
      }
    }
  };

  std::vector<Candidate> points;
  std::vector<double> small_size;
  const std::vector<double>& lengths = parts_->lengths;
  for (std::size_t i = 0; i < touching.size(); ++i) {
    points.push_back(candidate_of(touching, {static_cast<int>(i)}));
    const auto [a, b] = touching[i].parts;
    small_size.push_back(options.joint *
                         std::min(lengths[static_cast<std::size_t>(a)], lengths[static_cast<std::size_t>(b)]));
  }
  const Orbits orbits = orbits_of(trials.look_at(points, touching));
  Joints joints = joints_of(points, orbits, small_size, spacing, context);

  std::vector<char> in_small(points.size(), 0);
  std::vector<Candidate> small;
  for (std::size_t k = 0; k < joints.members.size(); ++k) {
    if (joints.small[k] == 0) continue;
    small.push_back(candidate_of(touching, places_of(joints.members[k], touching, kNoGap * subspace->diagonal)));
    for (const int number : joints.members[k]) in_small[static_cast<std::size_t>(number)] = 1;
  }
  keep(small, orbits_of(trials.look_at(small, touching)));
  Orbits in_large;
  for (const Numbers& orbit : orbits) {
    Numbers rest;
    std::ranges::copy_if(orbit, std::back_inserter(rest),
                         [&](int number) { return in_small[static_cast<std::size_t>(number)] == 0; });
    if (!rest.empty()) in_large.push_back(std::move(rest));
  }
  if (!in_large.empty()) keep(points, few_of(in_large, points, joints.spacing, options.most, context));
  return contacts;
}

Vector3d turned_gap(const Contact& contact, const std::array<Eigen::Matrix3d, 2>& turned) {
  return 0.5 * (turned[0] * contact.gap + turned[1] * contact.gap) - contact.gap;
}

Eigen::MatrixXd contact_rows(const std::vector<Contact>& contacts, const Subspace& subspace,
                             const ConjugatedBasis& basis) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * static_cast<Index>(contacts.size()), basis.degrees_of_freedom());
  Eigen::Matrix3Xd of_vertex(3, rows.cols());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      for (const auto& [vertex, weight] : contacts[i].sides[side].vertices) {
        of_vertex.setZero();
        add_vertex_rows(subspace, basis, vertex, of_vertex);
        rows.middleRows<3>(3 * static_cast<Index>(i)) += (side == 0 ? weight : -weight) * of_vertex;
      }
    }
  }
  return rows;
}

}  // namespace orbifit
