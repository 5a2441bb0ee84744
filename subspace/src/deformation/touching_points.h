#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// A point of a face.
struct FacePoint {
  int face = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< sums to 1
};

/// Two points of different parts at (nearly) one place.
struct TouchingPoints {
  std::array<int, 2> parts;         ///< of touching_parts(), ascending
  std::array<FacePoint, 2> points;  ///< on either
  Eigen::Vector3d middle;           ///< between them
  Eigen::Vector3d gap;              ///< from the second to the first
};

/// Where parts of a mesh touch, looked for with one spacing after another: of two parts that both spacings ask for the
/// same points of, what is known is told again. Const calls may run on several threads.
class TouchingSearch {
 public:
  /// Arguments as touching_points() has them. \param mesh  kept by reference
  TouchingSearch(const Mesh& mesh, const std::vector<int>& part_of_face, double tolerance, const RunContext& context);
  TouchingSearch(const TouchingSearch&) = delete;
  TouchingSearch& operator=(const TouchingSearch&) = delete;
  TouchingSearch(TouchingSearch&&) = delete;
  TouchingSearch& operator=(TouchingSearch&&) = delete;
  ~TouchingSearch();

  std::vector<TouchingPoints> points(double spacing, const RunContext& context) const;

 private:
  struct Part;
  struct Found;
  class OfPart;

  const Mesh& mesh_;
  double tolerance_;
  std::vector<Part> parts_;
  std::vector<std::array<int, 2>> pairs_;  // of parts whose boxes come near one another
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const std::vector<Found>> known_;  // of the pairs, as they were last looked for
};

/// Where parts of a mesh touch: where an edge of one passes through a face of another, and where one has points within
/// a tolerance of another. Looked at are the vertices of both and, where faces are large, points in them. As densely as
/// the mesh is: many points may say of one joint the same. In an order that depends on the mesh alone.
/// \param part_of_face  #F, see touching_parts(): those in one part are not asked
/// \param tolerance mesh units, >= 0: nearer than this is touching
/// \param spacing   mesh units, > 0: of the points looked at within large faces
/// O(F log F), and for each two parts whose boxes meet O(log F) for what they have there
std::vector<TouchingPoints> touching_points(const Mesh& mesh, const std::vector<int>& part_of_face, double tolerance,
                                            double spacing, const RunContext& context);

}  // namespace orbifit
