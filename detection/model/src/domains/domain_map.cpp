#include "domains/domain_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <span>

#include <Eigen/Geometry>

#include "orbifit/model/point_group.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kSameLine = 1e-7;  // of the diagonal, and radians
// Likewise, but for rounding: wheels of one axle, placed each for itself, differ by more.
constexpr double kOneLine = 1e-11;
constexpr double kOnAxis = 1e-12;  // of a point's offset
constexpr int kMaxFold = 120;
constexpr double kPoint = 1e-4;  // of the diagonal: side of the square that a vertex counts as

// One element of each component of a continuous group; mirrors contain the reference direction.
std::vector<Motion> components(const PointGroup& group, const Continuum& continuum) {
  const Vector3d& centre = continuum.centre;
  const Motion level = Motion::reflection(continuum.axis, centre);
  const Motion upright = Motion::reflection(continuum.axis.cross(continuum.reference), centre);
  const Motion half_turn = Motion::rotation(continuum.reference, std::numbers::pi, centre);
  switch (group.family) {
    case Family::Cinfv:
      return {Motion{}, upright};
    case Family::Cinfh:
      return {Motion{}, level};
    case Family::Dinf:
      return {Motion{}, half_turn};
    case Family::Dinfh:
      return {Motion{}, upright, level, half_turn};
    case Family::Kh:
      return {Motion{}, Motion::about(-Matrix3d::Identity(), centre)};
    default:
      return {Motion{}};
  }
}

bool same_line(const Continuum& a, const Vector3d& axis, const Vector3d& point, double size) {
  return a.axis.cross(axis).norm() < kOneLine && a.axis.cross(point - a.centre).norm() < kOneLine * size;
}

}  // namespace

double Continuum::distance(const Vector3d& point) const {
  return spherical ? (point - centre).norm() : axis.cross(point - centre).norm();
}

Vector3d Continuum::foot(const Vector3d& point) const {
  return spherical ? centre : Vector3d(centre + axis * axis.dot(point - centre));
}

Motion Continuum::turn_to(const Vector3d& point) const {
  const Vector3d offset = point - foot(point);
  const double scale = (point - centre).norm();
  if (offset.norm() <= kOnAxis * scale || scale == 0) return {};
  if (spherical) {
    // Of the far half by a half-turn first: the shortest turn to nearly the opposite loses digits.
    const bool far = axis.dot(offset) < 0;
    const Vector3d from = far ? Vector3d(-axis) : axis;
    Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(from, offset).toRotationMatrix();
    if (far) turn = turn * axis_rotation(reference, std::numbers::pi);
    return Motion::about(turn, centre);
  }
  const double angle = std::atan2(axis.dot(reference.cross(offset)), reference.dot(offset));
  return angle == 0 ? Motion{} : Motion::rotation(axis, angle, centre);
}

DomainMap::DomainMap(const Mesh& mesh, const SymmetryAnnotation& annotation,
                     const std::vector<std::vector<Motion>>& motions)
    : size_(diagonal(mesh.vertices)), origin_(bounding_box_centre(mesh.vertices)) {
  for (const Region& region : annotation.regions) add_region(region);
  regions_ = places();
  share_references();
  for (const Region& region : annotation.regions) {
    Place& place = places_[static_cast<std::size_t>(&region - annotation.regions.data())];
    if (place.continuum) place.motions = components(region.group, *place.continuum);
  }
  for (std::size_t p = 0; p < annotation.patterns.size(); ++p) add_pattern(annotation.patterns[p], motions[p]);
  find_sets(mesh);
  moments_ = moments_of_sets(mesh, set_of_face_, set_count(), origin_);
  images_.resize(places_.size());
  inverses_.resize(places_.size());
  find_meeting(mesh);
  find_twins(mesh);
}

