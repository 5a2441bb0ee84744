#include "batch/same_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "batch/shape_invariants.h"
#include "geometry/surface_index.h"

namespace orbifit::batch {

namespace {

// Surfaces that are `tolerance` of the diagonal apart have moments of order k that differ by some k times that,
// relative to their size, which is a third of the diagonal or so: six orders and the third give this factor.
constexpr double kInvariantsPerTolerance = 20;
constexpr std::size_t kMaxPairs = 2000;  // of vertices that may correspond, tried until one fits
constexpr Eigen::Index kProbes = 64;     // vertices that refuse most of what does not fit

// A mesh about its centroid, of size 1.
struct Normalised {
  Points points;
  Triangles faces;
  double diagonal = 0;
  Eigen::Matrix3d axes;  // principal, columns, right-handed
};

Normalised normalised(const Mesh& mesh) {
  const ShapeInvariants invariants = shape_invariants(mesh);
  Normalised result;
  result.faces = mesh.faces;
  result.points = (mesh.vertices.rowwise() - invariants.centroid.transpose()) / std::max(invariants.size, 1e-300);
  result.diagonal = diagonal(result.points);
  const Mesh moved{result.points, mesh.faces, {}};
  const Eigen::VectorXd areas = face_areas(moved);
  const Points centroids = face_centroids(moved);
  const Eigen::Matrix3d second = centroids.transpose() * areas.asDiagonal() * centroids;
  result.axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvectors();
  if (result.axes.determinant() < 0) result.axes.col(0) *= -1;
  return result;
}

// Whether the orthogonal map takes all of a's vertices to within `reach` of b's surface.
bool lies_on(const Eigen::Matrix3d& map, const Normalised& a, const SurfaceIndex& b, double reach) {
  const Eigen::Index count = a.points.rows();
  const auto near = [&](Eigen::Index v) { return b.within(map * a.points.row(v).transpose(), reach); };
  for (Eigen::Index p = 0; p < std::min(count, kProbes); ++p) {
    if (!near(p * count / std::min(count, kProbes))) return false;
  }
  for (Eigen::Index v = 0; v < count; ++v) {
    if (!near(v)) return false;
  }
  return true;
}

Eigen::Matrix3d frame(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  Eigen::Matrix3d result;
  result.col(0) = first.normalized();
  result.col(2) = first.cross(second).normalized();
  result.col(1) = result.col(2).cross(result.col(0));
  return result;
}

std::vector<Eigen::Index> at_distance(const Eigen::VectorXd& distances, double distance, double reach) {
  std::vector<Eigen::Index> result;
  for (Eigen::Index v = 0; v < distances.size(); ++v) {
    if (std::abs(distances[v] - distance) <= reach) result.push_back(v);
  }
  return result;
}

// Maps that take two vertices of a, the farthest and the one farthest from its line, to two of b that are as far from
// the centroid and from one another.
std::vector<Eigen::Matrix3d> maps_of_vertices(const Normalised& a, const Normalised& b, double reach) {
  Eigen::Index first = 0, second = 0;
  const Eigen::VectorXd distances_a = a.points.rowwise().norm(), distances_b = b.points.rowwise().norm();
  if (!(distances_a.maxCoeff(&first) > 0)) return {};
  const Eigen::Vector3d p = a.points.row(first), along = p.normalized();
  (a.points - (a.points * along) * along.transpose()).rowwise().norm().maxCoeff(&second);
  const Eigen::Vector3d q = a.points.row(second);
  if (!(p.cross(q).norm() > reach)) return {};
  std::vector<Eigen::Matrix3d> maps;
  const auto ends = at_distance(distances_b, distances_a[second], reach);
  for (const Eigen::Index v : at_distance(distances_b, distances_a[first], reach)) {
    for (const Eigen::Index w : ends) {
      const Eigen::Vector3d to_p = b.points.row(v), to_q = b.points.row(w);
      if (std::abs((to_p - to_q).norm() - (p - q).norm()) > reach || to_p.cross(to_q).norm() <= reach) continue;
      if (maps.size() >= 2 * kMaxPairs) return maps;
      const Eigen::Matrix3d from = frame(p, q), to = frame(to_p, to_q);
      maps.push_back(to * from.transpose());
      maps.push_back(to * Eigen::Vector3d(1, 1, -1).asDiagonal() * from.transpose());
    }
  }
  return maps;
}

std::vector<Eigen::Matrix3d> maps_of_axes(const Normalised& a, const Normalised& b) {
  std::vector<Eigen::Matrix3d> maps;
  for (int signs = 0; signs < 8; ++signs) {
    const Eigen::Vector3d flips(signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1);
    maps.push_back(b.axes * flips.asDiagonal() * a.axes.transpose());
  }
  return maps;
}

struct Described {
  std::size_t item;
  std::array<double, 5> values;
};

bool close(const std::array<double, 5>& a, const std::array<double, 5>& b, double tolerance) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (std::abs(a[k] - b[k]) > tolerance * std::max({std::abs(a[k]), std::abs(b[k]), 0.05})) return false;
  }
  return true;
}

