#include "orbifit/detection/detect_points.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "geometry/point_index.h"
#include "group/candidates.h"
#include "group/verification.h"
#include "kept_consistent.h"
#include "scan/partial_revolution.h"
#include "scan/point_surface.h"
#include "support/own_group.h"
#include "surface/surface_patch.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kMaxKept = 20000;
constexpr double kSampled = 0.6;      // radius of the surfels that carry samples, spacings
constexpr double kCovering = 2.0;     // and of those that cover the surface
constexpr double kMinCluster = 0.02;  // of the points: smaller clusters say little
constexpr double kMinShare = 0.15;    // of a cluster: smaller surfaces of revolution say little
constexpr double kMaxShare = 0.5;     // of several clusters together
constexpr double kCovered = 0.8;      // of some points: nothing new in them
constexpr int kMaxRevolutions = 4;    // of one cluster

// Per kept point whether normals nearby differ: there each says little.
std::vector<char> creases(const PointSurface& surface) {
  constexpr double kNearby = 3;  // spacings
  constexpr double kCosine = 0.9;
  const PointIndex index(surface.points);
  std::vector<char> result(static_cast<std::size_t>(surface.points.rows()));
  for (Eigen::Index i = 0; i < surface.points.rows(); ++i) {
    const auto near = index.within(surface.points.row(i), kNearby * surface.spacing);
    result[static_cast<std::size_t>(i)] = std::ranges::any_of(near, [&](const PointIndex::Neighbour& n) {
      return std::abs(surface.normals.row(i).dot(surface.normals.row(n.index))) < kCosine;
    });
  }
  return result;
}

/// One run on a prepared scan.
class PointDetector {
 public:
  PointDetector(const PointCloud& scan, const DetectOptions& options, RunContext& context)
      : options_(options),
        context_(context),
        start_(std::chrono::steady_clock::now()),
        surface_(prepare_points(scan, kMaxKept, context)),
        tolerance_(std::min(0.1, std::max({options.tolerance, 2 * surface_.noise, 0.5 * surface_.spacing}))),
        prepared_(prepare(surfels(surface_, kSampled * surface_.spacing))),
        crease_(creases(surface_)),
        screen_(hemisphere_directions(kScreenDirections)) {
    const Similarity normalise = inverse(prepared_.input_of_normalised);
    Mesh covering = surfels(surface_, kCovering * surface_.spacing);
    for (Eigen::Index v = 0; v < covering.vertices.rows(); ++v) {
      covering.vertices.row(v) = normalise(Vector3d(covering.vertices.row(v)));
    }
    covering_ = std::make_shared<const SurfaceIndex>(covering);
    annotation_.mesh_vertices = static_cast<int>(scan.points.rows());
    annotation_.mesh_faces = annotation_.mesh_vertices;
    annotation_.mesh_diagonal = diagonal(scan.points);
    annotation_.tolerance = tolerance_;
    prepared_.components.faces = surface_.clusters;
    for (std::size_t c = 0; c < surface_.clusters.size(); ++c) {
      for (const int k : surface_.clusters[c]) {
        prepared_.components.component_of_face[static_cast<std::size_t>(k)] = static_cast<int>(c);
      }
    }
  }

  SymmetryAnnotation run() {
    context_.progress("clusters", 0);
    std::vector<int> all(static_cast<std::size_t>(surface_.points.rows()));
    std::iota(all.begin(), all.end(), 0);
    std::vector<std::vector<int>> parts;
    for (const std::vector<int>& cluster : surface_.clusters) {
      if (static_cast<double>(cluster.size()) >= kMinCluster * static_cast<double>(all.size())) {
        parts.push_back(cluster);
      }
    }
    // What strays from the only cluster says nothing.
    if (parts.size() != 1) find_in(all, "whole", kMaxShare, 1);
    for (std::size_t c = 0; c < parts.size() && !late(); ++c) {
      find_in(parts[c], parts.size() == 1 ? "whole" : "cluster " + std::to_string(c), kMinShare, kMaxRevolutions);
      context_.progress("clusters", static_cast<double>(c + 1) / static_cast<double>(parts.size()));
    }
    annotation_ =
        kept_consistent(surfels(surface_, kCovering * surface_.spacing), annotation_, options_.explanation, context_);
    for (Region& region : annotation_.regions) region.faces = scan_points(surface_, region.faces);
    context_.progress("clusters", 1);
    return annotation_;
  }

 private:
  bool late() const {
    if (options_.time_budget <= 0) return false;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
    return spent.count() > options_.time_budget;
  }

