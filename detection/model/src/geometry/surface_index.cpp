#include "geometry/surface_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/face_cells.h"
#include "geometry/face_tree.h"
#include "geometry/space_order.h"

namespace orbifit {

namespace {

// Beyond this many boxes from the mesh single precision cannot tell its faces apart: every face is then measured.
constexpr double kFarAway = 1e6;

// Rounding of vertices, of the query and of the tree's own arithmetic, in units of the box; several times the worst
// case.
constexpr double kCullMargin = 1e-6;

// Squared sine of a corner below which Ericson's method, whose products grow with the fourth power, loses digits.
constexpr double kSliver = 1e-2;

// Where the index has more than that many times the faces of a part, the part gets a tree of its own: it is soon made,
// and leads past no other faces. Of a car, 10 to 40 do alike; 4 costs more than it spares.
constexpr std::size_t kWorthATree = 20;

// From far away a ray begins anew at a sphere of this radius about the box, where single precision resolves the faces.
constexpr double kSphere = 2;

struct Corners {
  Eigen::Vector3d a, b, c;

  // From p to the point with these weights. Differences first: they lose nothing far from the origin.
  Eigen::Vector3d from(const Eigen::Vector3d& p, const Eigen::Vector3d& weights) const {
    if (weights[1] == 1) return b - p;
    if (weights[2] == 1) return c - p;
    return (a - p) + (weights[1] * (b - a) + weights[2] * (c - a));
  }

  Eigen::Vector3d at(const Eigen::Vector3d& weights) const { return from(Eigen::Vector3d::Zero(), weights); }
};

// How far single precision may be off for what lies within the box, in units of it; several times the worst case.
constexpr float kFacetMargin = 2e-6F;

// What a query asks of a triangle before it measures, in one line of the cache.
struct alignas(64) Facet {
  // Times (p, 1), p in the tree's frame: the height over the triangle's plane, and how far p is outside each edge
  // within that plane. Times (n, 0): first the cosine of the angle between n and the normal. Not numbers, which no
  // comparison holds for, where the normal is uncertain.
  Eigen::Matrix4f planes;
};

// Parameter in [0, 1] of the point of segment a + t ab nearest to a + ap.
double nearest_on_segment(const Eigen::Vector3d& ap, const Eigen::Vector3d& ab) {
  const double length = ab.squaredNorm();
  return length > 0 ? std::clamp(ap.dot(ab) / length, 0.0, 1.0) : 0.0;
}

// Weights of the projection of a + ap, moved into the triangle where it falls outside.
Eigen::Vector3d project_on_plane(const Eigen::Vector3d& ap, const Eigen::Vector3d& ab, const Eigen::Vector3d& ac) {
  const Eigen::Vector3d normal = ab.cross(ac);
  const double squared_area = normal.squaredNorm();
  if (!(squared_area > 0)) return {1, 0, 0};
  double v = 0;
  double w = 0;
  for (int pass = 0; pass < 3; ++pass) {
    const Eigen::Vector3d rest = ap - (v * ab + w * ac);
    v += normal.dot(rest.cross(ac)) / squared_area;
    w += normal.dot(ab.cross(rest)) / squared_area;
  }
  if (!std::isfinite(v) || !std::isfinite(w)) return {1, 0, 0};
  v = std::clamp(v, 0.0, 1.0);
  w = std::clamp(w, 0.0, 1 - v);
  return {1 - v - w, v, w};
}

// Nearest among the three edges and, where it exists, the projection on the plane, refined twice: thin triangles keep
// full accuracy.
Eigen::Vector3d nearest_on_sliver(const Eigen::Vector3d& p, const Corners& face) {
  const Eigen::Vector3d ab = face.b - face.a;
  const Eigen::Vector3d ac = face.c - face.a;
  const Eigen::Vector3d ap = p - face.a;
  const double on_ab = nearest_on_segment(ap, ab);
  const double on_ac = nearest_on_segment(ap, ac);
  const double on_bc = nearest_on_segment(p - face.b, face.c - face.b);
  const Eigen::Vector3d candidates[4] = {
      {1 - on_ab, on_ab, 0}, {1 - on_ac, 0, on_ac}, {0, 1 - on_bc, on_bc}, project_on_plane(ap, ab, ac)};
  return *std::min_element(candidates, candidates + 4, [&](const Eigen::Vector3d& left, const Eigen::Vector3d& right) {
    return face.from(p, left).squaredNorm() < face.from(p, right).squaredNorm();
  });
}

// Ericson 2005, section 5.1.5. \pre lengths are between 1e-70 and 1e70, so that their fourth powers are finite.
Eigen::Vector3d nearest_weights(const Eigen::Vector3d& p, const Corners& face) {
  const Eigen::Vector3d ab = face.b - face.a;
  const Eigen::Vector3d ac = face.c - face.a;
  if (ab.cross(ac).squaredNorm() <= kSliver * ab.squaredNorm() * ac.squaredNorm()) return nearest_on_sliver(p, face);

  const Eigen::Vector3d ap = p - face.a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};

