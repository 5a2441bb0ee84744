#include "orbifit/datasets_tools/symmetry_residual.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "measures/carried_motion.h"
#include "measures/part_pairing.h"
#include "measures/region_surface.h"
#include "measures/tested_elements.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

// A point maps onto a vertex when it comes this near, as a fraction of the diagonal.
constexpr double kOntoVertex = 1e-6;
// Points of each element from which the carried motions are fitted; all are measured.
constexpr int kMaxFitPoints = 600;
constexpr int kMinFitPoints = 60;
constexpr int kFitBudget = 200000;

}  // namespace

// All (p, g, q) of one region.
struct RegionPairs {
  std::vector<int> vertices;             // p
  std::vector<Motion> elements;          // g, told from the region's centre
  std::vector<SurfacePlace> places;      // q: of element e and vertex v at e * #vertices + v
  std::vector<Pairing::Choice> choices;  // what else q may be
};

namespace {

// Regions side by side, which then tell no progress.
void for_each_region(const RunContext& context, std::size_t count,
                     const std::function<void(std::size_t number, const RunContext& own)>& body) {
  RunContext own = context;
  own.on_progress = nullptr;
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i, own);
  });
}

RegionPairs pair_up(const Mesh& mesh, const Region& region, double tolerance, double rest_diagonal,
                    const RunContext& context) {
  RegionPairs pairs;
  if (region.faces.empty()) return pairs;
  const double reach = kOntoVertex * rest_diagonal;
  const RegionParts parts(mesh, region.faces, reach);
  const RegionSurface& surface = parts.whole();
  pairs.vertices = surface.vertices();
  pairs.elements = tested_elements(region, surface);
  const Index count = surface.positions().rows();
  Points images(count * static_cast<Index>(pairs.elements.size()), 3);
  std::vector<Motion> motions;
  for (std::size_t e = 0; e < pairs.elements.size(); ++e) {
    const Motion& g = pairs.elements[e];
    const Index row = static_cast<Index>(e) * count;
    const Vector3d shift = g.translation + region.centre;
    images.middleRows(row, count) =
        ((surface.positions().rowwise() - region.centre.transpose()) * g.linear.transpose()).rowwise() +
        shift.transpose();
    motions.push_back({g.linear, shift - g.linear * region.centre});
  }
  const double apart = std::max(tolerance, region.residual.max) * rest_diagonal;
  Pairing pairing = pair_parts(parts, parts, motions, images, apart, reach, context);
  pairs.places = std::move(pairing.places);
  pairs.choices = std::move(pairing.choices);
  return pairs;
}

// Of parts at one place the deformed ones tell which are images of which: takes what leaves the least.
// \return whether that changed anything
bool choose(const Mesh& deformed, const CarriedFrame& carried, RegionPairs& pairs) {
  bool changed = false;
  const std::size_t count = pairs.vertices.size();
  for (Pairing::Choice& choice : pairs.choices) {
    const auto squares = [&](const auto& place_of) {
      double sum = 0;
      for (std::size_t i = 0; i < choice.pairs.size(); ++i) {
        const std::size_t pair = choice.pairs[i];
        const Vector3d p = carried(deformed.vertices.row(pairs.vertices[pair % count]));
        sum += (pairs.elements[pair / count](p) - carried(place_of(i)(deformed))).squaredNorm();
      }
      return sum;
    };
    double least = squares([&](std::size_t i) { return pairs.places[choice.pairs[i]]; });
    for (std::vector<SurfacePlace>& other : choice.alternatives) {
      const double sum = squares([&](std::size_t i) { return other[i]; });
      if (sum >= least) continue;
      least = sum;
      changed = true;
      for (std::size_t i = 0; i < choice.pairs.size(); ++i) std::swap(pairs.places[choice.pairs[i]], other[i]);
    }
  }
  return changed;
}

// |g N y(p) - N y(q)| for all pairs, in mesh units.
Eigen::VectorXd distances(const Mesh& mesh, const RegionPairs& pairs, const CarriedFrame& carried,
                          const RunContext& context) {
  Eigen::VectorXd result(static_cast<Index>(pairs.places.size()));
  const std::size_t count = pairs.vertices.size();
  parallel_for(context, pairs.places.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end;) {
      const Motion& element = pairs.elements[i / count];
      for (std::size_t v = i % count; v < count && i < end; ++v, ++i) {
        const Vector3d p = carried(mesh.vertices.row(pairs.vertices[v]));
        const Vector3d q = carried(pairs.places[i](mesh));
        result[static_cast<Index>(i)] = (element(p) - q).norm();
      }
    }
  });
  return result;
}

