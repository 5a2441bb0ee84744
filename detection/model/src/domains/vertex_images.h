#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"

#include "geometry/vertex_finder.h"

namespace orbifit {

/// Of a mesh, which vertices lie where motions take vertices. What was asked once is remembered: annotations of one
/// mesh share most of their motions, and of most meshes most vertices have no image at all. Not for use by several
/// threads.
class VertexImages {
 public:
  static constexpr int kNone = VertexFinder::kNone;
  static constexpr int kSeveral = VertexFinder::kSeveral;
  static constexpr std::size_t kMostRemembered = std::size_t{1} << 25U;  ///< 128 MiB

  /// \param vertices  kept by reference
  /// \param tolerance  how near is there, mesh units
  /// \param most_remembered  images; those of more motions are looked up each time
  VertexImages(const Points& vertices, double tolerance, std::size_t most_remembered = kMostRemembered)
      : vertices_(vertices), finder_(vertices, tolerance), most_remembered_(most_remembered) {}
  VertexImages(const VertexImages&) = delete;
  VertexImages& operator=(const VertexImages&) = delete;

  const VertexGrid& grid() const { return finder_.grid(); }

  /// Where one motion takes vertices.
  class Images {
   public:
    /// The vertex where it takes a vertex, or kNone, or kSeveral. O(1), on average.
    int operator()(int vertex) {
      if (known_.empty()) return of_.finder_.at(place_of(vertex));
      int& known = known_[static_cast<std::size_t>(vertex)];
      if (known == kUnknown) known = of_.finder_.at(place_of(vertex));
      return known;
    }

    /// Asks of several vertices, each given once, on all threads, so that the answers are known.
    void ask(const std::vector<int>& vertices, const RunContext& context);

   private:
    friend class VertexImages;
    static constexpr int kUnknown = -3;
    Images(const VertexImages& of, const Motion& motion, bool remembers)
        : of_(of), motion_(motion), known_(remembers ? static_cast<std::size_t>(of.vertices_.rows()) : 0, kUnknown) {}
    Eigen::Vector3d place_of(int vertex) const;

    const VertexImages& of_;
    Motion motion_;
    std::vector<int> known_;  // empty: nothing is remembered
  };

  /// \return valid as long as this object
  Images& of(const Motion& motion);

 private:
  const Points& vertices_;
  VertexFinder finder_;
  std::size_t most_remembered_;
  std::map<std::array<double, 12>, Images> by_motion_;
};

}  // namespace orbifit