  const Eigen::Vector3d bp = p - face.b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};

  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }

  const Eigen::Vector3d cp = p - face.c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};

  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }

  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }

  const double denominator = va + vb + vc;
  if (!(denominator > 0)) return nearest_on_sliver(p, face);
  const double v = vb / denominator;
  const double w = vc / denominator;
  return {1 - v - w, v, w};
}

// Zero for a degenerate face.
Eigen::Vector3d unit_normal(const Corners& face) {
  const Eigen::Vector3d vector = 0.5 * (face.b - face.a).cross(face.c - face.a);
  const double length = vector.stableNorm();
  return length > 0 ? Eigen::Vector3d(vector / length) : Eigen::Vector3d::Zero();
}

// \param face  in the tree's frame
Facet facet_of(const Corners& face) {
  Facet facet;
  const Eigen::Vector3d ab = face.b - face.a;
  const Eigen::Vector3d ac = face.c - face.a;
  const Eigen::Vector3d vector = ab.cross(ac);
  const double length = vector.stableNorm();
  if (!(length > 1e-6 * ab.norm() * ac.norm())) {
    facet.planes.setConstant(std::numeric_limits<float>::quiet_NaN());
    return facet;
  }
  const Eigen::Vector3d normal = vector / length;
  int row = 0;
  const auto add = [&](const Eigen::Vector3d& direction, const Eigen::Vector3d& point) {
    facet.planes.row(row++) << direction.cast<float>().transpose(), static_cast<float>(-direction.dot(point));
  };
  add(normal, face.a);
  add(ab.cross(normal).normalized(), face.a);
  add((face.c - face.b).cross(normal).normalized(), face.b);
  add((face.a - face.c).cross(normal).normalized(), face.a);
  return facet;
}

// The power of two that brings `length` near 1: multiplying by it does not round.
double unit_scale(double length) {
  return length > 0 && std::isfinite(length) ? std::ldexp(1.0, -std::clamp(std::ilogb(length), -1000, 1000)) : 1.0;
}

}  // namespace

Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) {
  const Eigen::Vector3d largest = (p - a).cwiseAbs().cwiseMax((b - a).cwiseAbs()).cwiseMax((c - a).cwiseAbs());
  const double scale = unit_scale(largest.maxCoeff());
  return nearest_weights(scale * (p - a), {Eigen::Vector3d::Zero(), scale * (b - a), scale * (c - a)});
}

struct SurfaceIndex::Implementation {
  std::optional<FaceTree> tree;                      // none for no faces
  double scale = 1;                                  // a power of two; lengths below are in scaled units
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the box, scaled units
  std::vector<Corners> corners;                      // scaled units
  std::vector<Facet> facets;
  FaceCells cells;
  std::vector<int> face_numbers;  // in the mesh
  std::vector<int> places;        // by face of the mesh, -1 for those that are not in

  void take(const Mesh& mesh);  // the corners of the faces numbered; those near one another come to lie near in memory
  void build();
  std::shared_ptr<Implementation> some(const std::vector<bool>& in) const;  // by place: a tree of those faces alone
  Nearest nearest(const Eigen::Vector3d& point, double max_distance, const Eigen::Vector3d* normal, double min_cosine,
                  bool unsigned_normal, const std::vector<bool>* only, bool any = false, int likely = -1) const;

  // A ray in the tree's frame, with the way by which its origin was moved towards the mesh.
  struct LocalRay {
    TreeRay ray;
    double advance;  // scaled units
    bool misses;
  };
  LocalRay local_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& unit_direction, double min_distance,
                     double max_distance) const;
};

namespace {

// State of one nearest-point query; the tree hands it to the callback.
struct Search {
  const Corners* corners = nullptr;
  const Facet* facets = nullptr;
  const int* face_numbers = nullptr;
  const std::vector<bool>* only = nullptr;  // by place: whether the face may be found; null: all may
  Eigen::Vector3d point;                    // scaled units
  double max_distance = 0;
  double margin = 0;

