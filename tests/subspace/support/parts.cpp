#include "parts.h"

#include <cmath>
#include <numeric>

#include "base/random.h"

namespace orbifit {

Mesh turned_part(const std::vector<Eigen::Vector2d>& profile, const std::vector<double>& angles) {
  const auto rows = static_cast<int>(profile.size());
  const auto columns = static_cast<int>(angles.size());
  Mesh mesh;
  std::vector<std::vector<int>> number(profile.size());
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < rows; ++i) {
    const Eigen::Vector2d& at = profile[static_cast<std::size_t>(i)];
    for (const double angle : angles) {
      const bool pole = at[0] == 0;
      if (!pole || number[static_cast<std::size_t>(i)].empty()) {
        points.emplace_back(at[0] * std::cos(angle), at[0] * std::sin(angle), at[1]);
      }
      number[static_cast<std::size_t>(i)].push_back(static_cast<int>(points.size()) - 1);
    }
  }
  mesh.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) mesh.vertices.row(static_cast<Eigen::Index>(v)) = points[v];
  std::vector<Eigen::RowVector3i> faces;
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const auto at = [&](int row, int column) {
        return number[static_cast<std::size_t>(row)][static_cast<std::size_t>(column % columns)];
      };
      const int a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
      if (a != b) faces.emplace_back(a, b, c);
      if (c != d) faces.emplace_back(a, c, d);
    }
  }
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.row(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

std::vector<double> irregular_angles(int count) {
  Random random(23, "angles");
  std::vector<double> result;
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    result.push_back(sum);
    sum += random.uniform(0.6, 1.4);
  }
  for (double& angle : result) angle *= 2 * M_PI / sum;
  return result;
}

Mesh box(const Eigen::Vector3d& half, int cells) {
  Mesh mesh;
  const Eigen::Index side = cells + 1;
  mesh.vertices.resize(6 * side * side, 3);
  mesh.faces.resize(Eigen::Index{12} * cells * cells, 3);
  Eigen::Index vertex = 0;
  Eigen::Index face = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::Index first = vertex;
      for (int i = 0; i <= cells; ++i) {
        for (int j = 0; j <= cells; ++j) {
          Eigen::Vector3d at;
          at[axis] = sign;
          at[(axis + 1) % 3] = 2.0 * i / cells - 1;
          at[(axis + 2) % 3] = 2.0 * j / cells - 1;
          mesh.vertices.row(vertex++) = at.cwiseProduct(half).transpose();
        }
      }
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          const auto a = static_cast<int>(first + i * side + j);
          const int b = a + static_cast<int>(side);
          mesh.faces.row(face++) = sign > 0 ? Eigen::RowVector3i(a, b, b + 1) : Eigen::RowVector3i(a, b + 1, b);
          mesh.faces.row(face++) = sign > 0 ? Eigen::RowVector3i(a, b + 1, a + 1) : Eigen::RowVector3i(a, a + 1, b + 1);
        }
      }
    }
  }
  return mesh;
}

Mesh wedge(double size) {
  Mesh mesh = box({0.5 * size, 0.35 * size, 0.4 * size}, 3);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double up = 0.5 + mesh.vertices(v, 2) / (0.8 * size);
    mesh.vertices(v, 0) *= 1 - 0.3 * up;
    mesh.vertices(v, 1) += 0.15 * size * up;
    mesh.vertices(v, 0) += 0.1 * size * up;
  }
  return mesh;
}

Mesh placed(const Mesh& mesh, const Motion& motion) {
  Mesh result = mesh;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    result.vertices.row(v) = motion(mesh.vertices.row(v).transpose()).transpose();
  }
  return result;
}

std::vector<int> append(Mesh& mesh, const Mesh& part) {
  const Eigen::Index vertices = mesh.vertices.rows();
  const Eigen::Index faces = mesh.faces.rows();
  mesh.vertices.conservativeResize(vertices + part.vertices.rows(), 3);
  mesh.vertices.bottomRows(part.vertices.rows()) = part.vertices;
  mesh.faces.conservativeResize(faces + part.faces.rows(), 3);
  mesh.faces.bottomRows(part.faces.rows()) = part.faces.array() + static_cast<int>(vertices);
  std::vector<int> result(static_cast<std::size_t>(part.faces.rows()));
  std::iota(result.begin(), result.end(), static_cast<int>(faces));
  return result;
}

GeneratedModel whole(const Mesh& mesh, const PointGroup& group, const Eigen::Vector3d& centre) {
  GeneratedModel model;
  model.mesh = mesh;
  model.truth = empty_annotation(mesh, 0.005);
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  std::iota(faces.begin(), faces.end(), 0);
  model.truth.regions.push_back(
      make_region(group, centre, frame_about(Eigen::Vector3d::UnitZ()), faces, group.symbol()));
  return model;
}

}  // namespace orbifit
