#include "consistency/region_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "base/disjoint_sets.h"
#include "domains/vertex_sets.h"
#include "geometry/grid_cell.h"
#include "geometry/side_order.h"
#include "geometry/topology.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kFew =
    8;  // shapes of fewer faces than one in so many have a tree of their own: the mesh's is slow for them
constexpr int kSamples = 64;     // of a shape: shares to two per cent
constexpr double kAlike = 1e-9;  // of the diagonal: rounding, where motions and copies are exact

// A number for each vertex; the same for those at one position whose faces meet in an edge of two faces.
std::vector<int> numbered_points(const Mesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.vertices.rows());
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int v) {
    return std::array<double, 3>{mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)};
  };
  std::ranges::sort(order, {}, key);
  std::vector<int> position(count);
  int number = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i]) != key(order[i - 1])) ++number;
    position[static_cast<std::size_t>(order[i])] = number;
  }
  struct Side {
    std::array<int, 2> ends, vertices;
  };
  std::vector<Side> sides;
  for (Eigen::Index face = 0; face < mesh.faces.rows(); ++face) {
    for (int k = 0; k < 3; ++k) {
      std::array<int, 2> vertices{mesh.faces(face, k), mesh.faces(face, (k + 1) % 3)};
      std::array<int, 2> ends{position[static_cast<std::size_t>(vertices[0])],
                              position[static_cast<std::size_t>(vertices[1])]};
      if (ends[0] > ends[1]) {
        std::swap(ends[0], ends[1]);
        std::swap(vertices[0], vertices[1]);
      }
      if (ends[0] != ends[1]) sides.push_back({ends, vertices});
    }
  }
  sort_by_ends(sides, count, &Side::ends);
  DisjointSets sets(count);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    for (std::size_t k = 0; end == i + 2 && k < 2; ++k) {
      sets.unite(sides[i].vertices[k], sides[i + 1].vertices[k]);
    }
    i = end;
  }
  std::vector<int> result(count);
  for (std::size_t v = 0; v < count; ++v) result[v] = sets.root(static_cast<int>(v));
  return result;
}

// Whether some element turns the axis over.
bool swaps_ends(const PointGroup& group) {
  using Family = PointGroup::Family;
  return group.family == Family::Cinfh || group.family == Family::Dinf || group.family == Family::Dinfh;
}

// The van der Corput sequence: evenly spread numbers in [0, 1).
double spread(int number, int base) {
  double result = 0;
  double digit = 1;
  for (int n = number; n > 0; n /= base) {
    digit /= base;
    result += digit * (n % base);
  }
  return result;
}

}  // namespace

ShapeSurface::ShapeSurface(const Mesh& of, double reach, const RunContext& running)
    : mesh(of),
      context(running),
      near(reach),
      diagonal(orbifit::diagonal(of.vertices)),
      origin(bounding_box_centre(of.vertices)),
      point_of_vertex(numbered_points(of)),
      areas(face_areas(of)),
      centroids(face_centroids(of)),
      index(std::make_shared<const SurfaceIndex>(of)),
      vertex_images(of.vertices, kDoublet * diagonal),
      domains(of) {}

const std::vector<std::array<bool, 3>>& ShapeSurface::open_edges() const {
  if (open_edges_) return *open_edges_;
  std::vector<std::array<bool, 3>>& result = open_edges_.emplace();
  const Weld weld = weld_vertices(mesh.vertices);
  for (const Edge& edge : welded_edges(mesh, weld)) {
    if (edge.faces.size() != 1) continue;
    if (result.empty()) result.resize(static_cast<std::size_t>(mesh.faces.rows()));
    const int face = edge.faces.front();
    for (std::size_t k = 0; k < 3; ++k) {
      const int vertex = mesh.faces(face, static_cast<Eigen::Index>(k));
      const int corner = weld.group_of_vertex[static_cast<std::size_t>(vertex)];
      if (std::ranges::find(edge.vertices, corner) == edge.vertices.end()) {
        result[static_cast<std::size_t>(face)][k] = true;
      }
    }
  }
  return result;
}

