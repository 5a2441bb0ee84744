#include "scan/partial_revolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

#include <Eigen/Dense>

#include "orbifit/model/point_group.h"

#include "base/random.h"
#include "geometry/grid_cell.h"
#include "geometry/point_index.h"

namespace orbifit {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNormalAngle = 0.26;                    // radians off the axis' plane, 15 degrees
constexpr double kMinArc = 70 * std::numbers::pi / 180;  // of a surface that is not merely bent
constexpr double kSteep = 0.94;                          // cosine to the axis, 20 degrees
constexpr int kArcBins = 72;
constexpr int kScored = 1200;  // points on which a proposed axis is judged
constexpr int kProposals = 60;

// A point in the half-plane of an axis.
struct ProfilePoint {
  Vector2d place;   // along the axis, and from it
  Vector2d normal;  // unit where the point's normal meets the axis
  Vector3d radial = Vector3d::Zero();
  double angle = 0;
  bool meets = false;
  bool steep = false;  // not at right angles to the axis
};

/// The points about one axis: which belong to one profile.
class Profile {
 public:
  Profile(const Points& points, const Points& normals, const Line& axis, double tolerance, double spacing)
      : cell_(std::max(1.5 * spacing, 2 * tolerance)) {
    const GroupFrame frame = frame_about(axis.direction);
    places_.resize(static_cast<std::size_t>(points.rows()));
    offset_.assign(places_.size(), 0);
    belongs_.assign(places_.size(), 0);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Vector3d p = Vector3d(points.row(static_cast<Eigen::Index>(i))) - axis.point;
      const Vector3d n = normals.row(static_cast<Eigen::Index>(i));
      ProfilePoint& place = places_[i];
      const double x = p.dot(frame.col(0));
      const double y = p.dot(frame.col(1));
      const double radius = std::hypot(x, y);
      place.place = {p.dot(axis.direction), radius};
      place.angle = std::atan2(y, x);
      if (radius > 1e-9) place.radial = (x * frame.col(0) + y * frame.col(1)) / radius;
      place.normal = {n.dot(axis.direction), n.dot(place.radial)};
      const double length = place.normal.norm();
      // Next to the axis every direction meets it within the noise.
      const double allowed = std::sin(kNormalAngle) + std::min(1.0, tolerance / std::max(radius, 1e-9));
      place.meets = length > 0.3 && std::sqrt(std::max(0.0, 1 - length * length)) <= allowed;
      place.steep = std::abs(place.normal.x()) < kSteep;
      if (length > 0) place.normal /= length;
      if (place.meets) cells_[key(place.place)].push_back(static_cast<int>(i));
    }
    measure(tolerance);
  }

  const std::vector<char>& belongs() const { return belongs_; }
  const std::vector<double>& offsets() const { return offset_; }
  const std::vector<ProfilePoint>& places() const { return places_; }
  const std::vector<Vector2d>& mean_normals() const { return mean_normal_; }

  std::size_t count() const { return static_cast<std::size_t>(std::ranges::count(belongs_, 1)); }

