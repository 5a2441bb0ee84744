#include "resolution/coarse_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/grid_cell.h"
#include "resolution/proxy_faces.h"
#include "surface/surface_patch.h"
#include "surface/vertex_clusters.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Corners = ClusteredMesh::Corners;

constexpr double kTurned = 0.5;  // cosine: more than that a face must not turn
constexpr int kRounds = 4;       // of splitting clusters at turned faces, and at tears

class Coarsening {
 public:
  Coarsening(const PreparedMesh& prepared, const CoarseMeshOptions& options, const RunContext& context)
      : prepared_(prepared),
        context_(context),
        sites_(prepared),
        clustering_(prepared, sites_, options.tolerance, options.noise),
        most_(options.most_faces * static_cast<double>(prepared.mesh.faces.rows())),
        clusters_(clustering_.clusters(context)),
        as_it_is_(prepared.components.faces.size(), 0),
        clustered_{prepared, sites_, {}, {}} {}

  std::optional<CoarseMesh> run() {
    for (int round = 0;; ++round) {
      context_.check();
      join_faces();
      if (static_cast<double>(clustered_.mesh.faces.rows()) > most_ || round > 2 * kRounds) return std::nullopt;
      std::vector<char> spoilt(clusters_.size(), 0);
      if (round < kRounds && mark_turned(spoilt)) {
        split(spoilt);
        continue;
      }
      const Components coarse =
          connected_components(clustered_.mesh, weld_vertices(clustered_.mesh.vertices, kWeldTolerance));
      if (round < 2 * kRounds && mark_torn(coarse, spoilt)) {
        split(spoilt);
        continue;
      }
      if (!leave_broken_components(coarse)) break;
    }
    complete_proxy_faces(clustered_, context_, proxy_face_);
    std::vector<int> all(first_.size());
    std::iota(all.begin(), all.end(), 0);
    return CoarseMesh{submesh(clustered_.mesh, all), std::move(proxy_face_)};
  }

 private:
  static std::size_t number(int i) { return static_cast<std::size_t>(i); }
  Corners corners_of(int face) const { return clustered_.corners_of(face); }

