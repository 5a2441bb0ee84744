#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "measures/region_surface.h"

namespace orbifit {

/// Some faces of a mesh and the connected parts into which they fall.
class RegionParts {
 public:
  struct Part {
    std::vector<int> faces;     ///< of the mesh
    std::vector<int> vertices;  ///< numbers within whole().vertices()
    Eigen::Vector3d centroid;   ///< of its area
    double area = 0;
  };

  /// Each vertex counts to one part.
  struct Division {
    std::vector<Part> parts;
    std::vector<int> part_of_vertex;  ///< by number within whole().vertices()
    std::vector<char> shared;         ///< likewise: whether other parts have the vertex as well
  };

  /// \param mesh  kept by reference \param reach  as RegionSurface has it
  RegionParts(const Mesh& mesh, const std::vector<int>& faces, double reach);

  const RegionSurface& whole() const { return whole_; }

  /// A part by itself; made when it is first asked for. Not for use by several threads.
  const RegionSurface& surface_of(std::size_t part) const;

  /// None where there is a single part, or hardly more than single triangles. Parts are touching_parts(), those in one
  /// place each by itself.
  const std::optional<Division>& division() const { return division_; }

 private:
  const Mesh& mesh_;
  double reach_;
  RegionSurface whole_;
  std::optional<Division> division_;
  mutable std::vector<std::unique_ptr<const RegionSurface>> surfaces_;  // by part
};

/// Points q on one surface for points p of another under some motions.
struct Pairing {
  std::vector<SurfacePlace> places;  ///< of motion m and vertex v of `from` at m * #vertices + v

  /// Where several parts lie at one place, nothing at rest says which of them is a part's image.
  struct Choice {
    std::vector<std::size_t> pairs;                       ///< numbers in `places`
    std::vector<std::vector<SurfacePlace>> alternatives;  ///< other places for all of them
  };
  std::vector<Choice> choices;
};

/// Finds the places of images of the vertices of `from` on `to`: on the part to which the motion takes the vertex'
/// part, where there is one within `tolerance`; else on all of `to`. So what touches a part, or is nearer to its image
/// than its counterpart is, does not matter.
/// \param motions  which make the images, in space
/// \param images  of vertex v under motion m in row m * #vertices + v
/// \param tolerance  mesh units, > 0
/// \param reach  distance at which places are the same, mesh units
Pairing pair_parts(const RegionParts& from, const RegionParts& to, const std::vector<Motion>& motions,
                   const Points& images, double tolerance, double reach, const RunContext& context);

}  // namespace orbifit
