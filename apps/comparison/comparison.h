#pragma once

#include <optional>
#include <string>
#include <vector>

#include "orbifit/datasets_tools/fit_score.h"
#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "cases/bending.h"

namespace orbifit {

/// A way to deform a template to a scan, or by handles alone.
struct Method {
  std::string name;
  std::string summary;  ///< for people
  double weight = 0;    ///< of symmetry against the other terms where it is a penalty, as the method's authors have it
};

/// Ours first, then the baselines.
const std::vector<Method>& methods();

struct ComparisonOptions {
  std::vector<std::string> methods;  ///< of those; empty: all
  /// Of the penalty, for the methods that have one; each is a fit.
  std::vector<double> weights{1e-2, 1, 1e2, 1e4, 1e6, 1e8, 1e10};
  std::vector<int> samples{100, 200, 400, 800};  ///< of the surface, to time an iteration against; each >= 4
  int meshes = 3;  ///< times that iterations are timed, each with four times the template's faces of before, >= 0
  FitOptions fit;  ///< of all methods, as far as they have the same options

  void validate() const;  ///< \throw UsageError naming the field, its value and the rule
};

/// The shape that was scanned.
struct ComparisonTruth {
  Mesh mesh;                  ///< in the scan's frame
  std::vector<char> visible;  ///< see visible_vertices()
};

/// What one method did.
struct MethodRun {
  std::string method;
  double weight = 0;     ///< of its symmetry penalty; 0 where it has none
  int faces = 0;         ///< of the template
  bool scanned = false;  ///< fitted to a scan, not by handles alone
  std::string failure;   ///< empty where it has a result
  FitResult result;
  double symmetry = 0;            ///< worst residual that the method added, of the diagonal (moving)
  std::string worst_region;       ///< whose that is
  Eigen::VectorXd vertex_excess;  ///< #V: see SymmetryReport
  Bending bending;                ///< of the template, where it is not only moved
  std::optional<FitScore> score;  ///< where the truth is known
  double prepare = 0;             ///< seconds before the first iteration
  double iteration = 0;           ///< seconds of one, the median
};

struct Comparison {
  std::vector<MethodRun> runs;     ///< one a method
  std::vector<MethodRun> weights;  ///< of the methods with a penalty, by method, then weight
  std::vector<MethodRun> samples;  ///< six iterations each, by method, then samples
  std::vector<MethodRun> meshes;   ///< likewise with the template's faces divided in 1, 4, 16
};

/// The options of a fit whose iterations are to be timed: six of them, without a condition number.
FitOptions with_few_iterations(FitOptions options);

/// Fits by one method. All find the scan where the input's pose says.
/// \param weight of its penalty, where it has one
MethodRun run_method(const Method& method, double weight, const FitInput& input, const FitOptions& options,
                     const ComparisonTruth* truth, RunContext& context);

/// Runs all methods on one template and one scan, or handles alone where the scan is empty.
/// \param truth  null where it is not known
/// \throw UsageError for a method that there is not
Comparison compare(const FitInput& input, const ComparisonOptions& options, const ComparisonTruth* truth,
                   RunContext& context);

}  // namespace orbifit
