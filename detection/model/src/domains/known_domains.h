#pragma once

#include <memory>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

#include "base/digest.h"
#include "domains/domain_map.h"

namespace orbifit {

/// The domains of one annotation of a mesh after another. Those asked for last are remembered: several ask of the same
/// annotation in turn. Not for use by several threads.
class KnownDomains {
 public:
  /// \param mesh  kept by reference
  explicit KnownDomains(const Mesh& mesh) : mesh_(mesh) {}

  /// Valid until those of another annotation are asked for. O(F)
  const DomainMap& of(const SymmetryAnnotation& annotation);

 private:
  const Mesh& mesh_;
  Digest annotation_;
  std::unique_ptr<const DomainMap> domains_;
};

}  // namespace orbifit
