#include "support/grid_region.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "group/verification.h"
#include "surface/creases.h"
#include "surface/face_points.h"
#include "surface/segments.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kMaxOff = 0.1;       // of a face's points
constexpr double kMaxAstray = 0.5;    // of them, next to a crease, where other normals are
constexpr double kMaxCut = 0.3;       // of the border of what is taken of a flat piece, within the piece
constexpr double kWholePiece = 0.97;  // of a piece
constexpr double kSmallPiece = 0.01;  // of the mesh's area: no plate that others stand on
constexpr double kMaxOfSmall = 0.5;   // of a small piece, which then belongs wherever it is cut
constexpr double kSpacing = 4;        // of a face's points, tolerances
constexpr int kMaxCuts = 6;           // of an edge

std::vector<int> with_area(const PreparedMesh& prepared) {
  std::vector<int> faces;
  for (Eigen::Index f = 0; f < prepared.mesh.faces.rows(); ++f) {
    if (prepared.areas[f] > 0) faces.push_back(static_cast<int>(f));
  }
  return faces;
}

/// Whether motions keep faces on the surface.
class FaceTest {
 public:
  FaceTest(const ScreenedSurface& surface, std::vector<Motion> motions)
      : surface_(surface), motions_(std::move(motions)) {}

  // All motions keep all but a few points of the face. Not for several threads at once.
  bool keep(int face) {
    face_points(surface_.prepared, face, kSpacing * surface_.tolerance, kMaxCuts, points_);
    at_crease_.assign(points_.size(), -1);
    const auto allowed = static_cast<std::size_t>(kMaxOff * static_cast<double>(points_.size()));
    const auto most_astray = static_cast<std::size_t>(kMaxAstray * static_cast<double>(points_.size()));
    const Vector3d normal = surface_.prepared.normals.row(face);
    const auto keeps = [&](const Motion& motion) {
      const Vector3d turned = motion.linear * normal;
      std::size_t off = 0;
      std::size_t astray = 0;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const Vector3d image = motion(points_[i]);
        if (surface_.grid.holds(image, turned)) continue;
        const bool near = surface_.grid.covers(image) && at_crease(face, i);
        if (near ? ++astray > most_astray : ++off > allowed) return false;
      }
      return true;
    };
    const auto refuting = std::ranges::find_if_not(motions_, keeps);
    if (refuting == motions_.end()) return true;
    // What takes this face off the surface will take its neighbours off, and is asked first.
    std::iter_swap(motions_.begin(), refuting);
    return false;
  }

 private:
  // Next to a crease any normal will do.
  bool at_crease(int face, std::size_t i) {
    if (at_crease_[i] < 0) {
      at_crease_[i] = near_crease(surface_.prepared, points_[i], face, kCreaseReach * surface_.tolerance) ? 1 : 0;
    }
    return at_crease_[i] != 0;
  }

  const ScreenedSurface& surface_;
  std::vector<Motion> motions_;
  std::vector<Vector3d> points_;
  std::vector<signed char> at_crease_;  // of the points, -1 where it was not asked yet
};

std::vector<int> kept_faces(const ScreenedSurface& surface, const std::vector<int>& faces,
                            const std::vector<Motion>& motions, const RunContext& context) {
  std::vector<char> kept(faces.size(), 0);
  parallel_for(context, faces.size(), [&](std::size_t begin, std::size_t end) {
    FaceTest test(surface, motions);
    for (std::size_t i = begin; i < end; ++i) {
      if (i % 256 == 0) context.check();
      kept[i] = test.keep(faces[i]) ? 1 : 0;
    }
  });
  std::vector<int> result;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (kept[i] != 0) result.push_back(faces[i]);
  }
  return result;
}

