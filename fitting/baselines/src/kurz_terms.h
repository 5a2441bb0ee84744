#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"

#include "grid_field.h"
#include "symmetry_quadrature.h"

namespace orbifit {

/// A deformation x + u(x) and how it carries the symmetries.
struct KurzState {
  Points nodes;                            ///< coefficients of u, #nodes by 3
  Points carriers;                         ///< translations, #carriers by 3
  std::vector<Eigen::Matrix3d> rotations;  ///< R of each region
};

/// Points of the template that are pulled to places.
struct PullTerm {
  SparseRows values;  ///< of the basis at the points
  Points offsets;     ///< target - point
  Eigen::VectorXd weights;
};

/// The same, along normals alone.
struct DataTerm {
  SparseRows values;
  Points offsets, normals;
  Eigen::VectorXd weights;
};

/// The energy of Kurz et al. 2014 in the unknowns u and t (nodes, carriers), for given correspondences and rotations:
///   E = sum of w |u(p) - offset|^2                    handles
///     + sum of w <n, u(p) - offset>^2                 data
///     + thin_plate * integral of the squared Hessian of u
///     + sum of symmetry * w |T f(x) - f(g x)|^2       symmetry, by quadrature
///     + hold * |(u, t) - (u, t) now|^2                what nothing else determines stays
/// in units of the template's length.
struct KurzTerms {
  Grid grid;
  SymmetryDemands symmetry;
  std::vector<SparseRows> at_points, at_images;  ///< of each demand: values of the basis
  PullTerm pulls;
  double thin_plate = 0, symmetry_weight = 0, hold = 0;
};

KurzTerms kurz_terms(const Grid& grid, const SymmetryDemands& symmetry);

KurzState rest_state(const KurzTerms& terms, std::size_t regions);

/// The parts of E but for `hold`.
struct KurzEnergy {
  double pulls = 0, data = 0, thin_plate = 0, symmetry = 0;
  double sum() const { return pulls + data + thin_plate + symmetry; }
};

/// \param plate thin_plate(terms.grid)
KurzEnergy kurz_energy(const KurzTerms& terms, const Eigen::SparseMatrix<double>& plate, const DataTerm& data,
                       const KurzState& state);

/// T f(x) - f(g x) of one demand.
Points symmetry_differences(const KurzTerms& terms, std::size_t demand, const KurzState& state);

/// One step of Gauss and Newton of each region's rotation R, its group's generators together; turns that commute with
/// the group, such as those about the axis of Cn, stay.
void turn_symmetries(const KurzTerms& terms, KurzState& state);

}  // namespace orbifit
