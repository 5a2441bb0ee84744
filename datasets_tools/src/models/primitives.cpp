#include "models/primitives.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "orbifit/model/point_group.h"

namespace orbifit {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

void turn_inside_out(Mesh& part) {
  part.faces.col(1).swap(part.faces.col(2));
}

Mesh assemble(const std::vector<Vector3d>& vertices, const std::vector<std::array<int, 3>>& faces) {
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t v = 0; v < vertices.size(); ++v) mesh.vertices.row(static_cast<Eigen::Index>(v)) = vertices[v];
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.faces(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(k)) = faces[f][k];
    }
  }
  if (signed_volume(mesh) < 0) turn_inside_out(mesh);
  return mesh;
}

class Skin {
 public:
  void add(const Ring& ring) {
    size_ = static_cast<int>(ring.size());
    vertices_.insert(vertices_.end(), ring.begin(), ring.end());
  }
  void join(int lower, int upper, const std::function<bool(int ring, int point)>& other_diagonal = {}) {
    for (int j = 0; j < size_; ++j) {
      const int next = (j + 1) % size_;
      const int a = lower * size_ + j;
      const int b = lower * size_ + next;
      const int c = upper * size_ + next;
      const int d = upper * size_ + j;
      if (other_diagonal && other_diagonal(lower, j)) {
        faces_.push_back({a, b, d});
        faces_.push_back({b, c, d});
      } else {
        faces_.push_back({a, b, c});
        faces_.push_back({a, c, d});
      }
    }
  }
  void close(int ring, const Vector3d& apex, bool first) {
    const int tip = static_cast<int>(vertices_.size());
    vertices_.push_back(apex);
    for (int j = 0; j < size_; ++j) {
      const int a = ring * size_ + j;
      const int b = ring * size_ + (j + 1) % size_;
      faces_.push_back(first ? std::array{b, a, tip} : std::array{a, b, tip});
    }
  }
  Mesh mesh() const { return assemble(vertices_, faces_); }

 private:
  int size_ = 0;
  std::vector<Vector3d> vertices_;
  std::vector<std::array<int, 3>> faces_;
};

// Grid lines across a box: even pieces of the flat part and, at either end, those that give the rounding equal angles.
std::vector<double> grid_lines(double half, int cells, double bevel, int bevel_cells) {
  std::vector<double> upper;
  const double flat = half - bevel;
  for (int i = 1; i <= cells / 2; ++i) upper.push_back(flat * 2 * i / cells);
  for (int i = 1; i <= bevel_cells; ++i) {
    upper.push_back(flat + bevel * std::tan(std::numbers::pi / 4 * i / bevel_cells));
  }
  std::vector<double> lines;
  for (auto line = upper.rbegin(); line != upper.rend(); ++line) lines.push_back(-*line);
  lines.push_back(0);
  lines.insert(lines.end(), upper.begin(), upper.end());
  return lines;
}

}  // namespace

