#include "domains/region_residual.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kContinuousAngles = 20;
constexpr double kLatticeStep = 0.02;  // of the diagonal
constexpr int kMaxLatticeSteps = 10;   // along an edge
constexpr std::size_t kMaxPairs = 16000;
constexpr std::size_t kMinPoints = 100;

Vector3d vertex(const Mesh& mesh, int face, int corner) {
  return mesh.vertices.row(mesh.faces(face, corner));
}

// How many steps of a lattice an edge of the face is divided into; 1: corners alone.
int lattice_steps(const Mesh& mesh, int face, double step) {
  double longest = 0;
  for (int k = 0; k < 3; ++k)
    longest = std::max(longest, (vertex(mesh, face, (k + 1) % 3) - vertex(mesh, face, k)).norm());
  return std::clamp(static_cast<int>(std::ceil(longest / step)), 1, kMaxLatticeSteps);
}

// Barycentric coordinates of the points within a face that are none of its corners.
std::vector<Vector3d> inner_points(int steps) {
  if (steps == 1) return {Vector3d::Constant(1.0 / 3)};
  std::vector<Vector3d> result;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      const int k = steps - i - j;
      if (std::max({i, j, k}) < steps) result.push_back(Vector3d(i, j, k) / steps);
    }
  }
  return result;
}

// From the axis, or the centre, on which a continuous group turns to the point.
Vector3d radial(const Region& region, const Vector3d& point) {
  const Vector3d from_centre = point - region.centre;
  if (!region.group.has_axis()) return from_centre;
  return from_centre - region.axis.dot(from_centre) * region.axis;
}

// Numbers of at most `count` of `total` points, spread evenly: golden-section steps visit all where the step is coprime
// to the total.
std::vector<std::size_t> spread(std::size_t total, std::size_t count) {
  std::vector<std::size_t> result(std::min(total, count));
  if (result.empty()) return result;
  auto step = std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(total) / std::numbers::phi));
  while (std::gcd(step, total) != 1) ++step;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = (i * step) % total;
  return result;
}

// Of the distances of images of the points, over all motions.
class Distances {
 public:
  Distances(const FacePoints& points, std::vector<std::size_t> chosen)
      : points_(points),
        chosen_(std::move(chosen)),
        square_(chosen_.size(), 0),
        largest_(chosen_.size(), 0),
        seen_(chosen_.size(), 0) {}

  void measure(const RegionDistance& distance, const std::vector<Motion>& motions, double visible,
               const RunContext& context) {
    parallel_for(context, chosen_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vector3d point = points_.points.row(static_cast<Eigen::Index>(chosen_[i]));
        for (const Motion& motion : motions) {
          const std::optional<double> length = distance(point, points_.face[chosen_[i]], motion, visible);
          if (!length) continue;
          ++seen_[i];
          square_[i] += *length * *length;
          largest_[i] = std::max(largest_[i], *length);
        }
      }
    });
  }

  void add_to(double& squares, double& weights, double& largest) const {
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      squares += points_.weights[chosen_[i]] * square_[i];
      weights += points_.weights[chosen_[i]] * static_cast<double>(seen_[i]);
      largest = std::max(largest, largest_[i]);
    }
  }

 private:
  const FacePoints& points_;
  std::vector<std::size_t> chosen_;
  std::vector<double> square_, largest_;
  std::vector<int> seen_;  // images that are not hidden
};

std::size_t points_for(std::size_t motions) {
  return std::max(kMinPoints, kMaxPairs / std::max<std::size_t>(1, motions));
}

Residual residual_of(double squares, double weights, double largest, double diagonal) {
  return weights > 0 ? Residual{std::sqrt(squares / weights) / diagonal, largest / diagonal} : Residual{};
}

}  // namespace

