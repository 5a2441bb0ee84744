#include "resolution/region_border.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>

#include "geometry/grid_cell.h"
#include "group/verification.h"
#include "surface/face_points.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kPiece = 0.5;  // size, tolerances

}  // namespace

RegionBorder::RegionBorder(const PreparedMesh& fine, const CoarseMesh& coarse, const PreparedMesh& prepared,
                           double tolerance)
    : fine_(fine),
      prepared_(prepared),
      tolerance_(tolerance),
      coarse_of_fine_(inverse(prepared.input_of_normalised)),
      faces_of_(static_cast<std::size_t>(coarse.mesh.faces.rows())) {
  for (std::size_t f = 0; f < coarse.proxy_face.size(); ++f) {
    faces_of_[static_cast<std::size_t>(coarse.proxy_face[f])].push_back(static_cast<int>(f));
  }
}

std::vector<int> RegionBorder::fine_faces(const std::vector<int>& coarse) const {
  std::vector<int> faces;
  for (const int face : coarse) std::ranges::copy(faces_of_[static_cast<std::size_t>(face)], std::back_inserter(faces));
  std::ranges::sort(faces);
  return faces;
}

std::vector<int> RegionBorder::along_border(const FoundRegion& region, std::vector<char>& in) const {
  const auto vertex = [&](int face, int k) {
    const auto corner = static_cast<std::size_t>(prepared_.mesh.faces(face, k));
    return static_cast<std::size_t>(prepared_.weld.group_of_vertex[corner]);
  };
  for (const int face : region.faces) in[static_cast<std::size_t>(face)] = 1;
  std::vector<char> seen(in.size(), 0);
  std::vector<int> result;
  const auto take = [&](int face) {
    if (seen[static_cast<std::size_t>(face)] != 0) return;
    seen[static_cast<std::size_t>(face)] = 1;
    result.push_back(face);
  };
  for (const int face : region.faces) {
    const Vector3d normal = prepared_.normals.row(face);
    for (int k = 0; k < 3; ++k) {
      for (const int other : prepared_.faces_of_vertex[vertex(face, k)]) {
        const auto number = static_cast<std::size_t>(other);
        const bool beyond = in[number] == 0 &&
                            prepared_.components.component_of_face[number] ==
                                prepared_.components.component_of_face[static_cast<std::size_t>(face)] &&
                            normal.dot(prepared_.normals.row(other)) > kAlikeNormals;
        if (!beyond) continue;
        take(face);
        take(other);
      }
    }
  }
  std::ranges::sort(result);
  return result;
}

std::vector<RegionBorder::Piece> RegionBorder::pieces_of(const std::vector<int>& coarse) const {
  const double size = kPiece * tolerance_;
  std::vector<Piece> pieces;
  for (const int face : coarse) {
    std::map<std::array<std::int64_t, 3>, std::size_t> known;  // by cell: the piece
    for (const int f : faces_of_[static_cast<std::size_t>(face)]) {
      const Vector3d centroid = coarse_of_fine_(face_centroid(fine_, f));
      const auto [entry, fresh] = known.try_emplace(grid_cell(centroid, size), pieces.size());
      if (fresh) pieces.push_back({centroid, prepared_.normals.row(face), {}});
      pieces[entry->second].faces.push_back(f);
    }
  }
  return pieces;
}

std::vector<int> RegionBorder::refined(const FoundRegion& region, const RunContext& context) const {
  std::vector<char> in(faces_of_.size(), 0);
  const std::vector<int> border = along_border(region, in);
  if (border.empty()) return fine_faces(region.faces);
  std::vector<int> inner;  // not at the border
  std::ranges::set_difference(region.faces, border, std::back_inserter(inner));
  std::vector<int> around;
  std::ranges::set_union(region.faces, border, std::back_inserter(around));
  const SurfaceIndex surface(prepared_.mesh, around);
  const SurfaceMoments moments = surface_moments(prepared_, region.faces);
  const double reach = tolerance_of_part(tolerance_, moments.diagonal);
  const GroupPlacement& placement = region.placement;
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  const std::vector<Piece> pieces = pieces_of(border);
  std::vector<char> kept(pieces.size(), 0);
  parallel_for(context, pieces.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i % 256 == 0) context.check();
      const bool all = std::ranges::all_of(motions, [&](const Motion& motion) {
        return surface.within_facing(motion(pieces[i].point), motion.linear * pieces[i].normal, kFacetNormals, reach);
      });
      kept[i] = all ? 1 : 0;
    }
  });
  std::vector<int> faces = fine_faces(inner);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (kept[i] != 0) std::ranges::copy(pieces[i].faces, std::back_inserter(faces));
  }
  std::ranges::sort(faces);
  return faces;
}

}  // namespace orbifit
