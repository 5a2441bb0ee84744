#include "support/trimmed_regions.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "evidence/policy.h"
#include "group/verification.h"
#include "surface/face_points.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

class Trimmer {
 public:
  /// \param motions  the group's elements but the identity
  Trimmer(const PreparedMesh& prepared, double tolerance, const std::vector<Motion>& motions, const RunContext& context,
          std::vector<int> faces)
      : prepared_(prepared),
        tolerance_(tolerance),
        motions_(motions),
        context_(context),
        faces_(std::move(faces)),
        in_(static_cast<std::size_t>(prepared.mesh.faces.rows()), 0) {
    for (const int face : faces_) in_[static_cast<std::size_t>(face)] = 1;
  }

  // The faces that stay; nothing where too many would go. Faces go in patches that begin at the border, at those that
  // are suspected, and where images lay on faces that went.
  std::optional<std::vector<int>> run(const std::vector<int>& suspects) {
    double spare = kEvidencePolicy.trimmed * area_of(prepared_, faces_);  // that may still go
    std::vector<int> asked = suspects;
    for (const int face : faces_) {
      if (at_border(face)) asked.push_back(face);
    }
    while (true) {
      const SurfaceIndex rest = prepared_.index->part(faces_);
      const std::vector<int> gone = leaving(rest, std::move(asked), spare);
      if (gone.empty()) return faces_;
      spare -= area_of(prepared_, gone);
      if (gone.size() == faces_.size() || spare < 0) return std::nullopt;
      for (const int face : gone) in_[static_cast<std::size_t>(face)] = 0;
      std::erase_if(faces_, [&](int face) { return in_[static_cast<std::size_t>(face)] == 0; });
      asked = those_that_lose(gone);
    }
  }

 private:
  bool at_border(int face) const {
    bool border = false;
    for_neighbours(prepared_, face, [&](int other) { border = border || in_[static_cast<std::size_t>(other)] == 0; });
    return border;
  }

  bool stays(const SurfaceIndex& rest, int face) const {
    std::array<Vector3d, 4> points{face_centroid(prepared_, face)};
    for (std::size_t k = 0; k < 3; ++k) {
      points[k + 1] = prepared_.mesh.vertices.row(prepared_.mesh.faces(face, static_cast<Eigen::Index>(k)));
    }
    return std::ranges::all_of(motions_, [&](const Motion& motion) {
      return std::ranges::all_of(points, [&](const Vector3d& p) { return rest.within(motion(p), tolerance_); });
    });
  }

  // Of those that are asked, and around those that go, the faces that some element takes away from the rest; some of
  // them where their area is more than `spare`.
  std::vector<int> leaving(const SurfaceIndex& rest, std::vector<int> asked, double spare) const {
    std::vector<char> seen(in_.size(), 0);
    std::vector<int> gone;
    while (!asked.empty()) {
      std::erase_if(asked, [&](int face) {
        return in_[static_cast<std::size_t>(face)] == 0 || std::exchange(seen[static_cast<std::size_t>(face)], 1) != 0;
      });
      std::vector<char> kept(asked.size(), 0);
      parallel_for(context_, asked.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          if (i % 256 == 0) context_.check();
          kept[i] = stays(rest, asked[i]) ? 1 : 0;
        }
      });
      std::vector<int> around;
      for (std::size_t i = 0; i < asked.size(); ++i) {
        if (kept[i] != 0) continue;
        gone.push_back(asked[i]);
        spare -= prepared_.areas[asked[i]];
        for_neighbours(prepared_, asked[i], [&](int other) { around.push_back(other); });
      }
      if (spare < 0) return gone;
      asked = std::move(around);
    }
    return gone;
  }

  // Faces that lay on one that is gone: the nearest to its images, and its own neighbours.
  std::vector<int> those_that_lose(const std::vector<int>& gone) const {
    const SurfaceIndex rest = prepared_.index->part(faces_);
    std::vector<int> nearest(gone.size() * motions_.size(), -1);
    parallel_for(context_, gone.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (i % 256 == 0) context_.check();
        const Vector3d centroid = face_centroid(prepared_, gone[i]);
        for (std::size_t m = 0; m < motions_.size(); ++m) {
          nearest[i * motions_.size() + m] = rest.nearest(motions_[m](centroid), 2 * tolerance_).face;
        }
      }
    });
    std::erase(nearest, -1);
    for (const int face : gone) for_neighbours(prepared_, face, [&](int other) { nearest.push_back(other); });
    return nearest;
  }

  const PreparedMesh& prepared_;
  double tolerance_;
  const std::vector<Motion>& motions_;
  const RunContext& context_;
  std::vector<int> faces_;  // that are left, ascending
  std::vector<char> in_;    // by face of the mesh: whether it is left
};