  Eigen::Vector4f place;  // (p, 1) in the tree's frame
  float facet_margin = 0;

  const Eigen::Vector3d* facing = nullptr;
  Eigen::Vector4f way = Eigen::Vector4f::Zero();  // (facing, 0)
  double way_margin = 0;
  double min_cosine = 0;
  bool unsigned_normal = false;
  bool any = false;  // the first face found will do

  double squared_distance = std::numeric_limits<double>::infinity();
  int face = -1;
  unsigned position = 0;
  Eigen::Vector3d barycentric;

  // The radius in single precision that still reaches every face at most this far.
  float reach(double distance) const { return static_cast<float>(distance * (1 + kCullMargin) + margin); }

  bool faces_the_right_way(unsigned triangle) const {
    if (facing == nullptr) return true;
    const double cosine = unit_normal(corners[triangle]).dot(*facing);
    return (unsigned_normal ? std::abs(cosine) : cosine) >= min_cosine;
  }
};

enum class Look { kNo, kYes, kUnsure };

// Whether the triangle faces the right way, as far as its facet tells.
Look look_at_way(const Search& search, const Facet& facet) {
  if (search.facing == nullptr) return Look::kYes;
  const float cosine = (facet.planes * search.way)[0];
  const double known = search.unsigned_normal ? std::abs(cosine) : cosine;
  if (known < search.min_cosine - search.way_margin) return Look::kNo;
  return known >= search.min_cosine + search.way_margin ? Look::kYes : Look::kUnsure;
}

// Whether the triangle is nearer than the best face so far, by its plane and by the lines of its edges within that
// plane: sure that not, or that its inside is. This spares most measurements, far from the surface by the plane, near
// fans of long triangles by the edges.
Look look_at_place(const Search& search, const Facet& facet) {
  const double limit = search.face < 0 ? search.max_distance * search.max_distance : search.squared_distance;
  const Eigen::Vector4f off = facet.planes * search.place;
  const float outside = std::max({off[1], off[2], off[3]});
  const double height = std::max(0.0F, std::abs(off[0]) - search.facet_margin);
  const double beside = std::max(0.0F, outside - search.facet_margin);
  if (height * height + beside * beside > limit) return Look::kNo;
  const double most = std::abs(off[0]) + search.facet_margin;
  return outside <= -search.facet_margin && most * most <= limit ? Look::kYes : Look::kUnsure;
}

// Whether the triangle is the nearest so far; then it is kept.
bool is_nearest(Search& search, unsigned triangle) {
  if (search.any && search.face >= 0) return false;
  if (search.only != nullptr && !(*search.only)[triangle]) return false;
  const Facet& facet = search.facets[triangle];
  const Look way = look_at_way(search, facet);
  if (way == Look::kNo) return false;
  const Look place = look_at_place(search, facet);
  if (place == Look::kNo) return false;
  if (search.any && place == Look::kYes && way == Look::kYes) {
    search.face = search.face_numbers[triangle];
    search.position = triangle;
    return true;
  }
  if (way == Look::kUnsure && !search.faces_the_right_way(triangle)) return false;
  const Corners& corners = search.corners[triangle];
  const Eigen::Vector3d barycentric = nearest_weights(search.point, corners);
  const double squared = corners.from(search.point, barycentric).squaredNorm();
  if (!(squared <= search.squared_distance)) return false;
  const int face = search.face_numbers[triangle];
  // Equal distances: the lowest number, whatever the order in which the tree is walked.
  if (squared == search.squared_distance && search.face >= 0 && face >= search.face) return false;
  const double distance = std::sqrt(squared);
  if (distance > search.max_distance) return false;
  search.squared_distance = squared;
  search.face = face;
  search.position = triangle;
  search.barycentric = barycentric;
  return true;
}

bool measure(void* state, unsigned face, float& radius) {
  Search& search = *static_cast<Search*>(state);
  if (!is_nearest(search, face)) return false;
  const float reach = search.any ? 0 : search.reach(std::sqrt(search.squared_distance));
  if (!(reach < radius)) return false;
  radius = reach;
  return true;
}

// Finds the nearest through the tree, which has the faces about `centre`.
void walk(const FaceTree& tree, const Eigen::Vector3d& centre, Search& search, MeasureFace look = measure) {
  const Eigen::Vector3d local = search.point - centre;
  const double offset = local.cwiseAbs().maxCoeff();
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  if (offset < kFarAway) {
    point = local.cast<float>();
    search.margin = kCullMargin * (1 + offset);
  } else {
    search.margin = std::numeric_limits<double>::infinity();
  }
  const double radius = search.face < 0 ? search.max_distance : std::sqrt(search.squared_distance);
  const float reach = radius < 2 * kFarAway ? search.reach(radius) : std::numeric_limits<float>::infinity();
  tree.search(point, reach, look, &search);
}

// All faces within the search's distance.
struct Gathering : Search {
  struct Found {
    unsigned position;
    double distance;  // scaled units
    Eigen::Vector3d barycentric;
  };
  std::vector<Found> found;
};

bool gather(void* state, unsigned face, float& /*radius*/) {
  Gathering& search = *static_cast<Gathering*>(static_cast<Search*>(state));
  if (search.only != nullptr && !(*search.only)[face]) return false;
  const Corners& corners = search.corners[face];
  const Eigen::Vector3d barycentric = nearest_weights(search.point, corners);
  const double distance = corners.from(search.point, barycentric).norm();
  if (distance <= search.max_distance) search.found.push_back({face, distance, barycentric});
  return false;
}

}  // namespace

