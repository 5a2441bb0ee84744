#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

#include "deformation/contacts.h"
#include "registration/correspondences.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// What the fits of one template share, made once. Const calls may run on several threads.
class SharedTemplate {
 public:
  /// \param mesh  kept by reference \param contacts  whether they will be asked for
  /// \param given  the subspace that the fit was given; null: it builds its own
  /// \param index  of the mesh; null: made
  SharedTemplate(const Mesh& mesh, bool contacts, std::shared_ptr<const Subspace> given,
                 std::shared_ptr<const SurfaceIndex> index, const RunContext& context);
  SharedTemplate(const SharedTemplate&) = delete;
  SharedTemplate& operator=(const SharedTemplate&) = delete;
  SharedTemplate(SharedTemplate&&) = delete;
  SharedTemplate& operator=(SharedTemplate&&) = delete;
  ~SharedTemplate() = default;

  const MatchSurface& surface() const { return surface_; }  ///< at rest
  const MovingSurface& tree() const { return *tree_; }      ///< at rest: to be copied and moved

  /// Whether a subspace is the fit's own: one that it was given others may be using meanwhile.
  bool owns(const Subspace& subspace) const { return !given_ || given_->operator->() != subspace.operator->(); }

  /// Those that a subspace of the mesh is to keep; remembered of the first one that is asked for.
  std::vector<Contact> contacts(const Subspace& subspace, const RunContext& context) const;

 private:
  std::shared_ptr<const Subspace> given_;
  MatchSurface surface_;
  std::shared_ptr<const MovingSurface> tree_;
  std::unique_ptr<const ContactSearch> search_;
  mutable std::mutex mutex_;
  mutable Subspace first_;
  mutable std::vector<Contact> of_first_;
};

}  // namespace orbifit