  // Whether what stands steep to the half-plane's axis, at the heights and distances of what belongs, belongs as well,
  // and is more than a sliver: the flat end of a box turns into itself, but its sides do not.
  bool sound() const {
    constexpr double kOutwards = 1.5;
    constexpr double kMax = 0.6;
    constexpr double kSliver = 0.1;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double far = 0;
    std::size_t steep = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (belongs_[i] == 0 || !places_[i].steep) continue;
      low = std::min(low, places_[i].place.x());
      high = std::max(high, places_[i].place.x());
      far = std::max(far, kOutwards * places_[i].place.y());
      ++steep;
    }
    const auto around = std::ranges::count_if(places_, [&](const ProfilePoint& p) {
      return p.steep && p.place.x() >= low && p.place.x() <= high && p.place.y() <= far;
    });
    return static_cast<double>(steep) >= kMax * static_cast<double>(around) &&
           static_cast<double>(steep) >= kSliver * static_cast<double>(count()) && arc() >= kMinArc;
  }

  // Longest run of angles at which steep points of the profile are seen; gaps of two bins are none.
  double arc() const {
    std::array<int, kArcBins> bins{};
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (belongs_[i] == 0 || !places_[i].steep) continue;
      const double turns = places_[i].angle / (2 * std::numbers::pi) + 0.5;
      ++bins[static_cast<std::size_t>(std::clamp(static_cast<int>(turns * kArcBins), 0, kArcBins - 1))];
    }
    const int total = std::accumulate(bins.begin(), bins.end(), 0);
    // A few strays do not fill a bin.
    const int least = std::max(1, total / (8 * kArcBins));
    int longest = 0;
    for (int first = 0; first < kArcBins; ++first) {
      int run = 0;
      int gap = 0;
      for (int k = 0; k < kArcBins && gap <= 2; ++k) {
        const bool filled = bins[static_cast<std::size_t>((first + k) % kArcBins)] >= least;
        gap = filled ? 0 : gap + 1;
        if (filled) run = k + 1;
      }
      longest = std::max(longest, run);
    }
    return 2 * std::numbers::pi * longest / kArcBins;
  }

 private:
  using Key = std::array<std::int64_t, 2>;
  Key key(const Vector2d& place) const { return {grid_cell(place.x() / cell_), grid_cell(place.y() / cell_)}; }

  // The signed distance of each point from the line through the mean of its neighbours on the profile.
  void measure(double tolerance) {
    constexpr double kCompatible = 0.85;
    constexpr int kMinNeighbours = 6;
    constexpr double kMinSpread = 0.25;  // radians of angle over which the neighbours must agree
    mean_normal_.assign(places_.size(), Vector2d::Zero());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const ProfilePoint& here = places_[i];
      if (!here.meets) continue;
      Vector2d mean = Vector2d::Zero();
      Vector2d normal = Vector2d::Zero();
      Vector2d direction = Vector2d::Zero();
      int count = 0;
      const Key at = key(here.place);
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        for (std::int64_t dy = -1; dy <= 1; ++dy) {
          const auto found = cells_.find({at[0] + dx, at[1] + dy});
          if (found == cells_.end()) continue;
          for (const int j : found->second) {
            const ProfilePoint& other = places_[static_cast<std::size_t>(j)];
            const double cosine = here.normal.dot(other.normal);
            if (std::abs(cosine) < kCompatible || (other.place - here.place).norm() > cell_) continue;
            mean += other.place;
            normal += cosine < 0 ? Vector2d(-other.normal) : other.normal;
            direction += Vector2d(std::cos(other.angle), std::sin(other.angle));
            ++count;
          }
        }
      }
      if (count < kMinNeighbours) continue;
      const double together = direction.norm() / count;  // 1: all at one angle
      if (std::sqrt(std::max(0.0, 2 * (1 - together))) < kMinSpread) continue;
      mean_normal_[i] = normal.normalized();
      offset_[i] = mean_normal_[i].dot(here.place - mean / count);
      belongs_[i] = std::abs(offset_[i]) <= tolerance ? 1 : 0;
    }
  }

  double cell_;
  std::vector<ProfilePoint> places_;
  std::map<Key, std::vector<int>> cells_;
  std::vector<double> offset_;
  std::vector<Vector2d> mean_normal_;
  std::vector<char> belongs_;
};

Points rows(const Points& points, const std::vector<int>& numbers) {
  return points(numbers, Eigen::all);
}

// One Gauss-Newton step of the axis on the distances of the points from their profile: moving the axis by s and turning
// it by t, both across its direction, changes a point's distance from it by -u.(s + z t) and its height by r u.t.
// Offsets are against neighbours' means, so what moves all points of one height alike does no harm.
std::optional<Line> improved(const Profile& profile, const Line& axis) {
  const GroupFrame frame = frame_about(axis.direction);
  Eigen::Matrix4d normal_matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < profile.places().size(); ++i) {
    if (profile.belongs()[i] == 0) continue;
    const ProfilePoint& place = profile.places()[i];
    const Vector2d m = profile.mean_normals()[i];
    const double x = place.radial.dot(frame.col(0));
    const double y = place.radial.dot(frame.col(1));
    const double turn = m.x() * place.place.y() - m.y() * place.place.x();
    const Eigen::Vector4d row(-m.y() * x, -m.y() * y, turn * x, turn * y);
    normal_matrix += row * row.transpose();
    right -= row * profile.offsets()[i];
  }
  const double trace = normal_matrix.trace();
  if (!(trace > 0)) return std::nullopt;
  const Eigen::Vector4d step = (normal_matrix + 1e-6 * trace * Eigen::Matrix4d::Identity()).ldlt().solve(right);
  if (!step.allFinite() || step.norm() > 0.2) return std::nullopt;
  Line result = axis;
  result.point += step[0] * frame.col(0) + step[1] * frame.col(1);
  result.direction = (axis.direction + step[2] * frame.col(0) + step[3] * frame.col(1)).normalized();
  return result;
}

// Some of the points, evenly at random, on which axes are scored.
struct ScoredPoints {
  Points points, normals;
  double spacing = 0;
};