void SurfaceIndex::Implementation::build() {
  Eigen::AlignedBox3d box;
  for (const Corners& face : corners) box.extend(face.a).extend(face.b).extend(face.c);
  // Unscaled so far: choose the scale, then apply it.
  scale = unit_scale((box.max() - box.min()).maxCoeff());
  centre = scale * (0.5 * box.min() + 0.5 * box.max());
  facets.reserve(corners.size());
  for (Corners& face : corners) {
    face = {scale * face.a, scale * face.b, scale * face.c};
    facets.push_back(facet_of({face.a - centre, face.b - centre, face.c - centre}));
  }
  cells = FaceCells(corners.size(), [&](std::size_t i) {
    return std::array{corners[i].a, corners[i].b, corners[i].c};
  });

  std::vector<TreeFace> faces;
  faces.reserve(corners.size());
  for (const Corners& face : corners) {
    faces.push_back(
        {(face.a - centre).cast<float>(), (face.b - centre).cast<float>(), (face.c - centre).cast<float>()});
  }
  tree.emplace(faces);
}

SurfaceIndex::Nearest SurfaceIndex::Implementation::nearest(const Eigen::Vector3d& point, double max_distance,
                                                            const Eigen::Vector3d* normal, double min_cosine,
                                                            bool unsigned_normal, const std::vector<bool>* only,
                                                            bool any, int likely) const {
  Nearest result;
  if (corners.empty() || !(max_distance >= 0)) return result;
  Search search;
  search.corners = corners.data();
  search.facets = facets.data();
  search.face_numbers = face_numbers.data();
  search.point = scale * point;
  search.max_distance = scale * max_distance;
  search.only = only;
  search.facing = normal;
  search.min_cosine = min_cosine;
  search.unsigned_normal = unsigned_normal;
  search.any = any;
  if (normal != nullptr) {
    search.way << normal->cast<float>(), 0;
    search.way_margin = kFacetMargin * normal->lpNorm<1>();
  }
  const Eigen::Vector3d local = search.point - centre;
  search.place << local.cast<float>(), 1;
  search.facet_margin = kFacetMargin * (1 + static_cast<float>(local.cwiseAbs().maxCoeff()));
  if (likely >= 0 && likely < static_cast<int>(face_numbers.size())) is_nearest(search, static_cast<unsigned>(likely));

  // Of those in the same cell one is near, if not the nearest: the tree then looks at little beyond it.
  if (search.face < 0) {
    if (const FaceCells::Faces* near = cells.at(search.point)) {
      for (std::size_t k = 0; k < near->size() && (*near)[k] >= 0 && search.face < 0; ++k) {
        is_nearest(search, static_cast<unsigned>((*near)[k]));
      }
    }
  }
  if (!any || search.face < 0) walk(*tree, centre, search);
  if (search.face < 0) return result;
  result.face = search.face;
  if (any) return result;
  result.distance = std::sqrt(search.squared_distance) / scale;
  result.place = static_cast<int>(search.position);
  result.barycentric = search.barycentric;
  result.point = corners[search.position].at(search.barycentric) / scale;
  return result;
}

