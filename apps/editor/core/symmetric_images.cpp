#include "symmetric_images.h"

#include <algorithm>
#include <numbers>

namespace orbifit::editor {

namespace {

constexpr std::size_t kMaxImages = 600;
constexpr int kAroundCircle = 48;  // images that stand for a continuum

// Of a finite group its elements; of one about an axis rotations by equal angles. None for spheres.
std::vector<Motion> motions_of(const Region& region) {
  if (!region.elements.empty()) return region.elements;
  std::vector<Motion> result;
  if (region.axis.squaredNorm() < 0.5) return result;
  for (int i = 0; i < kAroundCircle; ++i) {
    const Motion turn = Motion::rotation(region.axis, 2 * std::numbers::pi * i / kAroundCircle, region.centre);
    result.push_back(turn);
  }
  return result;
}

}  // namespace

SymmetricImages::SymmetricImages(const Mesh& mesh, const SymmetryAnnotation& annotation)
    : mesh_(mesh),
      surface_(mesh),
      near_(1e-4 * diagonal(mesh.vertices)),
      reach_(std::max(1e-3, 2 * annotation.tolerance) * diagonal(mesh.vertices)),
      regions_(static_cast<int>(annotation.regions.size())) {
  for (const Region& region : annotation.regions) add(region.faces, motions_of(region));
  for (const Pattern& pattern : annotation.patterns) {
    for (const PatternInstance& from : pattern.instances) {
      std::vector<Motion> motions;
      for (const PatternInstance& to : pattern.instances) motions.push_back(to.motion * inverse(from.motion));
      add(from.faces, std::move(motions));
    }
  }
}

void SymmetricImages::add(const std::vector<int>& faces, std::vector<Motion> motions) {
  Domain domain;
  domain.holds.assign(static_cast<std::size_t>(mesh_.faces.rows()), 0);
  for (const int face : faces) domain.holds[static_cast<std::size_t>(face)] = 1;
  domain.motions = std::move(motions);
  domains_.push_back(std::move(domain));
}

std::vector<SurfacePoint> SymmetricImages::orbit(const SurfacePoint& point) const {
  std::vector<SurfacePoint> result{point};
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (const Domain& domain : domains_) {
      if (domain.holds[static_cast<std::size_t>(result[i].face)] == 0) continue;
      for (const Motion& motion : domain.motions) {
        const Eigen::Vector3d image = motion(result[i].point);
        const bool known = std::any_of(result.begin(), result.end(), [&](const SurfacePoint& other) {
          return (other.point - image).norm() <= near_;
        });
        if (known) continue;
        const SurfaceIndex::Nearest nearest = surface_.nearest(image, reach_);
        if (nearest.face < 0) continue;
        result.push_back({nearest.face, nearest.barycentric, image});
        if (result.size() >= kMaxImages) return result;
      }
    }
  }
  return result;
}

std::vector<int> SymmetricImages::regions_of(int face) const {
  std::vector<int> result;
  for (int region = 0; region < regions_; ++region) {
    if (domains_[static_cast<std::size_t>(region)].holds[static_cast<std::size_t>(face)] != 0) result.push_back(region);
  }
  return result;
}

}  // namespace orbifit::editor
