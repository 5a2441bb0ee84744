#pragma once

#include <cstddef>
#include <vector>

#include "orbifit/model/run_context.h"

#include "evidence/claims.h"
#include "evidence/near_points.h"

namespace orbifit {

/// The quotient of a surface by what is known of it: samples of the surface, each with its orbit under the claims that
/// are accepted. A sample in an orbit of n points stands for an n-th of its area, since the others are its images.
class ClaimQuotient {
 public:
  /// Arguments are kept by reference. Lengths and areas are those of the normalised mesh. O(A log F) for A samples.
  /// \param tolerance  points nearer than half of it are one
  ClaimQuotient(const PreparedMesh& prepared, const std::vector<SymmetryClaim>& claims, const ClaimAtoms& atoms,
                double tolerance, const RunContext& context);

  double area() const;  ///< of the quotient

  /// Of the faces that the claims name: all, and what the quotient has of it.
  struct NamedArea {
    double all = 0, left = 0;
  };
  NamedArea named_area(const std::vector<std::size_t>& family) const;

  /// Whether an accepted claim names all faces, but for a sliver, of each of these; nothing but the whole holds the
  /// whole.
  bool lies_within_accepted(const std::vector<std::size_t>& family) const;

  /// What accepting claims that are images of one another would take off the area, about: exact for one claim whose
  /// orbits meet known ones evenly. O(A (n + |G|)) for orbits of n points.
  double saving(const std::vector<std::size_t>& family) const;

  void accept(const std::vector<std::size_t>& family);

 private:
  struct Site {
    int atom;
    std::vector<bool> complete;  // by claim: whether the orbit under it is in
  };
  // A circle or sphere that an accepted continuous group fills.
  struct Circle {
    std::size_t claim;
    std::size_t site;  // one on it
  };
  struct Sample {
    double weight;  // area
    NearPoints points;
    std::vector<Site> orbit;  // of each point
    std::vector<Circle> circles;
  };

  // The site at the point, or on a filled circle with it; -1: none.
  int find(const Sample& sample, const Eigen::Vector3d& point) const;
  bool turns_alike(std::size_t known, std::size_t claim) const;
  bool near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;
  bool on_one_circle(std::size_t claim, const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;
  int atom_at(const Eigen::Vector3d& point) const;
  double saved_share(const Sample& sample, std::size_t number, std::size_t claim) const;
  bool continuous(std::size_t claim) const {
    return claims_[claim].region != nullptr && claims_[claim].region->group.continuous();
  }
  void extend(Sample& sample, const std::vector<std::size_t>& news) const;
  void expand(Sample& sample, std::size_t site, std::size_t claim) const;

  const PreparedMesh& prepared_;
  const std::vector<SymmetryClaim>& claims_;
  const ClaimAtoms& atoms_;
  double tolerance_;
  const RunContext& context_;
  std::vector<std::size_t> accepted_, continuous_;  // the latter of the former
  std::vector<Sample> samples_;
};

}  // namespace orbifit
