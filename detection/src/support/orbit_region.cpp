#include "support/orbit_region.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/topology.h"
#include "group/verification.h"
#include "surface/creases.h"
#include "surface/face_points.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kPointSpacing = 4;   // of a face's sample points, tolerances
constexpr int kMaxEdgeCuts = 8;       // of each edge
constexpr double kMaxFarOff = 0.03;   // of a face's points, off the surface
constexpr double kMaxOnOthers = 0.5;  // of a face's points, on faces that are out

/// Asks whether motions keep faces on a surface.
class OrbitTest {
 public:
  OrbitTest(const PreparedMesh& prepared, const GroupPlacement& placement, double tolerance)
      : prepared_(prepared),
        motions_(judged_motions(placement.group, placement.frame, placement.centre)),
        tolerance_(tolerance) {}

  const std::vector<Motion>& motions() const { return motions_; }

  // Whether every motion keeps all but a share of the face's points; `points` is working space.
  // \param[out] images the faces on which the points come to lie, ascending
  bool stays(const SurfaceIndex& surface, int face, double most_off, std::vector<Vector3d>& points,
             std::vector<int>& images) const {
    images.clear();
    face_points(prepared_, face, kPointSpacing * tolerance_, kMaxEdgeCuts, points);
    const auto allowed = static_cast<std::size_t>(most_off * static_cast<double>(points.size()));
    const bool kept = std::ranges::all_of(motions_, [&](const Motion& motion) {
      std::size_t off = 0;
      for (const Vector3d& point : points) {
        images.push_back(landing(surface, motion, face, point));
        if (images.back() < 0 && ++off > allowed) return false;
      }
      return true;
    });
    std::ranges::sort(images);
    images.erase(std::unique(images.begin(), images.end()), images.end());
    images.shrink_to_fit();
    return kept;
  }

  // The face of the surface on which the point's image lies with a compatible normal, -1 for none.
  int image(const SurfaceIndex& surface, const Motion& motion, int face, const Vector3d& point) const {
    const Vector3d normal = motion.linear * prepared_.normals.row(face).transpose();
    return surface.nearest_facing(motion(point), normal, kAlikeNormals, tolerance_, true).face;
  }

 private:
  // The same, but next to a crease any normal will do.
  int landing(const SurfaceIndex& surface, const Motion& motion, int face, const Vector3d& point) const {
    const int facing = image(surface, motion, face, point);
    if (facing >= 0) return facing;
    const int any = surface.nearest(motion(point), tolerance_).face;
    if (any < 0) return -1;
    const bool degenerate = prepared_.normals.row(face).squaredNorm() < 0.5;
    return degenerate || near_crease(prepared_, point, face, kCreaseReach * tolerance_) ? any : -1;
  }

  const PreparedMesh& prepared_;
  std::vector<Motion> motions_;
  double tolerance_;
};

/// The faces that are in, thinned out round by round.
class Erosion {
 public:
  Erosion(const PreparedMesh& prepared, const OrbitTest& test, const RunContext& context)
      : prepared_(prepared),
        test_(test),
        context_(context),
        in_(static_cast<std::size_t>(prepared.mesh.faces.rows()), 1),
        images_(in_.size()),
        faces_(in_.size()) {
    std::iota(faces_.begin(), faces_.end(), 0);
  }

  std::vector<int> run(const SurfaceIndex& whole) {
    std::size_t before = faces_.size();
    judge(whole, faces_, kMaxFarOff);
    while (!faces_.empty() && faces_.size() < before) {
      before = faces_.size();
      // What lands on faces that are still in does so as before.
      std::vector<int> doubtful;
      for (const int face : faces_) {
        const auto out = [&](int image) { return image >= 0 && in_[static_cast<std::size_t>(image)] == 0; };
        if (std::ranges::any_of(images_[static_cast<std::size_t>(face)], out)) doubtful.push_back(face);
      }
      if (!doubtful.empty()) judge(prepared_.index->part(faces_), doubtful, kMaxOnOthers);
    }
    return faces_;
  }

 private:
  void judge(const SurfaceIndex& surface, const std::vector<int>& doubtful, double most_off) {
    constexpr std::size_t kMinShare = 64;
    const auto body = [&](std::size_t begin, std::size_t end) {
      std::vector<Vector3d> points;
      for (std::size_t i = begin; i < end; ++i) {
        if (i % 256 == 0) context_.check();
        const auto face = static_cast<std::size_t>(doubtful[i]);
        in_[face] = test_.stays(surface, doubtful[i], most_off, points, images_[face]) ? 1 : 0;
      }
    };
    parallel_for(context_, doubtful.size(), body, kMinShare);
    std::vector<int> kept;
    for (const int face : faces_) {
      if (in_[static_cast<std::size_t>(face)] != 0) kept.push_back(face);
    }
    faces_ = std::move(kept);
  }