Residual summary(const Eigen::VectorXd& values) {
  if (values.size() == 0) return {};
  return {std::sqrt(values.squaredNorm() / static_cast<double>(values.size())), values.maxCoeff()};
}

CarriedFrame at_rest(const Region& region) {
  return {Eigen::Matrix3d::Identity(), region.centre, Vector3d::Zero()};
}

RegionSample sample_of(const Mesh& deformed, const Region& region, const RegionPairs& pairs, int points) {
  RegionSample sample;
  sample.centre = region.centre;
  const std::size_t count = pairs.vertices.size();
  const std::size_t few = std::min(count, static_cast<std::size_t>(points));
  Random random(1, "fit points");
  for (std::size_t e = 0; e < pairs.elements.size(); ++e) {
    ElementSample element{pairs.elements[e], Points(static_cast<Index>(few), 3), Points(static_cast<Index>(few), 3)};
    for (std::size_t i = 0; i < few; ++i) {
      // One of each of `few` equal runs of the vertices: no regular step, which a regular mesh might answer.
      const double share = (static_cast<double>(i) + random.uniform()) / static_cast<double>(few);
      const std::size_t v =
          few == count ? i : std::min(count - 1, static_cast<std::size_t>(share * static_cast<double>(count)));
      element.p.row(static_cast<Index>(i)) = deformed.vertices.row(pairs.vertices[v]);
      element.q.row(static_cast<Index>(i)) = pairs.places[e * count + v](deformed);
    }
    sample.elements.push_back(std::move(element));
  }
  return sample;
}

// From the starts in turn, until one leaves nothing.
CarriedFit best_fit(const std::vector<RegionSample>& samples, CarriedMotions mode, double scale,
                    const std::vector<Motion>& starts) {
  CarriedFit best;
  for (const Motion& start : starts) {
    CarriedFit fit = fit_carried_frames(samples, mode, scale, start);
    if (best.frames.empty() || fit.energy < best.energy) best = std::move(fit);
    if (best.exact) break;
  }
  return best;
}

// A frame as a motion of space, from which another fit may start.
Motion as_motion(const CarriedFrame& frame, const Vector3d& centre) {
  return {frame.rotation, frame.offset + centre - frame.rotation * frame.pivot};
}

std::vector<CarriedFrame> carried_frames(const Mesh& mesh, const Mesh& deformed, const std::vector<Region>& regions,
                                         const std::vector<RegionPairs>& pairs, CarriedMotions motions,
                                         const RunContext& context) {
  std::vector<CarriedFrame> frames;
  frames.reserve(regions.size());
  for (const Region& region : regions) frames.push_back(at_rest(region));
  if (motions == CarriedMotions::fixed) return frames;

  std::vector<std::size_t> measured;
  std::size_t elements = 0;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (!pairs[r].places.empty()) measured.push_back(r);
    elements += pairs[r].elements.size();
  }
  if (measured.empty() || elements == 0) return frames;
  const int points = std::clamp(kFitBudget / static_cast<int>(elements), kMinFitPoints, kMaxFitPoints);
  std::vector<RegionSample> samples;
  samples.reserve(measured.size());
  for (const std::size_t r : measured) samples.push_back(sample_of(deformed, regions[r], pairs[r], points));

  const double scale = diagonal(deformed.vertices);
  const std::vector<Motion> starts{best_rigid_motion(deformed.vertices, mesh.vertices), Motion{}};
  const CarriedMotions common = motions == CarriedMotions::posed ? motions : CarriedMotions::floating;
  const CarriedFit together = best_fit(samples, common, scale, starts);
  for (std::size_t i = 0; i < measured.size(); ++i) frames[measured[i]] = together.frames[i];
  if (motions != CarriedMotions::moving) return frames;

  context.progress("carried motions", 0);
  for_each_region(context, measured.size(), [&](std::size_t i, const RunContext&) {
    const std::size_t r = measured[i];
    const Points from = deformed.vertices(pairs[r].vertices, Eigen::all);
    const Points to = mesh.vertices(pairs[r].vertices, Eigen::all);
    std::vector<Motion> own_starts{as_motion(together.frames[i], regions[r].centre), best_rigid_motion(from, to)};
    own_starts.insert(own_starts.end(), starts.begin(), starts.end());
    frames[r] = best_fit({samples[i]}, motions, scale, own_starts).frames.front();
  });
  return frames;
}

