#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/random.h"
#include "cases/spoil.h"
#include "command.h"
#include "detection.h"
#include "remeshing/remesh.h"
#include "truth/transferred_truth.h"

namespace orbifit::benchmarks {

namespace {

constexpr double kFineEdge = 0.012;  // of the diagonal: what noise moves
constexpr double kCutEdge = 0.02;    // likewise: as ragged as the cut may be
constexpr double kCutShare = 0.2;    // of the area

// A mesh that came from a model's, with the face from which each of its own came.
struct Made {
  Mesh mesh;
  std::vector<int> source_face;
};

Made made_of(Derived derived) {
  return {std::move(derived.mesh), std::move(derived.source_face)};
}

// Faces by the source that they came from.
std::vector<int> transferred_by_source(const std::vector<int>& faces, const std::vector<int>& source_face,
                                       int sources) {
  std::vector<char> chosen(static_cast<std::size_t>(sources), 0);
  for (const int face : faces) chosen[static_cast<std::size_t>(face)] = 1;
  std::vector<int> result;
  for (std::size_t f = 0; f < source_face.size(); ++f) {
    if (chosen[static_cast<std::size_t>(source_face[f])] != 0) result.push_back(static_cast<int>(f));
  }
  return result;
}

// The same surface in more triangles: what was right stays right.
TruthModel refined(TruthModel model, Made made) {
  const auto sources = static_cast<int>(model.mesh.faces.rows());
  const auto transfer = [&](std::vector<int>& faces) {
    faces = transferred_by_source(faces, made.source_face, sources);
  };
  const auto transfer_all = [&](std::vector<Region>& regions, std::vector<Pattern>& patterns) {
    for (Region& region : regions) transfer(region.faces);
    for (Pattern& pattern : patterns) {
      for (PatternInstance& instance : pattern.instances) transfer(instance.faces);
    }
  };
  DetectionTruth& truth = model.truth;
  transfer_all(truth.expected.regions, truth.expected.patterns);
  transfer_all(truth.optional_regions, truth.optional_patterns);
  for (auto& [id, sets] : truth.also_accepted) std::ranges::for_each(sets, transfer);
  model.mesh = std::move(made.mesh);
  truth.expected.mesh_vertices = static_cast<int>(model.mesh.vertices.rows());
  truth.expected.mesh_faces = static_cast<int>(model.mesh.faces.rows());
  return model;
}

// What is on one side of a plane in a random direction is removed, so much that a share of the area goes.
Made without_a_part(Made made, Random& random) {
  const Eigen::VectorXd areas = face_areas(made.mesh);
  HalfSpace removed;
  removed.normal = random.direction();
  std::vector<std::pair<double, double>> heights;  // of the faces, and their areas
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    double height = 0;
    for (int k = 0; k < 3; ++k) height += made.mesh.vertices.row(made.mesh.faces(f, k)).dot(removed.normal) / 3;
    heights.emplace_back(height, areas[f]);
  }
  std::ranges::sort(heights, std::ranges::greater{});
  double left = kCutShare * areas.sum();
  const auto last = std::ranges::find_if(heights, [&](const auto& face) { return (left -= face.second) <= 0; });
  removed.point = (last == heights.end() ? heights.back() : *last).first * removed.normal;
  Made result = made_of(orbifit::cut(made.mesh, removed));
  for (int& source : result.source_face) source = made.source_face[static_cast<std::size_t>(source)];
  return result;
}

Made with_own_faces(const Mesh& mesh) {
  Made made{mesh, std::vector<int>(static_cast<std::size_t>(mesh.faces.rows()))};
  std::iota(made.source_face.begin(), made.source_face.end(), 0);
  return made;
}

}  // namespace

std::string CaseForm::name() const {
  return std::string(remeshed ? "remesh" : "assembly") + (cut ? ", cut" : "");
}

std::string CaseForm::file_name() const {
  return std::string(remeshed ? "remesh" : "assembly") + (cut ? "-cut" : "") +
         (noise > 0 ? "-noise" + short_number(noise) : "");
}

TruthModel case_of(const SuiteModel& suite_model, const CaseForm& form, RunContext& context) {
  // Every form of a model has the same pose; the same noise falls on the same mesh.
  Random random(context.seed, "detection benchmark, " + suite_model.name);
  RunContext own = context;
  own.seed = random.next();
  const std::uint64_t pose_seed = random.next();
  const std::uint64_t noise_seed = random.next();

  TruthModel model = suite_model.build();
  Made made;
  if (form.remeshed) {
    Remeshed remeshed = remesh(model.mesh, {}, own);
    made = {std::move(remeshed.mesh), std::move(remeshed.source_face)};
  } else if (form.cut || form.noise > 0) {
    made = made_of(subdivided(model.mesh, form.noise > 0 ? kFineEdge : kCutEdge));
  } else {
    made = with_own_faces(model.mesh);
  }
  if (form.cut) made = without_a_part(std::move(made), random);
  if (form.remeshed || form.cut) {
    DetectionTruth truth = transferred_truth(model, made.mesh, made.source_face, {}, own);
    model = {std::move(made.mesh), std::move(truth)};
  } else {
    model = refined(std::move(model), std::move(made));
  }
  if (form.noise > 0) model.mesh = noisy(model.mesh, form.noise, noise_seed);
  TruthModel posed = transformed(model, random_pose(model.mesh, {}, pose_seed));
  posed.truth.expected.mesh_diagonal = diagonal(posed.mesh.vertices);
  return posed;
}

}  // namespace orbifit::benchmarks
