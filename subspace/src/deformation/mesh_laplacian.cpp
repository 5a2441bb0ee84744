#include "deformation/mesh_laplacian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kMaxCotangent = 1e4;
// A triangle's area is rounded at this fraction of its longest side squared.
constexpr double kNoArea = 1e-15;
constexpr int kMaxCuts = 256;
constexpr Index kBlock = 16384;  // rows of the lift that are multiplied at once
constexpr double kGraphShare = 0.02;

// One triangle: corners, twice its area, and the products of the sides that meet at each corner.
struct Corners {
  std::array<Vector3d, 3> at;
  Vector3d dots;
  double doubled_area = 0;
  double longest = 0;  // squared

  Corners(const Mesh& mesh, Index face) {
    for (int k = 0; k < 3; ++k) at[static_cast<std::size_t>(k)] = mesh.vertices.row(mesh.faces(face, k));
    for (int k = 0; k < 3; ++k) {
      const Vector3d& here = at[static_cast<std::size_t>(k)];
      const Vector3d next = at[static_cast<std::size_t>((k + 1) % 3)] - here;
      dots[k] = next.dot(at[static_cast<std::size_t>((k + 2) % 3)] - here);
      longest = std::max(longest, next.squaredNorm());
    }
    doubled_area = (at[1] - at[0]).cross(at[2] - at[0]).norm();
  }

  bool flat() const { return !(doubled_area > kNoArea * longest); }
};

// How often a triangle's sides are to be cut; a length that is a multiple up to rounding counts as one.
int cuts(const Mesh& mesh, Index face, double longest) {
  const double ratio = std::sqrt(Corners(mesh, face).longest) / longest;
  return std::clamp(static_cast<int>(std::ceil(ratio * (1 - 1e-9))), 1, kMaxCuts);
}

}  // namespace

Eigen::SparseMatrix<double> cotangent_laplacian(const Mesh& mesh) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(12 * mesh.faces.rows()));
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const Corners corners(mesh, f);
    if (corners.flat()) continue;
    Vector3d cotangents = corners.dots / corners.doubled_area;
    const double most = cotangents.cwiseAbs().maxCoeff();
    if (most > kMaxCotangent) cotangents *= kMaxCotangent / most;
    for (int k = 0; k < 3; ++k) {
      const int i = mesh.faces(f, (k + 1) % 3);
      const int j = mesh.faces(f, (k + 2) % 3);
      if (i == j) continue;
      const double weight = cotangents[k] / 2;
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
      entries.emplace_back(i, j, -weight);
      entries.emplace_back(j, i, -weight);
    }
  }
  Eigen::SparseMatrix<double> laplacian(mesh.vertices.rows(), mesh.vertices.rows());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

Eigen::VectorXd vertex_areas(const Mesh& mesh) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertices.rows());
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const Corners corners(mesh, f);
    if (corners.flat()) continue;
    const double area = corners.doubled_area / 2;
    for (int k = 0; k < 3; ++k) {
      double share = 0;
      if ((corners.dots.array() < 0).any()) {  // obtuse: half for the obtuse corner, a quarter for the others
        share = corners.dots[k] < 0 ? area / 2 : area / 4;
      } else {
        const int next = (k + 1) % 3;
        const int last = (k + 2) % 3;
        const auto side = [&](int to) {
          return (corners.at[static_cast<std::size_t>(to)] - corners.at[static_cast<std::size_t>(k)]).squaredNorm();
        };
        share = (side(next) * corners.dots[last] + side(last) * corners.dots[next]) / (8 * corners.doubled_area);
      }
      areas[mesh.faces(f, k)] += share;
    }
  }
  return areas;
}

Mesh tessellated(const Mesh& mesh, double longest) {
  Mesh result;
  Index vertices = mesh.vertices.rows();
  Index faces = 0;
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const Index n = cuts(mesh, f, longest);
    faces += n * n;
    if (n > 1) vertices += (n + 1) * (n + 2) / 2 - 3;
  }
  result.vertices.resize(vertices, 3);
  result.vertices.topRows(mesh.vertices.rows()) = mesh.vertices;
  result.faces.resize(faces, 3);
  Index vertex = mesh.vertices.rows();
  Index face = 0;
  std::vector<int> number;
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const int n = cuts(mesh, f, longest);
    // Row i from the first corner holds i + 1 vertices.
    number.clear();
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= i; ++j) {
        const Vector3d share = Vector3d(n - i, i - j, j) / n;
        int corner = -1;
        if (share.maxCoeff(&corner) == 1) {
          number.push_back(mesh.faces(f, corner));
          continue;
        }
        result.vertices.row(vertex) = share[0] * mesh.vertices.row(mesh.faces(f, 0)) +
                                      share[1] * mesh.vertices.row(mesh.faces(f, 1)) +
                                      share[2] * mesh.vertices.row(mesh.faces(f, 2));
        number.push_back(static_cast<int>(vertex++));
      }
    }
    const auto at = [&](int i, int j) { return number[static_cast<std::size_t>(i * (i + 1) / 2 + j)]; };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) {
        result.faces.row(face++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
        if (j < i) result.faces.row(face++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
      }
    }
  }
  return result;
}

Eigen::SparseMatrix<double> restricted_laplacian(const Mesh& mesh, const LiftWeights& weights,
                                                 const RunContext& context) {
  const LiftWeights laplacian = cotangent_laplacian(mesh);
  const Index rows = laplacian.rows();
  // Block by block, so that L W is never held whole; sums in the blocks' order.
  const auto blocks = static_cast<std::size_t>((rows + kBlock - 1) / kBlock);
  std::vector<Eigen::SparseMatrix<double>> parts(blocks);
  parallel_for(context, blocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const Index first = static_cast<Index>(b) * kBlock;
      const Index count = std::min(kBlock, rows - first);
      const LiftWeights block = weights.middleRows(first, count);
      const LiftWeights applied = LiftWeights(laplacian.middleRows(first, count)) * weights;
      parts[b] = Eigen::SparseMatrix<double>(block.transpose() * applied);
    }
  });
  Eigen::SparseMatrix<double> result(weights.cols(), weights.cols());
  for (const Eigen::SparseMatrix<double>& part : parts) result += part;
  // Both halves are the same up to rounding; made the same.
  const Eigen::SparseMatrix<double> transposed = result.transpose();
  result = 0.5 * (result + transposed);
  return result;
}

Eigen::SparseMatrix<double> scaled_like(const Eigen::SparseMatrix<double>& matrix,
                                        const Eigen::SparseMatrix<double>& model) {
  const double trace = matrix.diagonal().sum();
  if (!(trace > 0)) return matrix;
  return matrix * (model.diagonal().sum() / trace);
}

Eigen::SparseMatrix<double> cotangent_sample_laplacian(const Mesh& mesh, const Points& samples, double radius,
                                                       const SampleEdges& edges, const RunContext& context) {
  const double width = radius / 2;
  const Mesh fine = tessellated(mesh, width);
  const LiftWeights weights = lift_weights(fine.vertices, samples, width, context);
  const Eigen::SparseMatrix<double> graph = graph_laplacian(edges, samples.rows());
  const Eigen::SparseMatrix<double> surface = scaled_like(restricted_laplacian(fine, weights, context), graph);
  return (1 - kGraphShare) * surface + kGraphShare * graph;
}

}  // namespace orbifit
