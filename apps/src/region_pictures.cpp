#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "orbifit/apps/render.h"

namespace orbifit {

namespace {

const Colour kGrey{0.80F, 0.80F, 0.80F};
const Colour kAxisInk{0.12F, 0.13F, 0.16F};

// Beyond so many planes or axes a picture shows the lines less than it hides the shape.
constexpr std::size_t kMaxPlanes = 6;
constexpr std::size_t kMaxAxes = 8;

Colour from_hue(double hue, double saturation, double value) {
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + 6 * hue, 6.0);
    return static_cast<float>(value - value * saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
  };
  return {channel(5), channel(3), channel(1)};
}

// Unit vectors up to sign, without repetition.
void add_direction(std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& direction) {
  for (const Eigen::Vector3d& known : directions) {
    if (std::abs(known.dot(direction)) > 1 - 1e-6) return;
  }
  directions.push_back(direction);
}

struct Lines {
  std::vector<Eigen::Vector3d> from, to;

  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    from.push_back(a);
    to.push_back(b);
  }

  SegmentLayer layer(const Colour& colour, double radius) const {
    SegmentLayer result;
    result.colour = colour;
    result.radius = radius;
    result.from.resize(static_cast<Eigen::Index>(from.size()), 3);
    result.to.resize(static_cast<Eigen::Index>(to.size()), 3);
    for (std::size_t i = 0; i < from.size(); ++i) {
      result.from.row(static_cast<Eigen::Index>(i)) = from[i];
      result.to.row(static_cast<Eigen::Index>(i)) = to[i];
    }
    return result;
  }
};

// The main axis, or those of the highest order, for groups that have one.
std::vector<Eigen::Vector3d> axes_of(const Region& region) {
  std::vector<Eigen::Vector3d> axes;
  const bool plane_only = region.group.family == PointGroup::Family::Cs;
  if (region.axis.squaredNorm() > 0 && !plane_only) {
    axes.push_back(region.axis.normalized());
    return axes;
  }
  double least_angle = std::numbers::pi + 1;
  for (const Motion& element : region.elements) {
    const AxisAngle turn = axis_angle(element.linear);
    if (turn.determinant > 0 && turn.angle > 1e-6) least_angle = std::min(least_angle, turn.angle);
  }
  for (const Motion& element : region.elements) {
    const AxisAngle turn = axis_angle(element.linear);
    if (turn.determinant > 0 && turn.angle > 1e-6 && turn.angle < least_angle + 1e-6) add_direction(axes, turn.axis);
  }
  if (axes.size() > kMaxAxes) axes.clear();
  return axes;
}

std::vector<Eigen::Vector3d> mirror_normals_of(const Region& region) {
  std::vector<Eigen::Vector3d> normals;
  for (const Motion& element : region.elements) {
    const AxisAngle turn = axis_angle(element.linear);
    // A reflection is minus a half turn about the plane's normal.
    if (turn.determinant < 0 && std::abs(turn.angle - std::numbers::pi) < 1e-6) add_direction(normals, turn.axis);
  }
  if (normals.size() > kMaxPlanes) normals.clear();
  return normals;
}

struct Interval {
  double low, high;
};

Interval reach_along(const Points& points, const Eigen::Vector3d& centre, const Eigen::Vector3d& direction) {
  const Eigen::ArrayXd along = (points.rowwise() - centre.transpose()) * direction;
  const double margin = 0.06 * std::max(along.maxCoeff() - along.minCoeff(), 0.3 * diagonal(points));
  return {along.minCoeff() - margin, along.maxCoeff() + margin};
}

// The plane's cut through the region's box as a frame and a pane of glass.
void add_plane(const Points& points, const Region& region, const Eigen::Vector3d& normal, const Colour& colour,
               Lines& frames, Scene& scene) {
  Eigen::Vector3d u = region.axis - region.axis.dot(normal) * normal;
  if (u.norm() < 0.5) {
    // Along the coordinate axis that lies most in the plane.
    int least = 0;
    normal.cwiseAbs().minCoeff(&least);
    u = Eigen::Vector3d::Unit(least) - normal[least] * normal;
  }
  u.normalize();
  const Eigen::Vector3d v = normal.cross(u);
  const Interval on_u = reach_along(points, region.centre, u);
  const Interval on_v = reach_along(points, region.centre, v);
  const std::array<Eigen::Vector3d, 4> corners{
      region.centre + on_u.low * u + on_v.low * v, region.centre + on_u.high * u + on_v.low * v,
      region.centre + on_u.high * u + on_v.high * v, region.centre + on_u.low * u + on_v.high * v};
  SurfaceLayer pane;
  pane.mesh.vertices.resize(4, 3);
  pane.mesh.faces.resize(2, 3);
  pane.mesh.faces << 0, 1, 2, 0, 2, 3;
  for (std::size_t k = 0; k < 4; ++k) {
    pane.mesh.vertices.row(static_cast<Eigen::Index>(k)) = corners[k];
    frames.add(corners[k], corners[(k + 1) % 4]);
  }
  pane.face_colours = {colour};
  pane.opacity = 0.13;
  scene.surfaces.push_back(std::move(pane));
}

