#include "symmetry/moving_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Four = Eigen::Array4f;

// Rounding of boxes, of the query and of distances to boxes, in units of the mesh's box; several times the worst case.
constexpr double kCullMargin = 1e-6;
// Beyond this many boxes from the mesh single precision cannot tell its faces apart: every face is then measured.
constexpr double kFarAway = 1e6;
constexpr double kSliver = 1e-8;  // squared sine of a corner below which a face's plane is uncertain
constexpr double kPlane = 1e-10;  // above it, what distances to the plane may be off by, of the box and of themselves
constexpr float kUnbounded = std::numeric_limits<float>::infinity();

Four lanes(const std::array<float, 4>& values) {
  return Eigen::Map<const Four>(values.data());
}

// From p to the point with these weights. Differences first: they lose nothing far from the origin.
Vector3d offset_to(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c,
                   const Vector3d& weights) {
  if (weights[1] == 1) return b - p;
  if (weights[2] == 1) return c - p;
  return (a - p) + (weights[1] * (b - a) + weights[2] * (c - a));
}

struct Middle {
  std::array<float, 3> at;
  int face;
};

// Halves the faces, across the longest side of the box around their middles, until so many blocks of four, sixteen ...
// are left that one box holds four at most: those of one box lie as close together as may be.
void order_in_fours(Middle* begin, Middle* end) {
  const auto count = end - begin;
  if (count <= 4) return;
  std::ptrdiff_t block = 4;
  while (4 * block < count) block *= 4;
  Middle* const middle = begin + block * ((count + block - 1) / block / 2);
  std::array<float, 3> low = begin->at;
  std::array<float, 3> high = low;
  for (const Middle* each = begin; each != end; ++each) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], each->at[k]);
      high[k] = std::max(high[k], each->at[k]);
    }
  }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  }
  std::nth_element(begin, middle, end, [&](const Middle& a, const Middle& b) {
    return a.at[axis] < b.at[axis] || (a.at[axis] == b.at[axis] && a.face < b.face);
  });
  order_in_fours(begin, middle);
  order_in_fours(middle, end);
}

}  // namespace

struct MovingSurface::Query {
  Vector3d point;
  std::array<float, 3> local;  // in the boxes' frame
  double max_distance;
  double offset;  // from the middle of the mesh, in its boxes
  const Vector3d* facing = nullptr;
  double min_cosine = 0;
  bool unsigned_normal = false;
  bool any = false;  // whichever face is met will do

  float limit = kUnbounded;  // boxes farther than this, squared, hold nothing nearer, nor do planes
  double plane_limit = std::numeric_limits<double>::infinity();
  double squared_distance = std::numeric_limits<double>::infinity();
  int face = -1;
  std::size_t place = 0;
  Vector3d barycentric;

  void reach(double distance, double scale) {
    const double to_plane = distance + kPlane * (1 + offset) / scale + kPlane * distance;
    plane_limit = to_plane * to_plane;
    const double local_distance = distance * scale * (1 + kCullMargin) + kCullMargin * (1 + offset);
    limit = static_cast<float>(local_distance * local_distance * (1 + kCullMargin));
  }
};

struct MovingSurface::Ray {
  Vector3d origin, direction;  // unit
  double least, most;
  std::array<float, 3> local, inverse;
  float margin, first;
  bool any = false;  // whichever face is met will do
  int face = -1;
};

