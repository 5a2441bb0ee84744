#include "resolution/detail.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "assessment/fit_assessment.h"
#include "basis/subspace_parts.h"
#include "deformation/surface_detail.h"
#include "geometry/exposure.h"
#include "registration/alignment.h"
#include "registration/correspondences.h"
#include "resolution/detail_points.h"
#include "resolution/fit_residuals.h"
#include "resolution/height_prior.h"
#include "resolution/held_out.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Sparse = HeightPrior::Sparse;

struct DetailPolicy {
  int rounds = 2;             // of matching and solving: the second sees which face is nearest to what has moved
  double beyond = 3;          // times the noise: a point that is less beyond an edge may be there by noise
  double halved = 0.5;        // of a level's length
  double least_noise = 1e-3;  // of the heights: what has less is known as well as rounding lets it be
};
constexpr DetailPolicy kDetailPolicy;

// The surface as heights make it, and the scan's points matched to it.
class DetailFit {
 public:
  DetailFit(const FitInput& input, const FitResult& result, DetailPoints scan, double deviation, double noise,
            const RunContext& context)
      : input_(input),
        subspace_(result.subspace),
        base_(result.state()),
        context_(context),
        scan_(std::move(scan)),
        deviation_(deviation),
        noise_(noise),
        size_(diagonal(input.mesh.vertices)),
        mesh_{input.mesh.vertices + vertex_displacements(subspace_, base_, context), input.mesh.faces, {}},
        directions_(vertex_normals(mesh_)),
        quotient_(subspace_, mesh_),
        on_surface_(std::make_shared<const SurfaceVectors>(input.mesh)),
        map_(detail_map(subspace_, base_, *on_surface_, directions_, context)),
        surface_(mesh_) {
    find_exposed();
    const ConjugatedBasis& basis = basis_of(subspace_, base_);
    for (int v = 0; v < static_cast<int>(mesh_.vertices.rows()); ++v) {
      along_.push_back(vertex_way(subspace_, basis, v).along);
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t r = 0; r + 1 < map_.first.size(); ++r) {
      for (auto k = map_.first[r]; k < map_.first[r + 1]; ++k) {
        const DetailMap::Part& part = map_.parts[static_cast<std::size_t>(k)];
        for (int c = 0; c < 3; ++c) {
          entries.emplace_back(3 * static_cast<int>(r) + c, part.representative, part.direction[c]);
        }
      }
    }
    moves_.resize(3 * quotient_.areas.size(), quotient_.areas.size());
    moves_.setFromTriplets(entries.begin(), entries.end());
  }

  VectorXd flat() const { return VectorXd::Zero(quotient_.areas.size()); }
  const Points& points() const { return scan_.points; }

  /// The side of an equilateral triangle of the mean area: detail cannot be finer.
  double side() const {
    const double area = face_areas(mesh_).sum() / static_cast<double>(mesh_.faces.rows());
    return std::sqrt(4 * area / std::numbers::sqrt3);
  }

  SubspaceState state_of(const VectorXd& heights) const {
    SubspaceState state = base_;
    state.detail = surface_detail(subspace_, on_surface_, map_, directions_, heights);
    return state;
  }

  /// The likeliest heights, from those. \param left_out  of the points
  VectorXd solved(VectorXd heights, double length, const std::vector<char>& left_out) {
    const HeightPrior prior(quotient_, deviation_, length);
    for (int round = 0; round < kDetailPolicy.rounds; ++round) {
      std::vector<Correspondence> pairs = matched(heights);
      std::erase_if(pairs, [&](const Correspondence& pair) {
        // Noise takes points beyond an edge, and none within it: what it takes there would ever widen the shape.
        const bool beyond_an_edge = pair.barycentric.minCoeff() <= 0 && pair.distance < kDetailPolicy.beyond * noise_;
        return beyond_an_edge || (!left_out.empty() && left_out[static_cast<std::size_t>(pair.scan_point)] != 0);
      });
      heights = step(pairs, prior, heights);
    }
    return heights;
  }

  /// Squared distances of all points, robust; squared diagonals.
  std::vector<double> errors(const VectorXd& heights) {
    std::vector<double> result(static_cast<std::size_t>(scan_.points.rows()), kLastRobust * kLastRobust);
    for (const Correspondence& pair : matched(heights)) {
      result[static_cast<std::size_t>(pair.scan_point)] = robust_error(pair.distance / size_, kLastRobust);
    }
    return result;
  }

