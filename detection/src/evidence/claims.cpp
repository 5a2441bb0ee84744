#include "evidence/claims.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/disjoint_sets.h"
#include "evidence/policy.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Family = PointGroup::Family;

PointGroup finite_part(const PointGroup& group) {
  switch (group.family) {
    case Family::Cinf:
      return {Family::Cn, kQuotientResolution.circle};
    case Family::Cinfv:
      return {Family::Cnv, kQuotientResolution.circle};
    case Family::Cinfh:
      return {Family::Cnh, kQuotientResolution.circle};
    case Family::Dinf:
      return {Family::Dn, kQuotientResolution.circle};
    case Family::Dinfh:
      return {Family::Dnh, kQuotientResolution.circle};
    case Family::K:
      return {Family::I, 1};
    case Family::Kh:
      return {Family::Ih, 1};
    default:
      return group;
  }
}

std::vector<Motion> motions_of(const Region& region) {
  std::vector<Motion> result;
  if (!region.group.continuous()) {
    result = region.elements;
  } else {
    const GroupFrame frame = region.group.has_axis() ? frame_about(region.axis) : GroupFrame(GroupFrame::Identity());
    for (const Eigen::Matrix3d& linear : elements(finite_part(region.group), frame)) {
      result.push_back(Motion::about(linear, region.centre));
    }
  }
  if (!result.empty()) result.erase(result.begin());
  return result;
}

SymmetryClaim claim_of(const Pattern& pattern) {
  SymmetryClaim claim;
  claim.pattern = &pattern;
  const std::vector<PatternInstance>& instances = pattern.instances;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    claim.pieces.push_back(&instances[i].faces);
    const Motion back = inverse(instances[i].motion);
    std::vector<Motion>& motions = claim.motions.emplace_back();
    for (std::size_t j = 0; j < instances.size(); ++j) {
      if (j != i) motions.push_back(instances[j].motion * back);
    }
    claim.generators.push_back({instances[(i + 1) % instances.size()].motion * back});
  }
  return claim;
}

// Whether the motion takes the one region's group to the other's, to `reach` near `at`.
bool takes_group(const Region& from, const Motion& motion, const Region& to, const Vector3d& at, double extent,
                 double reach) {
  if (from.group != to.group) return false;
  if (!from.group.continuous()) {
    return std::ranges::all_of(from.generators, [&](const Motion& generator) {
      const Motion image = motion * generator * inverse(motion);
      return std::ranges::any_of(
          to.elements, [&](const Motion& element) { return motion_distance(image, element, at, extent) <= reach; });
    });
  }
  Vector3d apart = motion(from.centre) - to.centre;
  if (!from.group.has_axis()) return apart.norm() <= reach;
  if (extent * (motion.linear * from.axis).cross(to.axis).norm() > reach) return false;
  const bool slides = from.group.family == Family::Cinf || from.group.family == Family::Cinfv;
  if (slides) apart -= to.axis.dot(apart) * to.axis;
  return apart.norm() <= reach;
}

/// Finds the images of claims.
class Images {
 public:
  Images(const PreparedMesh& prepared, const std::vector<SymmetryClaim>& claims, const ClaimAtoms& atoms,
         double tolerance)
      : prepared_(prepared), claims_(claims), atoms_(atoms), tolerance_(tolerance), families_(claims.size()) {
    areas_.assign(claims.size(), 0);
    for (const SymmetryClaim& claim : claims) {
      moments_.push_back(claim.region != nullptr ? surface_moments(prepared, claim.region->faces) : SurfaceMoments{});
    }
    for (std::size_t atom = 0; atom < atoms.count(); ++atom) {
      witnesses_.push_back(witnesses(atoms.faces(atom)));
      atom_areas_.push_back(area_of(prepared, atoms.faces(atom)));
      std::vector<std::size_t>& here = claims_at_.emplace_back();
      for (std::size_t claim = 0; claim < claims.size(); ++claim) {
        if (atoms.piece(claim, static_cast<int>(atom)) < 0) continue;
        areas_[claim] += atom_areas_.back();
        here.push_back(claim);
      }
    }
  }

  DisjointSets families() {
    for (std::size_t mover = 0; mover < claims_.size(); ++mover) {
      for (std::size_t piece = 0; piece < claims_[mover].pieces.size(); ++piece) {
        for (const Motion& motion : claims_[mover].generators[piece])
          unite_images(mover, static_cast<int>(piece), motion);
      }
    }
    return std::move(families_);
  }

 private:
  struct Arrival {
    double asked = 0;                  // area of the claim's atoms in the mover's piece
    std::map<std::size_t, double> at;  // of it, what arrives in which claim
  };

  std::vector<Vector3d> witnesses(const std::vector<int>& faces) const {
    std::vector<Vector3d> result;
    const std::size_t count = std::min(kQuotientResolution.witnesses, faces.size());
    for (std::size_t k = 0; k < count; ++k) {
      const int face = faces[(2 * k + 1) * faces.size() / (2 * count)];
      Vector3d middle = Vector3d::Zero();
      for (int c = 0; c < 3; ++c) middle += prepared_.mesh.vertices.row(prepared_.mesh.faces(face, c)).transpose() / 3;
      result.push_back(middle);
    }
    return result;
  }

