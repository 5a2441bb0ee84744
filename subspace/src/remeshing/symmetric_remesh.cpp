#include "orbifit/subspace/symmetric_remesh.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "geometry/topology.h"
#include "remeshing/cells.h"
#include "remeshing/demands.h"
#include "remeshing/indices.h"
#include "remeshing/settled_place.h"
#include "remeshing/symmetric_cell.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Twice the tolerance: image and surface may each be off by it.
constexpr double kReach = 2;
constexpr double kOnePlace = 1e-9;  // of the diagonal: vertices of one component as near as this are one
constexpr int kMeasured = 20000;    // points on either surface

class Remeshing {
 public:
  Remeshing(const Mesh& mesh, const SymmetryAnnotation& annotation, const SymmetricRemeshOptions& options,
            const RunContext& context)
      : mesh_(mesh),
        annotation_(annotation),
        options_(options),
        context_(context),
        scale_(diagonal(mesh.vertices)),
        weld_(weld_vertices(mesh.vertices, kOnePlace * scale_)),
        components_(touching_parts(mesh, weld_, DoubledParts::apart)) {}

  SymmetricRemesh run() {
    AnnotationDemands asked = annotation_demands(mesh_, components_, annotation_, options_.min_score, context_);
    const double reach = kReach * annotation_.tolerance * scale_;
    Cells cells = find_cells(mesh_, components_, asked.demands, reach, context_);
    while (!add_cells(cells, reach, asked)) cells = find_cells(mesh_, components_, asked.demands, reach, context_);
    for (std::size_t i = 0; i < asked.items.size(); ++i) {
      if (!cells.refused[i]) continue;
      asked.items[i].kept_as.clear();
      asked.items[i].reason = *cells.refused[i];
    }
    finish();
    result_.items = std::move(asked.items);
    annotate(asked);
    measure();
    return std::move(result_);
  }

 private:
  // All cells with their images. \return false where one cannot be cut, and a demand was given up for it
  bool add_cells(const Cells& cells, double reach, AnnotationDemands& asked) {
    points_.clear();
    triangles_.clear();
    cells_faces_.clear();
    faces_of_component_.assign(components_.faces.size(), nullptr);
    result_ = {};
    result_.motions.emplace_back();
    bool all = true;
    for (const MeshCell& cell : cells.cells) {
      if (&cells.cells[at(cell.source)] != &cell) continue;
      try {
        add_with_images(cells, cell, reach);
      } catch (const NoResultError& error) {
        give_up(cells, cell, error.what(), asked);
        all = false;
      }
    }
    return all;
  }

  // Of the demands that take a cell, or an image of it, to itself or another, the least important one.
  void give_up(const Cells& cells, const MeshCell& cell, const std::string& reason, AnnotationDemands& asked) const {
    std::set<int> orbit;
    for (const MeshCell& other : cells.cells) {
      if (&cells.cells[at(other.source)] == &cell) orbit.insert(other.components.begin(), other.components.end());
    }
    for (std::size_t d = asked.demands.size(); d-- > 0;) {
      if (cells.refused[d]) continue;
      std::vector<ComponentMotion>& motions = asked.demands[d].motions;
      const bool acts = std::ranges::any_of(motions, [&](const ComponentMotion& motion) {
        return std::ranges::any_of(motion.from, [&](int component) { return orbit.contains(component); });
      });
      if (!acts) continue;
      motions.clear();
      asked.items[d].kept_as.clear();
      asked.items[d].reason = reason;
      return;
    }
    throw NoResultError(reason);
  }

  void add_with_images(const Cells& cells, const MeshCell& cell, double reach) {
    CellSurface surface = cell_surface(cell.components);
    GluedImages images;
    Motion settled;
    if (cell.group.order() == 1) {
      images = {surface.points, surface.triangles, surface.sources, std::vector<int>(surface.triangles.size(), 0), 0};
    } else {
      settled = settled_place(surface, cell.group);
      for (Vector3d& point : surface.points) point = settled(point);
      images = symmetric_cell(surface, cell.group, {options_.snap, reach, scale_}, context_);
    }
    for (const MeshCell& other : cells.cells) {
      if (&cells.cells[at(other.source)] == &cell) add_image(images, cell, other, settled);
    }
  }

  CellSurface cell_surface(const std::vector<int>& components) const {
    CellSurface surface;
    std::map<std::pair<int, int>, int> numbers;  // component, place
    for (const int component : components) {
      for (const int f : components_.faces[at(component)]) {
        std::array<int, 3> corners{};
        for (int k = 0; k < 3; ++k) {
          const int group = weld_.group_of_vertex[at(mesh_.faces(f, k))];
          const auto [entry, added] = numbers.try_emplace({component, group}, static_cast<int>(surface.points.size()));
          if (added) surface.points.emplace_back(mesh_.vertices.row(weld_.representative[at(group)]).transpose());
          corners[at(k)] = entry->second;
        }
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        surface.triangles.push_back(corners);
        surface.sources.push_back(f);
      }
    }
    return surface;
  }

