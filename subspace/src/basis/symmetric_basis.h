#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "sampling/symmetric_sampling.h"
#include "symmetry/group_words.h"

namespace orbifit {

/// Two ways from one point to another: both words must give the same displacement.
struct WordPair {
  int left, right;
  auto operator<=>(const WordPair&) const = default;
};

/// Transports of the words and of the samples as the groups stand now, and as they stand at rest. What is no symmetry
/// at rest (doublets merged, points snapped) is left out by taking differences.
struct CarriedTransports {
  std::vector<Transport> words, samples;
  std::vector<Transport> rest_words, rest_samples;  ///< empty: as now, groups not turned
  bool turned() const { return !rest_words.empty(); }
};

/// What words that must agree make of a displacement u and the carriers t: u is restricted to
/// kept * u + sum of bound t + slope * position + offset.
struct Binding {
  Eigen::Matrix3d kept = Eigen::Matrix3d::Identity();  ///< projector
  Carried bound;
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// A basis of the symmetry-preserving displacements of a sampling (paper, section 5; floating: docs/method.md 2.2).
/// A coordinate vector q gives the samples' displacements U q + offset, stacked x0 y0 z0 x1 ..., and the translations
/// T q + carried_offset that carry the groups. The offsets are zero unless groups are turned (moving).
struct SymmetricBasis {
  /// U, 3#S by DoF. Columns of one orbit touch that orbit alone; the last ones, which move groups, touch many.
  Eigen::SparseMatrix<double> columns;
  Eigen::VectorXd offset;  ///< 3#S
  /// T, 3#carriers by DoF; no rows when groups are fixed.
  Eigen::MatrixXd carried;
  Eigen::VectorXd carried_offset;  ///< 3#carriers
  double conflict = 0;             ///< how far turned groups are from agreeing with one another, mesh units

  int degrees_of_freedom() const { return static_cast<int>(columns.cols()); }
};

/// A point elsewhere (a vertex) whose constraints restrict the carriers too.
struct BoundPoint {
  Eigen::Vector3d position;  ///< the seed's
  std::vector<WordPair> words;
};

/// The null space of the constraints in the orbits' seeds s and the carriers t:
/// each orbit leaves 0 to 3 columns Z of its own, and t = T q couples orbits, s = Z q - C_s^+ C_t t.
/// \param elsewhere points that must be able to keep their symmetries as well
/// Cost O(samples * carriers they depend on + carriers^3).
SymmetricBasis symmetric_basis(const SymmetricSampling& sampling, const CarriedTransports& transports, int carriers,
                               const std::vector<BoundPoint>& elsewhere);

/// What pairs of words that must agree make of a displacement where they start.
Binding binding_of(const std::vector<WordPair>& pairs, const CarriedTransports& transports);

}  // namespace orbifit
