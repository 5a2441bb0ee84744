#include "suite/suite_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "base/random.h"
#include "models/shapes.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

Mesh on_sphere(Mesh mesh, double radius, int times) {
  for (int t = 0; t < times; ++t) {
    mesh = subdivided(mesh);
    mesh.vertices.rowwise().normalize();
  }
  mesh.vertices *= radius;
  return mesh;
}

void face_outwards(Mesh& mesh) {
  if (signed_volume(mesh) < 0) mesh.faces.col(1).swap(mesh.faces.col(2));
}

// The corner points of an outline with its sides cut.
Outline with_pieces(const Outline& corners, int pieces) {
  Outline result;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[(i + 1) % corners.size()];
    for (int k = 0; k < pieces; ++k) result.emplace_back((a * (pieces - k) + b * k) / pieces);
  }
  return result;
}

Vector2d at_angle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

PointGroup group(const std::string& symbol) {
  return PointGroup::parse(symbol).value();
}

Motion shift(double x, double y, double z) {
  return {Matrix3d::Identity(), {x, y, z}};
}

Motion turn_x(double degrees) {
  return {axis_rotation(Vector3d::UnitX(), degrees * pi / 180), Vector3d::Zero()};
}

Motion turn_y(double degrees) {
  return {axis_rotation(Vector3d::UnitY(), degrees * pi / 180), Vector3d::Zero()};
}

Motion turn_z(double degrees) {
  return {axis_rotation(Vector3d::UnitZ(), degrees * pi / 180), Vector3d::Zero()};
}

LocalFrame upright(double x, double y, double z) {
  Matrix3d frame;
  frame << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  return {frame, {x, y, z}};
}

LocalFrame level(double x, double y, double z) {
  return {Matrix3d::Identity(), {x, y, z}};
}

LocalFrame across(const Vector3d& axis, const Vector3d& point) {
  return {frame_about(axis.normalized()), point};
}

Outline round_outline(int points, const std::function<double(double)>& radius) {
  Outline result;
  for (int k = 0; k < points; ++k) {
    const double angle = 2 * pi * k / points;
    result.push_back(at_angle(radius(angle), angle));
  }
  return result;
}

Outline polygon_outline(int corners, double radius, int pieces) {
  return with_pieces(round_outline(corners, [&](double) { return radius; }), pieces);
}

Outline star_outline(int tips, double outer, double inner, int pieces) {
  Outline corners;
  for (int k = 0; k < 2 * tips; ++k) corners.push_back(at_angle(k % 2 == 0 ? outer : inner, pi * k / tips));
  return with_pieces(corners, pieces);
}

Outline rectangle_outline(double half_x, double half_y, int pieces) {
  return with_pieces({{half_x, -half_y}, {half_x, half_y}, {-half_x, half_y}, {-half_x, -half_y}}, pieces);
}

Outline gear_outline(int teeth, double root, double tip) {
  // Shares of the pitch, symmetric about the tooth's middle: the tip, then down the flank to the root.
  Outline result;
  for (int k = 0; k < teeth; ++k) {
    const double middle = 2 * pi * k / teeth;
    const double pitch = 2 * pi / teeth;
    for (const auto& [share, radius] : {std::pair{-0.3, root}, {-0.14, tip}, {0.0, tip}, {0.14, tip}, {0.3, root}}) {
      result.push_back(at_angle(radius, middle + share * pitch));
    }
    result.push_back(at_angle(root, middle + 0.5 * pitch));
  }
  return result;
}

Outline saw_outline(int teeth, double root, double tip) {
  Outline result;
  for (int k = 0; k < teeth; ++k) {
    const double start = 2 * pi * k / teeth;
    const double pitch = 2 * pi / teeth;
    constexpr int kPieces = 5;
    for (int i = 0; i < kPieces; ++i) {
      const double share = static_cast<double>(i) / kPieces;
      result.push_back(at_angle(root + (tip - root) * share, start + 0.9 * share * pitch));
    }
    result.push_back(at_angle(tip, start + 0.9 * pitch));
  }
  return result;
}

