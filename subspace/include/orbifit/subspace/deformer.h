#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

/// The Laplacians of the samples to choose from (docs/method.md 4).
enum class LaplacianKind {
  graph,      ///< degree less adjacency of neighbouring samples (the paper)
  cotangent,  ///< the surface's, restricted to the samples (Huang et al. 2006)
  point       ///< of the samples as a point cloud (Liu, Prabhakaran and Guo 2012)
};

std::string to_string(LaplacianKind kind);  ///< "graph", "cotangent", "point"
std::optional<LaplacianKind> parse_laplacian_kind(std::string_view text);

/// What a solve did.
struct Deformation {
  SubspaceState state;      ///< coordinates in the subspace and, for mode moving, the basis as it turned
  double energy = 0;        ///< E_L + alpha E_C at the end (paper, equation 3), and the contacts'
  double handle_error = 0;  ///< root mean square distance of the handles' points from their targets, mesh units
  double last_change = 0;   ///< largest movement of a sample in the last iteration, mesh units
};

struct DeformerOptions {
  LaplacianKind laplacian = LaplacianKind::graph;
  /// Parts that touch at rest are to touch afterwards: kept together by springs at their joints. Not in mode fixed,
  /// which locks parts in place.
  bool contacts = true;
};

/// Iterative co-rotated Laplace editing in the symmetric subspace (paper, section 6). Factorise once for a set of
/// handles, solve many times for where they go. All of it happens in the quotient: one rotation and one Laplace row for
/// samples that are images of one another.
class Deformer {
 public:
  /// \param subspace and mesh outlive the deformer
  /// \param context  solve() asks it as well whether to stop, unless given another one; a copy is kept
  Deformer(const Subspace& subspace, const Mesh& mesh, const DeformerOptions& options = {},
           const RunContext& context = RunContext{});
  ~Deformer();
  Deformer(Deformer&&) noexcept;

  /// Factorises U^T (L^T L + alpha A^T A) U (equation 4). A has a row for each point of a handle, of whose vertices at
  /// most 48 are taken, evenly; weighted so that a handle counts as the samples near it, however it is tessellated. An
  /// alpha that would leave the energy fewer than half of a double's digits counts as the largest that does not.
  /// O(DoF^3 / 3); where few coordinates meet, as without symmetries, the factor is sparse: about O(DoF^1.5).
  void set_handles(const std::vector<Handle>& handles, double alpha);

  /// Where the handles shall go: one motion for each, in the order of set_handles(). O(DoF^2) an iteration; in mode
  /// moving, where the groups turn as they must and the basis with them, O(samples * DoF^2).
  /// \param start state to start from (its rotations are used), or none for the rest pose
  /// \param context  asked before each iteration whether to stop; null: the one that the deformer keeps
  Deformation solve(const std::vector<Motion>& motions, int iterations, const SubspaceState& start = {},
                    const RunContext* context = nullptr) const;

  /// How many joints between parts that touch at rest are kept touching.
  std::size_t contacts() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace orbifit
