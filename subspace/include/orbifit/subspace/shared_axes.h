#pragma once

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// Which regions share_axes() may move, and how far.
enum class MayMove {
  /// None by more than a few times its residual and a little of its own size, nor by a quarter of the tolerance: what
  /// fits exactly stays, and what fits is not spoilt.
  inexact,
  all,  ///< all by up to the tolerance, for annotations whose residuals say nothing
};

/// Regions detected one by one share axes, planes and centres only up to the tolerance, and groups that miss each other
/// by a little do not close (see closable.h). Here each region in turn, largest first, is moved by less than
/// `tolerance` (fraction of the diagonal, on its own extent) so that
///  - its centre is fixed exactly by the elements of earlier regions around it that fix it nearly, and its axes and
///    mirrors are theirs where they nearly are;
///  - it is the exact image of an earlier region of the same group wherever an element around both takes one to the
///  other.
/// Elements are regenerated in closed form; residuals grow by the movement.
/// \param which regions may move
SymmetryAnnotation share_axes(const Mesh& mesh, const SymmetryAnnotation& annotation, double tolerance, MayMove which);

}  // namespace orbifit