  // \param settled  what moved the source's surface before it was cut
  void add_image(const GluedImages& images, const MeshCell& source, const MeshCell& cell, const Motion& settled) {
    const int first = static_cast<int>(points_.size());
    for (const Vector3d& point : images.points) points_.push_back(cell.from_source(point));
    const bool turned = cell.from_source.linear.determinant() < 0;
    const int motion = static_cast<int>(result_.motions.size());
    for (const Motion& element : source.group.elements) result_.motions.push_back(cell.from_source * element * settled);
    const bool as_it_is = &source == &cell && source.group.order() == 1;
    for (std::size_t t = 0; t < images.triangles.size(); ++t) {
      std::array<int, 3> corners = images.triangles[t];
      if (turned) std::swap(corners[1], corners[2]);
      for (int& corner : corners) corner += first;
      cells_faces_[&cell].push_back(static_cast<int>(triangles_.size()));
      triangles_.push_back(corners);
      result_.source_face.push_back(images.sources[t]);
      result_.motion_of_face.push_back(as_it_is ? 0 : motion + images.elements[t]);
    }
    for (const int component : cell.components) faces_of_component_[at(component)] = &cells_faces_[&cell];
  }

  void finish() {
    Mesh& mesh = result_.mesh;
    std::vector<int> number(points_.size(), -1);
    int used = 0;
    for (const auto& corners : triangles_) {
      for (const int corner : corners) {
        if (number[at(corner)] < 0) number[at(corner)] = used++;
      }
    }
    mesh.vertices.resize(used, 3);
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (number[v] >= 0) mesh.vertices.row(number[v]) = points_[v].transpose();
    }
    mesh.faces.resize(static_cast<Index>(triangles_.size()), 3);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k) mesh.faces(static_cast<Index>(t), k) = number[at(triangles_[t][at(k)])];
    }
  }

  std::vector<int> new_faces(const std::vector<int>& components) const {
    std::vector<const std::vector<int>*> parts;
    for (const int component : components) parts.push_back(faces_of_component_[at(component)]);
    std::ranges::sort(parts);
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    std::vector<int> faces;
    for (const std::vector<int>* part : parts) faces.insert(faces.end(), part->begin(), part->end());
    std::ranges::sort(faces);
    return faces;
  }

  void annotate(const AnnotationDemands& asked) {
    const auto& components = asked.components;
    result_.annotation = empty_annotation(result_.mesh, annotation_.tolerance);
    result_.annotation.up = annotation_.up;
    for (std::size_t i = 0; i < result_.items.size(); ++i) {
      if (result_.items[i].kept_as.empty()) continue;
      if (i < annotation_.regions.size()) {
        Region region = asked.finite[i];
        region.id = annotation_.regions[i].id;
        region.name = annotation_.regions[i].name;
        region.faces = new_faces(components[i].front());
        result_.annotation.regions.push_back(std::move(region));
      } else {
        Pattern pattern = annotation_.patterns[i - annotation_.regions.size()];
        for (std::size_t k = 0; k < pattern.instances.size(); ++k) {
          pattern.instances[k].faces = new_faces(components[i][k]);
        }
        result_.annotation.patterns.push_back(std::move(pattern));
      }
    }
    set_parents(result_.annotation.regions);
  }

  // Of points spread over one surface, and its vertices, to the other.
  void measure_from(const Mesh& from, const Mesh& to, double& largest, double& mean) const {
    const SurfaceIndex index(to);
    Random random(context_.seed);
    const SurfaceSamples samples = sample_surface(from, kMeasured, random);
    double sum = 0;
    for (Index i = 0; i < samples.points.rows(); ++i) {
      const double distance = index.nearest(samples.points.row(i).transpose()).distance;
      sum += distance;
      largest = std::max(largest, distance);
    }
    mean += sum / static_cast<double>(samples.points.rows()) / 2;
    std::vector<int> faces(static_cast<std::size_t>(from.faces.rows()));
    std::iota(faces.begin(), faces.end(), 0);
    for (const int v : vertices_of_faces(from, faces))
      largest = std::max(largest, index.nearest(from.vertices.row(v).transpose()).distance);
  }

  void measure() {
    measure_from(mesh_, result_.mesh, result_.largest_distance, result_.mean_distance);
    measure_from(result_.mesh, mesh_, result_.largest_distance, result_.mean_distance);
    result_.largest_distance /= scale_;
    result_.mean_distance /= scale_;
  }

  const Mesh& mesh_;
  const SymmetryAnnotation& annotation_;
  const SymmetricRemeshOptions& options_;
  const RunContext& context_;
  double scale_;
  Weld weld_;
  Components components_;
  std::vector<Vector3d> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::map<const MeshCell*, std::vector<int>> cells_faces_;
  std::vector<const std::vector<int>*> faces_of_component_;
  SymmetricRemesh result_;
};

}  // namespace

void SymmetricRemeshOptions::validate() const {
  require(min_score >= 0 && min_score <= 1, "min_score", min_score, "in [0, 1]");
  require(snap >= 0 && snap <= 0.4, "snap", snap, "in [0, 0.4]");
}

void require_scores(const Mesh& mesh, const SymmetryAnnotation& annotation, const SymmetricRemeshOptions& options,
                    const RunContext& context) {
  options.validate();
  const Weld weld = weld_vertices(mesh.vertices, kOnePlace * diagonal(mesh.vertices));
  annotation_demands(mesh, touching_parts(mesh, weld, DoubledParts::apart), annotation, options.min_score, context);
}

SymmetricRemesh symmetric_remesh(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                 const SymmetricRemeshOptions& options, const RunContext& context) {
  options.validate();
  return Remeshing(mesh, annotation, options, context).run();
}

}  // namespace orbifit
