#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "registration/correspondences.h"
#include "solver/pulls.h"
#include "solver/vertex_rows.h"

namespace orbifit {

/// The sum of w (row x - right)^2 as x^T matrix x - 2 side^T x and a constant.
struct NormalEquations {
  Eigen::SparseMatrix<double> matrix;  ///< lower half; a pair touches the coordinates near it, and the pose
  Eigen::VectorXd side;
};

/// How a small change of the pose is written: of each scan but the first a motion of its own, that comes before the
/// common one; the template's growth times a length, where it may grow; then a motion of all scans. Motions are a
/// rotation vector times the length and a translation. Growth and rotations are about a pivot.
struct ScanStep {
  Eigen::Vector3d pivot;
  double length;       ///< > 0
  bool grows = false;  ///< whether the growth is an unknown
  int others = 0;      ///< scans but the first

  int common() const { return grows ? 7 : 6; }  ///< the last of the unknowns
  int unknowns() const { return common() + 6 * others; }

  /// Of the others, from the solution for all unknowns of the pose.
  std::vector<Motion> other_motions(const Eigen::VectorXd& solved) const;

  Motion motion(const Eigen::Ref<const Eigen::Matrix<double, 6, 1>>& solved) const;
};

/// The vertices that pairs and pulls are about, each once, as they come.
std::vector<int> touched_vertices(const Mesh& mesh, const std::vector<Correspondence>& pairs,
                                  const std::vector<Pull>& pulls);

/// Adds what a fit's data ask for: share w <n, x + gamma (x - pivot) + u - (s + omega x (s - pivot) + tau)>^2 for each
/// pair, omega and tau being the sum of the common ones and those of the pair's scan, and each pull's vertex at its
/// target. The last unknowns are those of the pose. Summed in an order that does not depend on the number of threads.
/// \param rows  u of the vertices in the other unknowns, prepared for those that are touched \param mesh  where u = 0
/// \param normal  of all unknowns, with what else there is
void add_data(const VertexRows& rows, const Mesh& mesh, const ScanStep& step, const std::vector<Correspondence>& pairs,
              double share, const Points& scan_points, const std::vector<Pull>& pulls, const RunContext& context,
              NormalEquations& normal);

}  // namespace orbifit