int RegionShapes::add(const std::vector<int>& faces) {
  work_ += faces.size();
  Shape shape;
  shape.faces = faces;
  shape.digest.add(std::span<const int>(faces));
  shape.holds.assign(static_cast<std::size_t>(surface_.mesh.faces.rows()), 0);
  Vector3d sum = Vector3d::Zero();
  std::vector<char> has_point(surface_.point_of_vertex.size(), 0);
  for (const int face : faces) {
    shape.holds[static_cast<std::size_t>(face)] = 1;
    shape.area += surface_.areas[face];
    sum += surface_.areas[face] * surface_.centroids.row(face).transpose();
    for (const int vertex : surface_.mesh.faces.row(face)) {
      shape.box.extend(surface_.mesh.vertices.row(vertex).transpose());
      has_point[static_cast<std::size_t>(surface_.point_of_vertex[static_cast<std::size_t>(vertex)])] = 1;
    }
  }
  for (std::size_t point = 0; point < has_point.size(); ++point) {
    if (has_point[point] != 0) shape.points.push_back(static_cast<int>(point));
  }
  if (faces.empty()) {
    shape.extent = {Vector3d::Zero(), surface_.diagonal};
  } else {
    shape.extent.centre = shape.area > 0 ? Vector3d(sum / shape.area) : shape.box.center();
    for (const int face : faces) {
      for (const int vertex : surface_.mesh.faces.row(face)) {
        const double reach = (surface_.mesh.vertices.row(vertex).transpose() - shape.extent.centre).norm();
        shape.extent.reach = std::max(shape.extent.reach, reach);
      }
    }
    shape.extent.reach = std::max(shape.extent.reach, 1e-9 * surface_.diagonal);
  }
  shape.moments = moments_of_faces(surface_.mesh, faces, surface_.origin);
  shape.samples = sampled(shape.faces, shape.area);
  shapes_.push_back(std::move(shape));
  return count() - 1;
}

// One sample in each of as many parts of equal area.
Points RegionShapes::sampled(const std::vector<int>& faces, double area) const {
  Points result(area > 0 ? kSamples : 0, 3);
  double before = 0;
  std::size_t at = 0;
  for (int k = 0; k < result.rows(); ++k) {
    const double due = (k + 0.5) / kSamples * area;
    while (at + 1 < faces.size() && before + surface_.areas[faces[at]] < due) before += surface_.areas[faces[at++]];
    const double root = std::sqrt(spread(k + 1, 2));
    const double side = spread(k + 1, 3);
    const auto corner = [&](int c) {
      return Vector3d(surface_.mesh.vertices.row(surface_.mesh.faces(faces[at], c)).transpose());
    };
    result.row(k) = ((1 - root) * corner(0) + root * (1 - side) * corner(1) + root * side * corner(2)).transpose();
  }
  return result;
}

const SurfaceIndex& RegionShapes::index(int shape) const {
  const Shape& known = at(shape);
  if (!known.index) {
    const bool few = kFew * known.faces.size() < known.holds.size() && !known.faces.empty();
    known.index = few ? std::make_unique<SurfaceIndex>(surface_.mesh, known.faces)
                      : std::make_unique<SurfaceIndex>(surface_.index->part(known.faces));
  }
  return *known.index;
}

double RegionShapes::common_area(int a, int b) const {
  const Shape& later = at(std::max(a, b));
  const auto other = static_cast<std::size_t>(std::min(a, b));
  if (later.common.size() <= other) later.common.resize(static_cast<std::size_t>(std::max(a, b)) + 1, -1);
  double& known = later.common[other];
  if (known >= 0) return known;
  const bool first = at(a).faces.size() < at(b).faces.size();
  const Shape& few = first ? at(a) : at(b);
  const Shape& many = first ? at(b) : at(a);
  known = 0;
  for (const int face : few.faces) {
    if (many.holds[static_cast<std::size_t>(face)] != 0) known += surface_.areas[face];
  }
  return known;
}

PieceMoments RegionShapes::common_moments(int a, int b) const {
  if (at(b).faces.size() == static_cast<std::size_t>(surface_.mesh.faces.rows())) return at(a).moments;
  return remembered(surface_.common_moments, Digest().add(at(a).digest).add(at(b).digest), [&] {
    work_ += at(a).faces.size();
    std::vector<int> common;
    for (const int face : at(a).faces) {
      if (at(b).holds[static_cast<std::size_t>(face)] != 0) common.push_back(face);
    }
    return common.size() == at(a).faces.size() ? at(a).moments
                                               : moments_of_faces(surface_.mesh, common, surface_.origin);
  });
}

