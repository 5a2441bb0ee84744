#include "cases/spoil.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/topology.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kWeld = 1e-9;  // of the diagonal

[[noreturn]] void refuse(const std::string& what, double value, const std::string& rule) {
  std::ostringstream text;
  text << what << " is " << value << "; it must be " << rule;
  throw UsageError(text.str());
}

Vector3d area_vector(const Mesh& mesh, Index face) {
  const Vector3d a = mesh.vertices.row(mesh.faces(face, 0));
  const Vector3d b = mesh.vertices.row(mesh.faces(face, 1));
  const Vector3d c = mesh.vertices.row(mesh.faces(face, 2));
  return (b - a).cross(c - a);
}

// Unit normal of each group of vertices. Back to back sides cancel; then all are turned as the first.
Points group_normals(const Mesh& mesh, const Weld& weld) {
  const auto count = static_cast<Index>(weld.representative.size());
  Points sums = Points::Zero(count, 3);
  Points aligned = Points::Zero(count, 3);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(count);
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const Vector3d area = area_vector(mesh, f);
    for (Index k = 0; k < 3; ++k) {
      const int group = weld.group_of_vertex[static_cast<std::size_t>(mesh.faces(f, k))];
      sums.row(group) += area;
      aligned.row(group) += aligned.row(group).dot(area) < 0 ? Vector3d(-area) : area;
      areas[group] += area.norm();
    }
  }
  for (Index g = 0; g < count; ++g) {
    if (sums.row(g).norm() < 1e-6 * areas[g]) sums.row(g) = aligned.row(g);
    const double length = sums.row(g).stableNorm();
    if (length > 0) sums.row(g) /= length;
  }
  return sums;
}

Derived without(const Mesh& mesh, const std::function<bool(const Vector3d&)>& inside) {
  Derived result;
  result.mesh.vertices = mesh.vertices;
  for (Index f = 0; f < mesh.faces.rows(); ++f) {
    const Vector3d centroid = (mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) +
                               mesh.vertices.row(mesh.faces(f, 2))) /
                              3;
    if (!inside(centroid)) result.source_face.push_back(static_cast<int>(f));
  }
  if (result.source_face.empty()) throw NoResultError("cut: no face is left");
  result.mesh.faces = mesh.faces(result.source_face, Eigen::all);
  return result;
}

void rescale(Residual& residual, double factor) {
  residual.rms *= factor;
  residual.max *= factor;
}

}  // namespace

Mesh noisy(const Mesh& mesh, double sigma, std::uint64_t seed) {
  if (!(sigma >= 0 && sigma <= 0.1)) refuse("noisy: sigma", sigma, "in [0, 0.1] of the diagonal");
  const double size = diagonal(mesh.vertices);
  const Weld weld = weld_vertices(mesh.vertices, kWeld * size);
  const Points normals = group_normals(mesh, weld);
  Random random(seed, "noise");
  Eigen::VectorXd lengths(normals.rows());
  for (double& length : lengths) length = sigma * size * random.normal();
  Mesh result = mesh;
  for (Index v = 0; v < result.vertices.rows(); ++v) {
    const int group = weld.group_of_vertex[static_cast<std::size_t>(v)];
    result.vertices.row(v) += lengths[group] * normals.row(group);
  }
  return result;
}

Derived cut(const Mesh& mesh, const HalfSpace& removed) {
  if (!(removed.normal.norm() > 0)) throw UsageError("cut: the normal of the half-space is zero");
  return without(mesh, [&](const Vector3d& p) { return (p - removed.point).dot(removed.normal) > 0; });
}

Derived cut(const Mesh& mesh, const CutBall& removed) {
  if (!(removed.radius > 0)) refuse("cut: the radius of the ball", removed.radius, "positive");
  return without(mesh, [&](const Vector3d& p) { return (p - removed.centre).norm() < removed.radius; });
}

void PoseRange::validate() const {
  if (!(smallest_scale > 0)) refuse("pose: smallest_scale", smallest_scale, "positive");
  if (!(largest_scale >= smallest_scale)) refuse("pose: largest_scale", largest_scale, "at least smallest_scale");
  if (!(offset >= 0)) refuse("pose: offset", offset, "at least 0");
}

Similarity random_pose(const Mesh& mesh, const PoseRange& range, std::uint64_t seed) {
  range.validate();
  Random random(seed, "pose");
  Similarity pose;
  pose.linear = random.rotation();
  pose.scale = std::exp(random.uniform(std::log(range.smallest_scale), std::log(range.largest_scale)));
  const Vector3d place = range.offset * pose.scale * diagonal(mesh.vertices) * random.direction();
  pose.translation = place - pose.scale * pose.linear * bounding_box_centre(mesh.vertices);
  return pose;
}

Mesh transformed(const Mesh& mesh, const Similarity& similarity) {
  Mesh result = mesh;
  result.vertices =
      (similarity.scale * mesh.vertices * similarity.linear.transpose()).rowwise() + similarity.translation.transpose();
  if (similarity.linear.determinant() < 0) result.faces.col(1).swap(result.faces.col(2));
  return result;
}

TruthModel transformed(const TruthModel& model, const Similarity& similarity) {
  TruthModel result{transformed(model.mesh, similarity), model.truth};
  result.truth.expected = transformed(model.truth.expected, similarity);
  SymmetryAnnotation optional;
  optional.regions = model.truth.optional_regions;
  optional.patterns = model.truth.optional_patterns;
  optional = transformed(optional, similarity);
  result.truth.optional_regions = optional.regions;
  result.truth.optional_patterns = optional.patterns;

  const double size = diagonal(result.mesh.vertices);
  const double factor = similarity.scale * model.truth.expected.mesh_diagonal / size;
  result.truth.expected.mesh_diagonal = size;
  for (Region& region : result.truth.expected.regions) rescale(region.residual, factor);
  for (Pattern& pattern : result.truth.expected.patterns) rescale(pattern.residual, factor);
  for (Region& region : result.truth.optional_regions) rescale(region.residual, factor);
  for (Pattern& pattern : result.truth.optional_patterns) rescale(pattern.residual, factor);
  return result;
}

}  // namespace orbifit
