#include "evidence/truthful.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "domains/region_residual.h"
#include "evidence/policy.h"
#include "surface/near_cells.h"
#include "surface/surface_grid.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kGridReach = 1.75;          // reaches of a SurfaceGrid beyond which it holds nothing
constexpr double kMinGridReach = 1.0 / 400;  // of the diagonal: a SurfaceGrid's least

// One set of faces onto which others are taken. `given`: as it was before faces were taken out.
class Target {
 public:
  Target(const PreparedMesh& prepared, const std::vector<int>& faces, const std::vector<int>& given,
         const Region* region, double tolerance)
      : prepared_(prepared),
        tolerance_(tolerance),
        surface_(prepared.index->part(faces)),
        distance_(prepared.mesh, *prepared.index, surface_, given, region) {
    if (tolerance / kGridReach >= kMinGridReach) grid_.emplace(prepared, faces, tolerance / kGridReach);
  }

  bool holds(const FacePoints& points, std::size_t i, const Motion& motion) const {
    const Vector3d point = points.points.row(static_cast<Eigen::Index>(i));
    const Vector3d normal = prepared_.normals.row(points.face[i]);
    if (grid_ && grid_->holds(motion(point), motion.linear * normal)) return true;
    return distance_.within(point, points.face[i], motion, tolerance_);
  }

 private:
  const PreparedMesh& prepared_;
  double tolerance_;
  SurfaceIndex surface_;
  RegionDistance distance_;
  std::optional<SurfaceGrid> grid_;
};

// By point: whether all motions take it onto the target. \param near where something has changed since the last answer,
// by which all others were held; null: everywhere
std::vector<char> held_points(const Target& target, const FacePoints& points, const std::vector<Motion>& motions,
                              const NearCells* near, const RunContext& context) {
  std::vector<char> held(points.face.size(), 1);
  parallel_for(
      context, held.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Vector3d point = points.points.row(static_cast<Eigen::Index>(i));
          held[i] = std::ranges::all_of(motions, [&](const Motion& motion) {
            return (near != nullptr && !near->may_reach(motion(point))) || target.holds(points, i, motion);
          });
        }
      },
      64);
  context.check();
  return held;
}

// Takes out the faces with a point that is not held. \return those taken out, ascending
std::vector<int> take_out(const FacePoints& points, const std::vector<char>& held, std::vector<int>& faces) {
  std::vector<int> out;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] != 0) continue;
    out.insert(out.end(), points.faces.begin() + points.first[i], points.faces.begin() + points.first[i + 1]);
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  std::erase_if(faces, [&](int face) { return std::ranges::binary_search(out, face); });
  return out;
}

// Faces of the mesh onto which motions take points of the region, though they are not of it: a region has gaps where a
// search that puts it together of pieces has missed small ones.
std::vector<int> faces_in_gaps(const PreparedMesh& prepared, const FacePoints& points, const std::vector<char>& held,
                               const std::vector<Motion>& motions, const std::vector<int>& faces, double tolerance) {
  std::vector<int> result;
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] != 0) continue;
    const Vector3d point = points.points.row(static_cast<Eigen::Index>(i));
    const Vector3d normal = prepared.normals.row(points.face[i]);
    for (const Motion& motion : motions) {
      const SurfaceIndex::Nearest nearest =
          prepared.index->nearest_facing(motion(point), motion.linear * normal, kNearNormals, tolerance);
      if (nearest.face >= 0 && !std::ranges::binary_search(faces, nearest.face)) result.push_back(nearest.face);
    }
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

bool keeps_enough(double before, double after) {
  return after > 0 && after >= EvidencePolicy{}.min_left * before;
}

enum class Outcome { unchanged, trimmed, lost };

Outcome trim(const PreparedMesh& prepared, Region& region, double tolerance, const RunContext& context) {
  const std::vector<Motion> motions = judged_motions(region);
  const double before = area_of(prepared, region.faces);
  std::vector<int> given = region.faces;
  FacePoints points = face_points(prepared.mesh, region.faces, 1);
  std::vector<char> held =
      held_points(Target(prepared, region.faces, given, &region, tolerance), points, motions, nullptr, context);
  if (std::ranges::find(held, 0) == held.end()) return Outcome::unchanged;
  const std::vector<int> gaps = faces_in_gaps(prepared, points, held, motions, region.faces, tolerance);
  if (!gaps.empty() && area_of(prepared, gaps) <= EvidencePolicy{}.max_gaps * before) {
    std::vector<int> filled;
    std::ranges::set_union(region.faces, gaps, std::back_inserter(filled));
    region.faces = given = std::move(filled);
    points = face_points(prepared.mesh, region.faces, 1);
    held = held_points(Target(prepared, region.faces, given, &region, tolerance), points, motions, nullptr, context);
  }
  for (int round = 0; round < EvidencePolicy{}.max_rounds; ++round) {
    const std::vector<int> out = take_out(points, held, region.faces);
    if (out.empty()) return Outcome::trimmed;
    if (!keeps_enough(before, area_of(prepared, region.faces))) break;
    points = face_points(prepared.mesh, region.faces, 1);
    const NearCells near(prepared, out, tolerance);
    held = held_points(Target(prepared, region.faces, given, &region, tolerance), points, motions, &near, context);
  }
  return Outcome::lost;
}