double signed_volume(const Mesh& part) {
  const Vector3d origin = bounding_box_centre(part.vertices);
  double volume = 0;
  for (Eigen::Index f = 0; f < part.faces.rows(); ++f) {
    const Vector3d a = part.vertices.row(part.faces(f, 0)).transpose() - origin;
    const Vector3d b = part.vertices.row(part.faces(f, 1)).transpose() - origin;
    const Vector3d c = part.vertices.row(part.faces(f, 2)).transpose() - origin;
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

std::vector<Vector2d> trace_profile(const std::vector<ProfilePoint>& corners, int fillet_cells, bool closed) {
  const std::size_t count = corners.size();
  const auto place = [&](std::size_t i) { return Vector2d(corners[i].radius, corners[i].height); };
  // Each corner becomes one point or the points of its arc; then the lines between them are cut.
  std::vector<std::vector<Vector2d>> arcs(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool end = !closed && (i == 0 || i + 1 == count);
    if (corners[i].fillet <= 0 || end) {
      arcs[i] = {place(i)};
      continue;
    }
    const Vector2d back = (place((i + count - 1) % count) - place(i)).normalized();
    const Vector2d ahead = (place((i + 1) % count) - place(i)).normalized();
    const double half_angle = std::acos(std::clamp(back.dot(ahead), -1.0, 1.0)) / 2;
    const Vector2d centre = place(i) + (back + ahead).normalized() * (corners[i].fillet / std::sin(half_angle));
    const Vector2d from = place(i) + back * (corners[i].fillet / std::tan(half_angle)) - centre;
    const Vector2d to = place(i) + ahead * (corners[i].fillet / std::tan(half_angle)) - centre;
    const double angle = std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    for (int k = 0; k <= fillet_cells; ++k) {
      const double share = static_cast<double>(k) / fillet_cells;
      // Seen from both ends alike, so that a symmetric profile stays symmetric to rounding.
      const double weight_from = std::sin((1 - share) * angle) / std::sin(angle);
      const double weight_to = std::sin(share * angle) / std::sin(angle);
      arcs[i].emplace_back(centre + weight_from * from + weight_to * to);
    }
  }
  std::vector<Vector2d> line;
  for (std::size_t i = 0; i < count; ++i) {
    line.insert(line.end(), arcs[i].begin(), arcs[i].end());
    if (!closed && i + 1 == count) break;
    const Vector2d a = arcs[i].back();
    const Vector2d b = arcs[(i + 1) % count].front();
    for (int k = 1; k < corners[i].cells; ++k) {
      line.emplace_back((a * (corners[i].cells - k) + b * k) / corners[i].cells);
    }
  }
  return line;
}

Mesh loft(const std::vector<Ring>& rings, const Vector3d& first_apex, const Vector3d& last_apex) {
  Skin skin;
  const int count = static_cast<int>(rings.size());
  for (const Ring& ring : rings) skin.add(ring);
  for (int i = 0; i + 1 < count; ++i) skin.join(i, i + 1);
  skin.close(0, first_apex, true);
  skin.close(count - 1, last_apex, false);
  return skin.mesh();
}

Mesh closed_loft(const std::vector<Ring>& rings, const std::function<bool(int ring, int point)>& other_diagonal) {
  Skin skin;
  const int count = static_cast<int>(rings.size());
  for (const Ring& ring : rings) skin.add(ring);
  for (int i = 0; i < count; ++i) skin.join(i, (i + 1) % count, other_diagonal);
  return skin.mesh();
}

Mesh lathe(const std::vector<Vector2d>& profile, int facets, bool closed) {
  const std::vector<Eigen::Matrix3d> turns = elements({PointGroup::Family::Cn, facets});
  std::vector<Ring> rings;
  for (std::size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < profile.size(); ++i) {
    Ring& ring = rings.emplace_back();
    for (const Eigen::Matrix3d& turn : turns) ring.emplace_back(turn * Vector3d(profile[i].x(), 0, profile[i].y()));
  }
  if (closed) return closed_loft(rings);
  return loft(rings, {0, 0, profile.front().y()}, {0, 0, profile.back().y()});
}

Mesh box(const Vector3d& half, const std::array<int, 3>& cells, double bevel, int bevel_cells) {
  std::array<std::vector<double>, 3> lines;
  std::array<int, 3> last{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lines[axis] = grid_lines(half[static_cast<Eigen::Index>(axis)], cells[axis], bevel, bevel_cells);
    last[axis] = static_cast<int>(lines[axis].size()) - 1;
  }
  const Vector3d core = half.array() - bevel;
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;
  std::map<std::array<int, 3>, int> numbers;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [entry, fresh] = numbers.try_emplace(at, static_cast<int>(vertices.size()));
    if (fresh) {
      const auto line = [&](std::size_t axis) { return lines[axis][static_cast<std::size_t>(at[axis])]; };
      const Vector3d sharp(line(0), line(1), line(2));
      const Vector3d inner = sharp.cwiseMax(-core).cwiseMin(core);
      const Vector3d out = sharp - inner;
      vertices.emplace_back(bevel > 0 ? Vector3d(inner + out * (bevel / out.norm())) : sharp);
    }
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3;
    const std::size_t v = (axis + 2) % 3;
    for (const int side : {0, last[axis]}) {
      for (int i = 0; i < last[u]; ++i) {
        for (int j = 0; j < last[v]; ++j) {
          std::array<int, 4> corner{};
          for (int k = 0; k < 4; ++k) {
            std::array<int, 3> at{};
            at[axis] = side;
            at[u] = i + (k == 1 || k == 2 ? 1 : 0);
            at[v] = j + (k >= 2 ? 1 : 0);
            corner[static_cast<std::size_t>(k)] = vertex(at);
          }
          if (side == 0) std::swap(corner[1], corner[3]);
          // Diagonals radiate from the middle of the face: the tessellation has the symmetries of the box.
          const bool rising = (2 * i + 1 < last[u]) == (2 * j + 1 < last[v]);
          const auto [a, b, c, d] = corner;
          if (rising) {
            faces.push_back({a, b, c});
            faces.push_back({a, c, d});
          } else {
            faces.push_back({a, b, d});
            faces.push_back({b, c, d});
          }
        }
      }
    }
  }
  return assemble(vertices, faces);
}

Mesh tapered_leg(double thickness, double length, double foot, int detail) {
  Mesh leg = box({thickness / 2, thickness / 2, length / 2}, {2 * detail, 2 * detail, 8 * detail}, thickness * 0.14, 2);
  for (auto vertex : leg.vertices.rowwise()) {
    const double width = 1 + (foot - 1) * (0.5 - vertex.z() / length);
    vertex.x() *= width;
    vertex.y() *= width;
  }
  return leg;
}

Mesh rod(const std::vector<Vector3d>& path, const Vector3d& normal, double radius, int sides) {
  const std::vector<Eigen::Matrix3d> turns = elements({PointGroup::Family::Cn, sides});
  std::vector<Ring> rings;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vector3d before = i > 0 ? Vector3d((path[i] - path[i - 1]).normalized()) : Vector3d::Zero();
    const Vector3d after = i + 1 < path.size() ? Vector3d((path[i + 1] - path[i]).normalized()) : Vector3d::Zero();
    const Vector3d tangent = (before + after).normalized();
    const Vector3d across = normal.cross(tangent);
    const double mitre = 1 / tangent.dot(i > 0 ? before : after);
    Ring& ring = rings.emplace_back();
    for (const Eigen::Matrix3d& turn : turns) {
      const Vector3d section = turn.col(0) * radius;
      ring.emplace_back(path[i] + section.x() * mitre * across + section.y() * normal);
    }
  }
  return loft(rings, path.front(), path.back());
}

Mesh chiral_blob(int subdivisions) {
  // Four corners at unequal distances, none in a plane with two others and the origin; sides swell outwards.
  std::vector<Vector3d> vertices{{0.95, 0.1, -0.15}, {-0.55, 0.62, -0.3}, {-0.3, -0.7, -0.42}, {-0.05, 0.16, 0.6}};
  std::vector<std::array<int, 3>> faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [entry, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(vertices.size()));
      if (fresh) {
        const Vector3d mean = 0.5 * (vertices[static_cast<std::size_t>(a)] + vertices[static_cast<std::size_t>(b)]);
        vertices.emplace_back(mean * (level == 0 ? 1.35 : 1.05));
      }
      return entry->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  return assemble(vertices, faces);
}

Mesh moved(const Mesh& part, const Motion& motion) {
  Mesh result = part;
  result.vertices = (part.vertices * motion.linear.transpose()).rowwise() + motion.translation.transpose();
  if (motion.linear.determinant() < 0) turn_inside_out(result);
  return result;
}

}  // namespace orbifit