 private:
  // Asked a third of a face at a time, next to each corner.
  void find_exposed() {
    constexpr double kNextToCorner = 0.7;
    const Exposure exposed(mesh_);
    exposed_.resize(3 * static_cast<std::size_t>(mesh_.faces.rows()));
    parallel_for(context_, exposed_.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vector3d weights = Vector3d::Constant((1 - kNextToCorner) / 2);
        weights[static_cast<Index>(i % 3)] = kNextToCorner;
        const auto corners = mesh_.faces.row(static_cast<Index>(i / 3));
        exposed_[i] = exposed(mesh_.vertices(corners, Eigen::all).transpose() * weights) ? 1 : 0;
      }
    });
  }

  // To surface that a scanner can see.
  std::vector<Correspondence> matched(const VectorXd& heights) {
    mesh_.vertices = input_.mesh.vertices + vertex_displacements(subspace_, state_of(heights), context_);
    surface_.move(mesh_, context_);
    CorrespondenceOptions options;
    options.max_distance = kLastReach * size_;
    options.signed_normals = scan_.signed_normals;
    options.trim = 1;
    options.direction_noise = kDirectionNoise * size_;
    options.robust_scale = kLastRobust * size_;
    std::vector<Correspondence> pairs =
        find_correspondences(surface_, scan_.points, scan_.normals, options, context_, &likely_);
    std::erase_if(pairs, [&](const Correspondence& pair) {
      Index corner = 0;
      pair.barycentric.maxCoeff(&corner);
      return exposed_[3 * static_cast<std::size_t>(pair.face) + static_cast<std::size_t>(corner)] == 0;
    });
    return pairs;
  }

  // Least squares.
  VectorXd step(const std::vector<Correspondence>& pairs, const HeightPrior& prior, const VectorXd& heights) const {
    std::vector<Eigen::Triplet<double>> entries;
    VectorXd offsets(static_cast<Index>(pairs.size()));
    VectorXd weights(offsets.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Correspondence& pair = pairs[i];
      const auto row = static_cast<Index>(i);
      Vector3d foot = Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        const auto vertex = static_cast<std::size_t>(mesh_.faces(pair.face, k));
        foot += pair.barycentric[k] * mesh_.vertices.row(mesh_.faces(pair.face, k)).transpose();
        const Vector3d along = pair.barycentric[k] * (along_[vertex].transpose() * pair.normal);
        const int r = subspace_->orbits.followers[vertex].representative;
        for (int c = 0; c < 3; ++c) entries.emplace_back(static_cast<int>(i), 3 * r + c, along[c]);
      }
      offsets[row] = pair.normal.dot(scan_.points.row(pair.scan_point).transpose() - foot);
      weights[row] = pair.weight / (noise_ * noise_);
    }
    Sparse rows(offsets.size(), moves_.rows());
    rows.setFromTriplets(entries.begin(), entries.end());
    rows = Sparse(rows * moves_);
    const auto normal_times = [&](const VectorXd& x) -> VectorXd {
      return rows.transpose() * weights.cwiseProduct(rows * x) + prior.precision_times(x);
    };
    // What the points say, lumped onto the diagonal.
    VectorXd known = VectorXd::Zero(rows.cols());
    for (Index row = 0; row < rows.outerSize(); ++row) {
      double sum = 0;
      for (Sparse::InnerIterator it(rows, row); it; ++it) sum += std::abs(it.value());
      for (Sparse::InnerIterator it(rows, row); it; ++it) known[it.col()] += weights[row] * sum * std::abs(it.value());
    }
    return heights + solve_with_prior(prior, known, normal_times,
                                      rows.transpose() * weights.cwiseProduct(offsets) - prior.precision_times(heights),
                                      context_);
  }

  const FitInput& input_;
  const Subspace subspace_;
  const SubspaceState base_;
  const RunContext& context_;
  const DetailPoints scan_;
  double deviation_, noise_, size_;  // template units
  Mesh mesh_;                        // as last matched
  const Points directions_;
  const QuotientSurface quotient_;
  std::shared_ptr<const SurfaceVectors> on_surface_;
  const DetailMap map_;
  Sparse moves_;                        // 3#R by #R
  std::vector<Eigen::Matrix3d> along_;  // of each vertex, from its representative
  MovingSurface surface_;
  std::vector<int> likely_;
  std::vector<char> exposed_;  // three of each face
};

void take_over(const DetailFit& fit, const VectorXd& heights, const FitInput& input, const PlacedScan& start,
               const FitOptions& options, const RunContext& context, FitResult& result) {
  result.detail = fit.state_of(heights).detail;
  const Points before = to_template(result.pose, result.fitted.vertices);
  const Points after = input.mesh.vertices + vertex_displacements(result.subspace, result.state(), context);
  result.detail_rms = std::sqrt((after - before).rowwise().squaredNorm().mean()) / diagonal(input.mesh.vertices);
  result.fitted.vertices = from_template(result.pose, after);
  result.annotation.mesh_diagonal = diagonal(result.fitted.vertices);
  assess_fit(input, with_others_moved(start, result.others), start.views->silhouette.seen(), options, context, result);
}

}  // namespace

void add_detail(const FitInput& input, const PlacedScan& start, const FitOptions& options, const RunContext& context,
                FitResult& result) {
  const FitResiduals residuals = fit_residuals(input, start, result, context);
  const double size = diagonal(input.mesh.vertices);
  if (residuals.shared <= kWorthRefining) {
    context.message("no detail: neighbouring points have next to nothing in common that the fit leaves");
    return;
  }
  context.progress("detail", 0);
  const double deviation = std::sqrt(residuals.shared_squared) * size;
  const double noise = std::max(start.scan.noise / result.pose.scale, kDetailPolicy.least_noise * deviation);
  DetailFit fit(input, result, detail_points(input, start, result, context), deviation, noise, context);
  if (result.subspace.radius() < fit.side()) {
    context.message("no detail: the template's triangles are larger than what the subspace shows");
    return;
  }
  VectorXd heights = fit.flat();
  double kept = 0;
  for (double length = result.subspace.radius(); length >= fit.side(); length *= kDetailPolicy.halved) {
    context.progress("detail", 1 - fit.side() / length);
    const std::vector<char> left_out = some_patches(fit.points(), length, context.seed);
    const VectorXd coarse = kept > 0 ? fit.solved(heights, kept, left_out) : heights;
    const std::vector<double> before = of_chosen(fit.errors(coarse), left_out);
    if (before.empty()) break;
    const std::vector<double> after = of_chosen(fit.errors(fit.solved(coarse, length, left_out)), left_out);
    const bool better = smaller(before, after);
    result.detail_levels.push_back({length / size, root_mean(before), root_mean(after), better});
    if (!better) break;
    kept = length;
    heights = fit.solved(heights, kept, {});
  }
  if (kept > 0) take_over(fit, heights, input, start, options, context, result);
}

}  // namespace orbifit
