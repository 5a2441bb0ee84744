#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "base/random.h"
#include "cases/spoil.h"
#include "detection.h"

namespace orbifit::benchmarks {

namespace {

constexpr int kTimes = 2;             // each
constexpr double kOtherFaces = 0.02;  // of a region's area

std::vector<int> permutation(Eigen::Index count, Random& random) {
  std::vector<int> result(static_cast<std::size_t>(count));
  std::iota(result.begin(), result.end(), 0);
  for (std::size_t i = result.size(); i > 1; --i) std::swap(result[i - 1], result[random.below(i)]);
  return result;
}

// The mesh with vertices and faces in another order; `face_of` tells, by face of the result, its number in `mesh`.
Mesh reordered(const Mesh& mesh, Random& random, std::vector<int>& face_of) {
  const std::vector<int> vertex_of = permutation(mesh.vertices.rows(), random);
  face_of = permutation(mesh.faces.rows(), random);
  std::vector<int> place(vertex_of.size());
  Mesh result;
  result.vertices.resize(mesh.vertices.rows(), 3);
  for (std::size_t v = 0; v < vertex_of.size(); ++v) {
    result.vertices.row(static_cast<Eigen::Index>(v)) = mesh.vertices.row(vertex_of[v]);
    place[static_cast<std::size_t>(vertex_of[v])] = static_cast<int>(v);
  }
  result.faces.resize(mesh.faces.rows(), 3);
  for (std::size_t f = 0; f < face_of.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      result.faces(static_cast<Eigen::Index>(f), k) = place[static_cast<std::size_t>(mesh.faces(face_of[f], k))];
    }
  }
  return result;
}

double area_of(const Eigen::VectorXd& areas, const std::vector<int>& faces) {
  double sum = 0;
  for (const int face : faces) sum += areas[face];
  return sum;
}

bool same(const Eigen::VectorXd& areas, const Region& a, const Region& b) {
  if (a.group != b.group) return false;
  std::vector<int> different;
  std::ranges::set_symmetric_difference(a.faces, b.faces, std::back_inserter(different));
  return area_of(areas, different) <= kOtherFaces * area_of(areas, a.faces);
}

}  // namespace

double found_again(const Mesh& mesh, const SymmetryAnnotation& detected, const DetectOptions& options,
                   RunContext& context) {
  if (detected.regions.empty()) return 1;
  const Eigen::VectorXd areas = face_areas(mesh);
  Random random(context.seed, "again");
  std::size_t found = 0;
  for (int time = 0; time < 2 * kTimes; ++time) {
    std::vector<int> face_of(static_cast<std::size_t>(mesh.faces.rows()));
    std::iota(face_of.begin(), face_of.end(), 0);
    const Similarity pose = time < kTimes ? Similarity{} : random_pose(mesh, {}, random.next());
    const Mesh other = time < kTimes ? reordered(mesh, random, face_of) : transformed(mesh, pose);
    // As far on the shape: the box about a turned mesh has another diagonal.
    DetectOptions as_far = options;
    as_far.tolerance *= pose.scale * diagonal(mesh.vertices) / diagonal(other.vertices);
    SymmetryAnnotation again = detect(other, as_far, context);
    for (Region& region : again.regions) {
      for (int& face : region.faces) face = face_of[static_cast<std::size_t>(face)];
      std::ranges::sort(region.faces);
    }
    found += static_cast<std::size_t>(std::ranges::count_if(detected.regions, [&](const Region& region) {
      return std::ranges::any_of(again.regions, [&](const Region& each) { return same(areas, region, each); });
    }));
  }
  return static_cast<double>(found) / static_cast<double>(2 * kTimes * detected.regions.size());
}

}  // namespace orbifit::benchmarks
