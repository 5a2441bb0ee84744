#include "domains/known_domains.h"

#include <cstdint>
#include <span>
#include <string>

#include "domains/closed_sets.h"

namespace orbifit {

namespace {

void add(Digest& digest, const std::string& text) {
  digest.add(static_cast<std::uint64_t>(text.size()));
  for (const char letter : text) digest.add(static_cast<std::uint64_t>(letter));
}

void add(Digest& digest, const Eigen::Vector3d& vector) {
  for (const double coordinate : vector) digest.add(coordinate);
}

void add(Digest& digest, const Motion& motion) {
  for (int k = 0; k < 3; ++k) add(digest, motion.linear.col(k));
  add(digest, motion.translation);
}

// Of all that a DomainMap is made from, besides the mesh.
Digest digest_of(const SymmetryAnnotation& annotation) {
  Digest digest;
  digest.add(static_cast<std::uint64_t>(annotation.regions.size()));
  for (const Region& region : annotation.regions) {
    digest.add(static_cast<std::uint64_t>(region.id));
    add(digest, region.name);
    digest.add(static_cast<std::uint64_t>(region.group.family)).add(static_cast<std::uint64_t>(region.group.n));
    add(digest, region.centre);
    add(digest, region.axis);
    digest.add(static_cast<std::uint64_t>(region.elements.size()));
    for (const Motion& element : region.elements) add(digest, element);
    digest.add(std::span<const int>(region.faces));
  }
  for (const Pattern& pattern : annotation.patterns) {
    digest.add(static_cast<std::uint64_t>(pattern.id));
    add(digest, pattern.name);
    digest.add(static_cast<std::uint64_t>(pattern.instances.size()));
    for (const PatternInstance& instance : pattern.instances) {
      add(digest, instance.motion);
      digest.add(std::span<const int>(instance.faces));
    }
  }
  return digest;
}

}  // namespace

const DomainMap& KnownDomains::of(const SymmetryAnnotation& annotation) {
  const Digest digest = digest_of(annotation);
  if (!domains_ || !(digest == annotation_)) {
    domains_ = std::make_unique<const DomainMap>(mesh_, annotation, instance_motions(annotation));
    annotation_ = digest;
  }
  return *domains_;
}

}  // namespace orbifit
