#include "resolution/denoise.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "surface/surface_ends.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kMinVertices = 1500;
constexpr double kLongestEdge = 0.02;       // mean, in diagonals
constexpr double kMedianOfNormal = 0.6745;  // of the absolute value, in standard deviations

// Lists of whole numbers one after the other.
struct Lists {
  std::vector<int> first{0}, items;

  void close() { first.push_back(static_cast<int>(items.size())); }
  std::size_t size() const { return first.size() - 1; }
  auto begin_of(std::size_t i) const { return items.begin() + first[i]; }
  auto end_of(std::size_t i) const { return items.begin() + first[i + 1]; }
};

// Groups of the weld joined by an edge to each group.
Lists neighbours_of_groups(const PreparedMesh& prepared) {
  Lists result;
  std::vector<int> around;
  for (std::size_t g = 0; g < prepared.faces_of_vertex.size(); ++g) {
    around.clear();
    for (const int f : prepared.faces_of_vertex[g]) {
      for (int k = 0; k < 3; ++k) {
        const int other = prepared.weld.group_of_vertex[static_cast<std::size_t>(prepared.mesh.faces(f, k))];
        if (other != static_cast<int>(g)) around.push_back(other);
      }
    }
    std::ranges::sort(around);
    around.erase(std::unique(around.begin(), around.end()), around.end());
    result.items.insert(result.items.end(), around.begin(), around.end());
    result.close();
  }
  return result;
}

// Faces that share a corner with each face.
Lists neighbours_of_faces(const PreparedMesh& prepared) {
  constexpr std::size_t kMax = 64;  // at a corner: the apex of a large fan says nothing about noise
  Lists result;
  std::vector<int> around;
  for (Eigen::Index f = 0; f < prepared.mesh.faces.rows(); ++f) {
    around.clear();
    for (int k = 0; k < 3; ++k) {
      const int group = prepared.weld.group_of_vertex[static_cast<std::size_t>(prepared.mesh.faces(f, k))];
      const std::vector<int>& at = prepared.faces_of_vertex[static_cast<std::size_t>(group)];
      if (at.size() <= kMax) around.insert(around.end(), at.begin(), at.end());
    }
    std::ranges::sort(around);
    around.erase(std::unique(around.begin(), around.end()), around.end());
    std::erase(around, static_cast<int>(f));
    result.items.insert(result.items.end(), around.begin(), around.end());
    result.close();
  }
  return result;
}

double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::ranges::nth_element(values, at);
  return *at;
}

double median(std::vector<double> values) {
  return quantile_of(std::move(values), 0.5);
}

Vector3d place_of(const PreparedMesh& prepared, int group) {
  return prepared.mesh.vertices.row(prepared.weld.representative[static_cast<std::size_t>(group)]);
}

// One round of bilateral averaging of the normals.
Points filtered(const PreparedMesh& prepared, const Lists& around, const Points& centroids, const Points& normals,
                double distance, double difference, const RunContext& context) {
  Points result = normals;
  parallel_for(context, around.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto row = static_cast<Eigen::Index>(f);
      if (prepared.areas[row] <= 0) continue;
      Vector3d sum = prepared.areas[row] * normals.row(row).transpose();
      for (auto other = around.begin_of(f); other != around.end_of(f); ++other) {
        const double apart = (centroids.row(*other) - centroids.row(row)).squaredNorm() / (distance * distance);
        const double unlike = (normals.row(*other) - normals.row(row)).squaredNorm() / (difference * difference);
        sum += prepared.areas[*other] * std::exp(-0.5 * (apart + unlike)) * normals.row(*other).transpose();
      }
      if (sum.norm() > 0) result.row(row) = sum.normalized();
    }
  });
  return result;
}

// At one vertex.
struct Roughness {
  double unlike = 0;  // how far it is off the mean of its neighbours, less what these are off theirs, along its normal
  double edge = 0;    // mean length
  bool counts = false;
};

std::vector<Roughness> roughness(const PreparedMesh& prepared, const Lists& around) {
  const std::size_t count = around.size();
  std::vector<Roughness> result(count);
  Points offsets = Points::Zero(static_cast<Eigen::Index>(count), 3);  // from the mean of the neighbours
  const auto number_of = [&](std::size_t g) { return static_cast<double>(around.end_of(g) - around.begin_of(g)); };
  for (std::size_t g = 0; g < count; ++g) {
    if (around.begin_of(g) == around.end_of(g)) continue;
    const Vector3d here = place_of(prepared, static_cast<int>(g));
    Vector3d sum = Vector3d::Zero();
    for (auto other = around.begin_of(g); other != around.end_of(g); ++other) {
      const Vector3d there = place_of(prepared, *other);
      sum += there;
      result[g].edge += (there - here).norm();
    }
    result[g].edge /= number_of(g);
    offsets.row(static_cast<Eigen::Index>(g)) = (here - sum / number_of(g)).transpose();
  }
  for (std::size_t g = 0; g < count; ++g) {
    if (number_of(g) < 3) continue;
    Vector3d normal = Vector3d::Zero();
    for (const int f : prepared.faces_of_vertex[g]) normal += prepared.areas[f] * prepared.normals.row(f).transpose();
    if (!(normal.norm() > 0)) continue;
    Vector3d mean = Vector3d::Zero();
    for (auto other = around.begin_of(g); other != around.end_of(g); ++other) mean += offsets.row(*other).transpose();
    const Vector3d difference = offsets.row(static_cast<Eigen::Index>(g)).transpose() - mean / number_of(g);
    // With independent noise the difference has about 1 + 3 / number times its standard deviation.
    result[g].unlike = difference.dot(normal.normalized()) / (1 + 3 / number_of(g));
    result[g].counts = true;
  }
  return result;
}

