#pragma once

#include <optional>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct PlacementOptions {
  int scan_points = 4000;  ///< of the scan that are used, as dense as it is, >= 10
  int pairs = 2000;        ///< pairs of scan points looked at, >= 1
  int proposals = 40;      ///< poses tried for each, >= 1
  int refined = 60;        ///< distinct poses that are refined, >= 1
  double reach = 0.035;    ///< of the posed template's diagonal or 0.6 of the scan's: nearer is explained, in (0, 0.2)
  double min_scale = 0.3;  ///< of the template's diagonal against the scan's, > 0
  double max_scale = 2.5;  ///< likewise, > min_scale
  std::optional<double> scale = {};  ///< where it is known: of all poses that are found, > 0

  void validate() const;  ///< \throw UsageError naming the field, its value and the rule
};

/// Where a template may be in a scan.
struct Placement {
  Similarity pose;              ///< template -> scan
  double inlier_ratio = 0;      ///< share of the scan's points that lie on the template, by how near they are
  double visible_coverage = 0;  ///< share of what the viewpoints should have seen of the template that they saw
  double score() const { return inlier_ratio * visible_coverage; }
};

/// Finds a template in a scan at any position, turn and scale: nothing is assumed but that a fair part of the scan is
/// of it. Poses are proposed by mirror planes and axes, the template's onto those that parts of the scan show
/// (SymmetryHypotheses), and by pairs of oriented points (PoseHypotheses); few points, then more, judge them. The best
/// are refined by robust ICP with scale and judged by what they explain and by what should have been seen. Poses that
/// bring the template onto itself, as its symmetries do, are one.
/// \param annotation  of the template; one without regions leaves the pairs
/// \param given  a pose that is tried as well, such as the scan's own frame
/// \return best first, at most 10; empty where nothing fits
/// \throw InputError as for fit()
std::vector<Placement> find_placements(const Mesh& mesh, const SymmetryAnnotation& annotation, const PointCloud& scan,
                                       const PlacementOptions& options, const RunContext& context,
                                       const std::optional<Similarity>& given = {});

}  // namespace orbifit