Points RegionShapes::common_samples(int a, int b) const {
  const double common = common_area(a, b);
  return common < area(a) ? sampled(common_faces(a, b), common) : at(a).samples;
}

std::vector<int> RegionShapes::common_faces(int a, int b) const {
  std::vector<int> result;
  std::ranges::set_intersection(faces(a), faces(b), std::back_inserter(result));
  return result;
}

bool RegionShapes::meet(int a, int b) const {
  return common_area(a, b) > kSliver * std::min(area(a), area(b));
}

bool RegionShapes::touch(int a, int b) const {
  if (meet(a, b)) return true;
  std::vector<signed char>& later = at(std::max(a, b)).touching;
  const auto other = static_cast<std::size_t>(std::min(a, b));
  if (later.size() <= other) later.resize(static_cast<std::size_t>(std::max(a, b)) + 1, -1);
  signed char& known = later[other];
  if (known < 0) known = share_a_point(a, b) ? 1 : 0;
  return known != 0;
}

bool RegionShapes::share_a_point(int a, int b) const {
  const std::vector<int>& here = at(a).points;
  const std::vector<int>& there = at(b).points;
  auto i = here.begin();
  auto j = there.begin();
  while (i != here.end() && j != there.end()) {
    if (*i == *j) return true;
    *i < *j ? ++i : ++j;
  }
  return false;
}

std::vector<int> RegionShapes::faces_at(int a, int b) const {
  const std::vector<int>& points = at(b).points;
  std::vector<int> result;
  for (const int face : at(a).faces) {
    const auto shared = [&](int vertex) {
      return std::ranges::binary_search(points, surface_.point_of_vertex[static_cast<std::size_t>(vertex)]);
    };
    if (std::ranges::any_of(surface_.mesh.faces.row(face), shared)) result.push_back(face);
  }
  return result;
}

bool RegionShapes::within(int inner, int outer) const {
  const double common = common_area(inner, outer);
  return common >= (1 - kSliver) * area(inner) && (common >= area(inner) || ends_at(inner, outer));
}

// Whether all of the one outside of the other lies at its border.
bool RegionShapes::ends_at(int inner, int outer) const {
  const std::pair<int, int> key{inner, outer};
  if (const auto known = ends_at_.find(key); known != ends_at_.end()) return known->second;
  const Shape& border = at(outer);
  const bool result = std::ranges::all_of(at(inner).faces, [&](int face) {
    if (border.holds[static_cast<std::size_t>(face)] != 0) return true;
    const auto shared = [&](int vertex) {
      return std::ranges::binary_search(border.points, surface_.point_of_vertex[static_cast<std::size_t>(vertex)]);
    };
    return std::ranges::any_of(surface_.mesh.faces.row(face), shared) ||
           index(outer).within(surface_.centroids.row(face).transpose(), surface_.near);
  });
  ends_at_[key] = result;
  return result;
}

Digest RegionShapes::question(int from, int domain, const Motion& motion, int to, int arrival) const {
  Digest digest;
  for (const int shape : {from, domain, to, arrival}) digest.add(at(shape).digest);
  for (const double number : motion.linear.reshaped()) digest.add(number);
  for (const double number : motion.translation) digest.add(number);
  return digest;
}

double RegionShapes::arrived(int from, int domain, const Motion& motion, int to, int arrival) const {
  return remembered(surface_.arrived, question(from, domain, motion, to, arrival),
                    [&] { return share_arrived(from, domain, motion, to, arrival); });
}

// Of what lies near the target: whether something else is far nearer.
bool RegionShapes::belongs_elsewhere(const Vector3d& image, int target, int arrival) const {
  if (target == arrival) return false;
  const double far_nearer = kFarNearer * index(target).nearest(image, surface_.near).distance;
  return far_nearer > 1e-12 * surface_.diagonal && index(arrival).within(image, far_nearer);
}

