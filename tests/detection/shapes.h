#pragma once

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"

namespace orbifit::test {

inline constexpr double kTolerance = 0.005;  // of the diagonal

inline Mesh box(double x, double y, double z) {
  Mesh mesh;
  mesh.vertices.resize(8, 3);
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.row(i) << ((i & 1) != 0 ? x : -x) / 2, ((i & 2) != 0 ? y : -y) / 2, ((i & 4) != 0 ? z : -z) / 2;
  }
  mesh.faces.resize(12, 3);
  mesh.faces << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7,
      5;
  return mesh;
}

// A right prism over a regular n-gon of circumradius r, with its two ends closed by fans from a corner.
inline Mesh prism(int n, double radius, double height) {
  Mesh mesh;
  mesh.vertices.resize(2 * n, 3);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.vertices.row(i) << radius * std::cos(angle), radius * std::sin(angle), -height / 2;
    mesh.vertices.row(n + i) << radius * std::cos(angle), radius * std::sin(angle), height / 2;
  }
  mesh.faces.resize(2 * n + 2 * (n - 2), 3);
  int row = 0;
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.faces.row(row++) << i, j, n + j;
    mesh.faces.row(row++) << i, n + j, n + i;
  }
  for (int i = 1; i + 1 < n; ++i) {
    mesh.faces.row(row++) << 0, i + 1, i;
    mesh.faces.row(row++) << n, n + i, n + i + 1;
  }
  return mesh;
}

// A ball about the origin: n meridians, n / 2 bands.
inline Mesh ball(int n, double radius) {
  const int bands = n / 2;
  Mesh mesh;
  mesh.vertices.resize(Eigen::Index{2} + (bands - 1) * n, 3);
  mesh.vertices.row(0) << 0, 0, radius;
  mesh.vertices.row(1) << 0, 0, -radius;
  const auto vertex = [&](int band, int k) { return 2 + (band - 1) * n + k % n; };
  for (int band = 1; band < bands; ++band) {
    const double polar = std::numbers::pi * band / bands;
    for (int k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      mesh.vertices.row(vertex(band, k)) << radius * std::sin(polar) * std::cos(angle),
          radius * std::sin(polar) * std::sin(angle), radius * std::cos(polar);
    }
  }
  mesh.faces.resize(2 * n * (bands - 1), 3);
  Eigen::Index f = 0;
  for (int k = 0; k < n; ++k) {
    mesh.faces.row(f++) << 0, vertex(1, k), vertex(1, k + 1);
    mesh.faces.row(f++) << 1, vertex(bands - 1, k + 1), vertex(bands - 1, k);
    for (int band = 1; band < bands - 1; ++band) {
      mesh.faces.row(f++) << vertex(band, k), vertex(band + 1, k), vertex(band + 1, k + 1);
      mesh.faces.row(f++) << vertex(band, k), vertex(band + 1, k + 1), vertex(band, k + 1);
    }
  }
  return mesh;
}

// A sheet of some height over a square of side 1 about the origin, of n by n cells, each of two triangles, in columns
// along y.
template <typename Height>
Mesh sheet(int n, const Height& height) {
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(n + 1) * (n + 1), 3);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = static_cast<double>(i) / n - 0.5;
      const double y = static_cast<double>(j) / n - 0.5;
      mesh.vertices.row(i * (n + 1) + j) << x, y, height(x, y);
    }
  }
  mesh.faces.resize(static_cast<Eigen::Index>(2) * n * n, 3);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j;
      const int b = a + n + 1;
      mesh.faces.row(2 * (i * n + j)) << a, b, b + 1;
      mesh.faces.row(2 * (i * n + j) + 1) << a, b + 1, a + 1;
    }
  }
  return mesh;
}

// Even in x but for waves of a given height.
inline Mesh hills(int n, double odd) {
  return sheet(
      n, [odd](double x, double y) { return 0.1 * std::cos(7 * x) + 0.07 * std::sin(5 * y) + odd * std::sin(9 * x); });
}

// A tetrahedron with six different edges: no symmetry at all.
inline Mesh scalene() {
  Mesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 0, 0, 0, 1, 0.07, 0.03, 0.21, 0.8, -0.05, 0.33, 0.26, 0.55;
  mesh.faces.resize(4, 3);
  mesh.faces << 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3;
  return mesh;
}

inline Mesh moved(Mesh mesh, const Motion& motion) {
  mesh.vertices = (mesh.vertices * motion.linear.transpose()).rowwise() + motion.translation.transpose();
  if (motion.linear.determinant() < 0) mesh.faces.col(1).swap(mesh.faces.col(2));
  return mesh;
}

inline Mesh joined(const std::vector<Mesh>& parts) {
  Mesh mesh;
  for (const Mesh& part : parts) {
    const auto first = static_cast<int>(mesh.vertices.rows());
    const Eigen::Index faces = mesh.faces.rows();
    mesh.vertices.conservativeResize(first + part.vertices.rows(), 3);
    mesh.vertices.bottomRows(part.vertices.rows()) = part.vertices;
    mesh.faces.conservativeResize(faces + part.faces.rows(), 3);
    mesh.faces.bottomRows(part.faces.rows()) = part.faces.array() + first;
  }
  return mesh;
}

// Each triangle cut into four, so many times; vertices at one place are not one.
inline Mesh subdivided(Mesh mesh, int times) {
  for (; times > 0; --times) {
    Mesh finer;
    finer.vertices.resize(6 * mesh.faces.rows(), 3);
    finer.faces.resize(4 * mesh.faces.rows(), 3);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const auto a = mesh.vertices.row(mesh.faces(f, k));
        const auto b = mesh.vertices.row(mesh.faces(f, (k + 1) % 3));
        finer.vertices.row(6 * f + k) = a;
        finer.vertices.row(6 * f + 3 + k) = (a + b) / 2;
      }
      const int first = 6 * static_cast<int>(f);
      finer.faces.row(4 * f) << first, first + 3, first + 5;
      finer.faces.row(4 * f + 1) << first + 3, first + 1, first + 4;
      finer.faces.row(4 * f + 2) << first + 5, first + 4, first + 2;
      finer.faces.row(4 * f + 3) << first + 3, first + 4, first + 5;
    }
    mesh = finer;
  }
  return mesh;
}

inline std::vector<int> all_faces(const Mesh& mesh) {
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

inline Motion shift(double x, double y, double z) {
  return {Eigen::Matrix3d::Identity(), {x, y, z}};
}

}  // namespace orbifit::test
