#include <cmath>
#include <limits>
#include <memory>

#include <CLI/CLI.hpp>
#include <embree3/rtcore.h>

#include "base/random.h"
#include "benchmarks.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "models.h"
#include "stage_run.h"
#include "stopwatch.h"
#include "symmetry/moving_surface.h"

namespace orbifit::benchmarks {

namespace {

constexpr int kQueries = 20000;

struct MovingOptions {
  std::vector<std::string> models{"bar", "yard_tool", "car", "plane"};
  StageRun stages;
};

// Embree's tree over a mesh that moves, refitted instead of built anew.
class RefittedScene {
 public:
  explicit RefittedScene(const Mesh& mesh) : mesh_(&mesh) {
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);  // others never refit
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows());
    const auto faces = static_cast<std::size_t>(mesh.faces.rows());
    vertices_ = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
    auto* corners = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), faces));
    for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) corners[i] = static_cast<unsigned>(mesh.faces.data()[i]);
    rtcSetGeometryPointQueryFunction(geometry_, measure);
    rtcAttachGeometry(scene_, geometry_);
    move(mesh);
  }
  ~RefittedScene() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  RefittedScene(const RefittedScene&) = delete;
  RefittedScene& operator=(const RefittedScene&) = delete;

  void move(const Mesh& mesh) {
    mesh_ = &mesh;
    for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i) {
      vertices_[i] = static_cast<float>(mesh.vertices.data()[i]);
    }
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

  double nearest(const Eigen::Vector3d& point) const {
    Query query{mesh_, point, std::numeric_limits<double>::infinity()};
    RTCPointQuery ball{};
    ball.x = static_cast<float>(point.x());
    ball.y = static_cast<float>(point.y());
    ball.z = static_cast<float>(point.z());
    ball.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &ball, &context, nullptr, &query);
    return query.distance;
  }

 private:
  struct Query {
    const Mesh* mesh;
    Eigen::Vector3d point;
    double distance;
  };

  static bool measure(RTCPointQueryFunctionArguments* arguments) {
    Query& query = *static_cast<Query*>(arguments->userPtr);
    const auto corners = query.mesh->faces.row(static_cast<Eigen::Index>(arguments->primID));
    const Eigen::Vector3d a = query.mesh->vertices.row(corners[0]);
    const Eigen::Vector3d b = query.mesh->vertices.row(corners[1]);
    const Eigen::Vector3d c = query.mesh->vertices.row(corners[2]);
    const Eigen::Vector3d weights = nearest_on_triangle(query.point, a, b, c);
    const double distance = (weights[0] * a + weights[1] * b + weights[2] * c - query.point).norm();
    if (!(distance < query.distance)) return false;
    query.distance = distance;
    // Rounded up, so that single precision loses nothing.
    arguments->query->radius = static_cast<float>(distance * (1 + 1e-5));
    return true;
  }

  RTCDevice device_ = rtcNewDevice("threads=1");
  RTCScene scene_ = nullptr;
  RTCGeometry geometry_ = nullptr;
  const Mesh* mesh_;
  float* vertices_ = nullptr;
};

// As a wave of a twentieth of the diagonal bends it.
Points bent(const Mesh& mesh) {
  const double size = diagonal(mesh.vertices);
  Points result = mesh.vertices;
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    result(v, 2) += 0.05 * size * std::sin(6 * mesh.vertices(v, 0) / size);
  }
  return result;
}

std::vector<std::string> measure(const std::string& name, const RunContext& context) {
  Mesh mesh = benchmark_model(name).mesh;
  MovingSurface ours(mesh);
  RefittedScene theirs(mesh);
  mesh.vertices = bent(mesh);
  const TimingOptions timing;
  const double ours_move = median_ms([&] { ours.move(mesh, context); }, timing);
  const double theirs_move = median_ms([&] { theirs.move(mesh); }, timing);
  Random random(context.seed, "points near a surface that moves");
  SurfaceSamples samples = sample_surface(mesh, kQueries, random);
  samples.points += 0.01 * diagonal(mesh.vertices) * samples.normals;
  Eigen::VectorXd by_ours(kQueries);
  Eigen::VectorXd by_theirs(kQueries);
  const auto ask = [&](Eigen::VectorXd& distances, const auto& nearest) {
    const auto all = [&] {
      for (int i = 0; i < kQueries; ++i) distances[i] = nearest(samples.points.row(i).transpose());
    };
    return 1e3 * median_ms(all, timing) / kQueries;
  };
  const double ours_ask = ask(by_ours, [&](const Eigen::Vector3d& point) { return ours.nearest(point).distance; });
  const double theirs_ask = ask(by_theirs, [&](const Eigen::Vector3d& point) { return theirs.nearest(point); });
  const double apart = (by_ours - by_theirs).cwiseAbs().maxCoeff() / diagonal(mesh.vertices);
  return {name,
          std::to_string(mesh.faces.rows()),
          short_number(ours_move, 3),
          short_number(theirs_move, 3),
          short_number(theirs_move / ours_move, 3),
          short_number(ours_ask, 3),
          short_number(theirs_ask, 3),
          short_number(theirs_ask / ours_ask, 3),
          short_number(apart, 1)};
}

int run(const MovingOptions& options, const CommandContext& given) {
  const RunContext context = stage_context(given, options.stages);
  TextTable table({"model", "faces", "move ms", "Embree", "ratio", "nearest us", "Embree", "ratio", "apart"});
  for (const std::string& model : options.models) {
    given.run.check();
    given.run.message(model);
    table.add(measure(model, context));
  }
  print("Nearest points on a mesh that moves: our boxes, and Embree's tree with RTC_BUILD_QUALITY_REFIT\n" +
        table.text() +
        "move: until all boxes fit the moved mesh; nearest: of points at 1 % of the diagonal from it, both with exact\n"
        "distances in double precision; ratio: Embree's time by ours; apart: the answers, fraction of the diagonal.\n");
  return kDone;
}

}  // namespace

CommandBody moving(CLI::App& app) {
  auto options = std::make_shared<MovingOptions>();
  app.add_option("--models", options->models, "Which models of Table 1")->delimiter(',')->type_name("NAME,...");
  add_stage_run(app, options->stages, "points asked for");
  return [options](CommandContext& context) { return run(*options, context); };
}

}  // namespace orbifit::benchmarks