SurfaceIndex::Implementation::LocalRay SurfaceIndex::Implementation::local_ray(const Eigen::Vector3d& origin,
                                                                               const Eigen::Vector3d& unit_direction,
                                                                               double min_distance,
                                                                               double max_distance) const {
  LocalRay local{};
  Eigen::Vector3d start = scale * origin - centre;
  if (start.cwiseAbs().maxCoeff() > kSphere) {
    const double along = start.dot(unit_direction);
    const Eigen::Vector3d closest = start - along * unit_direction;
    if (closest.norm() > kSphere || along > 0) {
      local.misses = true;
      return local;
    }
    local.advance = std::max(0.0, -along - kSphere);
    start += local.advance * unit_direction;
  }
  local.ray.origin = start.cast<float>();
  local.ray.direction = unit_direction.cast<float>();
  const double limit = std::min(scale * max_distance - local.advance, 1e6);
  local.ray.near = static_cast<float>(std::clamp(scale * min_distance - local.advance, 0.0, 1e6));
  local.ray.far = static_cast<float>(limit);
  local.misses = !(limit >= 0) || !local.ray.origin.allFinite() || !local.ray.direction.allFinite();
  return local;
}

namespace {

Corners corners_of(const Mesh& mesh, int face) {
  const auto corner = [&](int k) -> Eigen::Vector3d { return mesh.vertices.row(mesh.faces(face, k)); };
  return {corner(0), corner(1), corner(2)};
}

}  // namespace

void SurfaceIndex::Implementation::take(const Mesh& mesh) {
  Points middles(static_cast<Eigen::Index>(face_numbers.size()), 3);
  for (std::size_t i = 0; i < face_numbers.size(); ++i) {
    const Corners face = corners_of(mesh, face_numbers[i]);
    middles.row(static_cast<Eigen::Index>(i)) = face.a / 3 + face.b / 3 + face.c / 3;
  }
  std::vector<int> ordered;
  ordered.reserve(face_numbers.size());
  for (const int i : space_order(middles)) ordered.push_back(face_numbers[static_cast<std::size_t>(i)]);
  face_numbers = std::move(ordered);
  corners.reserve(face_numbers.size());
  for (const int face : face_numbers) corners.push_back(corners_of(mesh, face));
}

std::shared_ptr<SurfaceIndex::Implementation> SurfaceIndex::Implementation::some(const std::vector<bool>& in) const {
  auto result = std::make_shared<Implementation>();
  result->places.assign(places.size(), -1);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!in[i]) continue;
    result->places[static_cast<std::size_t>(face_numbers[i])] = static_cast<int>(result->corners.size());
    result->face_numbers.push_back(face_numbers[i]);
    const Corners& face = corners[i];
    result->corners.push_back({face.a / scale, face.b / scale, face.c / scale});
  }
  if (!result->corners.empty()) result->build();
  return result;
}

SurfaceIndex::SurfaceIndex(const Mesh& mesh, const std::vector<int>& faces)
    : implementation_(std::make_shared<Implementation>()) {
  Implementation& data = *implementation_;
  data.face_numbers = faces;
  if (faces.empty()) {
    data.face_numbers.resize(static_cast<std::size_t>(mesh.faces.rows()));
    std::iota(data.face_numbers.begin(), data.face_numbers.end(), 0);
  }
  data.take(mesh);
  data.places.assign(static_cast<std::size_t>(mesh.faces.rows()), -1);
  for (std::size_t i = 0; i < data.face_numbers.size(); ++i) {
    data.places[static_cast<std::size_t>(data.face_numbers[i])] = static_cast<int>(i);
  }
  if (!data.corners.empty()) data.build();
}

SurfaceIndex::SurfaceIndex(std::shared_ptr<Implementation> implementation,
                           std::shared_ptr<const std::vector<bool>> only)
    : implementation_(std::move(implementation)), only_(std::move(only)) {}

SurfaceIndex SurfaceIndex::part(const std::vector<int>& faces) const {
  const Implementation& data = *implementation_;
  auto only = std::make_shared<std::vector<bool>>(data.face_numbers.size(), false);
  std::size_t count = 0;
  for (const int face : faces) {
    const int place = data.places[static_cast<std::size_t>(face)];
    if (place < 0 || (*only)[static_cast<std::size_t>(place)] || (only_ && !(*only_)[static_cast<std::size_t>(place)]))
      continue;
    (*only)[static_cast<std::size_t>(place)] = true;
    ++count;
  }
  if (count == data.face_numbers.size()) only.reset();
  if (kWorthATree * count < data.face_numbers.size()) return {data.some(*only), nullptr};
  return {implementation_, std::move(only)};
}

