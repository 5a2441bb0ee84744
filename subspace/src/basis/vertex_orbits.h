#pragma once

#include <cstdint>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "basis/symmetric_basis.h"
#include "symmetry/orbit.h"

namespace orbifit {

/// The vertices of a mesh in orbits: one representative each, whose displacement decides those of the others. A vertex
/// is in all places of all faces around its position, so that borders have the symmetries of both sides. Vertices
/// within a tolerance of an image of a representative follow it exactly, coincident ones too: a mesh read from a file
/// of few digits stays as symmetric as the file was. Images that meet no vertex are kept as points of the orbit, so
/// that the displacement is symmetric in space.
struct VertexOrbits {
  double tolerance = 0;  ///< vertices nearer than this are one place, mesh units
  struct Follower {
    int representative = 0;  ///< number of it
    int word = 0;            ///< from its canonical place to here
    int turn = -1;           ///< in `turns`, from here on; -1: none
  };
  std::vector<Follower> followers;  ///< #V
  struct Turn {
    int place;
    Motion motion;
  };
  std::vector<Turn> turns;  ///< of vertices on circles or spheres, from their canonical places

  Points positions;                       ///< #R by 3, canonical places of the representatives
  std::vector<int> bound;                 ///< #R: number of the representative's binding, -1: free
  std::vector<BoundPoint> bindings;       ///< those in use, then the same words at further points
  std::vector<std::int64_t> first_point;  ///< of each orbit in the lists below, and their length at the end
  std::vector<int> point_words;           ///< from the canonical place; the first of each orbit is the identity
  std::vector<int> point_sets;            ///< places that hold the point
  bool images_are_vertices = true;        ///< of every point of every orbit
  /// From where its word takes a vertex to where it is, at most `tolerance`, and the region that this turns with; -1:
  /// none.
  struct Offset {
    Eigen::Vector3d offset;
    int region = -1;
  };
  std::vector<Offset> offsets;  ///< #V; empty where groups do not turn

  int representatives() const { return static_cast<int>(bound.size()); }
};

/// \param tolerance vertices nearer than this are one place, mesh units
/// \param known_sets  closed_sets_of_vertices(), found and kept there where it is empty
/// O(V * elements), memory about 60 bytes a vertex.
/// \throw InputError when an orbit does not close
VertexOrbits vertex_orbits(const Mesh& mesh, const RegionMap& regions, GroupWords& words, double tolerance,
                           std::vector<int>& known_sets, const RunContext& context);

/// The set of places that holds a vertex, as its orbit has it.
int set_of_vertex(const VertexOrbits& orbits, int vertex);

/// The offsets of a mesh's vertices.
std::vector<VertexOrbits::Offset> follower_offsets(const Mesh& mesh, const RegionMap& regions,
                                                   const VertexOrbits& orbits, const GroupWords& words);

/// Every vertex its own representative, without symmetry.
VertexOrbits lone_vertices(const Mesh& mesh);

}  // namespace orbifit
