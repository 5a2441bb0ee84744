#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "geometry/topology.h"

namespace orbifit {

inline constexpr double kWeldTolerance = 1e-7;  ///< of the diagonal: vertices that are nearer are one

/// A mesh made ready for detection: moved so that its box is centred on the origin and its diagonal is 1.
struct PreparedMesh {
  Mesh mesh;                       ///< normalised; faces in the order of the input
  Similarity input_of_normalised;  ///< carries the normalised mesh back to where it was given
  Weld weld;                       ///< at kWeldTolerance
  Components components;           ///< touching_parts()
  Points normals;                  ///< #F by 3
  Eigen::VectorXd areas;           ///< #F; 0 for faces that repeat one of their component (two-sided sheets)
  std::vector<std::vector<int>> faces_of_vertex;  ///< by group of the weld: the faces at it
  double area = 0;
  double noise = 0;                           ///< that was taken out, a fraction of the diagonal
  std::shared_ptr<const SurfaceIndex> index;  ///< of all faces
  std::shared_ptr<const SurfaceIndex> ends;   ///< end_edges(), see there
};

/// \throw InputError when a coordinate is not finite
void require_finite(const Mesh& mesh);

/// \throw InputError when the mesh has no area or a coordinate is not finite
PreparedMesh prepare(const Mesh& mesh);

/// Of the faces that count, see PreparedMesh::areas.
double area_of(const PreparedMesh& prepared, const std::vector<int>& faces);

/// Calls look(other) for each face at a corner of the face, itself too; for those at two of its corners twice.
template <typename Look>
void for_neighbours(const PreparedMesh& prepared, int face, const Look& look) {
  for (int k = 0; k < 3; ++k) {
    const auto corner = static_cast<std::size_t>(prepared.mesh.faces(face, k));
    const auto vertex = static_cast<std::size_t>(prepared.weld.group_of_vertex[corner]);
    for (const int other : prepared.faces_of_vertex[vertex]) look(other);
  }
}

/// Area moments of some faces, exact integrals over the triangles.
struct SurfaceMoments {
  double area = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< about the centroid, divided by the area
  double radius = 0;                                     ///< largest distance of a vertex from the centroid
  double diagonal = 0;                                   ///< of the faces' bounding box
};
SurfaceMoments surface_moments(const PreparedMesh& prepared, const std::vector<int>& faces);

/// A set of faces with what is needed to ask whether motions map it to itself. Lengths are those of the normalised
/// mesh.
struct SurfacePatch {
  static constexpr int kPartSamples = 20;
  const PreparedMesh* prepared = nullptr;  ///< not owned
  std::vector<int> faces;                  ///< ascending
  SurfaceMoments moments;
  SurfaceSamples samples;
  std::vector<char> at_crease;  ///< per sample: a face at more than 25 degrees is within three tolerances
  SurfaceSamples part_samples;  ///< of the components, where there are several: kPartSamples of each in turn
  std::vector<char> part_at_crease;
  double tolerance = 0;           ///< min(t, 4 t d): t the mesh's, d the patch's diagonal
  double relative_tolerance = 0;  ///< t, a fraction of a diagonal
  double largest_blot = 0.005;    ///< share in one piece that may lie where there is no image
  std::shared_ptr<const SurfaceIndex> index;
};

/// \param stream name of the random stream that draws the samples
SurfacePatch make_patch(const PreparedMesh& prepared, std::vector<int> faces, int samples, double tolerance,
                        const RunContext& context, std::string_view stream);

/// The samples alone: without index, parts and creases.
SurfacePatch sample_patch(const PreparedMesh& prepared, std::vector<int> faces, int samples, double tolerance,
                          const RunContext& context, std::string_view stream);

}  // namespace orbifit
