#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include "search/part_regions.h"
#include "surface/thresholds.h"

namespace orbifit {

/// The parts of a prepared mesh by number, and what was found of them.
class PartTable {
 public:
  /// \param prepared, parts  kept by reference
  /// \param tolerance  of the detector, a fraction of the diagonal
  PartTable(const PreparedMesh& prepared, const PartRegions& parts, double tolerance)
      : prepared_(prepared), parts_(parts), tolerance_(tolerance) {}

  const PreparedMesh& prepared() const { return prepared_; }
  double tolerance() const { return tolerance_; }
  int count() const { return static_cast<int>(prepared_.components.faces.size()); }

  const std::vector<CongruenceClass>& classes() const { return parts_.survey.classes; }

  /// Of the first member of a class; null where it has none.
  const GroupPlacement* own_group(std::size_t number) const {
    return parts_.own_groups[number] ? &*parts_.own_groups[number] : nullptr;
  }

  const SurfaceMoments& moments(int part) const { return parts_.survey.moments[static_cast<std::size_t>(part)]; }

  double tolerance_of(int part) const { return tolerance_of_part(tolerance_, moments(part).diagonal); }

  /// Ascending.
  std::vector<int> faces_of(const std::vector<int>& parts) const {
    std::vector<int> faces;
    for (const int c : parts) {
      std::ranges::copy(prepared_.components.faces[static_cast<std::size_t>(c)], std::back_inserter(faces));
    }
    std::ranges::sort(faces);
    return faces;
  }

 private:
  const PreparedMesh& prepared_;
  const PartRegions& parts_;
  double tolerance_;
};

}  // namespace orbifit