Mesh swept(const Outline& outline, int levels, const std::function<Section(double share)>& section) {
  std::vector<Ring> rings;
  std::array<Vector3d, 2> ends;
  for (int i = 0; i <= levels; ++i) {
    const Section at = section(static_cast<double>(i) / levels);
    const double angle = at.degrees * pi / 180;
    const Eigen::Rotation2D<double> turn(angle);
    Ring& ring = rings.emplace_back();
    for (const Vector2d& point : outline) {
      const Vector2d moved = at.scale * (turn * point) + at.offset;
      ring.emplace_back(moved.x(), moved.y(), at.height);
    }
    if (i == 0) ends[0] = {at.offset.x(), at.offset.y(), at.height};
    ends[1] = {at.offset.x(), at.offset.y(), at.height};
  }
  return loft(rings, ends[0], ends[1]);
}

Mesh extruded(const Outline& outline, double low, double high, int levels) {
  return tapered(outline, low, high, 1, levels);
}

Mesh tapered(const Outline& outline, double low, double high, double taper, int levels) {
  return swept(outline, levels, [&](double share) {
    return Section{low * (1 - share) + high * share, 1 - share + taper * share, 0, Vector2d::Zero()};
  });
}

Mesh twisted(const Outline& outline, double height, double degrees, int levels) {
  return swept(outline, levels, [&](double share) {
    return Section{height * (share - 0.5), 1, degrees * (share - 0.5), Vector2d::Zero()};
  });
}

Mesh ring_of(const Outline& outline, double hole, double half) {
  std::vector<Ring> rings;
  for (const Vector2d& point : outline) {
    const Vector2d inner = hole * point.normalized();
    rings.push_back({{inner.x(), inner.y(), -half},
                     {point.x(), point.y(), -half},
                     {point.x(), point.y(), 0},
                     {point.x(), point.y(), half},
                     {inner.x(), inner.y(), half},
                     {inner.x(), inner.y(), 0}});
  }
  return closed_loft(rings, [](int, int point) { return point >= 2 && point < 5; });
}

Mesh subdivided(const Mesh& mesh, int times) {
  Mesh result = mesh;
  for (int t = 0; t < times; ++t) {
    std::vector<Vector3d> vertices;
    for (Eigen::Index v = 0; v < result.vertices.rows(); ++v) vertices.emplace_back(result.vertices.row(v));
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [entry, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(vertices.size()));
      if (fresh) {
        const Vector3d mean = 0.5 * (vertices[static_cast<std::size_t>(a)] + vertices[static_cast<std::size_t>(b)]);
        vertices.push_back(mean);
      }
      return entry->second;
    };
    Triangles faces(4 * result.faces.rows(), 3);
    for (Eigen::Index f = 0; f < result.faces.rows(); ++f) {
      const int a = result.faces(f, 0);
      const int b = result.faces(f, 1);
      const int c = result.faces(f, 2);
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      faces.middleRows<4>(4 * f) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
    }
    result.faces = std::move(faces);
    result.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
    for (std::size_t v = 0; v < vertices.size(); ++v) result.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
  }
  return result;
}

Mesh ball(double radius, int facets) {
  std::vector<Vector2d> profile;
  const int steps = std::max(8, facets / 2);
  for (int i = 0; i <= steps; ++i) {
    const double angle = pi * (i - 0.5 * steps) / steps;
    profile.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return lathe(profile, facets, false);
}

Mesh cubic_ball(double radius, int times) {
  Mesh mesh;
  mesh.vertices.resize(6, 3);
  mesh.vertices << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  mesh.faces.resize(8, 3);
  mesh.faces << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
  return on_sphere(std::move(mesh), radius, times);
}

std::vector<Vector3d> fivefold_axes() {
  std::vector<Vector3d> axes;
  for (const Matrix3d& element : elements(group("I"))) {
    const AxisAngle turn = axis_angle(element);
    if (std::abs(turn.angle - 0.4 * pi) < 1e-6) axes.push_back(turn.axis);
  }
  return axes;
}

Mesh icosahedral_ball(double radius, int times) {
  const std::vector<Vector3d> corners = fivefold_axes();
  Mesh mesh;
  mesh.vertices.resize(12, 3);
  for (std::size_t i = 0; i < corners.size(); ++i) mesh.vertices.row(static_cast<Eigen::Index>(i)) = corners[i];
  mesh.faces.resize(20, 3);
  const auto near = [&](std::size_t i, std::size_t j) { return (corners[i] - corners[j]).norm() < 1.2; };
  Eigen::Index face = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(k, i)) continue;
        const bool outwards = corners[i].dot(corners[j].cross(corners[k])) > 0;
        mesh.faces.row(face++) << static_cast<int>(i), static_cast<int>(outwards ? j : k),
            static_cast<int>(outwards ? k : j);
      }
    }
  }
  return on_sphere(std::move(mesh), radius, times);
}

