#include "resolution/proxy_faces.h"

#include <algorithm>
#include <limits>

#include "geometry/surface_index.h"
#include "surface/face_points.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

std::size_t number(int i) {
  return static_cast<std::size_t>(i);
}

// With regard to the normal, of the coarse faces at the clusters of the face's corners.
int nearest_of(int face, const ClusteredMesh& clustered, const std::vector<std::vector<int>>& around,
               const Points& normals) {
  const Vector3d centroid = face_centroid(clustered.fine, face);
  const Vector3d normal = clustered.fine.normals.row(face);
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const int cluster : clustered.corners_of(face)) {
    for (const int other : around[number(cluster)]) {
      const Vector3d a = clustered.mesh.vertices.row(clustered.mesh.faces(other, 0));
      const Vector3d b = clustered.mesh.vertices.row(clustered.mesh.faces(other, 1));
      const Vector3d c = clustered.mesh.vertices.row(clustered.mesh.faces(other, 2));
      const Vector3d weights = nearest_on_triangle(centroid, a, b, c);
      // A face that looks elsewhere counts as if it were its own size away.
      const double away = (weights[0] * a + weights[1] * b + weights[2] * c - centroid).norm();
      const double cost = away + (1 - normal.dot(normals.row(other))) * (b - a).norm();
      if (cost < least || (cost == least && other < best)) {
        least = cost;
        best = other;
      }
    }
  }
  return best;
}

// What dangles has no coarse face at its corners: as its neighbours do.
void spread_to_dangling(const Sites& sites, std::vector<int>& proxy_face) {
  std::vector<int> open;
  for (std::size_t f = 0; f < proxy_face.size(); ++f) {
    if (proxy_face[f] < 0) open.push_back(static_cast<int>(f));
  }
  std::vector<int> of_site(sites.group.size(), -1);
  for (std::size_t before = open.size() + 1; !open.empty() && open.size() < before;) {
    before = open.size();
    for (std::size_t f = 0; f < proxy_face.size(); ++f) {
      for (const int site : sites.of_face[f]) {
        if (of_site[number(site)] < 0) of_site[number(site)] = proxy_face[f];
      }
    }
    std::erase_if(open, [&](int f) {
      for (const int site : sites.of_face[number(f)]) {
        proxy_face[number(f)] = std::max(proxy_face[number(f)], of_site[number(site)]);
      }
      return proxy_face[number(f)] >= 0;
    });
  }
}

}  // namespace

ClusteredMesh::Corners ClusteredMesh::corners_of(int face) const {
  Corners corners{};
  for (std::size_t k = 0; k < 3; ++k) corners[k] = cluster_of_site[number(sites.of_face[number(face)][k])];
  return corners;
}

void complete_proxy_faces(const ClusteredMesh& clustered, const RunContext& context, std::vector<int>& proxy_face) {
  const Mesh& mesh = clustered.mesh;
  std::vector<std::vector<int>> around(static_cast<std::size_t>(mesh.vertices.rows()));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) around[number(mesh.faces(f, k))].push_back(static_cast<int>(f));
  }
  const Points normals = face_normals(mesh);
  parallel_for(context, proxy_face.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (f % 4096 == 0) context.check();
      if (proxy_face[f] < 0) proxy_face[f] = nearest_of(static_cast<int>(f), clustered, around, normals);
    }
  });
  spread_to_dangling(clustered.sites, proxy_face);
}

}  // namespace orbifit