SurfaceIndex::~SurfaceIndex() = default;
SurfaceIndex::SurfaceIndex(SurfaceIndex&&) noexcept = default;
SurfaceIndex& SurfaceIndex::operator=(SurfaceIndex&&) noexcept = default;

SurfaceIndex::Nearest SurfaceIndex::nearest(const Eigen::Vector3d& point, double max_distance, int likely) const {
  return implementation_->nearest(point, max_distance, nullptr, 0, false, only_.get(), false, likely);
}

SurfaceIndex::Nearest SurfaceIndex::nearest_facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                                   double min_cosine, double max_distance, bool unsigned_normal,
                                                   int likely) const {
  return implementation_->nearest(point, max_distance, &normal, min_cosine, unsigned_normal, only_.get(), false,
                                  likely);
}

std::vector<SurfaceIndex::Nearest> SurfaceIndex::all_within(const Eigen::Vector3d& point, double distance) const {
  const Implementation& data = *implementation_;
  std::vector<Nearest> result;
  if (data.corners.empty() || !(distance >= 0)) return result;
  Gathering search;
  search.corners = data.corners.data();
  search.point = data.scale * point;
  search.max_distance = data.scale * distance;
  search.only = only_.get();
  walk(*data.tree, data.centre, search, gather);
  for (const Gathering::Found& each : search.found) {
    result.push_back({each.distance / data.scale, data.face_numbers[each.position], static_cast<int>(each.position),
                      data.corners[each.position].at(each.barycentric) / data.scale, each.barycentric});
  }
  std::ranges::sort(result, {}, &Nearest::face);
  return result;
}

bool SurfaceIndex::within(const Eigen::Vector3d& point, double max_distance) const {
  return implementation_->nearest(point, max_distance, nullptr, 0, false, only_.get(), true).face >= 0;
}

bool SurfaceIndex::within_facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double min_cosine,
                                 double max_distance) const {
  return implementation_->nearest(point, max_distance, &normal, min_cosine, true, only_.get(), true).face >= 0;
}

std::optional<SurfaceIndex::Hit> SurfaceIndex::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                                    double min_distance) const {
  const Implementation& data = *implementation_;
  if (data.corners.empty()) return std::nullopt;
  const Eigen::Vector3d unit = direction.stableNormalized();
  const auto local = data.local_ray(origin, unit, min_distance, std::numeric_limits<double>::infinity());
  if (local.misses) return std::nullopt;
  TreeHit met;
  if (!data.tree->cast(local.ray, met)) return std::nullopt;

  const Corners& corners = data.corners[met.face];
  const auto u = static_cast<double>(met.u);
  const auto v = static_cast<double>(met.v);
  Hit hit;
  hit.face = data.face_numbers[met.face];
  hit.barycentric = {1 - u - v, u, v};
  // The point in double precision, where the ray does not graze the face (Moeller and Trumbore 1997).
  const Eigen::Vector3d ab = corners.b - corners.a;
  const Eigen::Vector3d ac = corners.c - corners.a;
  const Eigen::Vector3d across = unit.cross(ac);
  const double determinant = ab.dot(across);
  if (std::abs(determinant) > 1e-6 * ab.norm() * ac.norm()) {
    const Eigen::Vector3d to_origin = data.scale * origin - corners.a;
    const double fine_u = std::clamp(to_origin.dot(across) / determinant, 0.0, 1.0);
    const double fine_v = std::clamp(unit.dot(to_origin.cross(ab)) / determinant, 0.0, 1 - fine_u);
    if (std::abs(fine_u - u) + std::abs(fine_v - v) < 1e-2) hit.barycentric = {1 - fine_u - fine_v, fine_u, fine_v};
  }
  hit.point = corners.at(hit.barycentric) / data.scale;
  hit.distance = std::max(0.0, (hit.point - origin).dot(unit));
  return hit;
}

bool SurfaceIndex::occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double min_distance,
                            double max_distance) const {
  const Implementation& data = *implementation_;
  if (data.corners.empty()) return false;
  const auto local = data.local_ray(origin, direction.stableNormalized(), min_distance, max_distance);
  if (local.misses) return false;
  return data.tree->occluded(local.ray);
}

}  // namespace orbifit