MovingSurface::MovingSurface(const Mesh& mesh, const std::vector<int>& faces) : mesh_(&mesh), face_numbers_(faces) {
  if (faces.empty()) {
    face_numbers_.resize(static_cast<std::size_t>(mesh.faces.rows()));
    std::iota(face_numbers_.begin(), face_numbers_.end(), 0);
  }
  std::vector<char> used(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  for (const int face : face_numbers_) {
    for (const int vertex : mesh.faces.row(face)) used[static_cast<std::size_t>(vertex)] = 1;
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) vertices_.push_back(static_cast<int>(v));
  }
  frame();
  std::vector<Middle> middles;
  middles.reserve(face_numbers_.size());
  for (const int face : face_numbers_) {
    const Vector3d middle = mesh.vertices(mesh.faces.row(face), Eigen::all).colwise().mean();
    Middle& added = middles.emplace_back(Middle{{}, face});
    if (!middle.allFinite()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      added.at[k] = static_cast<float>(scale_ * (middle[axis] - centre_[axis]));
    }
  }
  order_in_fours(middles.data(), middles.data() + middles.size());
  corners_.reserve(middles.size());
  for (std::size_t place = 0; place < middles.size(); ++place) {
    const int face = face_numbers_[place] = middles[place].face;
    corners_.push_back({mesh.faces(face, 0), mesh.faces(face, 1), mesh.faces(face, 2)});
  }
  std::size_t boxes = face_numbers_.size();
  do {
    boxes = (boxes + 3) / 4;
    levels_.emplace_back(boxes);
  } while (boxes > 1);
  move(mesh, RunContext{});
}

void MovingSurface::frame() {
  Eigen::AlignedBox3d box;
  for (const int vertex : vertices_) box.extend(Vector3d(mesh_->vertices.row(vertex)));
  const double extent = box.isEmpty() ? 0 : box.diagonal().norm();
  centre_.setZero();
  if (!box.isEmpty()) centre_ = box.center();
  scale_ = extent > 0 && std::isfinite(extent) ? 1 / extent : 1;
}

void MovingSurface::move(const Mesh& mesh, const RunContext& context) {
  constexpr std::size_t kMinShare = 2000;
  mesh_ = &mesh;
  frame();
  // Rounding keeps the order of numbers, so boxes may be those of rounded vertices.
  const std::unique_ptr<float[]> rounded(new float[4 * static_cast<std::size_t>(mesh.vertices.rows())]);
  for (const int vertex : vertices_) {
    const Eigen::Vector3f local = (scale_ * (mesh.vertices.row(vertex).transpose() - centre_)).cast<float>();
    Eigen::Map<Four>(rounded.get() + 4 * static_cast<std::size_t>(vertex)) << local[0], local[1], local[2], 0;
  }
  parallel_for(
      context, levels_.front().size(),
      [&](std::size_t begin, std::size_t end) { fit_faces(rounded.get(), begin, end); }, kMinShare);
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    parallel_for(
        context, levels_[level].size(), [&](std::size_t begin, std::size_t end) { fit_nodes(level, begin, end); },
        kMinShare);
  }
}

void MovingSurface::fit_faces(const float* vertices, std::size_t begin, std::size_t end) {
  for (std::size_t g = begin; g < end; ++g) {
    Group& group = levels_.front()[g];
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const std::size_t place = 4 * g + lane;
      Four low = Four::Constant(kUnbounded);
      Four high = -low;
      if (place < corners_.size()) {
        const auto at = [&](std::size_t k) {
          return Four(Eigen::Map<const Four>(vertices + 4 * static_cast<std::size_t>(corners_[place][k])));
        };
        low = at(0).min(at(1)).min(at(2));
        high = at(0).max(at(1)).max(at(2));
      }
      for (std::size_t k = 0; k < 3; ++k) {
        group.low[k][lane] = low[static_cast<Eigen::Index>(k)];
        group.high[k][lane] = high[static_cast<Eigen::Index>(k)];
      }
    }
  }
}

void MovingSurface::fit_nodes(std::size_t level, std::size_t begin, std::size_t end) {
  const std::vector<Group>& below = levels_[level - 1];
  for (std::size_t g = begin; g < end; ++g) {
    Group& group = levels_[level][g];
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const std::size_t child = 4 * g + lane;
      for (std::size_t k = 0; k < 3; ++k) {
        group.low[k][lane] = child < below.size() ? lanes(below[child].low[k]).minCoeff() : kUnbounded;
        group.high[k][lane] = child < below.size() ? lanes(below[child].high[k]).maxCoeff() : -kUnbounded;
      }
    }
  }
}

