#include "remeshing/demands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include <Eigen/Geometry>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "remeshing/indices.h"
#include "symmetry/generating_set.h"
#include "symmetry/turning_group.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

// Shares of a component's area: less is none of it, more is all of it. Detection leaves out faces that miss the
// tolerance.
constexpr double kNone = 0.1;
constexpr double kAll = 0.9;
constexpr int kScored = 2000;  // points of a region, each under every element
constexpr int kMaxOrder = 64;  // of rotations that stand for a continuous group
constexpr int kMinOrder = 8;
constexpr double kSamePlace = 1e-9;  // of the diagonal, and of 1: what a consistent annotation leaves
constexpr double kOnAxis = 1e-6;     // of the diagonal: nearer to it a vertex has no angle about it
constexpr double kVertex = 0.1;      // of a typical edge: an image as near as this to a vertex is that vertex

class DemandSearch {
 public:
  DemandSearch(const Mesh& mesh, const Components& components, const SymmetryAnnotation& annotation, double min_score,
               const RunContext& context)
      : mesh_(mesh),
        components_(components),
        annotation_(annotation),
        min_score_(min_score),
        context_(context),
        areas_(face_areas(mesh)),
        normals_(face_normals(mesh)),
        scale_(diagonal(mesh.vertices)) {
    for (const std::vector<int>& faces : components.faces) {
      double sum = 0;
      for (const int f : faces) sum += areas_[f];
      component_areas_.push_back(sum);
    }
    for (const Region& region : annotation.regions) {
      known_.insert(known_.end(), region.elements.begin(), region.elements.end());
    }
    for (const Pattern& pattern : annotation.patterns) {
      for (const PatternInstance& instance : pattern.instances) {
        known_.push_back(instance.motion);
        known_.push_back(inverse(instance.motion));
      }
    }
  }

  AnnotationDemands run() {
    for (const Region& region : annotation_.regions) add_region(region);
    for (const Pattern& pattern : annotation_.patterns) add_pattern(pattern);
    return std::move(result_);
  }

 private:
  // The components that a set of faces holds, or nothing where it holds a part of one.
  std::optional<std::vector<int>> whole_components(const std::vector<int>& faces) const {
    std::vector<double> held(components_.faces.size(), 0);
    for (const int f : faces) held[at(components_.component_of_face[at(f)])] += areas_[f];
    std::vector<int> result;
    for (std::size_t c = 0; c < held.size(); ++c) {
      if (held[c] <= kNone * component_areas_[c]) continue;
      if (held[c] < kAll * component_areas_[c]) return std::nullopt;
      result.push_back(static_cast<int>(c));
    }
    if (result.empty()) return std::nullopt;
    return result;
  }

  std::vector<int> faces_of(const std::vector<int>& components) const {
    std::vector<int> faces;
    for (const int c : components)
      faces.insert(faces.end(), components_.faces[at(c)].begin(), components_.faces[at(c)].end());
    std::ranges::sort(faces);
    return faces;
  }

  void add_region(const Region& region) {
    result_.finite.push_back(region);
    SymmetricRemeshItem item{false, region.id, region.name, region.group.symbol(), "", 0, ""};
    Demand demand;
    const auto whole = whole_components(region.faces);
    const auto finite = whole ? finite_region(region, *whole) : std::nullopt;
    if (!whole) {
      item.reason = "it is a part of a connected component";
    } else if (!finite) {
      item.reason = "no finite group stands for its continuous one beside the regions that share its components";
    } else {
      item.score = score(faces_of(*whole), finite->elements);
      if (item.score < min_score_) refuse(item);
      item.kept_as = finite->group.symbol();
      result_.finite.back() = *finite;
      known_.insert(known_.end(), finite->elements.begin(), finite->elements.end());
      for (const Motion& generator : generating_set(*finite)) demand.motions.push_back({generator, *whole, *whole});
    }
    result_.items.push_back(std::move(item));
    result_.demands.push_back(std::move(demand));
    result_.components.push_back({whole.value_or(std::vector<int>{})});
  }

