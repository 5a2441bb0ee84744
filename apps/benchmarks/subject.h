#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/deformer.h"

#include "basis/subspace_parts.h"
#include "models.h"
#include "soft_symmetry.h"

namespace orbifit::benchmarks {

/// Iterations of co-rotated editing that Table 1 times.
constexpr int kIterations = 5;
/// Weight of the handles against the Laplace energy in all benchmarks.
constexpr double kAlpha = 100;

/// The radius at which the model has about `samples` samples: the nearest count that a search finds.
double radius_for_samples(const BenchmarkModel& model, int samples, GroupMode mode, const RunContext& context);

/// The handles as the least-squares methods see them: displacement of the handles' vertices as rows on the samples.
struct HandleRows {
  LiftWeights rows;         ///< #H by #S
  Eigen::VectorXd weights;  ///< #H, those of a handle sum to the samples near it, at least to three
  Points targets;           ///< #H by 3, displacements asked for
};

HandleRows handle_rows(const BenchmarkModel& model, const Subspace& subspace, const RunContext& context);

/// The subspace's sampling with the constraints that its basis solves: each sample to its orbit's seed, and each place
/// that is reached by two ways.
SoftSampling soft_sampling(const Subspace& subspace);

/// What is measured: the stages of an edit as users of subspace/ run them. Nearly all use of that folder by the
/// benchmarks is here.
class Subject {
 public:
  /// Builds the subspace; this is what build_ms times.
  /// \param model outlives the subject
  Subject(const BenchmarkModel& model, double radius, GroupMode mode, const RunContext& context);

  void start_editing();  ///< what depends on the subspace alone, once a model
  void prefactor();      ///< after a handle was added or has moved on the surface
  void solve5();         ///< five iterations from the rest pose
  void lift();           ///< the displacements of all vertices

  const Subspace& subspace() const { return subspace_; }
  int samples() const { return static_cast<int>(subspace_->sampling.points.rows()); }
  int degrees_of_freedom() const { return subspace_.degrees_of_freedom(); }

  /// Bytes that a lift reads of its own (weights, numbers of atoms, representatives, who follows them) and writes (the
  /// displacements of representatives and of all vertices).
  struct Traffic {
    std::size_t read = 0, written = 0;
  };
  Traffic lift_traffic() const;

  /// After solve5(): the worst region's residual of the field in space, and of the deformed vertices where they map
  /// onto vertices. Fractions of the diagonal.
  double field_residual() const;
  double mesh_residual() const;

  /// After solve5(): root mean square distance of the handles' vertices from their targets, fraction of the diagonal.
  double handle_error() const;

 private:
  const BenchmarkModel& model_;
  RunContext context_;
  Subspace subspace_;
  std::unique_ptr<Deformer> deformer_;
  std::vector<Motion> motions_;
  Deformation deformation_;
  Points displacements_;
};

}  // namespace orbifit::benchmarks
