#include "registration/landmark_consensus.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <Eigen/SVD>

#include "base/random.h"
#include "registration/alignment.h"
#include "registration/correspondences.h"

namespace orbifit {

namespace {

constexpr std::size_t kMinContradicting = 4;  // of three, no two are right against the third
constexpr double kOnALine = 1e-6;             // spread across it against that along it
constexpr std::size_t kAllTriplesOf = 20;     // 1140 of them; of more landmarks as many random ones
constexpr std::size_t kRandomTriples = 1200;  // half of the landmarks wrong: one triple in eight is right
constexpr int kRefinements = 10;

bool on_a_line(const Points& points) {
  if (points.rows() < 3) return true;
  const Eigen::MatrixXd offsets = points.rowwise() - points.colwise().mean();
  const Eigen::VectorXd spread = Eigen::JacobiSVD<Eigen::MatrixXd>(offsets).singularValues();
  return !(spread[1] > kOnALine * spread[0]);
}

std::vector<std::vector<std::size_t>> triples_of(std::size_t count) {
  std::vector<std::vector<std::size_t>> result;
  if (count <= kAllTriplesOf) {
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = a + 1; b < count; ++b) {
        for (std::size_t c = b + 1; c < count; ++c) result.push_back({a, b, c});
      }
    }
    return result;
  }
  Random random(0, "triples of landmarks");
  while (result.size() < kRandomTriples) {
    const std::size_t a = random.below(count);
    const std::size_t b = random.below(count);
    const std::size_t c = random.below(count);
    if (a != b && a != c && b != c) result.push_back({a, b, c});
  }
  return result;
}

std::vector<Landmark> some_of(const std::vector<Landmark>& landmarks, const std::vector<char>& chosen) {
  std::vector<Landmark> result;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (chosen[i] != 0) result.push_back(landmarks[i]);
  }
  return result;
}

}  // namespace

double landmark_residual(const Mesh& mesh, const Landmark& landmark, const Similarity& pose) {
  const Eigen::Vector3d place = pose(mesh.vertices.row(landmark.vertex).transpose());
  return (place - landmark.target).norm() / (pose.scale * diagonal(mesh.vertices));
}

double landmark_sum(const Mesh& mesh, const std::vector<Landmark>& landmarks, const Similarity& pose,
                    double tolerance) {
  double sum = 0;
  for (const Landmark& each : landmarks) sum += robust_error(landmark_residual(mesh, each, pose), 0.5 * tolerance);
  return sum;
}

std::vector<char> near_targets(const Mesh& mesh, const std::vector<Landmark>& landmarks, const Similarity& pose,
                               double tolerance) {
  std::vector<char> result;
  result.reserve(landmarks.size());
  for (const Landmark& each : landmarks) {
    result.push_back(landmark_residual(mesh, each, pose) <= tolerance ? 1 : 0);
  }
  return result;
}

bool determine_pose(const Mesh& mesh, const std::vector<Landmark>& landmarks) {
  Points own(static_cast<Eigen::Index>(landmarks.size()), 3);
  Points targets(own.rows(), 3);
  for (Eigen::Index i = 0; i < own.rows(); ++i) {
    const Landmark& each = landmarks[static_cast<std::size_t>(i)];
    own.row(i) = mesh.vertices.row(each.vertex);
    targets.row(i) = each.target.transpose();
  }
  return !on_a_line(own) && !on_a_line(targets);
}

LandmarkConsensus landmark_consensus(const Mesh& mesh, const std::vector<Landmark>& landmarks, double tolerance,
                                     const std::optional<double>& scale) {
  LandmarkConsensus result;
  result.agrees.assign(landmarks.size(), 1);
  if (landmarks.empty()) return result;
  result.pose = align_landmarks(mesh, landmarks, scale);
  if (landmarks.size() >= kMinContradicting) {
    double least = landmark_sum(mesh, landmarks, result.pose, tolerance);
    for (const std::vector<std::size_t>& triple : triples_of(landmarks.size())) {
      const std::vector<Landmark> three{landmarks[triple[0]], landmarks[triple[1]], landmarks[triple[2]]};
      if (!determine_pose(mesh, three)) continue;
      const Similarity pose = align_landmarks(mesh, three, scale);
      const double sum = landmark_sum(mesh, landmarks, pose, tolerance);
      if (sum >= least) continue;
      least = sum;
      result.pose = pose;
    }
    for (int round = 0; round < kRefinements; ++round) {
      std::vector<char> agrees = near_targets(mesh, landmarks, result.pose, tolerance);
      const std::vector<Landmark> kept = some_of(landmarks, agrees);
      const bool same = round > 0 && agrees == result.agrees;
      // No majority: nothing is known of which are wrong, and the scan has to say.
      if (same || 2 * kept.size() <= landmarks.size() || !determine_pose(mesh, kept)) break;
      result.agrees = std::move(agrees);
      result.pose = align_landmarks(mesh, kept, scale);
    }
  }
  const std::vector<Landmark> kept = some_of(landmarks, result.agrees);
  result.determined = determine_pose(mesh, kept);
  for (const Landmark& each : kept) {
    result.largest_residual = std::max(result.largest_residual, landmark_residual(mesh, each, result.pose));
  }
  return result;
}

}  // namespace orbifit
