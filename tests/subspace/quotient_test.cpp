#include "deformation/quotient.h"

#include <cmath>
#include <string>
#include <tuple>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "orbifit/subspace/deformer.h"

#include "base/dense.h"
#include "base/random.h"
#include "basis/subspace_parts.h"
#include "deformation/deformation_energy.h"
#include "deformation/handle_rows.h"
#include "models/orbit_model.h"
#include "subspaces.h"

namespace orbifit {
namespace {

Eigen::Matrix3d random_matrix(Random& random) {
  return Eigen::Matrix3d::NullaryExpr([&] { return random.normal(); });
}

// The largest trace of R^T C over rotations, from the singular values.
double largest_trace(const Eigen::Matrix3d& matrix) {
  const Eigen::Vector3d values = Eigen::JacobiSVD<Eigen::Matrix3d>(matrix).singularValues();
  return values[0] + values[1] + (matrix.determinant() < 0 ? -values[2] : values[2]);
}

Eigen::Matrix3d by_singular_values(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

void expect_nearest(const Eigen::Matrix3d& matrix, const Eigen::Matrix3d& start) {
  const Eigen::Matrix3d rotation = nearest_rotation(matrix, start);
  const double size = matrix.norm();
  EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13) << matrix;
  EXPECT_GT(rotation.determinant(), 0) << matrix;
  EXPECT_NEAR((rotation.transpose() * matrix).trace(), largest_trace(matrix), 1e-13 * (size + 1e-300)) << matrix;
}

enum class Shape { full, planar, line, reflected, symmetric, zero };

class NearestRotation : public testing::TestWithParam<Shape> {};

TEST_P(NearestRotation, HasTheLargestTraceFromAnyStart) {
  Random random(31, "matrices");
  for (int trial = 0; trial < 2000; ++trial) {
    const double scale = std::pow(10.0, random.uniform(-6, 6));
    const Eigen::Matrix3d before = random.rotation();
    const Eigen::Matrix3d after = random.rotation();
    Eigen::Vector3d values(random.uniform(0.5, 2), random.uniform(0.5, 2), random.uniform(0.5, 2));
    switch (GetParam()) {
      case Shape::planar:
        values[2] = 0;
        break;
      case Shape::line:
        values[1] = values[2] = 0;
        break;
      case Shape::reflected:
        values[2] = -0.4;
        break;
      case Shape::symmetric:
        values.setConstant(values[0]);
        break;
      case Shape::zero:
        values.setZero();
        break;
      case Shape::full:
        break;
    }
    const Eigen::Matrix3d matrix = scale * before * values.asDiagonal() * after;
    expect_nearest(matrix, Eigen::Matrix3d::Identity());
    expect_nearest(matrix, random.rotation());
    expect_nearest(matrix, by_singular_values(matrix));
    expect_nearest(matrix, by_singular_values(matrix) * axis_rotation(random.direction(), 1e-5));
    expect_nearest(matrix, by_singular_values(matrix) * axis_rotation(random.direction(), M_PI));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, NearestRotation,
                         testing::Values(Shape::full, Shape::planar, Shape::line, Shape::reflected, Shape::symmetric,
                                         Shape::zero));

TEST(NearestRotation, IsThatOfTheSingularValuesWhereItIsUnique) {
  Random random(32, "matrices");
  for (int trial = 0; trial < 5000; ++trial) {
    const Eigen::Matrix3d matrix = random_matrix(random);
    const Eigen::Vector3d values = Eigen::JacobiSVD<Eigen::Matrix3d>(matrix).singularValues();
    const double gap = values[1] + (matrix.determinant() < 0 ? -values[2] : values[2]);
    if (gap < 1e-3) continue;
    EXPECT_LT((nearest_rotation(matrix, random.rotation()) - by_singular_values(matrix)).norm(), 1e-13 / gap);
  }
}

// The whole computation on all samples, without the quotient (paper, equation 4).
struct FullSolve {
  FullSolve(const Subspace& the_subspace, const Mesh& mesh, const Corotation& the_energy,
            const std::vector<Handle>& handles, double alpha)
      : subspace(the_subspace), energy(the_energy), rows(handles, subspace, mesh) {
    const Eigen::Index freedom = subspace.degrees_of_freedom();
    const auto points = static_cast<Eigen::Index>(rows.vertices().size());
    handle_columns.resize(3 * points, freedom);
    weights.resize(3 * points);
    for (Eigen::Index i = 0; i < 3 * points; ++i) weights[i] = alpha * rows.weights()[static_cast<std::size_t>(i / 3)];
    for (Eigen::Index c = 0; c < freedom; ++c) {
      const Points moved = vertex_displacements(subspace, Eigen::VectorXd::Unit(freedom, c));
      handle_columns.col(c) = stacked(moved(rows.vertices(), Eigen::all));
    }
    const Eigen::SparseMatrix<double> squared = energy.laplacian.transpose() * energy.laplacian;
    stiffness = restricted(subspace->basis.columns, squared);
    Eigen::MatrixXd system = stiffness + handle_columns.transpose() * weights.asDiagonal() * handle_columns;
    system.diagonal().array() += 1e-12 * system.diagonal().mean();
    factor.compute(system);
  }

  Eigen::VectorXd solve(const std::vector<Motion>& motions, int iterations) const {
    const Eigen::VectorXd targets = rows.targets(motions);
    std::vector<Eigen::Matrix3d> rotations(static_cast<std::size_t>(energy.rest.rows()), Eigen::Matrix3d::Identity());
    Eigen::VectorXd q;
    for (int iteration = 0; iteration < iterations; ++iteration) {
      q = factor.solve(subspace->basis.columns.transpose() * stacked(corotated_pull(energy, rotations)) +
                       handle_columns.transpose() * weights.cwiseProduct(targets));
      rotations = local_rotations(energy, energy.rest + sample_displacements(subspace, q), rotations);
    }
    return q;
  }

  const Subspace& subspace;
  const Corotation& energy;
  HandleRows rows;
  Eigen::MatrixXd handle_columns, stiffness;
  Eigen::VectorXd weights;
  Eigen::LDLT<Eigen::MatrixXd> factor;
};

using QuotientCase = std::tuple<std::string, GroupMode, LaplacianKind>;

std::string quotient_case_name(const testing::TestParamInfo<QuotientCase>& info) {
  return std::get<0>(info.param) + "_" + to_string(std::get<1>(info.param)) + "_" + to_string(std::get<2>(info.param));
}

class QuotientOfModel : public testing::TestWithParam<QuotientCase> {};

TEST_P(QuotientOfModel, SolvesAsTheFullComputationDoes) {
  const auto& [name, mode, laplacian] = GetParam();
  const GeneratedModel model = generate(name);
  const Subspace subspace = subspace_of(model, mode, 0.06);
  const Mesh& mesh = model.mesh;
  const double size = subspace->diagonal;
  Deformer deformer(subspace, mesh, {.laplacian = laplacian, .contacts = false});  // equation (3) alone
  Eigen::Index low = 0;
  Eigen::Index high = 0;
  mesh.vertices.col(2).minCoeff(&low);
  mesh.vertices.col(2).maxCoeff(&high);
  const std::vector<Handle> handles{handle_at(mesh, mesh.vertices.row(low).transpose(), 0.1 * size),
                                    handle_at(mesh, mesh.vertices.row(high).transpose(), 0.1 * size)};
  const std::vector<Motion> motions{
      Motion{}, Motion{Eigen::Matrix3d::Identity(), size * Eigen::Vector3d(0.1, 0.05, 0.2)} *
                    Motion::rotation(Eigen::Vector3d(1, 2, 3).normalized(), 0.7, mesh.vertices.row(high).transpose())};
  deformer.set_handles(handles, 100);
  const Corotation energy = deformation_energy(subspace, mesh, laplacian, RunContext{});
  const FullSolve full(subspace, mesh, energy, handles, 100);
  for (const int iterations : {1, 2, 8}) {
    const Eigen::VectorXd q = full.solve(motions, iterations);
    const Eigen::VectorXd by_quotient = deformer.solve(motions, iterations).state.q;
    EXPECT_LT(
        (vertex_displacements(subspace, by_quotient) - vertex_displacements(subspace, q)).rowwise().norm().maxCoeff(),
        1e-10 * size)
        << iterations << " iterations";
  }

  const Quotient quotient(subspace, energy);
  EXPECT_LT((quotient.stiffness() - full.stiffness).norm(), 1e-11 * full.stiffness.norm());
  // The chair has but a mirror plane in common; point Laplacians see the borders of its parts.
  EXPECT_LE(5 * quotient.classes(), (name == "chair" ? 3 : 2) * subspace->sampling.points.rows());
}

INSTANTIATE_TEST_SUITE_P(
    Models, QuotientOfModel,
    testing::Combine(testing::Values("bar", "table", "chair"), testing::Values(GroupMode::fixed, GroupMode::floating),
                     testing::Values(LaplacianKind::graph, LaplacianKind::cotangent, LaplacianKind::point)),
    quotient_case_name);

using GroupCase = std::tuple<std::string, LaplacianKind>;

class QuotientOfGroup : public testing::TestWithParam<GroupCase> {};

// Where one group acts on everything, an orbit is one class. The same at any scale.
TEST_P(QuotientOfGroup, HasOneClassAnOrbitAndTheFullStiffness) {
  const auto& [symbol, laplacian] = GetParam();
  for (const double scale : {1.0, 1e-3, 1e3}) {
    OrbitOptions orbit;
    orbit.subdivisions = 1;
    orbit.radius = scale;
    orbit.frame = Random(3, symbol).rotation();
    orbit.centre = scale * Eigen::Vector3d(0.3, -0.2, 0.7);
    const GeneratedModel model = generate_orbit(PointGroup::parse(symbol).value(), orbit);
    const Subspace subspace = subspace_of(model, GroupMode::floating, 0.15);
    const Corotation energy = deformation_energy(subspace, model.mesh, laplacian, RunContext{});
    const Quotient quotient(subspace, energy);
    EXPECT_EQ(quotient.classes(), subspace->sampling.orbits()) << "scale " << scale;
    const Eigen::SparseMatrix<double> squared = energy.laplacian.transpose() * energy.laplacian;
    const Eigen::MatrixXd stiffness = restricted(subspace->basis.columns, squared);
    EXPECT_LT((quotient.stiffness() - stiffness).norm(), 1e-12 * stiffness.norm()) << "scale " << scale;

    // Rotations, pull and energy as of the full computation.
    const Eigen::VectorXd q = random_state(subspace, 0.05).q;
    std::vector<Eigen::Matrix3d> rotations(static_cast<std::size_t>(quotient.classes()), Eigen::Matrix3d::Identity());
    quotient.rotate(q, rotations);
    const std::vector<Eigen::Matrix3d> still(static_cast<std::size_t>(energy.rest.rows()), Eigen::Matrix3d::Identity());
    const std::vector<Eigen::Matrix3d> full =
        local_rotations(energy, energy.rest + sample_displacements(subspace, q), still);
    Eigen::VectorXd pull;
    quotient.pull(rotations, pull);
    const Eigen::VectorXd full_pull = subspace->basis.columns.transpose() * stacked(corotated_pull(energy, full));
    EXPECT_LT((pull - full_pull).norm(), 1e-9 * stiffness.norm() * subspace->diagonal) << "scale " << scale;
    const double due = laplace_energy(energy, full, sample_displacements(subspace, q));
    EXPECT_NEAR(quotient.energy(q, rotations), due, 1e-9 * due) << "scale " << scale;
  }
}

std::string group_case_name(const testing::TestParamInfo<GroupCase>& info) {
  return std::get<0>(info.param) + "_" + to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(
    Groups, QuotientOfGroup,
    testing::Combine(testing::Values("Cs", "Ci", "C2", "C5", "C3v", "C4v", "C3h", "C6h", "D2", "D5", "D4h", "D3h",
                                     "D2d", "D3d", "S4", "S6", "S8", "T", "Td", "Th", "O", "Oh", "I", "Ih"),
                     testing::Values(LaplacianKind::graph, LaplacianKind::cotangent, LaplacianKind::point)),
    group_case_name);

}  // namespace
}  // namespace orbifit