// How far the facets of a round region lie inside the surface that they stand for, at most: c^2 / (8 r) for a chord c
// at the radius r.
double largest_sagitta(const PreparedMesh& prepared, const GroupPlacement& placement, const std::vector<int>& faces) {
  const auto from = [&](int face, int k) -> Vector3d {
    return prepared.mesh.vertices.row(prepared.mesh.faces(face, k)).transpose() - placement.centre;
  };
  const Vector3d axis = placement.group.has_axis() ? Vector3d(placement.frame.col(2)) : Vector3d::Zero();
  double largest = 0;
  for (const int face : faces) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d a = from(face, k);
      const Vector3d b = from(face, (k + 1) % 3);
      Vector3d out = (a + b) / 2;
      out -= axis.dot(out) * axis;
      const double radius = out.norm();
      if (radius == 0) continue;
      Vector3d chord = b - a;
      chord -= axis.dot(chord) * axis + out.dot(chord) / (radius * radius) * out;
      largest = std::max(largest, chord.squaredNorm() / (8 * radius));
    }
  }
  return largest;
}

}  // namespace

namespace {

void note(Explanation* explanation, const FoundRegion& region, std::string reason) {
  if (explanation == nullptr) return;
  explanation->notes.push_back(
      {"trimming", region.placement.group.symbol() + " on " + region.name, true, std::move(reason)});
}

void set_faces(const PreparedMesh& prepared, std::vector<int> faces, FoundRegion& region) {
  region.faces = std::move(faces);
  region.area = area_of(prepared, region.faces);
}

}  // namespace

void trim_regions(const PreparedMesh& prepared, double tolerance, BorderMoves moves, const RunContext& context,
                  std::vector<FoundRegion>& regions, Explanation* explanation, const std::function<bool()>& late) {
  for (FoundRegion& region : regions) {
    if (late && late()) break;
    const GroupPlacement& placement = region.placement;
    if (region.residual && region.residual->max <= tolerance) continue;
    const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
    const auto patch_of = [&](const std::vector<int>& faces) {
      return make_patch(prepared, faces, kResidualSamples, tolerance, context, "residual");
    };
    const SurfacePatch patch = patch_of(region.faces);
    if (!region.residual) region.residual = measure_residual(patch, motions, context);
    if (region.residual->max <= tolerance) continue;
    if (placement.group.continuous() &&
        largest_sagitta(prepared, placement, region.faces) > kEvidencePolicy.sagitta * tolerance) {
      continue;
    }
    std::vector<int> voted = voted_border(prepared, tolerance, motions, region.faces, moves, context);
    if (!voted.empty() && voted != region.faces) {
      const Residual residual = measure_residual(patch_of(voted), motions, context);
      // Inwards only where it is done with then: what others take faces from comes here again and again.
      if (residual.max <= tolerance || (moves == BorderMoves::both_ways && residual.max < region.residual->max)) {
        note(explanation, region, "its border is where most of its images have it");
        set_faces(prepared, std::move(voted), region);
        region.residual = residual;
      }
    }
    if (region.residual->max <= tolerance) continue;
    std::optional<std::vector<int>> left =
        Trimmer(prepared, tolerance, motions, context, region.faces).run(patch.samples.faces);
    note(explanation, region,
         left ? std::to_string(region.faces.size() - left->size()) + " faces without an image go"
              : "more than a tenth would go; kept as it is");
    if (!left || left->size() == region.faces.size()) continue;
    set_faces(prepared, std::move(*left), region);
    region.residual.reset();
  }
}

}  // namespace orbifit
