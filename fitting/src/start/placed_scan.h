#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "orbifit/fitting/placement.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "registration/correspondences.h"
#include "scan/scan_preparation.h"
#include "solver/scan_views.h"
#include "solver/shared_template.h"

namespace orbifit {

/// A placement of a template, and what of the scan may be the template's there.
struct PlacedScan {
  PreparedScan scan;
  Similarity pose;          ///< template -> scan
  double overlap = 1;       ///< share of the scan's points near those that are left
  double torn_off = 0;      ///< share that is not, being far from the template, but hangs together with those
  bool scale_open = false;  ///< nothing is known of the scale: the pose's is that of the template as it is
  std::shared_ptr<const ScanViews> views = {};        ///< of the template and this scan
  std::shared_ptr<const SharedTemplate> shared = {};  ///< what fits from here share with others; null: nothing
  /// Where several scans are one: each of the others into the frame of the first, and of each point its scan's number.
  std::vector<Motion> others = {};
  std::vector<char> other_used = {};  ///< of the others: the template was found in it
  std::vector<int> view_of = {};
  std::vector<char> held_out = {};  ///< of each point: not fitted to, but kept to judge the fit by; empty: none
};

/// The start's scan with the points of the other scans moved. \param moves  one for each of PlacedScan::others, or none
PreparedScan with_others_moved(const PlacedScan& start, const std::vector<Motion>& moves);

/// A surface to be moved, of the template's faces. \param mesh  the template
MovingSurface moving_template(const PlacedScan& start, const Mesh& mesh);

/// Of the posed template's diagonal: what is farther from a template in the pose of its rest shape is not of it, be it
/// a point of a scan or a place where one of its vertices is said to be.
inline constexpr double kNearTemplate = 0.12;

/// Whether a placement says that the scan is about where it was said to be, in the template's units: then its scale is
/// that of the shapes, which differ, and not of the units.
bool near_given(const Mesh& mesh, const Similarity& found, const Similarity& given);

/// Leaves of the scan what may be the template's in a pose: what is near, without planes that it does not explain. This
/// is done wherever the pose comes from.
/// \param surface  the template's \param slack  of the diagonal: how much farther a point may be, where parts of the
///   template are known to be elsewhere
/// \return none where all of the scan is of something else \throw InputError as prepare_scan() does
std::optional<PlacedScan> placed_scan(const MatchSurface& surface, const PointCloud& cloud, const Similarity& pose,
                                      double slack, const PlacementOptions& options,
                                      const ScanPreparationOptions& preparation, const RunContext& context);

/// The same for a pose that was found. Where it is much the same as the rough pose, that one's scale is kept, and else
/// it is open. \param given  the rough pose
std::optional<PlacedScan> found_scan(const MatchSurface& surface, const PointCloud& cloud, const Similarity& pose,
                                     const Similarity& given, const PlacementOptions& options,
                                     const ScanPreparationOptions& preparation, const RunContext& context);

}  // namespace orbifit
