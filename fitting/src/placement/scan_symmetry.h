#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "scan/scan_preparation.h"
#include "scan/seen_surface.h"

namespace orbifit {

/// A plane about which much of a surface is its own mirror image, or an axis about which much of it is turned.
struct SymmetryElement {
  enum class Kind { plane, axis };
  Kind kind = Kind::plane;
  Eigen::Vector3d point;      ///< on it
  Eigen::Vector3d direction;  ///< unit: the plane's normal; along the axis. Either sign
  double support = 0;         ///< share of the surface that has the symmetry, in [0, 1]; of a template 1
};

/// What a scan shows of the symmetry of what was scanned, even if it saw one side alone and other things as well.
///
/// Planes: pairs of points whose normals mirror one another vote (Mitra et al. 2006); those with the most votes are
/// judged by where the mirrored points lie: on the scan, where no viewpoint looked, or where one saw through to
/// something farther away, which is against the plane (Thrun and Wegbreit 2005). A point counts by the square of the
/// cosine of its normal with the plane's: a floor is the mirror image of itself about any plane across it.
/// Axes: all normals of a surface of revolution meet its axis. Random neighbourhoods propose the axes that their
/// normals meet (the least slippage, Gelfand and Guibas 2004); normals along an axis do not count. \param points
/// numbers of the scan's points, in an order of which every beginning is spread over the scan \param extent  of the
/// scan, scan units: tolerances are fractions of it \return planes, then axes, each best first; at most a few, perhaps
/// none
std::vector<SymmetryElement> scan_symmetries(const PreparedScan& scan, const std::vector<int>& points,
                                             const SeenSurface& seen, double extent, const RunContext& context);

}  // namespace orbifit
