#pragma once

#include <optional>
#include <vector>

#include "orbifit/fitting/landmarks.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// What landmarks say of the pose together.
struct LandmarkConsensus {
  Similarity pose;              ///< template -> scan: align_landmarks() of those that agree
  bool determined = false;      ///< three agree that are not on one line: pose and scale are known
  std::vector<char> agrees;     ///< #L: within `tolerance` of its target in that pose
  double largest_residual = 0;  ///< of those that agree, fraction of the posed template's diagonal
};

/// The pose in which most landmarks lie near their targets: of the poses of all triples, or of random ones where there
/// are many (RANSAC, Fischler and Bolles 1981), the one of least robust error, refined by those that agree. Three or
/// fewer contradict one another no less than they agree, so all of them are believed.
/// \param tolerance  of the posed template's diagonal: how far shapes of one kind differ \param scale  where it is known
LandmarkConsensus landmark_consensus(const Mesh& mesh, const std::vector<Landmark>& landmarks, double tolerance,
                                     const std::optional<double>& scale = {});

/// Distance of a landmark's vertex from its target in a pose, fraction of the posed template's diagonal.
double landmark_residual(const Mesh& mesh, const Landmark& landmark, const Similarity& pose);

/// The sum of the landmarks' robust errors in a pose, squared fractions of the posed template's diagonal. Half the
/// tolerance is typical of a landmark that is right.
double landmark_sum(const Mesh& mesh, const std::vector<Landmark>& landmarks, const Similarity& pose, double tolerance);

/// Of each landmark, whether it is within the tolerance of its target.
std::vector<char> near_targets(const Mesh& mesh, const std::vector<Landmark>& landmarks, const Similarity& pose,
                               double tolerance);

/// Whether three landmarks at least are not on one line, in the template and in the scan.
bool determine_pose(const Mesh& mesh, const std::vector<Landmark>& landmarks);

}  // namespace orbifit
