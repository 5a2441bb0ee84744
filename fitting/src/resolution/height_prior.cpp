#include "resolution/height_prior.h"

#include <array>
#include <map>
#include <numbers>
#include <vector>

#include "orbifit/model/errors.h"

#include "basis/subspace_parts.h"
#include "deformation/mesh_laplacian.h"
#include "solver/normal_solver.h"

namespace orbifit {

using Eigen::Index;
using Eigen::VectorXd;

QuotientSurface::QuotientSurface(const Subspace& subspace, const Mesh& mesh) {
  constexpr double kNoArea = 1e-3;  // of the mean: less has a vertex of no face, or of needles
  const auto& followers = subspace->orbits.followers;
  const Index count = subspace->orbits.representatives();
  std::vector<Eigen::Triplet<double>> entries;
  const Eigen::SparseMatrix<double> each = cotangent_laplacian(mesh);
  for (Index column = 0; column < each.outerSize(); ++column) {
    const int to = followers[static_cast<std::size_t>(column)].representative;
    for (Eigen::SparseMatrix<double>::InnerIterator it(each, column); it; ++it) {
      entries.emplace_back(followers[static_cast<std::size_t>(it.row())].representative, to, it.value());
    }
  }
  stiffness.resize(count, count);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  areas = VectorXd::Zero(count);
  images = VectorXd::Zero(count);
  const VectorXd of_vertices = vertex_areas(mesh);
  std::map<std::array<double, 3>, int> known;  // vertices of seams are at one place
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    const int r = followers[static_cast<std::size_t>(v)].representative;
    areas[r] += of_vertices[v];
    const auto added = known.try_emplace({mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)}, r).second;
    if (added) images[r] += 1;
  }
  areas = areas.cwiseMax(kNoArea * areas.mean());
  images = images.cwiseMax(1);
}

HeightPrior::HeightPrior(const QuotientSurface& quotient, double deviation, double length) {
  const double curvature = 1 / (length * length);
  Sparse mass(quotient.areas.size(), quotient.areas.size());
  mass.setIdentity();
  mass.diagonal() = curvature * quotient.areas;
  root = mass + quotient.stiffness;
  weights = (quotient.areas.cwiseProduct(quotient.images) * 4 * std::numbers::pi * curvature * deviation * deviation)
                .cwiseInverse();
}

VectorXd HeightPrior::precision_times(const VectorXd& heights) const {
  return root.transpose() * weights.cwiseProduct(root * heights);
}

namespace {

class Preconditioner {
 public:
  Preconditioner(const HeightPrior& prior, const VectorXd& known) : weights_(prior.weights) {
    HeightPrior::Sparse sum = prior.root;
    sum.diagonal() += known.cwiseQuotient(weights_).cwiseSqrt();
    const Eigen::SparseMatrix<double> lower = Eigen::SparseMatrix<double>(sum).triangularView<Eigen::Lower>();
    if (!solver_.compute(lower, Eigen::MatrixXd(sum.cols(), 0))) {
      throw NoResultError("the detail of the fit could not be solved for");
    }
  }

  VectorXd solve(const VectorXd& side) const { return solver_.solve(solver_.solve(side).cwiseQuotient(weights_)); }

 private:
  const VectorXd& weights_;
  NormalSolver solver_;
};

}  // namespace

VectorXd solve_with_prior(const HeightPrior& prior, const VectorXd& known,
                          const std::function<VectorXd(const VectorXd&)>& times, const VectorXd& side,
                          const RunContext& context) {
  constexpr double kSolved = 1e-6;  // of the side: far less than noise
  constexpr int kMostSteps = 300;   // some ten times what it takes
  const Preconditioner near(prior, known);
  VectorXd x = VectorXd::Zero(side.size());
  VectorXd rest = side;
  VectorXd better = near.solve(rest);
  VectorXd way = better;
  double product = rest.dot(better);
  const double enough = kSolved * kSolved * product;
  for (int i = 0; i < kMostSteps && product > enough; ++i) {
    context.check();
    const VectorXd image = times(way);
    const double far = product / way.dot(image);
    x += far * way;
    rest -= far * image;
    better = near.solve(rest);
    const double next = rest.dot(better);
    way = better + (next / product) * way;
    product = next;
  }
  return x;
}

}  // namespace orbifit
