#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "orbifit/datasets_tools/fit_score.h"
#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// A template of which scans of another shape of its kind are made.
struct FitFamily {
  std::string name;                          ///< of the generator
  std::map<std::string, double> parameters;  ///< of the shape that is scanned; the template has the defaults
};

/// Eight families whose shapes differ from their templates by a tenth to a third in several lengths.
const std::vector<FitFamily>& fit_families();

/// How hard a scan is.
enum class FitLevel {
  three_views,  ///< in the template's frame, three views, no noise
  one_view,     ///< in the template's frame, one view, 0.2 % noise
  anywhere,     ///< any pose and scale (0.01 to 100), two views, 0.2 % noise, 5 % outliers, up to 30 % of other things
  other_shape,  ///< as three_views, of a shape that is changed further
  several       ///< three scans of a view each, 0.2 % noise, each turned and moved anywhere
};

/// A template, a scan of another shape and the truth.
struct FitCase {
  std::string name;  ///< of the family
  FitLevel level = FitLevel::three_views;
  GeneratedModel model;  ///< the template
  Mesh truth;            ///< the shape scanned, with the template's connectivity, in the scan's frame
  PointCloud scan;
  std::vector<PointCloud> others;  ///< more scans, each in a frame of its own
  Similarity pose;                 ///< template's frame -> scan's frame
  std::vector<char> visible;       ///< #V: a clean scan has a point within 1 % of the diagonal of the truth's vertex
};

/// What FitLevel::other_shape makes of the family's shape: other places of its vertices.
using ShapeChange = std::function<Points(const GeneratedModel&, RunContext&)>;

/// The same seed gives the same case. \param change  asked at FitLevel::other_shape
FitCase fit_case(const FitFamily& family, FitLevel level, RunContext& context, const ShapeChange& change = nullptr);

/// score_fit() of a fit of the case's template.
FitScore score_fit(const FitCase& truth, const Mesh& fitted, const RunContext& context);

}  // namespace orbifit
