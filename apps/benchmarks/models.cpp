#include "models.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/errors.h"

namespace orbifit::benchmarks {

namespace {

constexpr double kEnd = 0.08;      // of the longest extent
constexpr double kTurn = 20;       // degrees
constexpr double kMovement = 0.1;  // of the diagonal

struct Source {
  const char* name;
  const char* generator;
  PaperRow paper;
};

constexpr std::array kSources{
    Source{"bar", "bar", {4000, 8000, 1, 96, 18, 13, 2, 3}},
    Source{"fan", "fan", {2000, 4000, 3, 72, 27, 43, 3, 1}},
    Source{"chair", "chair", {15000, 58000, 2, 32, 39, 4, 2, 1}},
};

}  // namespace

std::vector<std::string> benchmark_model_names() {
  std::vector<std::string> names;
  for (const Source& source : kSources) names.emplace_back(source.name);
  return names;
}

BenchmarkModel benchmark_model(const std::string& name) {
  const auto source = std::ranges::find(kSources, name, &Source::name);
  if (source == kSources.end()) {
    std::string known;
    for (const std::string& each : benchmark_model_names()) known += (known.empty() ? "" : ", ") + each;
    throw UsageError("unknown model '" + name + "'; there are " + known);
  }
  GeneratedModel generated = generate(source->generator);
  BenchmarkModel model{name, std::move(generated.mesh), std::move(generated.truth), {}, source->paper};
  model.handles = end_handles(model.mesh);
  return model;
}

std::vector<Handle> end_handles(const Mesh& mesh) {
  const Eigen::Vector3d low = mesh.vertices.colwise().minCoeff();
  const Eigen::Vector3d high = mesh.vertices.colwise().maxCoeff();
  int along = 0;
  (high - low).maxCoeff(&along);
  const int across = (along + 1) % 3;
  const double depth = kEnd * (high[along] - low[along]);
  std::vector<Handle> handles(2);
  handles[0].name = "held";
  handles[1].name = "moved";
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double height = mesh.vertices(v, along);
    if (height <= low[along] + depth) handles[0].vertices.push_back(static_cast<int>(v));
    if (height < high[along] - depth) continue;
    handles[1].vertices.push_back(static_cast<int>(v));
    middle += mesh.vertices.row(v).transpose();
  }
  middle /= static_cast<double>(handles[1].vertices.size());
  handles[1].motion = Motion::rotation(Eigen::Vector3d::Unit(across), kTurn * std::numbers::pi / 180, middle);
  handles[1].motion.translation += kMovement * (high - low).norm() * Eigen::Vector3d::Unit(along);
  return handles;
}

}  // namespace orbifit::benchmarks