double RegionShapes::share_arrived(int from, int domain, const Motion& motion, int to, int arrival) const {
  const auto arriving = [&](int shape, int within, const Motion& way, int target, int there) {
    const Points samples = common_samples(shape, within);
    const Eigen::Index taken = samples.rows();
    if (taken == 0) return 0.0;
    work_ += static_cast<std::size_t>(taken);
    Eigen::Index missed = 0;
    Eigen::Index elsewhere = 0;
    for (Eigen::Index k = 0; k < taken && 2 * missed <= taken; ++k) {
      const Vector3d image = way(samples.row(k).transpose());
      const bool arrived =
          at(target).box.exteriorDistance(image) <= surface_.near && index(target).within(image, surface_.near);
      missed += arrived ? 0 : 1;
      elsewhere += arrived && belongs_elsewhere(image, target, there) ? 1 : 0;
    }
    if (2 * elsewhere > taken - missed) return 0.0;
    return 1 - static_cast<double>(missed) / static_cast<double>(taken);  // or hopeless
  };
  const double there = arriving(from, domain, motion, to, arrival);
  return there < 0.5 ? there : std::min(there, arriving(to, arrival, inverse(motion), from, domain));
}

double RegionShapes::distance(int from, int domain, const Motion& motion, int to, int arrival) const {
  return remembered(surface_.distances, question(from, domain, motion, to, arrival), [&] {
    const Motion told{Eigen::Matrix3d::Identity(), -surface_.origin};
    return separation(common_moments(from, domain), told * motion * inverse(told), common_moments(to, arrival),
                      surface_.diagonal);
  });
}

std::vector<int> RegionShapes::image_faces(int from, int domain, const Motion& motion, int arrival) const {
  constexpr std::size_t kMost = std::size_t{1} << 24U;  // faces remembered: 64 MB
  if (surface_.faces_remembered > kMost) {
    surface_.image_faces.clear();
    surface_.faces_remembered = 0;
  }
  return remembered(surface_.image_faces, question(from, domain, motion, arrival, arrival), [&] {
    std::vector<int> faces = faces_brought(from, domain, motion, arrival);
    surface_.faces_remembered += faces.size();
    return faces;
  });
}

std::vector<int> RegionShapes::faces_brought(int from, int domain, const Motion& motion, int arrival) const {
  constexpr std::size_t kWorthAThread = 512;  // faces, of which each takes up to a microsecond
  const Motion back = inverse(motion);
  const Shape& source = at(from);
  const SurfaceIndex& surface = index(domain);
  const SurfaceIndex* part = from == domain ? nullptr : &index(from);  // smaller: most faces lie near none of it
  const std::vector<int>& faces = at(arrival).faces;
  std::vector<int> others;
  std::ranges::copy_if(at(domain).faces, std::back_inserter(others),
                       [&](int face) { return source.holds[static_cast<std::size_t>(face)] == 0; });
  const SurfaceIndex rest = surface.part(others);
  // Where both lie there alike, as plates that lie in one another, the face's corners tell.
  const double alike = kAlike * surface_.diagonal;
  const auto as_near = [&](const Vector3d& place, double least) {
    return part == nullptr || part->within(place, least + alike);
  };
  const auto all_brought = [&](int face) {  // asked just inside the corners, which neighbours share
    const Vector3d middle = surface_.centroids.row(face).transpose();
    return std::ranges::all_of(surface_.mesh.faces.row(face), [&](int corner) {
      const Vector3d place = back(0.1 * middle + 0.9 * surface_.mesh.vertices.row(corner).transpose());
      return as_near(place, std::min(surface.nearest(place, surface_.near).distance, surface_.near));
    });
  };
  std::vector<char> brought(faces.size(), 0);
  std::vector<char> asked(faces.size(), 0);
  const auto look = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3d origin = back(surface_.centroids.row(faces[i]).transpose());
      if (source.box.exteriorDistance(origin) > surface_.near ||
          (part != nullptr && !part->within(origin, surface_.near)))
        continue;
      asked[i] = 1;
      const SurfaceIndex::Nearest nearest = surface.nearest(origin, surface_.near);
      if (nearest.face < 0) continue;
      bool comes = source.holds[static_cast<std::size_t>(nearest.face)] != 0;
      const double least = nearest.distance;
      if (comes ? rest.within(origin, least + alike) : as_near(origin, least)) comes = all_brought(faces[i]);
      brought[i] = comes ? 1 : 0;
    }
  };
  parallel_for(surface_.context, faces.size(), look, kWorthAThread);
  work_ += faces.size() / 4 + static_cast<std::size_t>(std::ranges::count(asked, 1));  // to find none costs a quarter
  std::vector<int> result;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (brought[i] != 0) result.push_back(faces[i]);
  }
  return result;
}