Outcome trim(const PreparedMesh& prepared, Pattern& pattern, double tolerance, const RunContext& context) {
  std::vector<PatternInstance>& instances = pattern.instances;
  std::vector<std::vector<int>> given;
  for (const PatternInstance& instance : instances) given.push_back(instance.faces);
  const Motion from_first = inverse(instances.front().motion);
  const auto keep = [&](const Target& target, const Motion& motion, std::vector<int>& faces) {
    const FacePoints points = face_points(prepared.mesh, faces, 1);
    return take_out(points, held_points(target, points, {motion}, nullptr, context), faces).empty();
  };
  for (int round = 0; round < EvidencePolicy{}.max_rounds; ++round) {
    bool changed = false;
    std::vector<int> first = instances.front().faces;
    const Target first_target(prepared, first, given.front(), nullptr, tolerance);
    for (std::size_t j = 1; j < instances.size(); ++j) {
      const Motion motion = instances[j].motion * from_first;
      const Target target(prepared, instances[j].faces, given[j], nullptr, tolerance);
      changed = !keep(target, motion, first) || changed;
      changed = !keep(first_target, inverse(motion), instances[j].faces) || changed;
    }
    instances.front().faces = std::move(first);
    if (!changed) return round == 0 ? Outcome::unchanged : Outcome::trimmed;
    for (std::size_t j = 0; j < instances.size(); ++j) {
      if (!keeps_enough(area_of(prepared, given[j]), area_of(prepared, instances[j].faces))) return Outcome::lost;
    }
  }
  return Outcome::lost;
}

template <typename Item, typename Describe>
bool trim_all(const PreparedMesh& prepared, std::vector<Item>& items, double tolerance, const Describe& describe,
              Explanation* explanation, const RunContext& context) {
  bool changed = false;
  std::vector<Item> kept;
  for (Item& item : items) {
    const Outcome outcome = trim(prepared, item, tolerance, context);
    changed = changed || outcome != Outcome::unchanged;
    if (outcome != Outcome::lost) {
      kept.push_back(std::move(item));
    } else if (explanation != nullptr) {
      explanation->notes.push_back(
          {"truthful", describe(item), false, "too little of it is within the tolerance under every element"});
    }
  }
  items = std::move(kept);
  return changed;
}

Similarity normalised_of_input(const PreparedMesh& prepared) {
  return inverse(prepared.input_of_normalised);
}

}  // namespace

bool make_truthful(const PreparedMesh& prepared, SymmetryAnnotation& annotation, Explanation* explanation,
                   const RunContext& context) {
  context.progress("truthful", 0);
  SymmetryAnnotation local = transformed(annotation, normalised_of_input(prepared));
  const bool regions = trim_all(
      prepared, local.regions, annotation.tolerance,
      [](const Region& region) { return region.group.symbol() + " on " + region.name; }, explanation, context);
  const bool patterns = trim_all(
      prepared, local.patterns, annotation.tolerance,
      [](const Pattern& pattern) { return to_string(pattern.kind) + " of " + pattern.name; }, explanation, context);
  if (!regions && !patterns) return false;
  // Motions stay as they are in the mesh's own frame, to the last digit.
  const auto take_faces = [](auto& items, auto& trimmed, const auto& copy) {
    std::size_t next = 0;
    std::erase_if(items, [&](auto& item) {
      if (next == trimmed.size() || trimmed[next].id != item.id) return true;
      copy(trimmed[next++], item);
      return false;
    });
  };
  take_faces(annotation.regions, local.regions, [](Region& from, Region& to) { to.faces = std::move(from.faces); });
  take_faces(annotation.patterns, local.patterns, [](Pattern& from, Pattern& to) {
    for (std::size_t j = 0; j < to.instances.size(); ++j) to.instances[j].faces = std::move(from.instances[j].faces);
  });
  set_parents(annotation.regions);
  return true;
}

void measure_residuals(const PreparedMesh& prepared, SymmetryAnnotation& annotation, const RunContext& context) {
  const SymmetryAnnotation local = transformed(annotation, normalised_of_input(prepared));
  for (std::size_t i = 0; i < local.regions.size(); ++i) {
    annotation.regions[i].residual =
        region_residual(prepared.mesh, *prepared.index, local.regions[i], annotation.tolerance, 1, context);
  }
  for (std::size_t i = 0; i < local.patterns.size(); ++i) {
    annotation.patterns[i].residual =
        pattern_residual(prepared.mesh, *prepared.index, local.patterns[i], annotation.tolerance, 1, context);
  }
}

}  // namespace orbifit