// What to take of the pieces, where the motions keep the faces.
std::vector<int> by_pieces(const ScreenedSurface& surface, const std::vector<int>& faces,
                           const std::vector<Motion>& motions) {
  const Components& pieces = surface.prepared.components;
  const auto piece_of = [&](int face) {
    return static_cast<std::size_t>(pieces.component_of_face[static_cast<std::size_t>(face)]);
  };
  std::vector<double> in(pieces.faces.size(), 0);
  std::vector<char> taken(static_cast<std::size_t>(surface.prepared.mesh.faces.rows()), 0);
  for (const int f : faces) {
    in[piece_of(f)] += surface.prepared.areas[f];
    taken[static_cast<std::size_t>(f)] = 1;
  }
  // Of what belongs of flat pieces: the length of its border, and of that within the piece, where no image of it is
  // where the surface ends.
  std::vector<double> border(pieces.faces.size(), 0);
  std::vector<double> cut(pieces.faces.size(), 0);
  for (const ScreenedSurface::FlatEdge& edge : surface.flat_edges) {
    if (taken[static_cast<std::size_t>(edge.face)] == 0) continue;
    if (edge.other >= 0 && taken[static_cast<std::size_t>(edge.other)] != 0) continue;
    border[piece_of(edge.face)] += edge.length;
    if (edge.other >= 0 && !surface.ends.taken_near(edge.middle, motions)) cut[piece_of(edge.face)] += edge.length;
  }
  std::vector<int> result;
  for (std::size_t piece = 0; piece < pieces.faces.size(); ++piece) {
    if (in[piece] <= 0) continue;
    const bool whole = in[piece] >= kWholePiece * surface.piece_areas[piece];
    const bool small = surface.piece_areas[piece] < kSmallPiece * surface.prepared.area;
    const bool mostly = small && in[piece] >= kMaxOfSmall * surface.piece_areas[piece];
    if (!whole && !mostly && surface.piece_flat[piece] != 0 && cut[piece] > kMaxCut * border[piece]) continue;
    std::ranges::copy_if(pieces.faces[piece], std::back_inserter(result),
                         [&](int f) { return whole || taken[static_cast<std::size_t>(f)] != 0; });
  }
  std::ranges::sort(result);
  return result;
}

}  // namespace

ScreenedSurface::ScreenedSurface(const PreparedMesh& mesh, double detector_tolerance, int sample_count,
                                 const RunContext& context)
    : prepared(mesh),
      tolerance(detector_tolerance),
      grid(mesh, with_area(mesh), detector_tolerance),
      balls(find_balls(mesh, detector_tolerance)),
      sides(face_sides(mesh)),
      ends(mesh, detector_tolerance) {
  faces = with_area(mesh);
  Random random(context.seed, "screen");
  samples = sample_surface(mesh.mesh, mesh.areas, mesh.normals, sample_count, random, faces);
  for (const int face : samples.faces) {
    piece_of_sample.push_back(mesh.components.component_of_face[static_cast<std::size_t>(face)]);
  }
  for (const std::vector<int>& piece : mesh.components.faces) {
    piece_areas.push_back(area_of(mesh, piece));
    piece_flat.push_back(flat_piece(mesh, piece) ? 1 : 0);
  }
  for (const Edge& edge : welded_edges(mesh.mesh, mesh.weld)) {
    const auto end = [&](std::size_t k) -> Vector3d {
      return mesh.mesh.vertices.row(mesh.weld.representative[static_cast<std::size_t>(edge.vertices[k])]);
    };
    for (const int f : edge.faces) {
      const int piece = mesh.components.component_of_face[static_cast<std::size_t>(f)];
      if (mesh.areas[f] <= 0 || piece_flat[static_cast<std::size_t>(piece)] == 0) continue;
      const auto other = std::ranges::find_if(edge.faces, [&](int g) {
        return g != f && mesh.areas[g] > 0 && mesh.components.component_of_face[static_cast<std::size_t>(g)] == piece;
      });
      flat_edges.push_back(
          {f, other == edge.faces.end() ? -1 : *other, (end(1) - end(0)).norm(), 0.5 * (end(0) + end(1))});
    }
  }
}

std::vector<int> grid_region(const ScreenedSurface& surface, const GroupPlacement& placement,
                             const RunContext& context) {
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  return by_pieces(surface, kept_faces(surface, surface.faces, motions, context), motions);
}

std::vector<int> thinned_region(const ScreenedSurface& surface, const SurfacePatch& patch,
                                const Verification& verification, const GroupPlacement& placement,
                                const RunContext& context) {
  constexpr double kFaultless = 0.98;  // of the samples of a piece
  const PreparedMesh& prepared = surface.prepared;
  const auto piece_of = [&](int face) {
    return static_cast<std::size_t>(prepared.components.component_of_face[static_cast<std::size_t>(face)]);
  };
  std::vector<int> samples(prepared.components.faces.size(), 0);
  std::vector<int> kept(samples.size(), 0);
  for (std::size_t s = 0; s < patch.samples.faces.size(); ++s) {
    const std::size_t piece = piece_of(patch.samples.faces[s]);
    ++samples[piece];
    kept[piece] += verification.kept[s];
  }
  const std::vector<Motion> motions = judged_motions(placement.group, placement.frame, placement.centre);
  std::vector<char> stays(patch.faces.size(), 1);
  parallel_for(context, patch.faces.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t piece = piece_of(patch.faces[i]);
      if (samples[piece] > 0 && kept[piece] >= kFaultless * samples[piece]) continue;
      if (i % 256 == 0) context.check();
      stays[i] = stays_on(patch, motions, patch.faces[i]) ? 1 : 0;
    }
  });
  std::vector<int> faces;
  for (std::size_t i = 0; i < stays.size(); ++i) {
    if (stays[i] != 0) faces.push_back(patch.faces[i]);
  }
  return by_pieces(surface, faces, motions);
}

}  // namespace orbifit
