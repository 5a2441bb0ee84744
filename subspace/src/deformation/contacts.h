#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "basis/subspace_parts.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// A place where two parts of a mesh touch at rest (docs/method.md 4.1), to be kept softly: what the one part's surface
/// does there the other's does too.
struct Contact {
  struct Side {
    std::vector<std::pair<int, double>> vertices;  ///< and weights that sum to 1: a point of the surface, or a mean
    int sample = -1;  ///< the sample of the same part nearest to the place: it tells how that turns
  };
  std::array<Side, 2> sides;
  Eigen::Vector3d point;  ///< at rest, between the two sides
  Eigen::Vector3d gap;    ///< at rest, from the second side's point to the first's; turns with the parts
  /// For how many contacts this one stands: its images under the symmetries, itself among them, whose rows say the same
  /// of the coordinates of a symmetric subspace, with the same energy.
  double count = 1;
};

struct ContactOptions {
  /// Surfaces nearer than this touch, fraction of the diagonal, >= 0. Drawn parts overlap, or end a little before what
  /// they are joined to; the annotation's usual tolerance is what counts as one place.
  double tolerance = 0.005;
  /// A joint smaller than this fraction of the smaller part's length is held by its mean: the parts may turn about it,
  /// as legs do that splay, and what opens then is small beside what moves. Larger ones are held all along.
  double joint = 0.25;
  /// Distance of the contacts kept along a large joint, in sampling radii, > 0: the lift resolves no more.
  double spacing = 1;
  /// Contacts along large joints to aim at, at most: where there are more, they are spaced wider. >= 1
  int most = 400;
  /// One contact of each orbit, which counts for all. Else all are kept: the same energies from more rows.
  bool representatives = true;
};

/// Finds contacts in one subspace of a mesh after another. Const calls may run on several threads.
class ContactSearch {
 public:
  /// \param mesh  kept by reference \param surface  of the mesh
  ContactSearch(const Mesh& mesh, std::shared_ptr<const MovingSurface> surface, const ContactOptions& options,
                const RunContext& context);
  ContactSearch(const ContactSearch&) = delete;
  ContactSearch& operator=(const ContactSearch&) = delete;
  ContactSearch(ContactSearch&&) = delete;
  ContactSearch& operator=(ContactSearch&&) = delete;
  ~ContactSearch();

  /// See find_contacts(). \param subspace  of the mesh
  std::vector<Contact> in(const Subspace& subspace, const RunContext& context) const;

 private:
  struct Parts;

  const Mesh& mesh_;
  std::shared_ptr<const MovingSurface> surface_;
  ContactOptions options_;
  std::unique_ptr<const Parts> parts_;  // null where there is a single part
};

/// The contacts of a mesh's connected parts (touching_parts() of the welded mesh), thinned out by whole orbits, so that
/// they have the subspace's symmetries. Which contacts are images of one another is found by comparing their gaps under
/// random displacements of the basis. Contacts whose gap no displacement opens are left out: parts that share vertices
/// hang together in any case.
std::vector<Contact> find_contacts(const Subspace& subspace, const Mesh& mesh, const ContactOptions& options,
                                   const RunContext& context);

/// The change of a contact's gap where its sides have turned so: (R - 1) gap, R being the mean of the two.
Eigen::Vector3d turned_gap(const Contact& contact, const std::array<Eigen::Matrix3d, 2>& turned);

/// The change of the gaps as linear forms in a basis' coordinates, 3 #contacts by DoF; what turned groups add whatever
/// the coordinates are, is left out.
Eigen::MatrixXd contact_rows(const std::vector<Contact>& contacts, const Subspace& subspace,
                             const ConjugatedBasis& basis);

}  // namespace orbifit