std::vector<Motion> judged_motions(const PointGroup& group, const GroupFrame& frame, const Vector3d& centre) {
  std::vector<Motion> result;
  if (!group.continuous()) {
    const std::vector<Eigen::Matrix3d> all = elements(group, frame);
    for (std::size_t i = 1; i < all.size(); ++i) result.push_back(Motion::about(all[i], centre));
    return result;
  }
  using Family = PointGroup::Family;
  const Vector3d x = frame.col(0);
  const Vector3d z = frame.col(2);
  std::vector<Eigen::Matrix3d> rotations;
  if (group.family == Family::K || group.family == Family::Kh) {
    for (int k = 1; k <= kContinuousAngles; ++k) {
      const double height = 1 - (2 * k - 1.0) / kContinuousAngles;
      const double turn = 2 * std::numbers::pi * k / std::numbers::phi;
      const double radius = std::sqrt(1 - height * height);
      const Vector3d axis = frame * Vector3d(radius * std::cos(turn), radius * std::sin(turn), height);
      rotations.push_back(axis_rotation(axis, 0.3 + 2.5 * k / kContinuousAngles));
    }
  } else {
    for (int k = 1; k <= kContinuousAngles; ++k) {
      const double turns = k / std::numbers::phi;
      rotations.push_back(axis_rotation(z, 2 * std::numbers::pi * (turns - std::floor(turns))));
    }
  }
  std::vector<Eigen::Matrix3d> cosets{Eigen::Matrix3d::Identity()};
  const Eigen::Matrix3d vertical = Eigen::Matrix3d::Identity() - 2 * x * x.transpose();
  const Eigen::Matrix3d horizontal = Eigen::Matrix3d::Identity() - 2 * z * z.transpose();
  if (group.family == Family::Cinfv || group.family == Family::Dinfh) cosets.push_back(vertical);
  if (group.family == Family::Cinfh || group.family == Family::Dinfh) cosets.push_back(horizontal);
  if (group.family == Family::Dinf || group.family == Family::Dinfh)
    cosets.push_back(axis_rotation(x, std::numbers::pi));
  if (group.family == Family::Kh) cosets.emplace_back(-Eigen::Matrix3d::Identity());
  for (const Eigen::Matrix3d& coset : cosets) {
    for (const Eigen::Matrix3d& rotation : rotations) result.push_back(Motion::about(rotation * coset, centre));
  }
  return result;
}

std::vector<Motion> judged_motions(const Region& region) {
  if (region.group.continuous()) {
    const GroupFrame frame = region.group.has_axis() ? frame_about(region.axis) : GroupFrame(GroupFrame::Identity());
    return judged_motions(region.group, frame, region.centre);
  }
  return region.elements.empty() ? region.elements
                                 : std::vector<Motion>(region.elements.begin() + 1, region.elements.end());
}

FacePoints face_points(const Mesh& mesh, const std::vector<int>& faces, double diagonal) {
  const std::vector<int> vertices = vertices_of_faces(mesh, faces);
  const auto number_of = [&](int vertex_number) {
    return static_cast<std::size_t>(std::ranges::lower_bound(vertices, vertex_number) - vertices.begin());
  };
  std::vector<std::vector<int>> at_corner(vertices.size());
  std::vector<double> corner_weights(vertices.size(), 0);
  std::vector<Vector3d> inner;
  std::vector<int> inner_face;
  std::vector<double> inner_weights;
  for (const int face : faces) {
    const int steps = lattice_steps(mesh, face, kLatticeStep * diagonal);
    const std::vector<Vector3d> places = inner_points(steps);
    const double area =
        0.5 *
        (vertex(mesh, face, 1) - vertex(mesh, face, 0)).cross(vertex(mesh, face, 2) - vertex(mesh, face, 0)).norm();
    const double weight = area / static_cast<double>(places.size() + 3);
    for (int k = 0; k < 3; ++k) {
      const std::size_t corner = number_of(mesh.faces(face, k));
      at_corner[corner].push_back(face);
      corner_weights[corner] += weight;
    }
    for (const Vector3d& place : places) {
      inner.emplace_back(place[0] * vertex(mesh, face, 0) + place[1] * vertex(mesh, face, 1) +
                         place[2] * vertex(mesh, face, 2));
      inner_face.push_back(face);
      inner_weights.push_back(weight);
    }
  }
  FacePoints result;
  const auto corners = static_cast<Eigen::Index>(vertices.size());
  result.points.resize(corners + static_cast<Eigen::Index>(inner.size()), 3);
  result.weights = std::move(corner_weights);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    result.points.row(static_cast<Eigen::Index>(i)) = mesh.vertices.row(vertices[i]);
    result.face.push_back(at_corner[i].front());
    result.first.push_back(static_cast<int>(result.faces.size()));
    result.faces.insert(result.faces.end(), at_corner[i].begin(), at_corner[i].end());
  }
  for (std::size_t i = 0; i < inner.size(); ++i) {
    result.points.row(corners + static_cast<Eigen::Index>(i)) = inner[i];
    result.first.push_back(static_cast<int>(result.faces.size()));
    result.faces.push_back(inner_face[i]);
  }
  result.face.insert(result.face.end(), inner_face.begin(), inner_face.end());
  result.weights.insert(result.weights.end(), inner_weights.begin(), inner_weights.end());
  result.first.push_back(static_cast<int>(result.faces.size()));
  return result;
}

RegionDistance::RegionDistance(const Mesh& mesh, const SurfaceIndex& whole, const SurfaceIndex& surface,
                               const std::vector<int>& own, const Region* region)
    : mesh_(mesh),
      whole_(whole),
      surface_(surface),
      own_(own),
      region_(region != nullptr && region->group.continuous() ? region : nullptr) {}

