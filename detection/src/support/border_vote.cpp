#include "support/border_vote.h"

#include <algorithm>
#include <cstddef>

#include "surface/face_points.h"
#include "surface/thresholds.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

class BorderVote {
 public:
  BorderVote(const PreparedMesh& prepared, double tolerance, const std::vector<Motion>& motions,
             const std::vector<int>& faces, BorderMoves moves)
      : prepared_(prepared),
        tolerance_(tolerance),
        motions_(motions),
        moves_(moves),
        in_(static_cast<std::size_t>(prepared.mesh.faces.rows()), 0),
        images_(in_.size()) {
    for (const int face : faces) in_[static_cast<std::size_t>(face)] = 1;
  }

  std::vector<int> run(std::vector<int> asked, const RunContext& context) {
    constexpr int kPasses = 4;  // faces by which a border may move: one that is off by more is another border
    for (int pass = 0; pass < kPasses; ++pass) {
      asked = at_border(asked);
      std::vector<char> elected(asked.size(), 0);
      parallel_for(context, asked.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          if (i % 256 == 0) context.check();
          elected[i] = is_elected(asked[i]) ? 1 : 0;
        }
      });
      bool any = false;
      for (std::size_t i = 0; i < asked.size(); ++i) {
        char& in = in_[static_cast<std::size_t>(asked[i])];
        any = any || in != elected[i];
        in = elected[i];
      }
      if (!any) break;
    }
    std::vector<int> result;
    for (std::size_t face = 0; face < in_.size(); ++face) {
      if (in_[face] != 0) result.push_back(static_cast<int>(face));
    }
    return result;
  }

 private:
  bool in(int face) const { return in_[static_cast<std::size_t>(face)] != 0; }

  // Of these faces and those around them the ones that have a neighbour on the other side of the border.
  std::vector<int> at_border(const std::vector<int>& faces) const {
    std::vector<int> result;
    for (const int face : faces) {
      for_neighbours(prepared_, face, [&](int other) {
        if (in(other) == in(face)) return;
        result.push_back(face);
        result.push_back(other);
      });
    }
    std::ranges::sort(result);
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  // The faces on which the motions take a face, -1 for none: the same ones in each pass.
  const std::vector<int>& images_of(int face) {
    std::vector<int>& images = images_[static_cast<std::size_t>(face)];
    if (!images.empty()) return images;
    const Vector3d centroid = face_centroid(prepared_, face);
    const Vector3d normal = prepared_.normals.row(face);
    for (const Motion& motion : motions_) {
      images.push_back(
          prepared_.index->nearest_facing(motion(centroid), motion.linear * normal, kAlikeNormals, tolerance_, true)
              .face);
    }
    return images;
  }

  // Not for two threads that ask of the same face.
  bool is_elected(int face) {
    if (moves_ == BorderMoves::inwards && !in(face)) return false;
    std::size_t votes = in(face) ? 1 : 0;
    for (const int image : images_of(face)) {
      if (image < 0 && !in(face)) return false;
      if (image >= 0 && in(image)) ++votes;
    }
    const std::size_t all = motions_.size() + 1;
    return 2 * votes > all || (2 * votes == all && in(face));
  }

  const PreparedMesh& prepared_;
  double tolerance_;
  const std::vector<Motion>& motions_;
  BorderMoves moves_;
  std::vector<char> in_;                  // by face of the mesh
  std::vector<std::vector<int>> images_;  // likewise, of those that were asked
};

}  // namespace

std::vector<int> voted_border(const PreparedMesh& prepared, double tolerance, const std::vector<Motion>& motions,
                              const std::vector<int>& faces, BorderMoves moves, const RunContext& context) {
  return BorderVote(prepared, tolerance, motions, faces, moves).run(faces, context);
}

}  // namespace orbifit
