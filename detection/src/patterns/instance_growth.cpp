#include "patterns/instance_growth.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

namespace orbifit {

using Eigen::Vector3d;

InstanceGrowth::InstanceGrowth(const PartTable& table, const RunContext& context)
    : table_(table),
      context_(context),
      used_(static_cast<std::size_t>(table.count()), 0),
      boxes_(static_cast<std::size_t>(table.count())) {
  const PreparedMesh& prepared = table.prepared();
  for (std::size_t c = 0; c < boxes_.size(); ++c) {
    for (const int face : prepared.components.faces[c]) {
      for (const int vertex : prepared.mesh.faces.row(face)) {
        boxes_[c].extend(Vector3d(prepared.mesh.vertices.row(vertex)));
      }
    }
  }
}

void InstanceGrowth::continue_row(Instances& instances) {
  const int first = instances.parts.front().front();
  const SurfacePatch patch =
      make_patch(table_.prepared(), table_.faces_of({first}), 100, table_.tolerance(), context_, "pattern");
  const Motion step = instances.arrangement.generators.front();
  for (const Motion& forth : {step, inverse(step)}) {
    Motion motion = forth;
    for (int misses = 0; misses <= 1; motion = forth * motion) {
      const Vector3d goal = motion(table_.moments(first).centroid);
      const auto near = [&](const Motion& other) {
        return (other(table_.moments(first).centroid) - goal).norm() < 2 * table_.tolerance();
      };
      if (std::ranges::any_of(instances.arrangement.motions, near)) continue;
      const int copy = copy_at(patch, motion);
      if (copy < 0) {
        ++misses;
        continue;
      }
      use(copy);
      instances.parts.push_back({copy});
      instances.arrangement.motions.push_back(motion);
    }
  }
}

// The part onto which the motion carries nearly all of the patch; -1 for none.
int InstanceGrowth::copy_at(const SurfacePatch& patch, const Motion& motion) const {
  constexpr double kAlike = 0.1;  // of the area
  for (int c = 0; c < table_.count(); ++c) {
    const SurfaceMoments& other = table_.moments(c);
    if (is_used(c) || std::abs(other.area - patch.moments.area) > kAlike * patch.moments.area) continue;
    if ((other.centroid - motion(patch.moments.centroid)).norm() > 3 * table_.tolerance()) continue;
    const std::vector<int>& faces = table_.prepared().components.faces[static_cast<std::size_t>(c)];
    if (fit_of_copy(patch, motion, faces).kept >= kKeptOfCopy) return c;
  }
  return -1;
}

void InstanceGrowth::grow(Instances& instances) {
  for (bool grown = true; grown;) {
    grown = false;
    for (std::size_t k = 0; k < table_.classes().size(); ++k) {
      const CongruenceClass& kind = table_.classes()[k];
      if (kind.members.size() < instances.parts.size()) continue;
      for (std::size_t m = 0; m < kind.members.size(); ++m) {
        if (is_used(kind.members[m]) || !touches(kind.members[m], instances.parts.front())) continue;
        const std::vector<int> orbit = orbit_of(k, m, instances);
        if (orbit.empty()) continue;
        for (std::size_t i = 0; i < orbit.size(); ++i) {
          instances.parts[i].push_back(orbit[i]);
          use(orbit[i]);
        }
        grown = true;
      }
    }
  }
}

bool InstanceGrowth::touches(int part, const std::vector<int>& others) const {
  const Vector3d slack = Vector3d::Constant(0.5 * table_.tolerance());
  const Eigen::AlignedBox3d& box = boxes_[static_cast<std::size_t>(part)];
  const Eigen::AlignedBox3d wider(box.min() - slack, box.max() + slack);
  return std::ranges::any_of(others,
                             [&](int other) { return wider.intersects(boxes_[static_cast<std::size_t>(other)]); });
}

// The parts of class k, one an instance, onto which the arrangement's motions carry its m-th member; empty where
// there are none, or where they are in use.
std::vector<int> InstanceGrowth::orbit_of(std::size_t k, std::size_t m, const Instances& instances) const {
  const CongruenceClass& kind = table_.classes()[k];
  const SurfaceMoments& mine = table_.moments(kind.members[m]);
  const SurfaceMoments& first = table_.moments(kind.members.front());
  const double tolerance = 3 * table_.tolerance_of(kind.members[m]);
  std::vector<int> orbit;
  for (const Motion& motion : instances.arrangement.motions) {
    const Vector3d goal = motion(mine.centroid);
    std::optional<int> image;
    for (std::size_t j = 0; j < kind.members.size() && !image; ++j) {
      const int part = kind.members[j];
      if (is_used(part) || (table_.moments(part).centroid - goal).norm() > tolerance) continue;
      if (std::ranges::find(orbit, part) != orbit.end()) continue;
      Motion rest = inverse(kind.motions[j]) * motion * kind.motions[m];
      if (table_.own_group(k) != nullptr) rest = straightened(rest, *table_.own_group(k));
      if (motion_distance(rest, Motion{}, first.centroid, first.radius) <= tolerance) image = part;
    }
    if (!image) return {};
    orbit.push_back(*image);
  }
  return orbit;
}

}  // namespace orbifit
