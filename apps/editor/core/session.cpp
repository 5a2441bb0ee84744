#include "session.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/consistent_annotation.h"
#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"
#include "orbifit/subspace/displacement_field.h"
#include "orbifit/subspace/subspace_io.h"

namespace orbifit::editor {

namespace {

constexpr int kFieldPairs = 30;  // of each region: where images lie between vertices a pair takes a third of a ms

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

}  // namespace

void Session::read_mesh(const std::string& file) {
  Mesh mesh = orbifit::read_mesh(file);
  if (!(diagonal(mesh.vertices) > 0)) throw InputError(file, "", "all vertices are at one place");
  DisplayMesh display(mesh);
  mesh_ = std::move(mesh);
  annotation_ = empty_annotation(mesh_, SymmetryAnnotation{}.tolerance);
  handles_ = {};
  symmetric_.resize(0, 3);
  forget_shape();
  symmetric_side_.display = std::move(display);
  symmetric_side_.vertices = mesh_.vertices;
  marks_.assign(4 * symmetric_side_.display.vertices(), 0);
}

void Session::read_annotation(const std::string& file, bool consistent) {
  SymmetryAnnotation annotation = orbifit::read_annotation(file, mesh_);
  annotation_ = consistent ? std::move(annotation) : made_consistent(mesh_, annotation, context);
  forget_groups();
}

void Session::forget_shape() {
  index_.reset();
  picker_.reset();
  picker_stale_ = true;
  forget_groups();
}

void Session::forget_groups() {
  images_.reset();
  pairs_.reset();
  free_.reset();
  symmetric_side_.deformer.reset();
  symmetric_side_.subspace.reset();
  symmetric_side_.state = {};
  symmetric_side_.handles_set = false;
  orbit_.clear();
}

void Session::read_basis(const std::string& file) {
  auto subspace = std::make_unique<Subspace>(read_subspace(file, mesh_, annotation_, context));
  free_.reset();
  symmetric_side_.deformer.reset();
  symmetric_side_.subspace = std::move(subspace);
  symmetric_side_.state = {};
  symmetric_side_.handles_set = false;
}

void Session::build_basis(const SubspaceOptions& options) {
  auto subspace = std::make_unique<Subspace>(build_subspace(mesh_, annotation_, options, context));
  free_.reset();
  symmetric_side_.deformer.reset();
  symmetric_side_.subspace = std::move(subspace);
  symmetric_side_.state = {};
  symmetric_side_.handles_set = false;
}

void Session::write_basis(const std::string& file) const {
  write_subspace(file, subspace(), mesh_, annotation_);
}

void Session::compare(const std::string& basis) {
  const SymmetryAnnotation nothing = empty_annotation(mesh_, annotation_.tolerance);
  Edited other;
  other.subspace = std::make_unique<Subspace>(read_subspace(basis, mesh_, nothing, context));
  other.vertices = mesh_.vertices;
  other.display = symmetric_side_.display;
  other.display.move(mesh_.vertices);
  free_ = std::move(other);
}

Deformer& Session::deformer(Side side) {
  Edited& edited = need(side);
  if (!edited.subspace) throw UsageError("there is no basis");
  if (!edited.deformer) {
    edited.deformer = std::make_unique<Deformer>(*edited.subspace, mesh_, DeformerOptions{}, context);
  }
  return *edited.deformer;
}

void Session::set_handles(const std::string& file) {
  handles_ = read_handles(file, mesh_);
  symmetric_side_.handles_set = false;
  if (free_) free_->handles_set = false;
  clear_marks(kHandle);
  clear_marks(kPin);
  for (const Handle& handle : handles_.handles) {
    const bool pin = handle.name.rfind("pin", 0) == 0;
    mark_vertices(pin ? kPin : kHandle, handle.vertices);
  }
}

void Session::take_vertices(Edited& edited, Points vertices) {
  edited.vertices = std::move(vertices);
  edited.display.move(edited.vertices);
  if (&edited == &symmetric_side_) picker_stale_ = true;
}

SolveRecord Session::solve(Side side, const std::vector<Motion>& motions, int iterations, bool onwards) {
  Edited& edited = need(side);
  Deformer& deformer = this->deformer(side);
  if (!edited.handles_set) {
    deformer.set_handles(handles_.handles, handles_.alpha);
    edited.handles_set = true;
  }
  SolveRecord record;
  const auto start = Clock::now();
  Deformation deformation = deformer.solve(motions, iterations, onwards ? edited.state : SubspaceState{});
  const auto solved = Clock::now();
  Points vertices = vertex_displacements(*edited.subspace, deformation.state, context);
  vertices += mesh_.vertices;
  const auto lifted = Clock::now();
  edited.state = std::move(deformation.state);
  take_vertices(edited, std::move(vertices));
  record.solve_ms = milliseconds(start, solved);
  record.lift_ms = milliseconds(solved, lifted);
  record.show_ms = milliseconds(lifted, Clock::now());
  record.handle_error = deformation.handle_error / edited.display.scale();
  record.energy = deformation.energy;
  return record;
}

void Session::rest() {
  symmetric_side_.state = {};
  take_vertices(symmetric_side_, mesh_.vertices);
  if (free_) take_vertices(*free_, mesh_.vertices);
}

void Session::show(const Points& vertices) {
  if (vertices.rows() != mesh_.vertices.rows()) throw UsageError("not as many vertices as the mesh has");
  take_vertices(symmetric_side_, vertices);
}

SymmetricImages& Session::images() {
  if (!images_) images_.emplace(mesh_, annotation_);
  return *images_;
}

ResidualPairs& Session::pairs() {
  if (!pairs_) pairs_.emplace(mesh_, annotation_, images());
  return *pairs_;
}

Motion Session::carried(int region) const {
  const Edited& edited = need(kSymmetric);
  if (!edited.subspace || edited.state.q.size() == 0) return {};
  return region_motion(*edited.subspace, edited.state, region);
}

std::vector<Residual> Session::residuals(Side side) {
  const Edited& edited = need(side);
  if (edited.state.q.size() == 0) return std::vector<Residual>(annotation_.regions.size());
  if (side == kSymmetric) return field_residuals(subspace(), mesh_, annotation_, edited.state, context, kFieldPairs);
  const Points& images = pairs().images();
  const std::vector<int> nowhere(static_cast<std::size_t>(images.rows()), 0);  // this side has no regions
  return pairs().of_displacement(edited.vertices,
                                 displacement_field(*edited.subspace, edited.state, images, nowhere, context));
}

std::vector<Residual> Session::shape_residuals() {
  return pairs().of_shape(need(kSymmetric).vertices, context);
}

void Session::write_shown(const std::string& file) const {
  Mesh shown = mesh_;
  shown.vertices = need(kSymmetric).vertices;
  write_mesh(file, shown);
}

void Session::write_rest(const std::string& file) const {
  write_mesh(file, mesh_);
}

}  // namespace orbifit::editor
