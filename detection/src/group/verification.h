#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"
#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// The motions on which a group is judged: all elements but the identity of a finite group; for a continuous one a
/// fixed set of rotations by irrational fractions of a turn, combined with the representatives of its cosets.
std::vector<Motion> judged_motions(const PointGroup& group, const GroupFrame& frame, const Eigen::Vector3d& centre);

/// How much of a patch a set of motions maps onto the patch.
struct Verification {
  double joint = 0;    ///< share of the samples that every motion keeps on the surface
  double worst = 1;    ///< smallest share over the motions
  double cluster = 0;  ///< share of the largest connected blot of samples that some motion throws far off
  double part = 1;     ///< least share of a part (component of at least 0.2 % of the area) kept by one of the motions
  bool complete = false;   ///< false: given up early, the figures are of the samples seen until then
  std::vector<char> kept;  ///< per sample seen: kept by every motion
};

struct VerificationLimits {
  double joint = 0.96;     ///< least share kept by all motions together
  double worst = 0.97;     ///< least share kept by each
  double cluster = 0.005;  ///< largest blot, so that one missing bolt is not averaged away
  double part = 0.6;       ///< of each part, so that large flats do not swamp small parts
};

/// The usual limits, with the blot that the patch allows.
VerificationLimits limits_of(const SurfacePatch& patch);

/// Images are on the surface when a face whose normal is within 25 degrees (any face for samples next to a crease) lies
/// within `tolerance`.
/// \param samples how many of the patch's samples to use, spread evenly; 0: all
/// \param give_up_below stop as soon as the share kept jointly falls below; 0: never
Verification verify(const SurfacePatch& patch, const std::vector<Motion>& motions, double tolerance, int samples,
                    double give_up_below, const RunContext& context);

bool passes(const Verification& verification, const VerificationLimits& limits = {});

/// Whether nothing but a blot is against it. How large a blot is, few samples or angles do not tell: more may decide.
bool only_a_blot_fails(const Verification& verification, const VerificationLimits& limits = {});

/// Why it does not pass, in words for an explanation; empty where it does.
std::string objection(const Verification& verification, const VerificationLimits& limits = {});

/// Share of `samples` spread evenly over the patch that one motion keeps; cheap, for screening.
double kept_share(const SurfacePatch& patch, const Motion& motion, double tolerance, int samples,
                  double give_up_below = 0);

inline constexpr int kResidualSamples = 1000;  ///< of a region, at most as many as its residual asks for

/// Whether a region fits a group there about as well as here, so that its placement may move to where others say.
bool fits_as_well(double residual_there, double residual_here);

/// Distances between g(S) and S over samples and motions, in the mesh's diagonal.
/// \param queries how many pairs of a sample and a motion to measure, about
Residual measure_residual(const SurfacePatch& patch, const std::vector<Motion>& motions, const RunContext& context,
                          std::size_t queries = 16000);

}  // namespace orbifit