// The mesh, each face in the colour of its number, grey below 0, or as glass there.
Scene shape_scene(const Mesh& mesh, const std::vector<int>& number, bool see_through) {
  constexpr double kGlass = 0.1;
  Scene scene;
  if (!see_through) {
    SurfaceLayer& shape = scene.surfaces.emplace_back();
    shape.mesh = mesh;
    for (const int each : number) shape.face_colours.push_back(region_colour(each));
    return scene;
  }
  std::vector<int> solid;
  std::vector<int> glass;
  std::vector<Colour> colours;
  for (std::size_t face = 0; face < number.size(); ++face) {
    (number[face] < 0 ? glass : solid).push_back(static_cast<int>(face));
    if (number[face] >= 0) colours.push_back(region_colour(number[face]));
  }
  scene.surfaces.push_back({submesh(mesh, glass), {kGrey}, {}, kGlass});
  scene.surfaces.push_back({submesh(mesh, solid), colours, {}});
  return scene;
}

}  // namespace

Colour region_colour(int number) {
  // Ordered so that neighbours differ in hue and in lightness.
  static const std::array<Colour, 24> colours{{
      {0.26F, 0.52F, 0.86F}, {0.95F, 0.55F, 0.20F}, {0.30F, 0.69F, 0.38F}, {0.86F, 0.31F, 0.33F}, {0.56F, 0.42F, 0.80F},
      {0.96F, 0.79F, 0.26F}, {0.18F, 0.69F, 0.71F}, {0.90F, 0.47F, 0.68F}, {0.58F, 0.43F, 0.31F}, {0.60F, 0.77F, 0.28F},
      {0.22F, 0.35F, 0.62F}, {0.98F, 0.67F, 0.56F}, {0.13F, 0.47F, 0.37F}, {0.70F, 0.53F, 0.90F}, {0.74F, 0.20F, 0.47F},
      {0.55F, 0.82F, 0.92F}, {0.77F, 0.61F, 0.15F}, {0.42F, 0.26F, 0.55F}, {0.62F, 0.87F, 0.68F}, {0.68F, 0.26F, 0.16F},
      {0.45F, 0.60F, 0.72F}, {0.99F, 0.86F, 0.55F}, {0.40F, 0.50F, 0.20F}, {0.84F, 0.70F, 0.84F},
  }};
  if (number < 0) return kGrey;
  if (static_cast<std::size_t>(number) < colours.size()) return colours[static_cast<std::size_t>(number)];
  // Steps of the golden ratio around the circle of hues never repeat.
  return from_hue(std::fmod(number * 0.6180339887498949, 1.0), number % 2 == 0 ? 0.55 : 0.75,
                  number % 3 == 0 ? 0.70 : 0.88);
}

Colour heat_colour(double value) {
  if (std::isnan(value)) return kGrey;
  // Moreland's diverging map: blue, light grey, red.
  static const std::array<Colour, 5> stops{{{0.230F, 0.299F, 0.754F},
                                            {0.552F, 0.690F, 0.996F},
                                            {0.875F, 0.870F, 0.862F},
                                            {0.958F, 0.603F, 0.482F},
                                            {0.706F, 0.016F, 0.150F}}};
  const double place = 4 * std::clamp(value, 0.0, 1.0);
  const auto stop = static_cast<std::size_t>(std::min(place, 3.0));
  const auto share = static_cast<float>(place - static_cast<double>(stop));
  return (1 - share) * stops[stop] + share * stops[stop + 1];
}

Scene region_scene(const Mesh& mesh, const Region& region, bool see_through) {
  const Colour colour = region_colour(region.id);
  std::vector<int> number(static_cast<std::size_t>(mesh.faces.rows()), -1);
  for (const int face : region.faces) number[static_cast<std::size_t>(face)] = region.id;
  Scene scene = shape_scene(mesh, number, see_through);
  const Points points = region.faces.empty() ? mesh.vertices : submesh(mesh, region.faces).vertices;

  Lines axes;
  for (const Eigen::Vector3d& axis : axes_of(region)) {
    const Interval reach = reach_along(points, region.centre, axis);
    const double beyond = 0.12 * (reach.high - reach.low);
    axes.add(region.centre + (reach.low - beyond) * axis, region.centre + (reach.high + beyond) * axis);
  }
  if (!axes.from.empty()) scene.segments.push_back(axes.layer(kAxisInk, 0.0035));
  Lines frames;
  for (const Eigen::Vector3d& normal : mirror_normals_of(region)) {
    add_plane(points, region, normal, colour, frames, scene);
  }
  if (!frames.from.empty()) scene.segments.push_back(frames.layer(0.75F * colour, 0.002));
  return scene;
}

Scene pattern_scene(const Mesh& mesh, const Pattern& pattern, bool see_through) {
  std::vector<int> number(static_cast<std::size_t>(mesh.faces.rows()), -1);
  for (std::size_t i = 0; i < pattern.instances.size(); ++i) {
    for (const int face : pattern.instances[i].faces) number[static_cast<std::size_t>(face)] = static_cast<int>(i);
  }
  return shape_scene(mesh, number, see_through);
}

}  // namespace orbifit
