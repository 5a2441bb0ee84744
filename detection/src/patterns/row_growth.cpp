#include "patterns/row_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "group/patterns.h"
#include "patterns/row_step.h"
#include "surface/face_points.h"
#include "surface/face_sides.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kMaxPlaces = 200;

/// Parts that a step repeats.
class RowSearch {
 public:
  RowSearch(const PreparedMesh& prepared, const RowStep& step, double tolerance, const RunContext& context)
      : prepared_(prepared),
        tolerance_(tolerance),
        context_(context),
        step_(step),
        most_(step_.places(kMaxPlaces)),
        lengths_(static_cast<std::size_t>(prepared.mesh.faces.rows()), 0) {}

  // The part that covers most, at its first place, and its number of places; none where nothing repeats often enough.
  struct Part {
    std::vector<int> faces;
    int places = 0;
    double area = 0;  // of all places
  };
  Part part() {
    if (!step_.proper()) return {};
    parallel_for(context_, lengths_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        if (f % 256 == 0) context_.check();
        lengths_[f] = length(static_cast<int>(f));
      }
    });
    Part best;
    for (const std::vector<int>& part : first_parts()) {
      const int count = common_length(part);
      std::vector<int> unit;
      std::ranges::copy_if(part, std::back_inserter(unit), [&](int f) { return lengths_[number(f)] >= count; });
      const double area = count * area_of(prepared_, unit);
      if (area > best.area) best = {std::move(unit), count, area};
    }
    return best;
  }

  // The faces of the part at each of its places.
  std::vector<std::vector<int>> instances(const Part& part) const {
    const std::vector<int>& unit = part.faces;
    const SurfaceIndex surface(prepared_.mesh, unit);
    const SurfaceMoments moments = surface_moments(prepared_, unit);
    std::vector<Motion> back;
    back.reserve(static_cast<std::size_t>(part.places));
    for (int k = 0; k < part.places; ++k) back.push_back(inverse(step_.times(k)));
    std::vector<std::vector<int>> faces(back.size());
    for (int f = 0; f < static_cast<int>(lengths_.size()); ++f) {
      if (prepared_.areas[f] <= 0) continue;
      if (f % 256 == 0) context_.check();
      const Vector3d centroid = face_centroid(prepared_, f);
      for (std::size_t k = 0; k < back.size(); ++k) {
        const Vector3d at = back[k](centroid);
        if ((at - moments.centroid).norm() > moments.radius + tolerance_) continue;
        const Vector3d normal = back[k].linear * prepared_.normals.row(f).transpose();
        if (!surface.within_facing(at, normal, kAlikeNormals, tolerance_)) continue;
        faces[k].push_back(f);
        break;
      }
    }
    return faces;
  }

 private:
  static std::size_t number(int face) { return static_cast<std::size_t>(face); }

  bool on_surface(const Motion& motion, int face) const {
    const Vector3d normal = motion.linear * prepared_.normals.row(face).transpose();
    return most_of_face(prepared_, face, [&](const Vector3d& point) {
      return prepared_.index->within_facing(motion(point), normal, kAlikeNormals, tolerance_);
    });
  }

  // Whether the face stays on the surface most of the way to the next place.
  bool slides(int face) const {
    constexpr int kParts = 8;
    constexpr int kMax = 4;  // of the places between
    int on = 0;
    for (int k = 1; k < kParts; ++k) on += on_surface(step_.times(static_cast<double>(k) / kParts), face) ? 1 : 0;
    return on > kMax;
  }

  // Of a face at the first of several places: at how many in a row the surface has it. 0 for all others.
  int length(int face) const {
    if (prepared_.areas[face] <= 0 || !on_surface(step_.times(1), face) || on_surface(step_.times(-1), face)) return 0;
    if (slides(face)) return 0;
    int count = 2;
    while (count < most_ && on_surface(step_.times(count), face)) ++count;
    return count >= kMin ? count : 0;
  }

  // Faces at first places that hang together.
  std::vector<std::vector<int>> first_parts() const {
    const std::vector<std::array<FaceSide, 3>> sides = face_sides(prepared_);
    std::vector<char> seen(sides.size(), 0);
    std::vector<std::vector<int>> parts;
    for (std::size_t seed = 0; seed < sides.size(); ++seed) {
      if (lengths_[seed] == 0 || seen[seed] != 0) continue;
      seen[seed] = 1;
      std::vector<int> part{static_cast<int>(seed)};
      for (std::size_t i = 0; i < part.size(); ++i) {
        for (const FaceSide& side : sides[number(part[i])]) {
          if (side.face < 0 || lengths_[number(side.face)] == 0 || seen[number(side.face)] != 0) continue;
          seen[number(side.face)] = 1;
          part.push_back(side.face);
        }
      }
      std::ranges::sort(part);
      parts.push_back(std::move(part));
    }
    return parts;
  }

  // The most places that nearly all of the part has.
  int common_length(const std::vector<int>& part) const {
    std::vector<std::pair<int, double>> areas;  // by length
    double all = 0;
    for (const int f : part) {
      areas.emplace_back(lengths_[number(f)], prepared_.areas[f]);
      all += prepared_.areas[f];
    }
    std::ranges::sort(areas);
    double less = 0;
    for (const auto& [count, area] : areas) {
      less += area;
      if (less > (1 - kKeptOfCopy) * all) return count;
    }
    return 0;
  }

  static constexpr int kMin = 3;  // places

  const PreparedMesh& prepared_;
  double tolerance_;
  const RunContext& context_;
  RowStep step_;
  int most_;
  std::vector<int> lengths_;  // by face, see length()
};

