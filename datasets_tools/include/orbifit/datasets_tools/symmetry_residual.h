#pragma once

#include <memory>
#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace orbifit {

/// Which motions of a region's group are allowed in the deformed shape (docs/method.md 2.2).
enum class CarriedMotions {
  fixed,     ///< the group as it is
  posed,     ///< moved by one rigid motion common to all regions
  floating,  ///< one common rotation and a translation for each region
  moving     ///< a rigid motion for each region
};

struct RegionResidual {
  int id = 0;
  std::string name;
  std::string group;
  int vertices = 0;  ///< of the region
  int mapped = 0;    ///< of its (vertex, element) pairs, how many map onto a vertex to 1e-6 of the diagonal
  int pairs = 0;
  /// Of the rest shape: distances |g p - q|, q the point nearest to g p of the region's connected part to which g takes
  /// that of p, or of the region where g takes it onto none. Fractions of its diagonal.
  Residual floor;
  /// Of the deformed shape: |g' y(p) - y(q)| by the same q, g' the carried motion. Fractions of its diagonal.
  Residual deformed;
  /// deformed less floor, vertex by vertex, at least 0.
  Residual excess;
  int worst_vertex = -1;  ///< of the deformed shape where given, else of the rest shape
};

struct PatternResidual {
  int id = 0;
  std::string name;
  Residual floor, deformed;  ///< congruence with instance 0 after the best rigid motion
};

struct SymmetryReport {
  bool vertices_onto_vertices = false;  ///< every pair of every region
  std::vector<RegionResidual> regions;
  std::vector<PatternResidual> patterns;
  double worst_floor = 0, worst_deformed = 0, worst_excess = 0;  ///< over the regions
  Eigen::VectorXd vertex_excess;  ///< #V: the largest excess of a vertex in any region; 0 at rest and outside of them
};

/// How far the regions and patterns are from symmetric, at rest and, if `deformed` is not null, after a deformation
/// that kept the connectivity. Points are paired at rest, within parts, so that what touches a part or lies in the same
/// place does not matter; where several parts do lie in one place, the deformed shape tells them apart. Continuous
/// groups are measured on mirrors, half turns and the rotations that the tessellation has.
/// \throw InputError when the
/// deformed mesh's counts differ
SymmetryReport symmetry_residual(const Mesh& mesh, const SymmetryAnnotation& annotation, const Mesh* deformed,
                                 CarriedMotions motions, RunContext& context);

/// The same in two steps: how points are paired at rest, which takes longest, is found before there is a deformed
/// shape.
class SymmetryPairs {
 public:
  /// References are kept.
  SymmetryPairs(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context);
  SymmetryPairs(SymmetryPairs&&) noexcept;
  SymmetryPairs& operator=(SymmetryPairs&&) = delete;
  ~SymmetryPairs();

  SymmetryReport residual(const Mesh* deformed, CarriedMotions motions, const RunContext& context) const;

 private:
  struct OfRegions;

  const Mesh& mesh_;
  const SymmetryAnnotation& annotation_;
  std::unique_ptr<const OfRegions> pairs_;
};

}  // namespace orbifit