void MovingSurface::measure(std::size_t place, Query& query) const {
  const Vector3d a = corner(place, 0);
  const Vector3d b = corner(place, 1);
  const Vector3d c = corner(place, 2);
  const int face = face_numbers_[place];
  const Vector3d vector = (b - a).cross(c - a);
  const double squared_length = vector.squaredNorm();
  if (query.facing != nullptr) {
    const double cosine = squared_length > 0 ? vector.dot(*query.facing) / std::sqrt(squared_length) : 0;
    if (!((query.unsigned_normal ? std::abs(cosine) : cosine) >= query.min_cosine)) return;
  }
  // Most faces are farther than the best by their plane alone, where that is known.
  const double height = vector.dot(query.point - a);
  if (height * height > squared_length * query.plane_limit &&
      squared_length > kSliver * (b - a).squaredNorm() * (c - a).squaredNorm()) {
    return;
  }
  const Vector3d barycentric = nearest_on_triangle(query.point, a, b, c);
  const double squared = offset_to(query.point, a, b, c, barycentric).squaredNorm();
  if (!(squared <= query.squared_distance)) return;
  // Equal distances: the lowest number, whatever the order in which the tree is walked.
  if (squared == query.squared_distance && query.face >= 0 && face >= query.face) return;
  const double distance = std::sqrt(squared);
  if (distance > query.max_distance) return;
  query.squared_distance = squared;
  query.face = face;
  query.place = place;
  query.barycentric = barycentric;
  query.reach(distance, scale_);
  if (query.any) query.limit = -1;
}

void MovingSurface::search(std::size_t level, std::size_t group, Query& query) const {
  const Group& boxes = levels_[level][group];
  Four squared = Four::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Four off = (lanes(boxes.low[k]) - query.local[k]).max(query.local[k] - lanes(boxes.high[k])).max(0.0F);
    squared += off * off;
  }
  // The nearest first; between them the limit may fall.
  std::array<std::pair<float, std::size_t>, 4> order;
  std::size_t count = 0;
  for (std::size_t lane = 0; lane < 4; ++lane) {
    const float here = squared[static_cast<Eigen::Index>(lane)];
    if (!(here <= query.limit) || here == kUnbounded) continue;
    std::size_t at = count++;
    for (; at > 0 && order[at - 1].first > here; --at) order[at] = order[at - 1];
    order[at] = {here, 4 * group + lane};
  }
  for (std::size_t i = 0; i < count && order[i].first <= query.limit; ++i) {
    if (level == 0) {
      measure(order[i].second, query);
    } else {
      search(level - 1, order[i].second, query);
    }
  }
}

MovingSurface::Nearest MovingSurface::answer(Query& query, int likely) const {
  Nearest result;
  if (face_numbers_.empty() || !(query.max_distance >= 0)) return result;
  const Vector3d local = scale_ * (query.point - centre_);
  query.offset = local.cwiseAbs().maxCoeff();
  query.reach(query.max_distance, scale_);
  if (likely >= 0 && static_cast<std::size_t>(likely) < face_numbers_.size()) {
    measure(static_cast<std::size_t>(likely), query);
  }
  if (query.offset < kFarAway) {
    for (std::size_t k = 0; k < 3; ++k) query.local[k] = static_cast<float>(local[static_cast<Eigen::Index>(k)]);
    search(levels_.size() - 1, 0, query);
  } else {
    for (std::size_t place = 0; place < face_numbers_.size(); ++place) measure(place, query);
  }
  if (query.face < 0) return result;
  result.distance = std::sqrt(query.squared_distance);
  result.face = query.face;
  result.place = static_cast<int>(query.place);
  result.barycentric = query.barycentric;
  result.point = query.point + offset_to(query.point, corner(query.place, 0), corner(query.place, 1),
                                         corner(query.place, 2), query.barycentric);
  return result;
}

MovingSurface::Nearest MovingSurface::nearest(const Vector3d& point, double max_distance, int likely) const {
  Query query{};
  query.point = point;
  query.max_distance = max_distance;
  return answer(query, likely);
}

bool MovingSurface::within(const Vector3d& point, double distance, int likely) const {
  Query query{};
  query.point = point;
  query.max_distance = distance;
  query.any = true;
  return answer(query, likely).face >= 0;
}

MovingSurface::Nearest MovingSurface::nearest_facing(const Vector3d& point, const Vector3d& normal, double min_cosine,
                                                     double max_distance, bool unsigned_normal, int likely) const {
  Query query{};
  query.point = point;
  query.max_distance = max_distance;
  query.facing = &normal;
  query.min_cosine = min_cosine;
  query.unsigned_normal = unsigned_normal;
  return answer(query, likely);
}

