#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// The vertices of the welded mesh as the components have them: where components meet in a vertex each has its own.
struct Sites {
  explicit Sites(const PreparedMesh& prepared);

  std::vector<std::array<int, 3>> of_face;  ///< #F: the sites of its corners
  std::vector<int> group;                   ///< by site: of the weld
  std::vector<int> component;               ///< by site
};

/// Neighbouring sites that one vertex stands for.
struct VertexCluster {
  std::vector<int> sites;  ///< ascending, joined by edges, of one component, within one cell
  int level = 0;           ///< of the cells: each has half the size of those of the level before
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

/// Clusters of a fine mesh's vertices in the cells of a grid (Lindstrom 2000: quadrics place what stands for a cell),
/// which is finer where the surface bends: a cluster whose faces' planes all but pass through one point within the cell
/// stays, others fall into those of the next level. What is not joined within a cell by edges stays apart, such as the
/// two sides of a plate.
class VertexClustering {
 public:
  /// \param prepared, sites kept by reference \param tolerance of the detector, a fraction of the diagonal
  /// \param noise standard deviation of what noise was in the vertices, in diagonals
  VertexClustering(const PreparedMesh& prepared, const Sites& sites, double tolerance, double noise);

  /// Costs O(F).
  std::vector<VertexCluster> clusters(const RunContext& context) const;

  /// What becomes of a cluster when cells of its level will not do.
  std::vector<VertexCluster> split(const VertexCluster& cluster) const;

  /// Each site for itself.
  std::vector<VertexCluster> singles(const std::vector<int>& sites) const;

 private:
  struct Quadric;
  using Cell = std::array<std::int64_t, 3>;

  void find_creases();
  Eigen::Vector3d place_of(int site) const;
  Cell cell_of(int site, int level) const;
  bool at_border(int a, int b) const;
  // The sites sorted into sets joined by edges within a cell of the level.
  std::vector<std::vector<int>> joined(const std::vector<int>& sites, int level) const;
  Quadric quadric_of(const std::vector<int>& sites) const;
  void merge(std::vector<int> sites, int level, std::vector<VertexCluster>& merged) const;

  const PreparedMesh& prepared_;
  const Sites& sites_;
  double rough_;                          // how far planes may be off for what is left of noise
  std::vector<double> tolerances_;        // by component
  std::vector<std::array<int, 2>> rims_;  // edges of one face only, as ascending sites; sorted
  std::vector<char> on_rim_;              // by site
  std::vector<char> at_crease_;           // by site: two faces at it differ by 25 degrees across an edge
};

}  // namespace orbifit
