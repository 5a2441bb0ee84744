#include "orbifit/subspace/deformer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/SparseCore>

#include "basis/subspace_parts.h"
#include "deformation/bounded_edit.h"
#include "deformation/contact_energy.h"
#include "deformation/deformation_energy.h"
#include "deformation/handle_rows.h"
#include "deformation/moving_solve.h"
#include "deformation/quotient.h"
#include "deformation/symmetric_factor.h"
#include "deformation/unsolvable.h"

namespace orbifit {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Keeps what neither Laplacian nor handles hold where it is: relative to the mean of the diagonal without the contacts.
constexpr double kHold = 1e-12;

// Most that handles may weigh, relative to the energy by their traces: half of a double's digits are left to either.
constexpr double kMaxHandleWeight = 0x1p26;

// What a contact weighs against equation (3): see kContactWeight.
double contact_weight(const Corotation& corotation) {
  return kContactWeight * corotation.laplacian.squaredNorm() / static_cast<double>(corotation.laplacian.cols());
}

SparseMatrix lower(const SparseMatrix& symmetric) {
  return symmetric.triangularView<Eigen::Lower>();
}

SparseMatrix held(Eigen::Index freedom, double weight) {
  return SparseMatrix(Eigen::VectorXd::Constant(freedom, weight).asDiagonal());
}

}  // namespace

struct Deformer::Implementation {
  const Subspace& subspace;
  const Mesh& mesh;
  Corotation corotation;
  Quotient quotient;
  ContactEnergy contacts;
  SparseMatrix stiffness;  // lower half of U^T L^T L U, and the contacts'
  double of_contacts = 0;  // mean of the diagonal that is the contacts'
  HandleRows handles;
  double alpha = 0;
  SparseMatrix system;  // equation (4), left: lower half
  SymmetricFactor factor;
  std::optional<MovingSolve> moving;
  RunContext context;

  Implementation(const Subspace& the_subspace, const Mesh& the_mesh, const DeformerOptions& options,
                 const RunContext& the_context)
      : subspace(the_subspace),
        mesh(the_mesh),
        corotation(deformation_energy(subspace, mesh, options.laplacian, the_context)),
        quotient(subspace, corotation),
        stiffness(lower(quotient.stiffness())),
        context(the_context) {
    const double weight = contact_weight(corotation);
    std::vector<Contact> found;
    // Fixed groups lock parts in place: what touches them could not follow a handle.
    if (options.contacts && subspace->mode != GroupMode::fixed) found = find_contacts(subspace, mesh, {}, context);
    if (subspace->mode == GroupMode::moving && subspace->regions->places() > 0) {
      moving.emplace(subspace, corotation, found, weight, context);
    }
    contacts = ContactEnergy(std::move(found), subspace, weight);
    if (contacts.contacts().empty()) return;
    const SparseMatrix joined = lower(contacts.gram());
    if (joined.size() > 0) of_contacts = joined.diagonal().mean();
    stiffness += joined;
  }

  Deformation solve(const std::vector<Motion>& motions, int iterations, const SubspaceState& start,
                    const RunContext& asked) const;
  Eigen::VectorXd held_back(double weight, Eigen::VectorXd side) const;
};

Deformer::Deformer(const Subspace& subspace, const Mesh& mesh, const DeformerOptions& options,
                   const RunContext& context)
    : implementation_(std::make_unique<Implementation>(subspace, mesh, options, context)) {}

Deformer::~Deformer() = default;
Deformer::Deformer(Deformer&&) noexcept = default;

std::size_t Deformer::contacts() const {
  return implementation_->contacts.contacts().size();
}

void Deformer::set_handles(const std::vector<Handle>& handles, double alpha) {
  Implementation& own = *implementation_;
  own.handles = HandleRows(handles, own.subspace, own.mesh);
  own.alpha = alpha;
  const Eigen::Index freedom = own.stiffness.rows();
  const SparseMatrix pulled = own.handles.gram(freedom);
  const double energy = own.stiffness.diagonal().sum() - own.of_contacts * static_cast<double>(freedom);
  if (const double most = kMaxHandleWeight * energy; most > 0) {
    own.alpha = std::min(own.alpha, most / pulled.diagonal().sum());
  }
  own.system = own.stiffness + own.alpha * pulled;
  if (freedom > 0) own.system += held(freedom, kHold * (own.system.diagonal().mean() - own.of_contacts));
  if (!own.factor.factorise(own.system)) refuse_unsolvable();
}

Deformation Deformer::solve(const std::vector<Motion>& motions, int iterations, const SubspaceState& start,
                            const RunContext* context) const {
  if (motions.size() != implementation_->handles.handles()) {
    throw UsageError("there are " + std::to_string(implementation_->handles.handles()) + " handles but " +
                     std::to_string(motions.size()) + " motions");
  }
  const RunContext& asked = context != nullptr ? *context : implementation_->context;
  if (implementation_->moving) {
    return implementation_->moving->solve(implementation_->handles, implementation_->alpha, motions, iterations, start,
                                          asked);
  }
  return implementation_->solve(motions, iterations, start, asked);
}

// The solution where every coordinate is held by a weight besides.
Eigen::VectorXd Deformer::Implementation::held_back(double weight, Eigen::VectorXd side) const {
  SymmetricFactor firm;
  if (!firm.factorise(system + held(system.rows(), weight))) refuse_unsolvable();
  firm.solve(side);
  return side;
}

Deformation Deformer::Implementation::solve(const std::vector<Motion>& motions, int iterations,
                                            const SubspaceState& start, const RunContext& asked) const {
  const Eigen::Index freedom = subspace.degrees_of_freedom();
  const Eigen::VectorXd targets = handles.targets(motions);
  const Eigen::VectorXd handle_pull = alpha * handles.pull(targets, freedom);
  std::vector<Eigen::Matrix3d> rotations(static_cast<std::size_t>(quotient.classes()), Eigen::Matrix3d::Identity());
  Deformation result;
  Eigen::VectorXd& q = result.state.q;
  q = start.q.size() == freedom ? start.q : Eigen::VectorXd::Zero(freedom);
  if (start.q.size() == freedom) quotient.rotate(q, rotations);
  Eigen::VectorXd previous = q;
  Eigen::VectorXd side(freedom);
  const auto turned = [&](int sample) { return quotient.rotation_of(sample, rotations); };
  // Equation (4), right, with the Laplace coordinates turned.
  const auto pull_all = [&] {
    quotient.pull(rotations, side);
    side += handle_pull;
    contacts.add_pull(turned, side);
  };
  const auto energy_at = [&](const Eigen::VectorXd& at) {
    return quotient.energy(at, rotations) + alpha * handles.squared_error(at, targets) + contacts.value(at, turned);
  };
  const BoundedEdit bound(subspace->diagonal, targets);
  const SparseMatrix& columns = subspace->basis.columns;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    asked.check();
    pull_all();
    factor.solve(side);
    if (bound.exceeded(columns, side)) {
      pull_all();
      side = held_back(bound.weight(columns, energy_at(Eigen::VectorXd::Zero(freedom))), std::move(side));
    }
    previous.swap(q);
    q.swap(side);
    if (iteration + 1 < iterations) quotient.rotate(q, rotations);
  }
  if (iterations > 0 && freedom > 0) {
    result.last_change = sample_displacements(subspace, Eigen::VectorXd(q - previous)).rowwise().norm().maxCoeff();
  }
  const double squares = handles.squared_error(q, targets);
  result.handle_error = std::sqrt(squares / handles.total_weight());
  result.energy = energy_at(q);
  return result;
}

}  // namespace orbifit