MovingSurface::Ray MovingSurface::ray_of(const Vector3d& origin, const Vector3d& direction, double least,
                                         double most) const {
  constexpr double kLevel = 1e-12;  // a direction's part below this is taken for this, which no box is far enough for
  Ray ray{};
  ray.origin = origin;
  ray.direction = direction.stableNormalized();
  ray.least = least;
  ray.most = most;
  const Vector3d local = scale_ * (origin - centre_);
  ray.margin = static_cast<float>(kCullMargin * (1 + local.cwiseAbs().maxCoeff()));
  ray.first = static_cast<float>(scale_ * least * (1 - kCullMargin)) - ray.margin;
  for (std::size_t k = 0; k < 3; ++k) {
    const double part = ray.direction[static_cast<Eigen::Index>(k)];
    ray.local[k] = static_cast<float>(local[static_cast<Eigen::Index>(k)]);
    ray.inverse[k] = static_cast<float>(1 / (std::abs(part) < kLevel ? std::copysign(kLevel, part) : part));
  }
  return ray;
}

void MovingSurface::trace(std::size_t level, std::size_t group, Ray& ray) const {
  const Group& boxes = levels_[level][group];
  const std::size_t count = level > 0 ? levels_[level - 1].size() : face_numbers_.size();
  Four first = Four::Constant(ray.first);
  Four last = Four::Constant(static_cast<float>(scale_ * ray.most * (1 + kCullMargin)) + ray.margin);
  for (std::size_t k = 0; k < 3; ++k) {
    const Four to_low = (lanes(boxes.low[k]) - (ray.local[k] + ray.margin)) * ray.inverse[k];
    const Four to_high = (lanes(boxes.high[k]) - (ray.local[k] - ray.margin)) * ray.inverse[k];
    first = first.max(to_low.min(to_high));
    last = last.min(to_low.max(to_high));
  }
  for (Eigen::Index lane = 0; lane < 4; ++lane) {
    const std::size_t child = 4 * group + static_cast<std::size_t>(lane);
    if (child >= count || !(first[lane] <= last[lane])) continue;
    if (level > 0) {
      trace(level - 1, child, ray);
    } else {
      meet(child, ray);
    }
    if (ray.any && ray.face >= 0) return;
  }
}

// Moeller and Trumbore 1997
void MovingSurface::meet(std::size_t place, Ray& ray) const {
  constexpr double kEdge = 1e-9;  // what passes between two faces meets one of them
  const Vector3d a = corner(place, 0);
  const Vector3d ab = corner(place, 1) - a;
  const Vector3d ac = corner(place, 2) - a;
  const Vector3d across = ray.direction.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0) return;
  const Vector3d to_origin = ray.origin - a;
  const double u = to_origin.dot(across) / determinant;
  const Vector3d turned = to_origin.cross(ab);
  const double v = ray.direction.dot(turned) / determinant;
  const double distance = ac.dot(turned) / determinant;
  if (!(u >= -kEdge && v >= -kEdge && u + v <= 1 + kEdge && distance >= ray.least && distance <= ray.most)) return;
  const int face = face_numbers_[place];
  if (ray.face >= 0 && distance == ray.most && face > ray.face) return;
  ray.most = distance;
  ray.face = face;
}

bool MovingSurface::occluded(const Vector3d& origin, const Vector3d& direction, double min_distance,
                             double max_distance) const {
  if (face_numbers_.empty()) return false;
  Ray ray = ray_of(origin, direction, min_distance, max_distance);
  ray.any = true;
  trace(levels_.size() - 1, 0, ray);
  return ray.face >= 0;
}

int MovingSurface::first_hit(const Vector3d& origin, const Vector3d& direction, double min_distance) const {
  if (face_numbers_.empty()) return -1;
  Ray ray = ray_of(origin, direction, min_distance, std::numeric_limits<double>::infinity());
  trace(levels_.size() - 1, 0, ray);
  return ray.face;
}

}  // namespace orbifit
