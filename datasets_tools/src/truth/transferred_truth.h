#pragma once

#include <vector>

#include "orbifit/datasets_tools/truth.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

struct CarryOptions {
  /// An image is on the region within this fraction of the mesh's diagonal, > 0, and within kRegionTolerance of the
  /// region's.
  double tolerance = 0.005;
  double least_kept = 0.6;        ///< share of its visible area below which a region or pattern is optional, in [0, 1]
  double least_expected = 0.003;  ///< share of the mesh's area below which one is optional, in [0, 1]
  double least_area = 0.002;      ///< share of the mesh's area below which one vanishes, in [0, least_expected]

  void validate() const;  ///< \throw UsageError
};

/// The truth about a mesh made from a model's: remeshed, subdivided or cut, in the model's own pose and without noise.
///
/// A region's faces are those whose source belongs to it and whose centroid stays, under every element of its group (96
/// or more random ones of a continuous group), on the region's visible surface with a normal within 25 degrees,
/// unsigned, unless next to a crease (docs/method.md 6). All faces whose source belongs to it are accepted as well, and
/// what the model accepts besides. A region becomes optional
/// - when that test leaves too little or too ragged a part of it, or when it is small;
/// - when it slides along itself because its ends are hidden or cut off: a piece of a plane or of a cylinder;
/// - when a region that holds its faces also has all its elements.
///
/// A pattern's instances keep what all of them show. Residuals are those of the faces' centroids. Ids stay; parents are
/// set anew among the expected regions.
///
/// \param mesh the new one
/// \param source_face the model's face from which each face of `mesh` came, #F
/// \throw InputError when there is not one source for each face, or one is outside the model
DetectionTruth transferred_truth(const TruthModel& model, const Mesh& mesh, const std::vector<int>& source_face,
                                 const CarryOptions& options, RunContext& context);

}  // namespace orbifit