void DomainMap::find_sets(const Mesh& mesh) {
  const auto faces = static_cast<std::size_t>(mesh.faces.rows());
  std::vector<std::size_t> first(faces + 1, 0);  // of each face among the members
  for (const Place& place : places_) {
    for (const int face : place.faces) ++first[static_cast<std::size_t>(face) + 1];
  }
  for (std::size_t face = 0; face < faces; ++face) first[face + 1] += first[face];
  std::vector<int> members(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (int place = 0; place < places(); ++place) {
    for (const int face : at(place).faces) members[next[static_cast<std::size_t>(face)]++] = place;
  }
  set_of_face_.resize(faces);
  std::vector<int> set;
  int number = intern(set);
  for (std::size_t face = 0; face < faces; ++face) {
    const std::span here(members.data() + first[face], first[face + 1] - first[face]);
    if (!std::equal(here.begin(), here.end(), set.begin(), set.end())) {  // neighbours mostly have the same
      set.assign(here.begin(), here.end());
      number = intern(set);
    }
    set_of_face_[face] = number;
  }
  for (Place& place : places_) {
    place.whole = static_cast<Eigen::Index>(place.faces.size()) == mesh.faces.rows();
    for (const int face : place.faces) {
      for (const int vertex : mesh.faces.row(face)) place.box.extend(mesh.vertices.row(vertex).transpose());
    }
  }
}

// Also those that share no face but vertices: what lies on both must keep both.
void DomainMap::find_meeting(const Mesh& mesh) {
  meeting_.resize(places_.size());
  points_ = point_sets(mesh, *this);
  std::vector<int> sets = by_vertex(points_);
  std::vector<PieceMoments> points(sets_.size());
  const double weight = kPoint * kPoint * size_ * size_;
  for (std::size_t v = 0; v < sets.size(); ++v) {
    const Eigen::Vector3d place = mesh.vertices.row(static_cast<Eigen::Index>(v)).transpose() - origin_;
    points[static_cast<std::size_t>(sets[v])] += {weight, weight * place, weight * place * place.transpose()};
  }
  for (std::size_t set = 0; set < points.size(); ++set) {
    if (points[set].area > 0) point_moments_.emplace_back(static_cast<int>(set), points[set]);
  }
  sets.insert(sets.end(), set_of_face_.begin(), set_of_face_.end());
  std::ranges::sort(sets);
  sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
  for (const int set : sets) {
    for (const int place : set_places(set)) {
      auto& met = meeting_[static_cast<std::size_t>(place)];
      met.insert(met.end(), set_places(set).begin(), set_places(set).end());
    }
  }
  around_.resize(places_.size());
  for (std::size_t inner = 0; inner < places_.size(); ++inner) {
    std::vector<int>& met = meeting_[inner];
    std::ranges::sort(met);
    met.erase(std::unique(met.begin(), met.end()), met.end());
    std::ranges::copy_if(met, std::back_inserter(around_[inner]), [&](int outer) {
      for (std::size_t set = 0; set < moments_.size(); ++set) {
        if (holds(static_cast<int>(set), static_cast<int>(inner)) && !holds(static_cast<int>(set), outer)) return false;
      }
      return true;
    });
  }
  find_followers(sets);
}

void DomainMap::add_region(const Region& region) {
  Place place;
  place.name = region.name.empty() ? "region " + std::to_string(region.id) : region.name;
  place.motions = region.elements;
  place.centre = region.centre;
  place.faces = region.faces;
  if (region.group.continuous()) {
    Continuum continuum;
    continuum.centre = region.centre;
    continuum.spherical = !region.group.has_axis();
    if (!continuum.spherical) continuum.axis = region.axis.normalized();
    continuum.reference = frame_about(continuum.axis).col(0);
    place.continuum = continuum;
  }
  places_.push_back(std::move(place));
}

// Regions on one line share its direction, and the half-plane of canonical places lies in a mirror of finite groups
// about the line, so that copies of a ring have their symmetries.
void DomainMap::share_references() {
  for (std::size_t b = 0; b < places_.size(); ++b) {
    if (!places_[b].continuum || places_[b].continuum->spherical) continue;
    Continuum& own = *places_[b].continuum;
    bool shared = false;
    for (std::size_t a = 0; a < b && !shared; ++a) {
      if (!places_[a].continuum || places_[a].continuum->spherical) continue;
      if (!same_line(*places_[a].continuum, own.axis, own.centre, size_)) continue;
      const Vector3d centre = own.centre;
      own = *places_[a].continuum;
      own.centre = own.foot(centre);
      places_[b].centre = own.centre;  // what turns with the group turns about its axis
      shared = true;
    }
    if (shared) continue;
    std::size_t most = 0;
    for (const Place& place : places_) {
      int rotations = 1;
      Vector3d across = Vector3d::Zero();
      for (const Motion& element : place.motions) {
        const AxisAngle turn = axis_angle(element.linear);
        const bool fixes = (element(own.centre) - own.centre).norm() < kSameLine * size_;
        if (!fixes) continue;
        if (turn.determinant > 0 && turn.angle > 0 && turn.axis.cross(own.axis).norm() < kSameLine) ++rotations;
        // A mirror is -1 times a half turn about its normal.
        if (turn.determinant < 0 && std::abs(turn.angle - std::numbers::pi) < 1e-9 &&
            std::abs(turn.axis.dot(own.axis)) < kSameLine) {
          across = turn.axis.cross(own.axis);
        }
      }
      if (!place.continuum && rotations > 1) own.fold = std::lcm(own.fold, rotations);
      if (across.norm() > 0.5 && place.motions.size() > most) {
        most = place.motions.size();
        own.reference = (across - own.axis * own.axis.dot(across)).normalized();
      }
    }
    if (own.fold > kMaxFold) own.fold = 1;
  }
}

void DomainMap::add_pattern(const Pattern& pattern, const std::vector<Motion>& motions) {
  const int first = places();
  first_place_.push_back(first);
  for (std::size_t a = 0; a < pattern.instances.size(); ++a) {
    Place place;
    place.name = (pattern.name.empty() ? "pattern " + std::to_string(pattern.id) : pattern.name) + ", instance " +
                 std::to_string(a);
    place.faces = pattern.instances[a].faces;
    place.pattern_first = first;
    const Motion back = inverse(motions[a]);
    for (const Motion& motion : motions) place.motions.push_back(motion * back);
    place.motions[a] = Motion{};
    places_.push_back(std::move(place));
  }
}

int DomainMap::arrival(int place, int element) const {
  return at(place).pattern_first < 0 ? place : at(place).pattern_first + element;
}

int DomainMap::inverse_element(int place, int element) const {
  if (at(place).pattern_first >= 0) return place - at(place).pattern_first;
  std::vector<int>& inverses = inverses_[static_cast<std::size_t>(place)];
  const std::vector<Motion>& motions = at(place).motions;
  if (inverses.empty()) inverses.assign(motions.size(), -1);
  int& inverse = inverses[static_cast<std::size_t>(element)];
  if (inverse < 0) {
    const Eigen::Matrix3d back = motions[static_cast<std::size_t>(element)].linear.transpose();
    const auto nearest =
        std::ranges::min_element(motions, {}, [&](const Motion& m) { return (m.linear - back).norm(); });
    inverse = static_cast<int>(nearest - motions.begin());
  }
  return inverse;
}

int DomainMap::intern(const std::vector<int>& set) const {
  const auto [entry, added] = number_of_set_.try_emplace(set, static_cast<int>(sets_.size()));
  if (added) sets_.push_back(&entry->first);
  return entry->second;
}

bool DomainMap::holds(int set, int place) const {
  return std::ranges::binary_search(set_places(set), place);
}

bool DomainMap::contains(int set, int subset) const {
  return set == subset || std::ranges::includes(set_places(set), set_places(subset));
}

int DomainMap::with(int set, int place) const {
  const std::uint64_t key =
      static_cast<std::uint64_t>(static_cast<std::uint32_t>(set)) << 32U | static_cast<std::uint32_t>(place);
  const auto known = with_.find(key);
  if (known != with_.end()) return known->second;
  std::vector<int> members = set_places(set);
  const auto position = std::ranges::lower_bound(members, place);
  if (position == members.end() || *position != place) members.insert(position, place);
  return with_[key] = intern(members);
}

int DomainMap::joined(int a, int b) const {
  if (contains(a, b)) return a;
  int result = a;
  for (const int place : std::vector<int>(set_places(b))) result = with(result, place);
  return result;
}

int innermost_region(const DomainMap& domains, int set) {
  int best = -1;
  for (const int place : domains.set_places(set)) {
    if (place >= domains.count()) continue;
    if (best < 0 || domains.face_count(place) < domains.face_count(best)) best = place;
  }
  return best;
}

}  // namespace orbifit