  void note(const std::string& stage, const std::string& subject, bool kept, const std::string& reason) const {
    if (options_.explanation != nullptr) options_.explanation->notes.push_back({stage, subject, kept, reason});
  }

  void find_in(const std::vector<int>& points, const std::string& name, double share, int most) {
    if (known(points)) return;
    SurfacePatch patch = make_patch(prepared_, points, options_.samples, tolerance_, context_, name);
    patch.index = std::make_shared<const SurfaceIndex>(covering_->part(points));
    for (std::size_t s = 0; s < patch.at_crease.size(); ++s) {
      patch.at_crease[s] = crease_[static_cast<std::size_t>(patch.samples.faces[s])];
    }
    const std::optional<OwnGroup> own = find_own_group(patch, &screen_, {}, context_);
    if (own) note("own group", own->placement.group.symbol() + " on " + name, true, "seen from all sides");
    if (own && own->placement.group.continuous()) {
      add(own->placement, patch, points, name);
      return;
    }
    const std::size_t turned = find_revolutions(points, name, share, most);
    if (!own) return;
    // Of a surface of revolution seen from one side the border is symmetric, and nothing else.
    if (static_cast<double>(turned) > 0.9 * static_cast<double>(points.size())) {
      note("own group", own->placement.group.symbol() + " on " + name, false, "the border's alone");
      return;
    }
    add(own->placement, patch, points, name);
  }

  void add(const GroupPlacement& placement, const SurfacePatch& patch, const std::vector<int>& points,
           const std::string& name) {
    Region region =
        make_region(placement.group, prepared_.input_of_normalised(placement.centre), placement.frame, points, name);
    region.residual =
        measure_residual(patch, judged_motions(placement.group, placement.frame, placement.centre), context_);
    annotation_.regions.push_back(std::move(region));
    if (placement.group.continuous()) found_.push_back(points);
  }

  // Whether most of the points lie in a turned region found before.
  bool known(const std::vector<int>& points) const {
    return std::ranges::any_of(found_, [&](const std::vector<int>& other) {
      const auto inside = std::ranges::count_if(points, [&](int k) { return std::ranges::binary_search(other, k); });
      return static_cast<double>(inside) > kCovered * static_cast<double>(points.size());
    });
  }

  // How many of the points lie on the first surface of revolution found.
  std::size_t find_revolutions(const std::vector<int>& points, const std::string& name, double least_share, int most) {
    std::vector<int> rest = points;
    std::size_t first = 0;
    for (int k = 0; k < most && !late(); ++k) {
      const double share = least_share * static_cast<double>(points.size()) / static_cast<double>(rest.size());
      const PartialRevolution found =
          find_partial_revolution(surface_, rest, tolerance_, share, context_, name + " turned " + std::to_string(k));
      if (found.points.empty() || known(found.points)) break;
      if (k == 0) first = found.points.size();
      note("turned", "Cinfv on " + name, true,
           std::to_string(found.points.size()) + " of " + std::to_string(points.size()) + " points, " +
               std::to_string(static_cast<int>(found.arc * 57.3)) + " degrees seen");
      const std::string title = name + ", turned part" + (k == 0 ? "" : " " + std::to_string(k + 1));
      Region region = make_region(*PointGroup::parse("Cinfv"), surface_.input_of_normalised(found.axis.point),
                                  frame_about(found.axis.direction), found.points, title);
      region.residual = {found.rms, tolerance_};
      annotation_.regions.push_back(std::move(region));
      std::vector<int> left;
      std::ranges::set_difference(rest, found.points, std::back_inserter(left));
      rest = std::move(left);
      found_.push_back(found.points);
      if (static_cast<double>(rest.size()) < least_share * static_cast<double>(points.size())) break;
    }
    return first;
  }

  const DetectOptions& options_;
  RunContext& context_;
  std::chrono::steady_clock::time_point start_;
  PointSurface surface_;
  double tolerance_;
  PreparedMesh prepared_;                         // small surfels, which carry samples
  std::shared_ptr<const SurfaceIndex> covering_;  // of large ones, which leave no holes: what images are compared with
  std::vector<char> crease_;
  DirectionSet screen_;
  SymmetryAnnotation annotation_;        // of kept points, each a surfel
  std::vector<std::vector<int>> found_;  // kept points of turned regions, ascending
};

}  // namespace

SymmetryAnnotation detect_points(const PointCloud& scan, const DetectOptions& options, RunContext& context) {
  options.validate();
  return PointDetector(scan, options, context).run();
}

}  // namespace orbifit
