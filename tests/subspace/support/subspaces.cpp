#include "subspaces.h"

#include <algorithm>
#include <memory>

#include "orbifit/subspace/displacement_field.h"

#include "base/random.h"
#include "basis/conjugated_regions.h"
#include "basis/subspace_parts.h"

namespace orbifit {

Subspace subspace_of(const GeneratedModel& model, GroupMode mode, double relative_radius, LiftKind lift) {
  SubspaceOptions options;
  options.mode = mode;
  options.lift = lift;
  options.radius = relative_radius * diagonal(model.mesh.vertices);
  return build_subspace(model.mesh, model.truth, options, RunContext{});
}

SubspaceState random_state(const Subspace& subspace, double size, double turn) {
  Random random(11, "coordinates");
  SubspaceState state;
  if (subspace->mode == GroupMode::moving) {
    const ConjugatedRegions regions(subspace);
    const auto angle = [&] { return turn * random.normal(); };
    const ConjugatedRegions::Turns turns =
        regions.turned(regions.rest(), Eigen::VectorXd::NullaryExpr(regions.freedom(), angle));
    state.basis = std::make_shared<const ConjugatedBasis>(conjugated_basis(subspace, regions.rotations(turns)));
  }
  const auto coordinate = [&] { return size * subspace->diagonal * random.normal(); };
  state.q = Eigen::VectorXd::NullaryExpr(basis_of(subspace, state).degrees_of_freedom(), coordinate);
  return state;
}

GeneratedModel cut_irregularly(const GeneratedModel& model) {
  Random random(17, "cut");
  GeneratedModel result = model;
  result.mesh.polygon_of_face.clear();
  const Eigen::Index faces = model.mesh.faces.rows();
  Eigen::Index points = model.mesh.vertices.rows();
  Eigen::Index cut = 0;
  std::vector<std::vector<int>> parts(static_cast<std::size_t>(faces));
  result.mesh.vertices.conservativeResize(points + faces, 3);
  result.mesh.faces.conservativeResize(3 * faces, 3);
  for (Eigen::Index f = 0; f < faces; ++f) {
    const Eigen::RowVector3i corners = model.mesh.faces.row(f);
    const auto add = [&](int a, int b, int c) {
      result.mesh.faces.row(cut) << a, b, c;
      parts[static_cast<std::size_t>(f)].push_back(static_cast<int>(cut++));
    };
    if (random.below(3) != 0) {
      add(corners[0], corners[1], corners[2]);
      continue;
    }
    Eigen::RowVector3d shares(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
    shares /= shares.sum();
    const auto middle = static_cast<int>(points);
    result.mesh.vertices.row(points++) = shares[0] * model.mesh.vertices.row(corners[0]) +
                                         shares[1] * model.mesh.vertices.row(corners[1]) +
                                         shares[2] * model.mesh.vertices.row(corners[2]);
    for (int k = 0; k < 3; ++k) add(corners[k], corners[(k + 1) % 3], middle);
  }
  result.mesh.vertices.conservativeResize(points, 3);
  result.mesh.faces.conservativeResize(cut, 3);
  const auto renumber = [&](std::vector<int>& list) {
    std::vector<int> now;
    for (const int face : list) {
      const std::vector<int>& new_faces = parts[static_cast<std::size_t>(face)];
      now.insert(now.end(), new_faces.begin(), new_faces.end());
    }
    list = now;
  };
  result.truth.mesh_vertices = static_cast<int>(points);
  result.truth.mesh_faces = static_cast<int>(cut);
  for (Region& region : result.truth.regions) renumber(region.faces);
  for (Pattern& pattern : result.truth.patterns) {
    for (PatternInstance& instance : pattern.instances) renumber(instance.faces);
  }
  return result;
}

WorstResidual worst_residual(const GeneratedModel& model, const Subspace& subspace, const SubspaceState& state,
                             int pairs) {
  WorstResidual worst;
  const auto consider = [&](double residual, const std::string& name) {
    if (!(residual <= worst.residual)) worst = {residual, name};
  };
  for (std::size_t i = 0; i < model.truth.regions.size(); ++i) {
    const Region& region = model.truth.regions[i];
    consider(field_residual(subspace, model.mesh, region, static_cast<int>(i), state, RunContext{}, pairs).max,
             region.name + " (" + region.group.symbol() + ")");
  }
  for (std::size_t i = 0; i < model.truth.patterns.size(); ++i) {
    const Pattern& pattern = model.truth.patterns[i];
    consider(pattern_residual(subspace, model.mesh, pattern, static_cast<int>(i), state, RunContext{}).max,
             "pattern " + pattern.name);
  }
  return worst;
}

Handle handle_at(const Mesh& mesh, const Eigen::Vector3d& centre, double radius) {
  Handle handle;
  handle.name = "handle";
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    if ((mesh.vertices.row(v).transpose() - centre).norm() <= radius) handle.vertices.push_back(static_cast<int>(v));
  }
  return handle;
}

}  // namespace orbifit
