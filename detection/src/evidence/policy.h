#pragma once

namespace orbifit {

/// What the judge asks of regions and patterns before they are listed: each threshold with its unit and its reason.
struct EvidencePolicy {
  /// Share of its area that a region, or an instance of a pattern, keeps where faces beyond the tolerance are taken out
  /// of it. What loses more was held together by those faces: its group is not a property of what is left.
  double min_left = 0.5;

  /// Rounds in which faces are taken out of a region, each those whose images lay on the faces of the last. Borders
  /// creep by a face each round where they lie askew to the triangles; what goes on and on unravels.
  int max_rounds = 30;

  /// Share of its area that a region may gain where its motions take it onto faces of the mesh that it lacks. More is
  /// no gap, but another region.
  double max_gaps = 0.1;

  /// Share of the quotient's area that a region or pattern (with its images) saves, given those listed before it; with
  /// less the list ends. Below it is what a person would not write down: a group that repeats what others say of its
  /// faces, but for a sliver.
  double min_importance = 0.003;
};

}  // namespace orbifit
