#pragma once

#include <optional>
#include <string>
#include <vector>

#include "orbifit/datasets_tools/truth.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct DetectionScoreOptions {
  int samples = 1500;  ///< points of each region that are moved by its elements; >= 100

  void validate() const;  ///< \throw UsageError
};

/// Why a claim says nothing.
enum class Triviality {
  none,
  tiny,        ///< less than 0.2 % of the mesh's area
  featureless  ///< the part slides over the mesh as freely as the claim moves it: a piece of a larger plane, say
};

/// The region or pattern of a truth that a prediction stands for.
struct TruthMatch {
  int id = 0;
  bool optional = false;  ///< of the optional ones
};

/// A predicted region.
struct RegionScore {
  int id = 0;
  std::string name, group;
  bool well_formed = true;  ///< breaches no rule of the format; if it does, the rest is not measured
  double area = 0;          ///< fraction of the mesh's
  double validity = 0;      ///< fraction of the region's area that stays on it under every element tried
  Triviality trivial = Triviality::none;
  std::optional<int> duplicate_of;  ///< id of a predicted region that says the same or more
  std::optional<TruthMatch> matches;
  bool counts = false;  ///< towards precision
};

/// A predicted pattern.
struct PatternScore {
  int id = 0;
  std::string name;
  Pattern::Kind kind = Pattern::Kind::congruent;
  int instances = 0;
  bool well_formed = true;
  double area = 0;      ///< of all instances, fraction of the mesh's
  double validity = 0;  ///< mean over the instances of the share that instance 0 covers, to and fro
  Triviality trivial = Triviality::none;
  std::optional<int> duplicate_of;  ///< id of an earlier predicted pattern
  std::optional<TruthMatch> matches;
  bool counts = false;
};

/// An expected region and the predicted one nearest to it.
struct ExpectedRegionScore {
  int id = 0;
  std::string name, group;
  double area = 0;  ///< fraction of the mesh's
  bool strict = false, loose = false;
  std::optional<int> by;  ///< id of the best prediction; none where there is no well-formed one
  std::string by_group;
  double iou = 0;                      ///< with that one, by area
  std::optional<double> axis_error;    ///< degrees; none below an IoU of 0.3
  std::optional<double> offset_error;  ///< of the fixed sets, fraction of the diagonal; likewise
};

/// An expected pattern and the predicted one nearest to it.
struct ExpectedPatternScore {
  int id = 0;
  std::string name;
  Pattern::Kind kind = Pattern::Kind::congruent;
  int instances = 0;
  double area = 0;
  bool strict = false, loose = false;
  std::optional<int> by;
  double iou = 0;          ///< median over the instances
  bool by_region = false;  ///< found as a region whose group relates all instances
};

struct DetectionSummary {
  int predicted = 0;            ///< regions and patterns
  int valid = 0;                ///< of these, whose validity is 0.95 at least
  std::optional<int> expected;  ///< regions and patterns of the truth, optional ones left out; none without a truth
  std::optional<double> strict_recall, loose_recall;  ///< none without anything expected
  double precision = 1;
  std::optional<double> f1;            ///< of strict recall and precision; none without a truth
  std::optional<double> axis_error;    ///< degrees, mean over the regions found strictly
  std::optional<double> offset_error;  ///< fraction of the diagonal, mean over the same
};

struct DetectionScore {
  std::vector<std::string> breaches;  ///< "region 3: rule", of what a reader lets pass
  std::vector<RegionScore> regions;   ///< in the order of the prediction
  std::vector<PatternScore> patterns;
  std::vector<ExpectedRegionScore> expected_regions;  ///< in the order of the truth
  std::vector<ExpectedPatternScore> expected_patterns;
  DetectionSummary summary;
};

/// How good detected symmetries are, by themselves and against a truth (null: none is known).
///
/// Validity: the area fraction of a region whose image under every element is on the region; "on" is within
/// min(0.5 % of the mesh's diagonal, 2 % of the region's) of a triangle whose normal is within 25 degrees (unsigned;
/// any triangle next to a crease). A region is valid from 0.95 on. At most 60 elements of a group are tried, its
/// generators among them, and 24 or more of a continuous one.
/// Duplicate: the same group, axis and centre as an earlier region's at an IoU above 0.9; or inside another region
/// whose group holds every element of this one's. Strict: the same group; every axis and mirror within 1 degree; the
/// fixed set within 1 % of the diagonal; IoU of 0.8. Loose: the group holds the true one, or is one of its subgroups of
/// index 2; 3 degrees; 3 %; IoU of 0.6. Precision: the share of the predictions that match an expected or optional one
/// (strictly, or loosely without claiming more), or are valid, not trivial and no duplicate. F1 is of strict recall and
/// precision. A pattern is found strictly when its instances are matched one to one (median IoU of 0.7) by motions that
/// agree within 1 degree and 1 % or map the instance as well; loosely when 60 % of them are. Copies without a lattice
/// may also be found as a region whose group relates them.
///
/// Everything but these is exact: validities and the featureless test are measured on random samples (1500, 400 or 300
/// of them; elements of large and continuous groups are drawn too), so another program that follows the same rules may
/// get validities that differ by the samples' noise (a hundredth or so near 0.95, up to five where half of a region
/// stays), and another verdict where one is that close to 0.95 (0.9 for the motions of a pattern's instances). What is
/// next to a crease is judged by distances to triangles.
///
/// The same bytes with any number of threads.
/// \throw InputError when the prediction or truth is of another mesh, or a face list is not ascending or leaves the
/// mesh
DetectionScore score_detection(const Mesh& mesh, const SymmetryAnnotation& predicted, const DetectionTruth* truth,
                               const DetectionScoreOptions& options, const RunContext& context);

/// For people: a line for each breach, prediction and expected symmetry, the summary last.
std::string to_text(const DetectionScore& score);

}  // namespace orbifit