// The pattern of these instances, the first of them the first; nothing where one is no copy of it.
std::optional<Pattern> judged(const PreparedMesh& prepared, const Pattern& pattern, const RowStep& step,
                              std::vector<std::vector<int>> faces, double tolerance, const RunContext& context) {
  constexpr int kSamples = 300;
  constexpr double kAlike = 0.15;  // of the area
  const SurfacePatch patch = make_patch(prepared, faces.front(), kSamples, tolerance, context, "row");
  Pattern result = pattern;
  result.instances.clear();
  double square = 0;
  double largest = 0;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Motion motion = step.times(static_cast<double>(k));
    const double area = area_of(prepared, faces[k]);
    if (std::abs(area - patch.moments.area) > kAlike * patch.moments.area) return std::nullopt;
    const CopyFit fit = fit_of_copy(patch, motion, faces[k]);
    if (fit.kept < kKeptOfCopy) return std::nullopt;
    square += fit.square;
    largest = std::max(largest, fit.largest);
    result.instances.push_back(
        {k == 0 ? Motion{} : conjugate(prepared.input_of_normalised, motion), std::move(faces[k])});
  }
  const auto count = static_cast<double>(patch.samples.points.rows()) * static_cast<double>(faces.size());
  result.residual = {std::sqrt(square / std::max(count, 1.0)), largest};
  return result;
}

}  // namespace

std::optional<Pattern> grown_row(const PreparedMesh& prepared, const Pattern& pattern, double tolerance,
                                 const RunContext& context) {
  constexpr double kGain = 1.1;
  constexpr int kRounds = 4;
  if (pattern.generators.size() != 1 || pattern.instances.size() < 3) return std::nullopt;
  RowStep step(conjugate(inverse(prepared.input_of_normalised), pattern.generators.front()));
  double area = 0;
  std::vector<std::vector<int>> faces;
  // A step known better reaches farther, and what it reaches says better what it is.
  for (int round = 0; round < kRounds; ++round) {
    const RowStep better =
        round == 0 ? step : refined_step(prepared, step, faces.front(), static_cast<int>(faces.size()), tolerance);
    RowSearch search(prepared, better, tolerance, context);
    const RowSearch::Part part = search.part();
    if (part.area <= area) break;
    area = part.area;
    step = better;
    faces = search.instances(part);
  }
  if (faces.empty()) return std::nullopt;
  double before = 0;
  double after = 0;
  for (const PatternInstance& instance : pattern.instances) before += area_of(prepared, instance.faces);
  for (const std::vector<int>& each : faces) after += area_of(prepared, each);
  if (after < kGain * before) return std::nullopt;
  Pattern result = pattern;
  result.generators.front() = conjugate(prepared.input_of_normalised, step.times(1));
  return judged(prepared, result, step, std::move(faces), tolerance, context);
}

}  // namespace orbifit