// The first item of a set, to which each other one leads.
std::size_t root_of(const std::vector<std::size_t>& firsts, std::size_t item) {
  while (firsts[item] != item) item = firsts[item];
  return item;
}

std::optional<Mesh> mesh_of(const Collection& collection, std::size_t item) {
  try {
    const auto summary = nlohmann::json::parse(collection.record(item).summary);
    return read_mesh(summary.at("mesh").at("file").get<std::string>());
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

bool same_up_to_similarity(const Mesh& a, const Mesh& b, double tolerance) {
  const Normalised from = normalised(a), to = normalised(b);
  const double reach = tolerance * to.diagonal;
  const SurfaceIndex on_a(Mesh{from.points, from.faces, {}}), on_b(Mesh{to.points, to.faces, {}});
  const auto fits = [&](const Eigen::Matrix3d& map) {
    return lies_on(map, from, on_b, reach) && lies_on(map.transpose(), to, on_a, reach);
  };
  return std::ranges::any_of(maps_of_axes(from, to), fits) ||
         std::ranges::any_of(maps_of_vertices(from, to, reach), fits);
}

SameShapes find_same_shapes(const Collection& collection, double tolerance, const RunContext& context) {
  require(tolerance > 0 && tolerance <= 0.1, "--same-within", tolerance, "above 0 and at most 0.1");
  SameShapes result;
  result.same_file.resize(collection.size());
  std::iota(result.same_file.begin(), result.same_file.end(), std::size_t{0});
  result.same_shape = result.same_file;
  std::map<std::string, std::size_t> first_of_file;
  std::vector<Described> described;
  for (std::size_t i = 0; i < collection.size(); ++i) {
    const auto summary = nlohmann::json::parse(collection.record(i).summary);
    const auto mesh = summary.find("mesh");
    if (mesh == summary.end()) continue;
    const std::size_t first = first_of_file.emplace(mesh->at("hash").get<std::string>(), i).first->second;
    result.same_file[i] = result.same_shape[i] = first;
    if (first == i) described.push_back({i, mesh->at("shape").get<std::array<double, 5>>()});
  }
  std::ranges::sort(described, {}, [](const Described& one) { return std::pair(one.values[0], one.item); });
  // Each with those before it whose first value is near.
  const double window = kInvariantsPerTolerance * tolerance;
  for (std::size_t i = 0; i < described.size(); ++i) {
    context.progress("same shapes", static_cast<double>(i) / static_cast<double>(described.size()));
    const Described& one = described[i];
    std::optional<Mesh> mesh;
    for (std::size_t j = i; j-- > 0 && described[j].values[0] > one.values[0] * (1 - window);) {
      const Described& other = described[j];
      if (!close(one.values, other.values, window)) continue;
      if (!mesh) mesh = mesh_of(collection, one.item);
      const std::optional<Mesh> before = mesh ? mesh_of(collection, other.item) : std::nullopt;
      if (!before || !same_up_to_similarity(*mesh, *before, tolerance)) continue;
      // Both sets become one, named by its first item.
      const std::size_t one_root = root_of(result.same_shape, one.item);
      const std::size_t other_root = root_of(result.same_shape, other.item);
      result.same_shape[std::max(one_root, other_root)] = std::min(one_root, other_root);
      break;
    }
  }
  for (std::size_t i = 0; i < collection.size(); ++i) result.same_shape[i] = root_of(result.same_shape, i);
  return result;
}

}  // namespace orbifit::batch
