#include "surface/smooth_border.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "surface/face_points.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Sides = std::vector<std::array<FaceSide, 3>>;

Vector3d middle_of(const PreparedMesh& prepared, const FaceSide& side) {
  const auto end = [&](std::size_t k) -> Vector3d {
    return prepared.mesh.vertices.row(prepared.weld.representative[static_cast<std::size_t>(side.ends[k])]);
  };
  return 0.5 * (end(0) + end(1));
}

// Whether the surface about an edge faces the way it does there, as far as `reach`.
bool smooth_about(const PreparedMesh& prepared, const Sides& sides, int face, const FaceSide& side, double reach) {
  constexpr double kElsewhere = 0.9396926207859084;  // cosine of 20 degrees
  constexpr double kMax = 0.125;                     // of the area that faces elsewhere
  constexpr std::size_t kMaxFaces = 400;
  const Vector3d normal = (prepared.normals.row(face) + prepared.normals.row(side.face)).normalized();
  const Vector3d middle = middle_of(prepared, side);
  std::vector<int> near{face, side.face};
  std::unordered_set<int> seen(near.begin(), near.end());
  double area = 0;
  double elsewhere = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    area += prepared.areas[near[i]];
    if (prepared.normals.row(near[i]).dot(normal) < kElsewhere) elsewhere += prepared.areas[near[i]];
    for (const FaceSide& next : sides[static_cast<std::size_t>(near[i])]) {
      if (next.face < 0 || near.size() >= kMaxFaces) continue;
      if ((face_centroid(prepared, next.face) - middle).norm() > reach || !seen.insert(next.face).second) continue;
      near.push_back(next.face);
    }
  }
  return elsewhere <= kMax * area;
}

}  // namespace

double smooth_border_share(const PreparedMesh& prepared, const Sides& sides, const std::vector<int>& faces,
                           double tolerance, const std::function<bool(const Vector3d& middle)>& excused) {
  constexpr std::size_t kLooks = 300;
  struct BorderEdge {
    int face;
    const FaceSide* side;
  };
  std::vector<BorderEdge> border;
  for (const int face : faces) {
    for (const FaceSide& side : sides[static_cast<std::size_t>(face)]) {
      if (side.face >= 0 && !std::ranges::binary_search(faces, side.face)) border.push_back({face, &side});
    }
  }
  const std::size_t looks = std::min(kLooks, border.size());
  double length = 0;
  double smooth = 0;
  for (std::size_t k = 0; k < looks; ++k) {
    const BorderEdge& edge = border[k * border.size() / looks];
    length += edge.side->length;
    if (!smooth_about(prepared, sides, edge.face, *edge.side, kAboutBorder * tolerance)) continue;
    if (!excused || !excused(middle_of(prepared, *edge.side))) smooth += edge.side->length;
  }
  return length > 0 ? smooth / length : 0;
}

}  // namespace orbifit