// A mesh and its diagonal.
struct Shape {
  explicit Shape(const Mesh& given) : mesh(given), size(diagonal(given.vertices)) {}

  const Mesh& mesh;
  double size;
};

// \param deformed  null: at rest alone
RegionResidual region_residual(const Shape& rest, const Shape* deformed, const Region& region, const RegionPairs& pairs,
                               const CarriedFrame& carried, const RunContext& context, Eigen::VectorXd& vertex_excess) {
  RegionResidual result;
  result.id = region.id;
  result.name = region.name;
  result.group = region.group.symbol();
  result.vertices = static_cast<int>(pairs.vertices.size());
  result.pairs = static_cast<int>(pairs.places.size());
  result.mapped = static_cast<int>(std::ranges::count_if(pairs.places, [](const auto& q) { return q.vertex >= 0; }));
  const Eigen::VectorXd floor = distances(rest.mesh, pairs, at_rest(region), context) / rest.size;
  result.floor = summary(floor);
  Eigen::VectorXd ranked = floor;
  if (deformed != nullptr) {
    ranked = distances(deformed->mesh, pairs, carried, context) / deformed->size;
    result.deformed = summary(ranked);
    const Eigen::VectorXd excess = (ranked - floor).cwiseMax(0);
    result.excess = summary(excess);
    for (Index i = 0; i < excess.size(); ++i) {
      double& most = vertex_excess[pairs.vertices[static_cast<std::size_t>(i) % pairs.vertices.size()]];
      most = std::max(most, excess[i]);
    }
  }
  if (ranked.size() > 0) {
    Index worst = 0;
    ranked.maxCoeff(&worst);
    result.worst_vertex = pairs.vertices[static_cast<std::size_t>(worst) % pairs.vertices.size()];
  }
  return result;
}

PatternResidual pattern_residual(const Mesh& mesh, const Mesh* deformed, const Pattern& pattern, double tolerance,
                                 const RunContext& context) {
  PatternResidual result;
  result.id = pattern.id;
  result.name = pattern.name;
  if (pattern.instances.empty() || pattern.instances.front().faces.empty()) return result;
  const double rest_diagonal = diagonal(mesh.vertices);
  const double deformed_diagonal = deformed != nullptr ? diagonal(deformed->vertices) : 0;
  const double reach = kOntoVertex * rest_diagonal;
  const double apart = std::max(tolerance, pattern.residual.max) * rest_diagonal;
  const RegionParts first_parts(mesh, pattern.instances.front().faces, reach);
  const RegionSurface& first = first_parts.whole();
  const Motion back = inverse(pattern.instances.front().motion);
  double floor_sum = 0;
  double deformed_sum = 0;
  double count = 0;
  for (std::size_t j = 1; j < pattern.instances.size(); ++j) {
    const PatternInstance& instance = pattern.instances[j];
    if (instance.faces.empty()) continue;
    const Motion motion = instance.motion * back;
    const Points images = (first.positions() * motion.linear.transpose()).rowwise() + motion.translation.transpose();
    const RegionParts parts(mesh, instance.faces, reach);
    const std::vector<SurfacePlace> places =
        pair_parts(first_parts, parts, {motion}, images, apart, reach, context).places;
    Points from(images.rows(), 3);
    Points to(images.rows(), 3);
    for (Index i = 0; i < images.rows(); ++i) {
      const SurfacePlace& place = places[static_cast<std::size_t>(i)];
      const double distance = (place(mesh) - images.row(i).transpose()).norm() / rest_diagonal;
      floor_sum += distance * distance;
      result.floor.max = std::max(result.floor.max, distance);
      if (deformed == nullptr) continue;
      // A mirrored copy is mirrored first: what remains is a rotation.
      from.row(i) = motion.linear * deformed->vertices.row(first.vertices()[static_cast<std::size_t>(i)]).transpose();
      to.row(i) = place(*deformed);
    }
    count += static_cast<double>(images.rows());
    if (deformed == nullptr) continue;
    // Means first: the motion then turns about the part's own middle.
    const Eigen::RowVector3d from_mean = from.colwise().mean();
    const Eigen::RowVector3d to_mean = to.colwise().mean();
    from.rowwise() -= from_mean;
    to.rowwise() -= to_mean;
    const Motion best = best_rigid_motion(from, to);
    const Points rest =
        ((from * best.linear.transpose()).rowwise() + best.translation.transpose() - to) / deformed_diagonal;
    deformed_sum += rest.squaredNorm();
    result.deformed.max = std::max(result.deformed.max, rest.rowwise().norm().maxCoeff());
  }
  if (count > 0) {
    result.floor.rms = std::sqrt(floor_sum / count);
    result.deformed.rms = std::sqrt(deformed_sum / count);
  }
  return result;
}

}  // namespace