ScoredPoints some_of(const Points& points, const Points& normals, double spacing, Random& random) {
  const int total = static_cast<int>(points.rows());
  const int scored = std::min(total, kScored);
  std::vector<int> chosen(static_cast<std::size_t>(total));
  std::iota(chosen.begin(), chosen.end(), 0);
  for (int i = 0; i < scored; ++i) {
    std::swap(chosen[static_cast<std::size_t>(i)],
              chosen[static_cast<std::size_t>(i) + random.below(static_cast<std::uint64_t>(total - i))]);
  }
  chosen.resize(static_cast<std::size_t>(scored));
  return {rows(points, chosen), rows(normals, chosen), spacing * std::sqrt(static_cast<double>(total) / scored)};
}

struct ProposedAxis {
  Line axis;
  std::size_t count = 0;  // of the scored points that belong to the surface about it
};

ProposedAxis scored_axis(const ScoredPoints& few, const Line& axis, double tolerance) {
  const Profile profile(few.points, few.normals, axis, tolerance, few.spacing);
  return {axis, profile.sound() ? profile.count() : std::size_t{0}};
}

// Axes fitted to what lies in balls about random points, the first ball holding everything.
std::vector<ProposedAxis> proposed_axes(const ScoredPoints& few, double size, double tolerance, Random& random,
                                        const RunContext& context) {
  const int scored = static_cast<int>(few.points.rows());
  std::vector<ProposedAxis> proposals(kProposals);
  std::vector<std::pair<Vector3d, double>> balls;
  for (int k = 0; k < kProposals; ++k) {
    const Vector3d middle = few.points.row(static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(scored))));
    balls.emplace_back(middle,
                       k == 0 ? 2 * size : size * std::array{0.15, 0.25, 0.35, 0.5}[static_cast<std::size_t>(k) % 4]);
  }
  parallel_for(context, proposals.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      std::vector<int> near;
      for (int i = 0; i < scored; ++i) {
        if ((Vector3d(few.points.row(i)) - balls[k].first).norm() <= balls[k].second) near.push_back(i);
      }
      const std::optional<RevolutionFit> fit =
          fit_axis_of_revolution(rows(few.points, near), rows(few.normals, near), {}, kNormalAngle);
      if (!fit || fit->planar) continue;
      proposals[k] = scored_axis(few, fit->axis, tolerance);
    }
  });
  context.check();
  std::ranges::stable_sort(proposals, std::greater<>(), &ProposedAxis::count);
  return proposals;
}

// Of the first few proposals and what improving them comes by.
ProposedAxis best_axis(const std::vector<ProposedAxis>& proposals, const ScoredPoints& few, double tolerance) {
  constexpr std::size_t kRefined = 5;
  ProposedAxis best;
  for (std::size_t k = 0; k < std::min(kRefined, proposals.size()); ++k) {
    if (proposals[k].count == 0) break;
    ProposedAxis current = proposals[k];
    if (current.count > best.count) best = current;
    for (int step = 0; step < 12; ++step) {
      // At first a loose band, so that a tilted axis finds what it misses.
      const double band = tolerance * std::max(1.0, 3.0 - 0.5 * step);
      const Profile profile(few.points, few.normals, current.axis, band, few.spacing);
      std::optional<Line> next = improved(profile, current.axis);
      if (!next) break;
      current = scored_axis(few, *next, tolerance);
      if (current.count > best.count) best = current;
    }
  }
  return best;
}

}  // namespace

PartialRevolution find_partial_revolution(const PointSurface& surface, const std::vector<int>& among, double tolerance,
                                          double least_share, const RunContext& context, std::string_view stream) {
  PartialRevolution result;
  const int total = static_cast<int>(among.size());
  if (total < 30) return result;
  Random random(context.seed, stream);
  const Points points = rows(surface.points, among);
  const Points normals = rows(surface.normals, among);
  const ScoredPoints few = some_of(points, normals, surface.spacing, random);
  const ProposedAxis best = best_axis(proposed_axes(few, diagonal(points), tolerance, random, context), few, tolerance);
  if (best.count == 0) return result;

  const Profile profile(points, normals, best.axis, tolerance, surface.spacing);
  result.arc = profile.arc();
  Vector3d centroid = Vector3d::Zero();
  double square = 0;
  for (int i = 0; i < total; ++i) {
    if (profile.belongs()[static_cast<std::size_t>(i)] == 0) continue;
    result.points.push_back(among[static_cast<std::size_t>(i)]);
    centroid += points.row(i);
    square += profile.offsets()[static_cast<std::size_t>(i)] * profile.offsets()[static_cast<std::size_t>(i)];
  }
  const double count = static_cast<double>(result.points.size());
  if (count < least_share * total || !profile.sound() || count < 30) return {};
  centroid /= count;
  result.axis = best.axis;
  result.axis.point += best.axis.direction * best.axis.direction.dot(centroid - best.axis.point);
  result.rms = std::sqrt(square / count);
  return result;
}

}  // namespace orbifit