Mesh cylinder(double radius, double half, int facets, double bevel) {
  if (bevel <= 0)
    return turned_part({{0, -half, 0, 2}, {radius, -half, 0, 2}, {radius, half, 0, 2}, {0, half, 0, 1}}, facets);
  return turned_part({{0, -half, 0, 2}, {radius, -half, bevel, 2}, {radius, half, bevel, 2}, {0, half, 0, 1}}, facets,
                     4);
}

Mesh turned_part(const std::vector<ProfilePoint>& corners, int facets, int fillet_cells) {
  return lathe(trace_profile(corners, fillet_cells, false), facets, false);
}

Mesh torus(double radius, double thickness, int facets, int cells) {
  std::vector<Vector2d> profile;
  for (int k = 0; k < cells; ++k) {
    const double angle = 2 * pi * k / cells;
    profile.emplace_back(radius + thickness * std::cos(angle), thickness * std::sin(angle));
  }
  return lathe(profile, facets, true);
}

Mesh cone(double foot, double top, double length, int facets) {
  return turned_part({{0, 0, 0, 1}, {foot, 0, 0.15 * foot, 4}, {top, length, 0.8 * top, 2}, {0, length, 0, 1}}, facets,
                     4);
}

Mesh blade(double from, double to, double chord, double pitch_degrees, double thickness) {
  constexpr int kStations = 16;
  constexpr int kPoints = 24;
  std::vector<Ring> rings;
  std::array<Vector3d, 2> ends;
  for (int i = 0; i <= kStations; ++i) {
    const double share = static_cast<double>(i) / kStations;
    const double pitch = pitch_degrees * pi / 180 * (1.3 - 0.8 * share);
    // Broadest beyond the middle, the leading edge swept back.
    const double wide = chord * (0.55 + 1.2 * share - 0.95 * share * share);
    const double back = 0.28 * chord * share * share;
    Ring& ring = rings.emplace_back();
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < kPoints; ++k) {
      const double angle = 2 * pi * k / kPoints;
      const double along = 0.5 * wide * std::cos(angle);
      // A drop, thicker towards the leading edge, over an arched line.
      const double half = 0.5 * thickness * (1 - 0.35 * share) * (1 + 0.45 * std::cos(angle)) * std::sin(angle);
      const double arch = 0.12 * wide * (1 - std::pow(2 * along / wide, 2));
      const Vector2d local(along - back, half + arch);
      const Vector2d section = Eigen::Rotation2D<double>(pitch) * local;
      ring.emplace_back(from + (to - from) * share, section.x(), section.y());
      sum += ring.back();
    }
    const Vector3d mean = sum / kPoints;
    if (i == 0) ends[0] = mean;
    ends[1] = mean;
  }
  return loft(rings, ends[0], ends[1]);
}

Mesh lump(int number, int fineness) {
  Random random(static_cast<std::uint64_t>(number), "lump");
  struct Wave {
    Vector3d direction;
    double phase;
    double size;
  };
  std::vector<Wave> waves;
  for (const double length : {1.1, 1.7, 2.3, 2.9, 3.7}) {
    waves.push_back({length * random.direction(), random.uniform(0, 2 * pi), 0.22 / std::sqrt(length)});
  }
  const Vector3d stretch(1.25, 0.95, 0.75);
  Mesh mesh = capped_skin({6, fineness / 2, fineness}, [&](double share, double cosine, double sine) {
    const double polar = pi * share;
    const Vector3d direction(std::sin(polar) * cosine, std::sin(polar) * sine, std::cos(polar));
    double radius = 1;
    for (const Wave& wave : waves) radius += wave.size * std::sin(wave.direction.dot(direction) + wave.phase);
    return Vector3d(radius * direction.cwiseProduct(stretch));
  });
  face_outwards(mesh);
  return mesh;
}

}  // namespace orbifit