std::vector<int> RegionShapes::without_orbit(int shape, const std::vector<int>& taken, const GroupPlace& place) {
  std::vector<char> gone(static_cast<std::size_t>(surface_.mesh.faces.rows()), 0);
  for (const int face : taken) gone[static_cast<std::size_t>(face)] = 1;
  if (place.group.continuous()) {
    // Those as far from the axis, and along it, as one that is taken.
    const Vector3d axis = place.frame.col(2);
    using Cell = std::pair<std::int64_t, std::int64_t>;
    const auto cell_of = [&](int face) {
      const Vector3d offset = surface_.centroids.row(face).transpose() - place.centre;
      if (!place.group.has_axis()) return Cell(grid_cell(offset.norm() / surface_.near + 0.5), 0);
      const double along = offset.dot(axis);
      return Cell(grid_cell((offset - along * axis).norm() / surface_.near + 0.5),
                  grid_cell(along / surface_.near + 0.5));
    };
    std::set<Cell> cells;
    for (const int face : taken) {
      const Cell cell = cell_of(face);
      for (long r = -1; r <= 1; ++r) {
        for (long z = -1; z <= 1; ++z) {
          cells.emplace(cell.first + r, cell.second + z);
          if (swaps_ends(place.group)) cells.emplace(cell.first + r, -cell.second + z);
        }
      }
    }
    for (const int face : at(shape).faces) {
      if (cells.contains(cell_of(face))) gone[static_cast<std::size_t>(face)] = 1;
    }
  } else {
    const int away = add(taken);
    for (const Motion& motion : members(place)) {
      for (const int face : image_faces(away, shape, motion, shape)) gone[static_cast<std::size_t>(face)] = 1;
    }
    keep(away);
  }
  std::vector<int> result;
  for (const int face : at(shape).faces) {
    if (gone[static_cast<std::size_t>(face)] == 0) result.push_back(face);
  }
  return result;
}

double RegionShapes::kept(int shape, const std::vector<Motion>& motions, double near) const {
  const Shape& known = at(shape);
  if (known.samples.rows() == 0) return 0;
  work_ += static_cast<std::size_t>(known.samples.rows()) * motions.size();
  int all = 0;
  for (Eigen::Index k = 0; k < known.samples.rows(); ++k) {
    const Vector3d sample = known.samples.row(k).transpose();
    if (std::ranges::all_of(motions, [&](const Motion& motion) { return index(shape).within(motion(sample), near); }))
      ++all;
  }
  return static_cast<double>(all) / static_cast<double>(known.samples.rows());
}

bool RegionShapes::past_the_end(int shape, const Motion& motion) const {
  const std::vector<std::array<bool, 3>>& open = surface_.open_edges();
  if (open.empty()) return false;
  const Points& samples = at(shape).samples;
  work_ += static_cast<std::size_t>(samples.rows());
  Eigen::Index past = 0;
  for (Eigen::Index k = 0; k < samples.rows(); ++k) {
    const Vector3d image = motion(samples.row(k).transpose());
    if (surface_.index->within(image, surface_.near)) continue;
    const SurfaceIndex::Nearest nearest = surface_.index->nearest(image);
    if (nearest.face < 0) continue;
    const std::array<bool, 3>& edges = open[static_cast<std::size_t>(nearest.face)];
    for (std::size_t corner = 0; corner < 3; ++corner) {  // a point on an edge has no share of the corner opposite
      if (!edges[corner] || nearest.barycentric[static_cast<Eigen::Index>(corner)] > 0) continue;
      ++past;
      break;
    }
  }
  return static_cast<double>(past) > kSliver * static_cast<double>(samples.rows());
}

Residual RegionShapes::residual(int shape, const std::vector<Motion>& motions) const {
  Residual result;
  work_ += static_cast<std::size_t>(at(shape).samples.rows()) * motions.size();
  double count = 0;
  for (const Motion& motion : motions) {
    for (Eigen::Index k = 0; k < at(shape).samples.rows(); ++k) {
      const double distance =
          index(shape).nearest(motion(at(shape).samples.row(k).transpose())).distance / surface_.diagonal;
      result.rms += distance * distance;
      result.max = std::max(result.max, distance);
      ++count;
    }
  }
  if (count > 0) result.rms = std::sqrt(result.rms / count);
  return result;
}

}  // namespace orbifit
