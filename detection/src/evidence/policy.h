#pragma once

#include <cstddef>

#include "group/verification.h"

namespace orbifit {

/// What decides on the list of regions and patterns: each threshold with its unit and its reason.
struct EvidencePolicy {
  /// Share of an area that says nothing, since borders are drawn face by face. A region or pattern (with its images)
  /// that saves no more of what was left of its own surface follows from those listed before it; one that has no more
  /// outside of another lies in it.
  double sliver = 0.05;
  /// Share of the mesh's area from which on a region or pattern (with its images) is a main part: it is listed unless
  /// another holds it, since it tells how others stand to one another.
  double main_part = 0.2;
  /// Share of the surface that does not follow from what is listed before, below which what a region or pattern (with
  /// its images) saves of it is next to nothing where it ends within a part. What is a part of its own is listed
  /// however small it is: it was modelled as one.
  double least = 0.02;
  /// Share of a region's area that may be taken from its border: a region that loses more ends within a surface whose
  /// faces are too large for its group, and loses on with each face that goes. With half in place of a tenth 3 % fewer
  /// of a remesh's groups are found.
  double trimmed = 0.1;
  /// Share of its border, by length, that may lie within smooth surface (smooth_border_share()) where a region is one
  /// that ends where the shape does.
  double smooth_border = 0.2;
  /// Tolerances by which the facets of a round region may lie inside what they stand for: with more of it they
  /// themselves, not faces that belong to something else, are what misses.
  double sagitta = 0.5;
};

inline constexpr EvidencePolicy kEvidencePolicy;

/// How finely the quotient of a surface is measured.
struct QuotientResolution {
  int samples = 400;          ///< of the whole surface, about: areas to a few percent
  int samples_of_atom = 3;    ///< at least, so that no small part goes unasked; of a sliver one
  std::size_t witnesses = 6;  ///< faces of an atom that are asked where a motion takes it
  int circle = 36;            ///< images about an axis that stand for a circle: divisible by the usual orders
  std::size_t orbit = 400;    ///< points at most: groups that do not close
  double reach = 3;           ///< tolerances within which an image finds its face
  double arrived = 0.5;       ///< share of a claim's area that must arrive in another for them to be images
};

/// When colours speak against a motion that the shape keeps.
struct ColourPolicy {
  /// Distance in sRGB, each of red, green and blue from 0 to 1, above which two colours are different.
  double difference = 24.0 / 255;
  double share = 1 - VerificationLimits{}.worst;  ///< of a region's surface: as much as the shape may miss
  int samples = 400;                              ///< of a region: they tell the share to 1 %
  /// Colours are averaged over a disc of the tolerance's radius, of which there are so many points: the mean of a
  /// pattern of black and white dots is then known to 255 / (2 sqrt(16)) = 32 levels, the best of a neighbourhood's to
  /// a few.
  double samples_of_disc = 16;
  double least_samples = 20000, most_samples = 300000;  ///< of a mesh; the most take some seconds
  double same_side = 0.5;                               ///< cosine between normals: the surface's own side
  int largest_order = 36;                               ///< of rotations sought: more than colours are painted in
  double least_steps = 36, most_steps = 720;            ///< angles at which mirrors are sought: 5 and 0.25 degrees
  double same_motion = 1e-6;                            ///< of the diagonal, and radians
};

inline constexpr ColourPolicy kColourPolicy;

inline constexpr QuotientResolution kQuotientResolution;

}  // namespace orbifit