namespace {

void require_same_connectivity(const Mesh& mesh, const Mesh* deformed) {
  if (deformed != nullptr && (deformed->vertices.rows() != mesh.vertices.rows() ||
                              deformed->faces.rows() != mesh.faces.rows() || deformed->faces != mesh.faces)) {
    throw InputError("", "deformed mesh",
                     "has " + std::to_string(deformed->vertices.rows()) + " vertices and " +
                         std::to_string(deformed->faces.rows()) +
                         " faces; its connectivity must be that of the mesh, " + std::to_string(mesh.vertices.rows()) +
                         " vertices and " + std::to_string(mesh.faces.rows()) + " faces");
  }
}

}  // namespace

struct SymmetryPairs::OfRegions {
  std::vector<RegionPairs> pairs;
};

SymmetryPairs::SymmetryPairs(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context)
    : mesh_(mesh), annotation_(annotation) {
  const double size = diagonal(mesh.vertices);
  auto of_regions = std::make_unique<OfRegions>();
  of_regions->pairs.resize(annotation.regions.size());
  context.progress("pairs", 0);
  for_each_region(context, annotation.regions.size(), [&](std::size_t r, const RunContext& own) {
    of_regions->pairs[r] = pair_up(mesh, annotation.regions[r], annotation.tolerance, size, own);
  });
  pairs_ = std::move(of_regions);
}

SymmetryPairs::SymmetryPairs(SymmetryPairs&&) noexcept = default;
SymmetryPairs::~SymmetryPairs() = default;

SymmetryReport symmetry_residual(const Mesh& mesh, const SymmetryAnnotation& annotation, const Mesh* deformed,
                                 CarriedMotions motions, RunContext& context) {
  require_same_connectivity(mesh, deformed);
  return SymmetryPairs(mesh, annotation, context).residual(deformed, motions, context);
}

SymmetryReport SymmetryPairs::residual(const Mesh* deformed, CarriedMotions motions, const RunContext& context) const {
  require_same_connectivity(mesh_, deformed);
  const Mesh& mesh = mesh_;
  const SymmetryAnnotation& annotation = annotation_;
  const Shape rest(mesh);
  std::optional<Shape> now;
  if (deformed != nullptr) now.emplace(*deformed);
  const bool open = std::ranges::any_of(pairs_->pairs, [](const RegionPairs& each) { return !each.choices.empty(); });
  std::vector<RegionPairs> chosen;  // of parts at one place others may be chosen
  if (open) chosen = pairs_->pairs;
  const std::vector<RegionPairs>& pairs = open ? chosen : pairs_->pairs;
  std::vector<CarriedFrame> frames(annotation.regions.size());
  constexpr int kRounds = 4;  // of frames and choices, each of which rests on the other
  for (int round = 0; deformed != nullptr && round < kRounds; ++round) {
    frames = carried_frames(mesh, *deformed, annotation.regions, pairs, motions, context);
    bool changed = false;
    for (std::size_t r = 0; r < chosen.size(); ++r) changed = choose(*deformed, frames[r], chosen[r]) || changed;
    if (!changed) break;
  }

  SymmetryReport report;
  report.vertices_onto_vertices = true;
  report.vertex_excess.setZero(mesh.vertices.rows());
  for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
    const RegionResidual& region = report.regions.emplace_back(region_residual(
        rest, now ? &*now : nullptr, annotation.regions[r], pairs[r], frames[r], context, report.vertex_excess));
    report.vertices_onto_vertices = report.vertices_onto_vertices && region.mapped == region.pairs;
    report.worst_floor = std::max(report.worst_floor, region.floor.max);
    report.worst_deformed = std::max(report.worst_deformed, region.deformed.max);
    report.worst_excess = std::max(report.worst_excess, region.excess.max);
  }
  for (const Pattern& pattern : annotation.patterns) {
    report.patterns.push_back(pattern_residual(mesh, deformed, pattern, annotation.tolerance, context));
  }
  return report;
}

}  // namespace orbifit
