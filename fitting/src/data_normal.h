#pragma once

#include <vector>

#include <Eigen/Core>

#include "orbifit/fitting/correspondences.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "pulls.h"
#include "vertex_rows.h"

namespace orbifit {

/// The sum of w (row x - right)^2 as x^T matrix x - 2 side^T x and a constant.
struct DataNormal {
  Eigen::MatrixXd matrix;  ///< lower half
  Eigen::VectorXd side;
};

/// How a small motion of the scan is written: a rotation vector times a length, about a pivot, and a translation.
struct ScanStep {
  Eigen::Vector3d pivot;
  double length;  ///< > 0

  Motion motion(const Eigen::Ref<const Eigen::Matrix<double, 6, 1>>& solved) const;
};

/// The vertices that pairs and pulls are about, ascending.
std::vector<int> touched_vertices(const Mesh& mesh, const std::vector<Correspondence>& pairs,
                                  const std::vector<Pull>& pulls);

/// What a fit's data ask for: share w <n, x + u - (s + omega x (s - pivot) + tau)>^2 for each pair, and each pull's
/// vertex at its target. The last six unknowns are the scan's step. Summed in an order that does not depend on the
/// number of threads.
/// \param rows  u of the vertices in the other unknowns, prepared for those that are touched \param columns  number of
/// the other unknowns \param mesh  where u = 0
DataNormal data_normal(const VertexRows& rows, Eigen::Index columns, const Mesh& mesh, const ScanStep& step,
                       const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                       const std::vector<Pull>& pulls, const RunContext& context);

}  // namespace orbifit
