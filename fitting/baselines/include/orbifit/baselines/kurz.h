#pragma once

#include "orbifit/fitting/fit.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// How the linear least-squares problem of an iteration is solved; both to the same solution.
enum class KurzSolver {
  normal_equations,  ///< products of what stays made once, CHOLMOD
  ceres              ///< residual by residual, Ceres' sparse normal Cholesky (CHOLMOD as well): slower
};

/// Kurz et al. 2014. Lengths are those of a template whose longest side is 1. The weights stand before
///   handles       sum of squared distances; a landmark counts as 1, the vertices of a handle share 3
///   data          sum over the scan's points, <n, f(p) - d>^2, scaled as if there were `scan_points` of them
///   thin plate    integral over the grid of the squared Hessian of f
///   symmetry      for each generator of each region, the integral of |T f(x) - f(g x)|^2 over the region, divided by
///                 the template's area and times `scan_points`: a whole shape's symmetry counts as a whole scan
struct KurzOptions {
  double handle_weight = 100;       ///< >= 0
  double data_weight = 1;           ///< >= 0
  double thin_plate_weight = 0.01;  ///< > 0; the paper's 1 stands before the sum over all points of its scans
  double symmetry_weight = 3;       ///< >= 0; 0: deformation without symmetry
  /// What becomes of T: that of the template; carried by a translation of each region, which is solved for; or by a
  /// rigid motion of each region, whose rotation is estimated anew in each iteration. The paper's is free.
  GroupMode mode = GroupMode::moving;
  double spacing = 0.1;            ///< of the grid, in (0, 1]
  int linear_iterations = 100;     ///< at most, of piecewise linear functions, >= 1
  int smooth_iterations = 1;       ///< with cubic B-splines after them, >= 0
  int stiff_iterations = 20;       ///< in which the thin plate's weight falls from first_thin_plate, >= 0
  double first_thin_plate = 1e4;   ///< that of an affine map, >= thin_plate_weight
  double still = 1e-4;             ///< the linear iterations end when no vertex moves by more, >= 0
  int quadrature_points = 2000;    ///< on a region that is the whole template, >= 64; at least 64 on any
  double trim = 0.8;               ///< share of the nearest correspondences kept, in (0, 1]
  double never_trim = 0.05;        ///< distances below this are always kept, >= 0
  double min_normal_cosine = 0.5;  ///< of compatible normals, in [0, 1)
  /// Normals are compatible in sign too, where both the scan's and the template's look outwards: as in fit().
  bool signed_normals = true;
  int scan_points = 4000;         ///< points of the scan used, >= 10
  double inlier_distance = 0.01;  ///< of the diagonal: a scan point nearer than this is explained, > 0
  bool align = true;              ///< as FitOptions::align
  KurzSolver solver = KurzSolver::normal_equations;
  bool condition = false;  ///< estimate the condition number of the last linear system; not with Ceres

  void validate() const;  ///< \throw UsageError naming the field, its value and the rule
};

/// Template deformation and fitting with symmetry as transfinite least-squares constraints: Kurz et al.,
/// "Symmetry-Aware Template Deformation and Fitting", 2014. The unknowns are the coefficients of basis functions
/// on a grid around the template and the translations of the symmetries; the normal equations are solved by sparse
/// Cholesky. A scan without points and with handles asks for an edit by those handles.
/// Of the result, `samples` counts the grid's nodes, `degrees_of_freedom` the last stage's unknowns, `q` is empty, and
/// `annotation` has the symmetries as they were carried, which the fitted mesh meets up to `field_residual`. An
/// iteration's `stiffness` is the thin plate's weight, its `energy` that of the paper before the step, in squared
/// diagonals a scan point. Times: "prepare", "fit", and of the latter "smooth".
/// \throw InputError for a scan of 1 to 9 points, or none and no handles; UsageError for options; NoResultError where
///        the matrix is not positive definite to rounding, as weights grow
FitResult fit_kurz(const FitInput& input, const KurzOptions& options, const RunContext& context);

}  // namespace orbifit
