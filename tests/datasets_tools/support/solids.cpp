#include "solids.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "geometry/topology.h"

namespace orbifit::test {

Mesh solid_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  for (int v = 0; v < 8; ++v) {
    for (int k = 0; k < 3; ++k) mesh.vertices(v, k) = ((v >> k) & 1) != 0 ? high[k] : low[k];
  }
  mesh.faces.resize(12, 3);
  mesh.faces << 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7,
      6;
  return mesh;
}

Mesh solid_sphere(double radius, int subdivisions) {
  std::vector<Eigen::Vector3d> vertices;
  for (int k = 0; k < 3; ++k) {
    vertices.push_back(Eigen::Vector3d::Unit(k));
    vertices.push_back(-Eigen::Vector3d::Unit(k));
  }
  std::vector<Eigen::Vector3i> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int pass = 0; pass < subdivisions; ++pass) {
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& face : faces) {
      const int first = static_cast<int>(vertices.size());
      for (int k = 0; k < 3; ++k) {
        const auto a = static_cast<std::size_t>(face[k]);
        const auto b = static_cast<std::size_t>(face[(k + 1) % 3]);
        vertices.push_back((vertices[a] + vertices[b]).normalized());
      }
      finer.push_back({face[0], first, first + 2});
      finer.push_back({first, face[1], first + 1});
      finer.push_back({first + 2, first + 1, face[2]});
      finer.push_back({first, first + 1, first + 2});
    }
    faces = finer;
  }
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v)
    mesh.vertices.row(static_cast<Eigen::Index>(v)) = radius * vertices[v];
  const Weld weld = weld_vertices(mesh.vertices, 1e-12 * radius);
  mesh.vertices = Points(mesh.vertices(weld.representative, Eigen::all));
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      mesh.faces(static_cast<Eigen::Index>(f), k) = weld.group_of_vertex[static_cast<std::size_t>(faces[f][k])];
    }
  }
  return mesh;
}

Mesh solid_torus(double ring_radius, double tube_radius, int around_ring, int around_tube) {
  Mesh mesh;
  mesh.vertices.resize(around_ring * around_tube, 3);
  mesh.faces.resize(2 * around_ring * around_tube, 3);
  for (int i = 0; i < around_ring; ++i) {
    for (int j = 0; j < around_tube; ++j) {
      const double along = 2 * std::numbers::pi * i / around_ring;
      const double across = 2 * std::numbers::pi * j / around_tube;
      const double radius = ring_radius + tube_radius * std::cos(across);
      mesh.vertices.row(i * around_tube + j) << radius * std::cos(along), radius * std::sin(along),
          tube_radius * std::sin(across);
      const int next_i = (i + 1) % around_ring;
      const int next_j = (j + 1) % around_tube;
      const int a = i * around_tube + j;
      const int b = next_i * around_tube + j;
      const int c = next_i * around_tube + next_j;
      const int d = i * around_tube + next_j;
      mesh.faces.row(2 * a) << a, b, c;
      mesh.faces.row(2 * a + 1) << a, c, d;
    }
  }
  return mesh;
}

Mesh joined_meshes(const std::vector<Mesh>& meshes) {
  Mesh result;
  for (const Mesh& mesh : meshes) {
    const auto vertices = static_cast<int>(result.vertices.rows());
    const auto faces = result.faces.rows();
    result.vertices.conservativeResize(vertices + mesh.vertices.rows(), 3);
    result.vertices.bottomRows(mesh.vertices.rows()) = mesh.vertices;
    result.faces.conservativeResize(faces + mesh.faces.rows(), 3);
    result.faces.bottomRows(mesh.faces.rows()) = mesh.faces.array() + vertices;
  }
  return result;
}

double one_sided_distance(const Mesh& from, const Mesh& to) {
  Random random(11, "distance");
  const SurfaceSamples samples = sample_surface(from, 5000, random);
  const SurfaceIndex index(to);
  double worst = 0;
  for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
    worst = std::max(worst, index.nearest(samples.points.row(i)).distance);
  }
  return worst;
}

}  // namespace orbifit::test