  bool alike(std::size_t a, std::size_t b) const {
    if (std::min(areas_[a], areas_[b]) < kQuotientResolution.arrived * std::max(areas_[a], areas_[b])) return false;
    if ((claims_[a].region != nullptr) != (claims_[b].region != nullptr)) return false;
    if (claims_[a].region != nullptr) return claims_[a].region->group == claims_[b].region->group;
    return claims_[a].pattern->kind == claims_[b].pattern->kind &&
           claims_[a].pattern->instances.size() == claims_[b].pattern->instances.size();
  }

  void unite_images(std::size_t mover, int piece, const Motion& motion) {
    std::map<std::size_t, Arrival> arrivals;  // by the claim that is moved
    for (std::size_t atom = 0; atom < atoms_.count(); ++atom) {
      if (atoms_.piece(mover, static_cast<int>(atom)) != piece) continue;
      const double weight = atom_areas_[atom] / static_cast<double>(witnesses_[atom].size());
      for (const Vector3d& witness : witnesses_[atom]) {
        const SurfaceIndex::Nearest nearest =
            prepared_.index->nearest(motion(witness), kQuotientResolution.reach * tolerance_);
        const int there = nearest.face < 0 ? -1 : atoms_.of_face(nearest.face);
        for (const std::size_t from : claims_at_[atom]) {
          if (from == mover) continue;
          Arrival& arrival = arrivals[from];
          arrival.asked += weight;
          if (there < 0) continue;
          for (const std::size_t to : claims_at_[static_cast<std::size_t>(there)]) {
            if (alike(from, to)) arrival.at[to] += weight;
          }
        }
      }
    }
    for (const auto& [from, arrival] : arrivals) {
      for (const auto& [to, area] : arrival.at) {
        if (to == from || area < kQuotientResolution.arrived * arrival.asked) continue;
        if (families_.root(static_cast<int>(from)) == families_.root(static_cast<int>(to))) continue;
        if (claims_[from].region == nullptr || takes(from, motion, to)) {
          families_.unite(static_cast<int>(from), static_cast<int>(to));
        }
      }
    }
  }

  bool takes(std::size_t from, const Motion& motion, std::size_t to) const {
    const SurfaceMoments& moments = moments_[to];
    return takes_group(*claims_[from].region, motion, *claims_[to].region, moments.centroid, moments.radius,
                       tolerance_);
  }

  const PreparedMesh& prepared_;
  const std::vector<SymmetryClaim>& claims_;
  const ClaimAtoms& atoms_;
  double tolerance_;
  DisjointSets families_;
  std::vector<std::vector<Vector3d>> witnesses_;     // by atom
  std::vector<std::vector<std::size_t>> claims_at_;  // by atom
  std::vector<double> atom_areas_, areas_;           // by atom, by claim
  std::vector<SurfaceMoments> moments_;              // by claim, of regions
};

}  // namespace

std::vector<SymmetryClaim> claims_of(const SymmetryAnnotation& annotation) {
  std::vector<SymmetryClaim> claims;
  for (const Region& region : annotation.regions) {
    SymmetryClaim& claim = claims.emplace_back();
    claim.region = &region;
    claim.pieces = {&region.faces};
    claim.motions = {motions_of(region)};
    claim.generators = {region.generators};
  }
  for (const Pattern& pattern : annotation.patterns) claims.push_back(claim_of(pattern));
  return claims;
}

ClaimAtoms::ClaimAtoms(const PreparedMesh& prepared, const std::vector<SymmetryClaim>& claims) {
  const auto face_count = static_cast<std::size_t>(prepared.mesh.faces.rows());
  atom_of_face_.assign(face_count, 0);
  std::vector<int> piece_of_face(face_count);
  std::vector<std::vector<int>> pieces{{}};
  for (const SymmetryClaim& claim : claims) {
    std::ranges::fill(piece_of_face, -1);
    for (std::size_t p = 0; p < claim.pieces.size(); ++p) {
      for (const int face : *claim.pieces[p]) piece_of_face[static_cast<std::size_t>(face)] = static_cast<int>(p);
    }
    std::map<std::pair<int, int>, int> atoms;
    std::vector<std::vector<int>> next;
    for (std::size_t f = 0; f < face_count; ++f) {
      const std::pair<int, int> key{atom_of_face_[f], piece_of_face[f]};
      const auto [at, is_new] = atoms.try_emplace(key, static_cast<int>(next.size()));
      if (is_new) {
        next.push_back(pieces[static_cast<std::size_t>(key.first)]);
        next.back().push_back(key.second);
      }
      atom_of_face_[f] = at->second;
    }
    pieces = std::move(next);
  }
  pieces_ = std::move(pieces);
  faces_.resize(pieces_.size());
  for (std::size_t f = 0; f < face_count; ++f) {
    if (prepared.areas[static_cast<Eigen::Index>(f)] > 0) {
      faces_[static_cast<std::size_t>(atom_of_face_[f])].push_back(static_cast<int>(f));
    }
  }
}

std::vector<std::vector<std::size_t>> families_of(const PreparedMesh& prepared,
                                                  const std::vector<SymmetryClaim>& claims, const ClaimAtoms& atoms,
                                                  double tolerance) {
  return Images(prepared, claims, atoms, tolerance).families().sets();
}

}  // namespace orbifit