// What a shape's own edges and bends make of the vertices is no noise. Of neighbours that noise moves independently
// 40 to 43 % are off to the same side (half of those of a remeshed shape with thin parts, two thirds of a lathe's); and
// wherever the mesh is as fine, the offsets are spread as a normal distribution is.
bool looks_independent(const Lists& around, const std::vector<Roughness>& rough) {
  constexpr double kMinSame = 0.37;
  constexpr double kMaxSame = 0.46;
  constexpr double kTenthOfNormal = 0.1257;  // the quantile of the absolute value, in standard deviations
  constexpr double kMinOfMedian = 0.65;
  std::size_t pairs = 0;
  std::size_t same = 0;
  std::vector<std::pair<double, double>> sizes;  // by the length of edges
  for (std::size_t g = 0; g < rough.size(); ++g) {
    if (!rough[g].counts) continue;
    sizes.emplace_back(rough[g].edge, std::abs(rough[g].unlike));
    for (auto other = around.begin_of(g); other != around.end_of(g); ++other) {
      const Roughness& there = rough[static_cast<std::size_t>(*other)];
      if (!there.counts) continue;
      ++pairs;
      if (rough[g].unlike * there.unlike > 0) ++same;
    }
  }
  const double share = pairs == 0 ? 1 : static_cast<double>(same) / static_cast<double>(pairs);
  if (share < kMinSame || share > kMaxSame) return false;
  std::ranges::sort(sizes);
  constexpr std::size_t kParts = 4;
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<double> here;
    for (std::size_t i = part * sizes.size() / kParts; i < (part + 1) * sizes.size() / kParts; ++i) {
      here.push_back(sizes[i].second);
    }
    const double tenth = quantile_of(here, 0.1) / kTenthOfNormal;
    if (tenth < kMinOfMedian * quantile_of(here, 0.5) / kMedianOfNormal) return false;
  }
  return true;
}

}  // namespace

double noise_of(const PreparedMesh& prepared) {
  if (prepared.faces_of_vertex.size() < kMinVertices) return 0;
  const Lists around = neighbours_of_groups(prepared);
  const std::vector<Roughness> rough = roughness(prepared, around);
  double edges = 0;
  std::vector<double> sizes;
  for (const Roughness& at : rough) {
    if (!at.counts) continue;
    edges += at.edge;
    sizes.push_back(std::abs(at.unlike));
  }
  if (!(edges <= kLongestEdge * static_cast<double>(sizes.size())) || !looks_independent(around, rough)) return 0;
  return median(std::move(sizes)) / kMedianOfNormal;
}

void denoise(PreparedMesh& prepared, double sigma, const RunContext& context) {
  constexpr int kVertexRounds = 12;
  const Lists around = neighbours_of_faces(prepared);
  Mesh& mesh = prepared.mesh;
  // The noisier, the more rounds and the more unlike normals may be.
  std::vector<double> steps;
  std::vector<double> lengths;
  const Points centroids = face_centroids(mesh);
  for (std::size_t f = 0; f < around.size(); f += 7) {
    const auto row = static_cast<Eigen::Index>(f);
    for (auto other = around.begin_of(f); other != around.end_of(f); ++other) {
      lengths.push_back((centroids.row(*other) - centroids.row(row)).norm());
      steps.push_back((prepared.normals.row(*other) - prepared.normals.row(row)).norm());
    }
  }
  const double distance = std::max(median(lengths), 1e-9);
  const double difference = std::clamp(1.2 * median(steps), 0.25, 0.6);
  const int outer = sigma > 0.0015 ? 3 : 2;
  const int rounds = std::clamp(static_cast<int>(std::lround(20 * sigma / distance)), 4, 24);
  for (int pass = 0; pass < outer; ++pass) {
    context.check();
    Points normals = prepared.normals;
    Points middles = face_centroids(mesh);
    for (int round = 0; round < rounds; ++round) {
      normals = filtered(prepared, around, middles, normals, distance, difference, context);
    }
    for (int round = 0; round < kVertexRounds; ++round) {
      middles = face_centroids(mesh);
      std::vector<Vector3d> moved(prepared.faces_of_vertex.size(), Vector3d::Zero());
      for (std::size_t g = 0; g < moved.size(); ++g) {
        const Vector3d here = place_of(prepared, static_cast<int>(g));
        const std::vector<int>& faces = prepared.faces_of_vertex[g];
        for (const int f : faces) {
          const Vector3d normal = normals.row(f);
          moved[g] += normal * normal.dot(middles.row(f).transpose() - here);
        }
        if (!faces.empty()) moved[g] /= static_cast<double>(faces.size());
      }
      for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        mesh.vertices.row(v) +=
            moved[static_cast<std::size_t>(prepared.weld.group_of_vertex[static_cast<std::size_t>(v)])].transpose();
      }
    }
    const Eigen::VectorXd before = prepared.areas;
    prepared.normals = face_normals(mesh);
    prepared.areas = face_areas(mesh);
    for (Eigen::Index f = 0; f < before.size(); ++f) {
      if (before[f] <= 0) prepared.areas[f] = 0;  // repeated faces still do not count
    }
  }
  prepared.area = prepared.areas.sum();
  prepared.index = std::make_shared<const SurfaceIndex>(mesh);
  prepared.ends = end_edges(prepared);
}

}  // namespace orbifit
