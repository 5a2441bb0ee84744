#pragma once

#include <string>
#include <vector>

#include <Eigen/SparseCore>

#include "orbifit/baselines/kurz.h"

#include "kurz_normal.h"
#include "kurz_terms.h"
#include "registration/correspondences.h"
#include "unit_input.h"

namespace orbifit {

/// The iterations of fit_kurz(): correspondences, then a linear solve, then the symmetries' rotations.
class KurzFit {
 public:
  /// All references are kept.
  KurzFit(const FitInput& input, const UnitInput& unit, const KurzOptions& options, const RunContext& context);

  /// Iterations with one kind of basis functions, from the surface as it is: at most so many, or until it rests.
  void run(GridBasis basis, int most);

  /// All but what an assessment and a clock fill in.
  FitResult result() &&;

 private:
  bool handles_alone() const { return unit_.points.rows() == 0; }
  void begin(GridBasis basis);
  double thin_plate_at(int iteration) const;
  PullTerm pull_term() const;
  std::vector<Correspondence> match();
  DataTerm data_term(const std::vector<Correspondence>& pairs) const;
  void iterate(KurzNormal& normal, bool first);
  SymmetryAnnotation carried() const;
  void carry_pattern(std::size_t number, Pattern& pattern) const;

  const FitInput& input_;
  const UnitInput& unit_;
  const KurzOptions& options_;
  const RunContext& context_;
  double size_;  // the unit template's diagonal
  SymmetryDemands demands_;
  bool signed_normals_;
  KurzState state_;
  KurzTerms terms_;
  Eigen::SparseMatrix<double> plate_;
  SparseRows vertex_values_;
  Mesh deformed_;
  MovingSurface surface_;  // of deformed_
  std::vector<int> likely_;
  std::vector<FitIteration> iterations_;
  std::string stopped_because_;  // of the linear functions, or of the smooth ones where those came to rest
  double condition_ = 0;
};

}  // namespace orbifit
