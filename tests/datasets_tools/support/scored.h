#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "orbifit/datasets_tools/detection_score.h"

#include "models/orbit_model.h"

namespace orbifit::scored {

inline constexpr double kDegree = std::numbers::pi / 180;

inline PointGroup group_named(const std::string& symbol) {
  return PointGroup::parse(symbol).value();
}

/// Meshes and what is claimed about them, put together for a test.
struct Scene {
  Mesh mesh;
  DetectionTruth truth;

  /// An annotation of the mesh without claims.
  SymmetryAnnotation nothing() const { return empty_annotation(mesh, 0.005); }

  DetectionScore score(const SymmetryAnnotation& predicted, int threads = 1) const {
    RunContext context;
    context.threads = threads;
    return score_detection(mesh, predicted, &truth, {}, context);
  }

  /// The score of these regions, numbered in their order.
  DetectionScore score(std::vector<Region> regions) const {
    SymmetryAnnotation predicted = nothing();
    for (std::size_t i = 0; i < regions.size(); ++i) regions[i].id = static_cast<int>(i);
    set_parents(regions);
    predicted.regions = std::move(regions);
    return score(predicted);
  }

  DetectionScore score(std::vector<Pattern> patterns) const {
    SymmetryAnnotation predicted = nothing();
    for (std::size_t i = 0; i < patterns.size(); ++i) patterns[i].id = static_cast<int>(i);
    predicted.patterns = std::move(patterns);
    return score(predicted);
  }

  /// Adds the mesh; its faces' numbers.
  std::vector<int> add(const Mesh& part) {
    const auto vertices = static_cast<int>(mesh.vertices.rows());
    const auto faces = static_cast<int>(mesh.faces.rows());
    mesh.vertices.conservativeResize(vertices + part.vertices.rows(), 3);
    mesh.vertices.bottomRows(part.vertices.rows()) = part.vertices;
    mesh.faces.conservativeResize(faces + part.faces.rows(), 3);
    mesh.faces.bottomRows(part.faces.rows()) = part.faces.array() + vertices;
    std::vector<int> added(static_cast<std::size_t>(part.faces.rows()));
    std::iota(added.begin(), added.end(), faces);
    return added;
  }

  void expect(std::vector<Region> regions) {
    truth.expected = nothing();
    for (std::size_t i = 0; i < regions.size(); ++i) regions[i].id = static_cast<int>(i);
    truth.expected.regions = std::move(regions);
  }
};

/// Chiral copies by every element of a finite group, in a frame of no special directions.
inline Scene orbit_scene(const std::string& symbol, const GroupFrame& frame, int subdivisions = 2) {
  OrbitOptions options;
  options.subdivisions = subdivisions;
  options.centre = {0.4, -0.3, 0.2};
  options.frame = frame;
  const GeneratedModel model = generate_orbit(group_named(symbol), options);
  Scene scene;
  scene.mesh = model.mesh;
  scene.truth.expected = model.truth;
  return scene;
}

/// A grid of quads over [0, 1] x [0, 1], two triangles each; `place` bends it.
inline Mesh bent_grid(int columns, int rows, const std::function<Eigen::Vector3d(double, double)>& place) {
  Mesh mesh;
  mesh.vertices.resize((columns + 1) * (rows + 1), 3);
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      mesh.vertices.row(r * (columns + 1) + c) = place(static_cast<double>(c) / columns, static_cast<double>(r) / rows);
    }
  }
  mesh.faces.resize(2 * columns * rows, 3);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int a = r * (columns + 1) + c;
      const int face = 2 * (r * columns + c);
      mesh.faces.row(face) << a, a + 1, a + columns + 2;
      mesh.faces.row(face + 1) << a, a + columns + 2, a + columns + 1;
    }
  }
  return mesh;
}

/// Turned about the z axis: the profile's radius and height over [0, 1].
inline Mesh turned_part(const std::function<double(double)>& radius, const std::function<double(double)>& height) {
  return bent_grid(128, 32, [&](double u, double v) {
    const double angle = 2 * std::numbers::pi * u;
    return Eigen::Vector3d(radius(v) * std::cos(angle), radius(v) * std::sin(angle), height(v));
  });
}

/// The group of the region moved by a motion, its faces left.
inline Region moved_group(Region region, const Motion& motion) {
  for (Motion& generator : region.generators) generator = conjugate(motion, generator);
  for (std::size_t i = 1; i < region.elements.size(); ++i) region.elements[i] = conjugate(motion, region.elements[i]);
  region.centre = motion(region.centre);
  region.axis = motion.linear * region.axis;
  return region;
}

/// The numbers of all faces.
inline std::vector<int> members_of(const Mesh& mesh) {
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

inline Mesh moved_mesh(Mesh mesh, const Motion& motion) {
  mesh.vertices = (mesh.vertices * motion.linear.transpose()).rowwise() + motion.translation.transpose();
  return mesh;
}

/// Some of the faces, from the first on, with this share of their area.
inline std::vector<int> share_of(const Mesh& mesh, const std::vector<int>& faces, double share) {
  const Eigen::VectorXd areas = face_areas(mesh);
  double all = 0;
  for (const int face : faces) all += areas[face];
  std::vector<int> result;
  double sum = 0;
  for (const int face : faces) {
    sum += areas[face];
    if (sum > share * all) break;
    result.push_back(face);
  }
  return result;
}

}  // namespace orbifit::scored
