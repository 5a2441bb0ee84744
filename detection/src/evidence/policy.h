#pragma once

namespace orbifit {

/// What the judge asks of regions and patterns before they are listed: each threshold with its unit and its reason.
struct EvidencePolicy {
  /// Share of what was left of its own surface that a region or pattern (with its images) saves, given those listed
  /// before it; what saves less repeats what others say of its faces, but for a sliver.
  double min_saving = 0.05;
  /// Share of the mesh's area from which on a region or pattern (with its images) is a main part: it is listed in any
  /// case, since it tells how others stand to one another.
  double main_part = 0.2;
};

}  // namespace orbifit
