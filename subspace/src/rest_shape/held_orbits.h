#pragma once

#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "rest_shape/image_pairs.h"
#include "rest_shape/matched_orbits.h"

namespace orbifit {

/// How far the images of a region's places are from its surface, in mesh units.
struct GapSummary {
  double max = 0;
  double squares = 0;  ///< sum of the squared distances
  std::size_t pairs = 0;
};

/// Tells which orbits have to stay where they were, so that no region is worse than before.
class HeldOrbits {
 public:
  /// All are kept by reference.
  /// \param rest    of the places, #P by 3
  /// \param at_rest all pairs' matches there
  HeldOrbits(ImagePairs& pairs, const std::vector<PlaceOrbit>& orbits, const Points& rest,
             const std::vector<SurfaceMatch>& at_rest);

  const std::vector<GapSummary>& before() const { return before_; }  ///< of each region, at rest

  /// Of each region when the places are at `positions`, where orbits are exact unless they are held.
  std::vector<GapSummary> summary(const Points& positions, const RunContext& context);

  /// Holds orbits with members farther than `most` from rest, mesh units.
  void hold_far(const Points& positions, double most);

  /// Faces that turned over, or nearly, and lie much more sharply against a neighbour than at rest; none where as many
  /// lie much less so: noise as large as the faces leaves them in disorder, and they turn as it goes.
  std::vector<int> folded(const Points& positions) const;

  /// Holds orbits of the corners of those; whether there are any.
  bool hold_folded(const Points& positions);

  /// Whether any region's largest or mean square distance exceeds that at rest. Then more orbits are held: those of
  /// the pairs that make it so, a place or what its image meets, now or at rest. A pair all of whose orbits are held
  /// is no farther apart than at rest, since the surface's point that was nearest then is still there: so, with the
  /// held orbits put back to rest, sooner or later the answer is no.
  /// \param whole_regions  all orbits of such a region at once
  bool hold_more(const Points& positions, bool whole_regions, const RunContext& context);

  const std::vector<char>& held() const { return held_; }  ///< by orbit

 private:
  std::vector<std::vector<char>> open_places() const;
  Points normals(const Points& positions) const;
  double sharpest(int face, const Points& normals) const;
  bool hold(std::size_t pair, const SurfaceMatch& match, bool complete_ones);
  bool hold_corners(const SurfaceMatch& match, bool complete_ones);
  bool hold_place(int place, bool complete_ones);

  ImagePairs& pairs_;
  const std::vector<PlaceOrbit>& orbits_;
  std::vector<int> orbit_of_;  // of places
  const Points& rest_;
  double rounding_;  // mesh units
  const std::vector<SurfaceMatch>& at_rest_;
  Points normals_;                            // of the faces at rest, unit; 0 of those too thin to have one
  std::vector<Eigen::RowVector3i> partners_;  // of each face's sides the face that goes on there at rest; -1: none
  std::vector<GapSummary> before_;
  std::vector<char> held_;
};

}  // namespace orbifit