  // The faces whose corners are in three clusters, those that have the same ones once, component by component. Faces of
  // opposite sense with the same corners are a fold pressed flat: none of them stays.
  void join_faces() {
    clustered_.cluster_of_site.assign(sites_.group.size(), -1);
    clustered_.mesh.vertices.resize(static_cast<Eigen::Index>(clusters_.size()), 3);
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
      clustered_.mesh.vertices.row(static_cast<Eigen::Index>(c)) = clusters_[c].place;
      for (const int site : clusters_[c].sites) clustered_.cluster_of_site[number(site)] = static_cast<int>(c);
    }
    proxy_face_.assign(sites_.of_face.size(), -1);
    first_.clear();
    const std::vector<char> folds = find_folds();
    for (std::size_t component = 0; component < as_it_is_.size(); ++component) {
      for (const int face : prepared_.components.faces[component]) {
        int& proxy_face = proxy_face_[number(face)];
        if (as_it_is_[component] != 0) {
          proxy_face = static_cast<int>(first_.size());
        } else if (like_[number(face)] >= 0 && folds[number(like_[number(face)])] == 0) {
          const int like = like_[number(face)];
          proxy_face = like == face ? static_cast<int>(first_.size()) : proxy_face_[number(like)];
        }
        if (proxy_face == static_cast<int>(first_.size())) first_.push_back(face);
      }
    }
    clustered_.mesh.faces.resize(static_cast<Eigen::Index>(first_.size()), 3);
    for (std::size_t f = 0; f < first_.size(); ++f) {
      const Corners corners = corners_of(first_[f]);
      for (int k = 0; k < 3; ++k) clustered_.mesh.faces(static_cast<Eigen::Index>(f), k) = corners[number(k)];
    }
  }

  // Sets like_. By face: whether it is the first of those with the same three clusters, and there are both senses.
  std::vector<char> find_folds() {
    like_.assign(sites_.of_face.size(), -1);
    std::vector<char> senses(like_.size(), 0);  // bit 0: as the first, bit 1: the other
    std::unordered_map<Corners, int, CellHash> known;
    for (std::size_t f = 0; f < like_.size(); ++f) {
      Corners key = corners_of(static_cast<int>(f));
      std::ranges::sort(key);
      if (key[0] == key[1] || key[1] == key[2]) continue;
      like_[f] = known.try_emplace(key, static_cast<int>(f)).first->second;
      // A sheet of two sides has area on one of them only.
      if (prepared_.areas[static_cast<Eigen::Index>(f)] <= 0) continue;
      senses[number(like_[f])] |= same_sense(static_cast<int>(f), like_[f]) ? 1 : 2;
    }
    for (char& sense : senses) sense = sense == 3 ? 1 : 0;
    return senses;
  }

  bool same_sense(int face, int other) const {
    const Corners a = corners_of(face);
    const Corners b = corners_of(other);
    const auto at = static_cast<std::size_t>(std::ranges::find(b, a[0]) - b.begin());
    return a[1] == b[(at + 1) % 3];
  }

  // Marks the clusters at faces that no longer look to where they did. Whether there are any.
  bool mark_turned(std::vector<char>& spoilt) const {
    bool any = false;
    for (std::size_t f = 0; f < first_.size(); ++f) {
      const auto row = static_cast<Eigen::Index>(f);
      const Vector3d before = prepared_.normals.row(first_[f]);
      if (prepared_.areas[first_[f]] <= 0 || face_normal(clustered_.mesh, row).dot(before) >= kTurned) continue;
      for (int k = 0; k < 3; ++k) {
        const std::size_t cluster = number(clustered_.mesh.faces(row, k));
        if (clusters_[cluster].sites.size() == 1) continue;
        spoilt[cluster] = 1;
        any = true;
      }
    }
    return any;
  }

  // Marks the clusters that alone hold together what is one component of the fine mesh. Whether there are any.
  bool mark_torn(const Components& coarse, std::vector<char>& spoilt) const {
    bool any = false;
    std::vector<int> component(clusters_.size(), -1);
    for (std::size_t f = 0; f < first_.size(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const std::size_t cluster = number(clustered_.mesh.faces(static_cast<Eigen::Index>(f), k));
        const int here = coarse.component_of_face[f];
        if (component[cluster] < 0) component[cluster] = here;
        if (component[cluster] == here || clusters_[cluster].sites.size() == 1) continue;
        spoilt[cluster] = 1;
        any = true;
      }
    }
    return any;
  }

  void split(const std::vector<char>& spoilt) {
    std::vector<VertexCluster> result;
    result.reserve(clusters_.size());
    for (std::size_t c = 0; c < clusters_.size(); ++c) {
      if (spoilt[c] == 0) {
        result.push_back(std::move(clusters_[c]));
      } else {
        std::ranges::move(clustering_.split(clusters_[c]), std::back_inserter(result));
      }
    }
    clusters_ = std::move(result);
  }

  // Leaves as they are the components that are not one component of the coarse mesh each. Whether there are any.
  bool leave_broken_components(const Components& coarse) {
    const std::size_t count = as_it_is_.size();
    std::vector<int> found(count, -1);
    std::vector<int> holder(coarse.faces.size(), -1);
    std::vector<char> broken(count, 0);
    for (std::size_t f = 0; f < first_.size(); ++f) {
      const std::size_t mine = number(prepared_.components.component_of_face[number(first_[f])]);
      const int now = coarse.component_of_face[f];
      if (found[mine] < 0) found[mine] = now;
      if (holder[number(now)] < 0) holder[number(now)] = static_cast<int>(mine);
      const std::size_t other = number(holder[number(now)]);
      if (found[mine] != now) broken[mine] = 1;
      if (other != mine) broken[mine] = broken[other] = 1;
    }
    bool any = false;
    for (std::size_t c = 0; c < count; ++c) {
      broken[c] = (broken[c] != 0 || found[c] < 0) && as_it_is_[c] == 0 ? 1 : 0;
      if (broken[c] == 0) continue;
      as_it_is_[c] = 1;
      any = true;
    }
    if (any) take_apart(broken);
    return any;
  }

  void take_apart(const std::vector<char>& broken) {
    std::vector<VertexCluster> result;
    for (VertexCluster& cluster : clusters_) {
      if (broken[number(sites_.component[number(cluster.sites.front())])] == 0) {
        result.push_back(std::move(cluster));
      } else {
        std::ranges::move(clustering_.singles(cluster.sites), std::back_inserter(result));
      }
    }
    clusters_ = std::move(result);
  }

  const PreparedMesh& prepared_;
  const RunContext& context_;
  Sites sites_;
  VertexClustering clustering_;
  double most_;
  std::vector<VertexCluster> clusters_;
  std::vector<char> as_it_is_;  // by component: not coarsened
  std::vector<int> like_;       // by fine face: the first with its corners' clusters; -1 where two are the same
  ClusteredMesh clustered_;
  std::vector<int> first_;       // by coarse face: the fine face from which it comes
  std::vector<int> proxy_face_;  // by fine face; -1 as long as there is none
};

}  // namespace

std::optional<CoarseMesh> coarse_mesh(const PreparedMesh& prepared, const CoarseMeshOptions& options,
                                      const RunContext& context) {
  return Coarsening(prepared, options, context).run();
}

Components transferred_pieces(const Components& pieces, const PreparedMesh& fine, const CoarseMesh& coarse) {
  struct Share {
    int face, piece;
    double area;
  };
  std::vector<Share> shares;
  shares.reserve(coarse.proxy_face.size());
  for (std::size_t f = 0; f < coarse.proxy_face.size(); ++f) {
    shares.push_back({coarse.proxy_face[f], pieces.component_of_face[f], fine.areas[static_cast<Eigen::Index>(f)]});
  }
  std::ranges::stable_sort(shares, {}, [](const Share& s) { return std::pair(s.face, s.piece); });
  const auto count = static_cast<std::size_t>(coarse.mesh.faces.rows());
  std::vector<int> piece_of(count, 0);
  std::vector<double> most(count, -1);
  for (std::size_t i = 0; i < shares.size();) {
    const Share& first = shares[i];
    double area = 0;
    for (; i < shares.size() && shares[i].face == first.face && shares[i].piece == first.piece; ++i) {
      area += shares[i].area;
    }
    const auto face = static_cast<std::size_t>(first.face);
    if (area <= most[face]) continue;
    most[face] = area;
    piece_of[face] = first.piece;
  }
  Components result;
  std::vector<std::vector<int>> faces(pieces.faces.size());
  for (std::size_t f = 0; f < count; ++f) faces[static_cast<std::size_t>(piece_of[f])].push_back(static_cast<int>(f));
  result.component_of_face.resize(count);
  for (std::vector<int>& piece : faces) {
    if (piece.empty()) continue;
    for (const int f : piece)
      result.component_of_face[static_cast<std::size_t>(f)] = static_cast<int>(result.faces.size());
    result.faces.push_back(std::move(piece));
  }
  return result;
}

}  // namespace orbifit