  const PreparedMesh& prepared_;
  const OrbitTest& test_;
  const RunContext& context_;
  std::vector<char> in_;                  // by face
  std::vector<std::vector<int>> images_;  // by face: where its points came to lie when last judged
  std::vector<int> faces_;                // that are in, ascending
};

/// Faces joined along edges.
struct Pieces {
  std::vector<int> piece_of_face;  // of the mesh, -1 for faces that are out
  std::vector<std::vector<int>> faces;
  std::vector<double> areas;
};

Pieces connected_pieces(const PreparedMesh& prepared, const std::vector<int>& faces) {
  const auto count = static_cast<std::size_t>(prepared.mesh.faces.rows());
  std::vector<char> in(count, 0);
  for (const int f : faces) in[static_cast<std::size_t>(f)] = 1;
  std::vector<std::vector<int>> neighbours(count);
  for (const Edge& edge : welded_edges(prepared.mesh, prepared.weld)) {
    int last = -1;
    for (const int f : edge.faces) {
      if (in[static_cast<std::size_t>(f)] == 0) continue;
      if (last >= 0) {
        neighbours[static_cast<std::size_t>(f)].push_back(last);
        neighbours[static_cast<std::size_t>(last)].push_back(f);
      }
      last = f;
    }
  }
  Pieces result;
  result.piece_of_face.assign(count, -1);
  for (const int first : faces) {
    if (result.piece_of_face[static_cast<std::size_t>(first)] >= 0) continue;
    const auto number = static_cast<int>(result.faces.size());
    std::vector<int> piece{first};
    result.piece_of_face[static_cast<std::size_t>(first)] = number;
    double area = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const int face = piece[i];
      area += prepared.areas[face];
      for (const int next : neighbours[static_cast<std::size_t>(face)]) {
        if (result.piece_of_face[static_cast<std::size_t>(next)] >= 0) continue;
        result.piece_of_face[static_cast<std::size_t>(next)] = number;
        piece.push_back(next);
      }
    }
    result.faces.push_back(std::move(piece));
    result.areas.push_back(area);
  }
  return result;
}

}  // namespace

std::vector<int> symmetric_faces(const PreparedMesh& prepared, const SurfaceIndex& whole,
                                 const GroupPlacement& placement, double tolerance, const RunContext& context) {
  const OrbitTest test(prepared, placement, tolerance);
  return Erosion(prepared, test, context).run(whole);
}

std::vector<int> connected_orbit(const PreparedMesh& prepared, const GroupPlacement& placement,
                                 const std::vector<int>& symmetric, const std::vector<int>& seeds, double tolerance,
                                 const RunContext& context) {
  constexpr double kMostly = 0.5;  // of either piece's area
  if (symmetric.empty()) return {};
  const Pieces pieces = connected_pieces(prepared, symmetric);
  std::vector<char> taken(pieces.faces.size(), 0);
  std::vector<std::size_t> order;
  const auto take = [&](int piece) {
    if (piece < 0 || taken[static_cast<std::size_t>(piece)] != 0) return;
    taken[static_cast<std::size_t>(piece)] = 1;
    order.push_back(static_cast<std::size_t>(piece));
  };
  for (const int seed : seeds) take(pieces.piece_of_face[static_cast<std::size_t>(seed)]);
  const OrbitTest test(prepared, placement, tolerance);
  const SurfaceIndex inside(prepared.mesh, symmetric);
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < order.size() && order.size() < pieces.faces.size(); ++i) {
    const std::size_t piece = order[i];
    for (const Motion& motion : test.motions()) {
      context.check();
      std::map<int, double> received;  // by piece: the area that falls on it
      for (const int face : pieces.faces[piece]) {
        face_points(prepared, face, kPointSpacing * tolerance, kMaxEdgeCuts, points);
        const double share = prepared.areas[face] / static_cast<double>(points.size());
        for (const Vector3d& point : points) {
          const int image = test.image(inside, motion, face, point);
          if (image >= 0) received[pieces.piece_of_face[static_cast<std::size_t>(image)]] += share;
        }
      }
      for (const auto& [other, area] : received) {
        const double whole = std::min(pieces.areas[static_cast<std::size_t>(other)], pieces.areas[piece]);
        if (area > 0 && area >= kMostly * whole) take(other);
      }
    }
  }
  std::vector<int> result;
  for (const std::size_t piece : order) {
    result.insert(result.end(), pieces.faces[piece].begin(), pieces.faces[piece].end());
  }
  std::ranges::sort(result);
  return result;
}

}  // namespace orbifit