  void refuse(const SymmetricRemeshItem& item) const {
    std::ostringstream text;
    text.precision(3);
    text << "region " << item.id << " \"" << item.name << "\" (" << item.group << "): only " << 100 * item.score
         << " % of its surface lies on itself under every element, less than the " << 100 * min_score_
         << " % asked for";
    throw NoResultError(text.str());
  }

  double score(const std::vector<int>& faces, const std::vector<Motion>& elements) const {
    const SurfaceIndex index(mesh_, faces);
    Random random(context_.seed);
    const int count = std::max(100, kScored / static_cast<int>(elements.size()) * 4);
    const SurfaceSamples samples = sample_surface(mesh_, areas_, normals_, count, random, faces);
    const double reach = annotation_.tolerance * scale_;
    int good = 0;
    for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
      const Vector3d point = samples.points.row(i).transpose();
      good += std::ranges::all_of(elements, [&](const Motion& e) { return index.within(e(point), reach); }) ? 1 : 0;
    }
    return static_cast<double>(good) / static_cast<double>(samples.points.rows());
  }

  std::optional<Region> finite_region(const Region& region, const std::vector<int>& whole) const {
    if (!region.group.continuous()) return region;
    if (const auto related = related_region(region)) return related;
    const std::vector<int> vertices = vertices_of_faces(mesh_, region.faces);
    const Points places = mesh_.vertices(vertices, Eigen::all);
    const double edge = typical_edge(region.faces);
    // Vertices that a rotation takes to vertices, not only near to some: what is thinner than the tolerance is
    // invariant under any.
    const double reach = std::min(2 * annotation_.tolerance * scale_, kVertex * edge);
    const auto turning = turning_region(region, places, reach, known_);
    // Off the axis an orbit has as many places as there are rotations: on thin parts finer ones may seem to fit.
    if (turning && turning->group.n <= static_cast<int>(places.rows())) return turning;
    return alone(region, whole) ? chosen_group(region) : std::nullopt;
  }

  // With the group that an earlier region has, where a motion takes that one here: images get one another's groups.
  std::optional<Region> related_region(const Region& region) const {
    for (std::size_t i = 0; i < result_.items.size() && i < annotation_.regions.size(); ++i) {
      const Region& from = result_.finite[i];
      if (annotation_.regions[i].group != region.group || result_.items[i].kept_as.empty()) continue;
      if (from.faces.size() != region.faces.size()) continue;
      for (const Motion& motion : known_) {
        if ((motion(from.centre) - region.centre).norm() > kSamePlace * scale_) continue;
        if ((motion.linear * from.axis).cross(region.axis).norm() > kSamePlace) continue;
        Region result = region;
        result.group = from.group;
        result.generators.clear();
        result.elements.clear();
        for (const Motion& generator : from.generators) result.generators.push_back(conjugate(motion, generator));
        for (const Motion& element : from.elements) result.elements.push_back(conjugate(motion, element));
        return result;
      }
    }
    return std::nullopt;
  }

  // Mean of the triangles' shortest sides.
  double typical_edge(const std::vector<int>& faces) const {
    double sum = 0;
    for (const int f : faces) {
      double shortest = scale_;
      for (int k = 0; k < 3; ++k) {
        const auto side = mesh_.vertices.row(mesh_.faces(f, k)) - mesh_.vertices.row(mesh_.faces(f, (k + 1) % 3));
        shortest = std::min(shortest, side.norm());
      }
      sum += shortest;
    }
    return sum / static_cast<double>(faces.size());
  }

  // Whether no other region or pattern of whole components holds any of these.
  bool alone(const Region& region, const std::vector<int>& whole) const {
    const std::vector<int> faces = faces_of(whole);
    const auto apart = [&](const std::vector<int>& others) {
      return !whole_components(others) ||
             std::ranges::none_of(others, [&](int f) { return std::ranges::binary_search(faces, f); });
    };
    for (const Region& other : annotation_.regions) {
      if (&other != &region && !apart(other.faces)) return false;
    }
    for (const Pattern& pattern : annotation_.patterns) {
      for (const PatternInstance& instance : pattern.instances) {
        if (!apart(instance.faces)) return false;
      }
    }
    return true;
  }

  // The angle about the axis from one vertex to the next: of the triangles' widest ones the mean by area.
  double step_about_axis(const Region& region) const {
    double sum = 0;
    double area = 0;
    for (const int f : region.faces) {
      std::array<Vector3d, 3> across;
      for (int k = 0; k < 3; ++k) {
        const Vector3d from_centre = mesh_.vertices.row(mesh_.faces(f, k)).transpose() - region.centre;
        across[static_cast<std::size_t>(k)] = from_centre - region.axis.dot(from_centre) * region.axis;
      }
      double widest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d& a = across[k];
        const Vector3d& b = across[(k + 1) % 3];
        if (!(a.norm() > kOnAxis * scale_ && b.norm() > kOnAxis * scale_)) continue;
        widest = std::max(widest, std::atan2(a.cross(b).norm(), a.dot(b)));
      }
      sum += areas_[f] * widest;
      area += areas_[f];
    }
    return area > 0 ? sum / area : 0;
  }

  // Of the same kind, with as many rotations as the tessellation has steps about the axis, so that there are about as
  // many triangles as before.
  std::optional<Region> chosen_group(const Region& region) const {
    using Family = PointGroup::Family;
    const double turns = 2 * std::numbers::pi / std::max(step_about_axis(region), 1e-3);
    // Powers of two have one another's rotations, and an even order has half turns in its mirrors.
    int order = kMinOrder;
    while (2 * order <= std::min(turns, static_cast<double>(kMaxOrder))) order *= 2;
    PointGroup group = finite_counterpart(region.group, order);
    if (!region.group.has_axis()) group = {region.group.family == Family::Kh ? Family::Ih : Family::I, 1};
    const GroupFrame frame = region.axis.isZero() ? GroupFrame(GroupFrame::Identity()) : frame_about(region.axis);
    return make_region(group, region.centre, frame, region.faces, region.name);
  }

  void add_pattern(const Pattern& pattern) {
    SymmetricRemeshItem item{true, pattern.id, pattern.name, to_string(pattern.kind), "", 1, ""};
    Demand demand;
    std::vector<std::vector<int>> instances;
    for (const PatternInstance& instance : pattern.instances) {
      const auto whole = whole_components(instance.faces);
      if (!whole) break;
      instances.push_back(*whole);
    }
    if (instances.size() < pattern.instances.size()) {
      item.reason = "its instances are parts of connected components";
      instances.clear();
    } else {
      item.kept_as = item.group;
      for (std::size_t i = 1; i < instances.size(); ++i) {
        demand.motions.push_back({pattern.instances[i].motion, instances[0], instances[i]});
      }
    }
    result_.items.push_back(std::move(item));
    result_.demands.push_back(std::move(demand));
    result_.components.push_back(std::move(instances));
  }

  const Mesh& mesh_;
  const Components& components_;
  const SymmetryAnnotation& annotation_;
  double min_score_;
  const RunContext& context_;
  Eigen::VectorXd areas_;
  Points normals_;
  double scale_;
  std::vector<double> component_areas_;
  std::vector<Motion> known_;
  AnnotationDemands result_;
};

}  // namespace

AnnotationDemands annotation_demands(const Mesh& mesh, const Components& components,
                                     const SymmetryAnnotation& annotation, double min_score,
                                     const RunContext& context) {
  return DemandSearch(mesh, components, annotation, min_score, context).run();
}

}  // namespace orbifit