std::optional<double> RegionDistance::operator()(const Vector3d& point, int face, const Motion& motion,
                                                 double visible) const {
  const Vector3d image = motion(point);
  const SurfaceIndex::Nearest nearest = surface_.nearest(image);
  const double distance = region_ == nullptr ? nearest.distance : less_sagitta(point, face, nearest);
  if (distance > visible && hidden(image, motion.linear * face_normal(mesh_, face))) return std::nullopt;
  return distance;
}

bool RegionDistance::within(const Vector3d& point, int face, const Motion& motion, double limit) const {
  constexpr double kMostSagitta = 2;  // limits: no facet that is rounder than that is a facet
  const Vector3d image = motion(point);
  if (surface_.within(image, limit)) return true;
  if (region_ != nullptr && less_sagitta(point, face, surface_.nearest(image, (1 + kMostSagitta) * limit)) <= limit) {
    return true;
  }
  return hidden(image, motion.linear * face_normal(mesh_, face));
}

// Whether the image lies within the solid, something else above it: to both sides of where the surface would be the
// first that one meets is a face seen from behind.
bool RegionDistance::hidden(const Vector3d& image, const Vector3d& normal) const {
  if (!(normal.squaredNorm() > 0)) return false;
  for (const double side : {1.0, -1.0}) {
    const Vector3d direction = side * normal.normalized();
    const std::optional<SurfaceIndex::Hit> hit = whole_.cast(image, direction);
    if (!hit || face_normal(mesh_, hit->face).dot(direction) <= 0) return false;
    if (side > 0 && std::ranges::binary_search(own_, hit->face)) return false;
  }
  return true;
}

double RegionDistance::less_sagitta(const Vector3d& point, int face, const SurfaceIndex::Nearest& nearest) const {
  if (nearest.face < 0) return nearest.distance;
  return std::max(0.0, nearest.distance - std::max(sagitta(point, face), sagitta(nearest.point, nearest.face)));
}

// How much farther out the circles through a face's corners are than the face, at this point of it, along its normal.
double RegionDistance::sagitta(const Vector3d& point, int face) const {
  const Vector3d out = radial(*region_, point);
  const double radius = out.norm();
  if (!(radius > 0)) return 0;
  const Vector3d place =
      nearest_on_triangle(point, vertex(mesh_, face, 0), vertex(mesh_, face, 1), vertex(mesh_, face, 2));
  double through_corners = 0;
  for (int k = 0; k < 3; ++k) through_corners += place[k] * radial(*region_, vertex(mesh_, face, k)).norm();
  return std::max(0.0, through_corners - radius) * std::abs(face_normal(mesh_, face).dot(out)) / radius;
}

Residual region_residual(const Mesh& mesh, const SurfaceIndex& whole, const Region& region, double tolerance,
                         double diagonal, const RunContext& context) {
  const std::vector<Motion> motions = judged_motions(region);
  if (motions.empty() || region.faces.empty()) return {};
  const FacePoints points = face_points(mesh, region.faces, diagonal);
  const SurfaceIndex surface = whole.part(region.faces);
  Distances distances(points, spread(points.face.size(), points_for(motions.size())));
  distances.measure(RegionDistance(mesh, whole, surface, region.faces, &region), motions, tolerance * diagonal,
                    context);
  double squares = 0;
  double weights = 0;
  double largest = 0;
  distances.add_to(squares, weights, largest);
  return residual_of(squares, weights, largest, diagonal);
}

Residual pattern_residual(const Mesh& mesh, const SurfaceIndex& whole, const Pattern& pattern, double tolerance,
                          double diagonal, const RunContext& context) {
  double squares = 0;
  double weights = 0;
  double largest = 0;
  if (pattern.instances.size() < 2) return {};
  const PatternInstance& first = pattern.instances.front();
  const FacePoints first_points = face_points(mesh, first.faces, diagonal);
  const SurfaceIndex first_surface = whole.part(first.faces);
  const std::size_t count = points_for(2 * (pattern.instances.size() - 1));
  Distances out(first_points, spread(first_points.face.size(), count));
  for (std::size_t j = 1; j < pattern.instances.size(); ++j) {
    const PatternInstance& instance = pattern.instances[j];
    const Motion motion = instance.motion * inverse(first.motion);
    const SurfaceIndex surface = whole.part(instance.faces);
    out.measure(RegionDistance(mesh, whole, surface, instance.faces, nullptr), {motion}, tolerance * diagonal, context);
    const FacePoints points = face_points(mesh, instance.faces, diagonal);
    Distances back(points, spread(points.face.size(), count));
    back.measure(RegionDistance(mesh, whole, first_surface, first.faces, nullptr), {inverse(motion)},
                 tolerance * diagonal, context);
    back.add_to(squares, weights, largest);
  }
  out.add_to(squares, weights, largest);
  return residual_of(squares, weights, largest, diagonal);
}

}  // namespace orbifit
