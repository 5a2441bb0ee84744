#include "orbifit/fitting/fit.h"

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/datasets_tools/symmetry_residual.h"
#include "orbifit/datasets_tools/virtual_scan.h"
#include "orbifit/model/errors.h"

#include "base/random.h"

namespace orbifit {
namespace {

struct Case {
  const char* name;
  const char* model;
  std::map<std::string, double> parameters;  // of the truth; the template has the defaults
};

class FitOfModel : public testing::TestWithParam<Case> {
 protected:
  FitOfModel() : template_(generate(GetParam().model)), truth_(generate(GetParam().model, GetParam().parameters)) {
    ScanOptions options;
    options.noise = 0.0005;
    scan_ = virtual_scan(truth_.mesh, options, context_);
    result_ = fit({template_.mesh, template_.truth, scan_, Similarity{}, {}, {}}, {}, context_);
  }

  RunContext context_;
  GeneratedModel template_, truth_;
  PointCloud scan_;
  FitResult result_;
};

TEST_P(FitOfModel, ExplainsTheScanAndCompletesWhatItDidNotSee) {
  ASSERT_TRUE(result_.converged) << result_.stopped_because;
  EXPECT_GT(result_.inlier_ratio, 0.97);
  EXPECT_GT(result_.hidden_fraction, 0.2);
  const Eigen::VectorXd errors =
      (result_.fitted.vertices - truth_.mesh.vertices).rowwise().norm() / diagonal(truth_.mesh.vertices);
  double hidden = 0;
  int count = 0;
  for (Eigen::Index v = 0; v < errors.size(); ++v) {
    if (result_.seen[static_cast<std::size_t>(v)] != 0) continue;
    hidden += errors[v];
    ++count;
  }
  const Eigen::VectorXd before =
      (template_.mesh.vertices - truth_.mesh.vertices).rowwise().norm() / diagonal(truth_.mesh.vertices);
  EXPECT_LT(hidden / count, 0.015);
  EXPECT_LT(hidden / count, 0.5 * before.mean());
}

TEST_P(FitOfModel, KeepsTheWholesGroupExactly) {
  SymmetryAnnotation whole = result_.annotation;
  whole.patterns.clear();
  std::erase_if(whole.regions, [&](const Region& region) {
    return static_cast<Eigen::Index>(region.faces.size()) != template_.mesh.faces.rows();
  });
  ASSERT_FALSE(whole.regions.empty());
  EXPECT_LT(symmetry_residual(result_.fitted, whole, nullptr, CarriedMotions::fixed, context_).worst_floor, 1e-12);
}

TEST_P(FitOfModel, ComesToRest) {
  EXPECT_EQ(result_.stopped_because.substr(0, 9), "converged") << result_.stopped_because;
  // Steps that do not lower the energy are taken back, so that it ends as low as it ever was with what was far then.
  const FitIteration& last = result_.iterations.back();
  EXPECT_LT(last.energy, result_.iterations.front().energy);
  // White noise of 0.05 % warrants hardly more than the least stiffness.
  EXPECT_GE(last.stiffness, FitOptions{}.last_stiffness);
  EXPECT_LT(last.stiffness, 5 * FitOptions{}.last_stiffness);
  EXPECT_LT(result_.iterations[result_.iterations.size() - 2].change, 0.01);
}

TEST_P(FitOfModel, IsTheSameWithTwoThreads) {
  RunContext two;
  two.threads = 2;
  const FitResult again = fit({template_.mesh, template_.truth, scan_, Similarity{}, {}, {}}, {}, two);
  EXPECT_EQ(again.fitted.vertices, result_.fitted.vertices);
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(
    Models, FitOfModel,
    testing::Values(Case{"table", "table", {{"width", 1.0}, {"height", 0.78}}},
                    Case{"chair", "chair", {{"seat_width", 0.48}, {"seat_depth", 0.48}, {"leg_height", 0.46}}}),
    case_name);

// Where nothing is to be moved, two steps at each scale of what is far say so, once the stiffness has fallen.
TEST(Fit, TakesNoMoreStepsThanBringItFarther) {
  RunContext context;
  const GeneratedModel model = generate("table");
  const PointCloud scan = virtual_scan(model.mesh, ScanOptions{}, context);
  FitOptions options;
  options.align = false;
  options.refinements = 0;
  const FitInput input{model.mesh, model.truth, scan, Similarity{}};
  const FitResult there = fit(input, options, context);
  EXPECT_LE(there.iterations.size(), static_cast<std::size_t>(options.levels * options.iterations) + 8);
  FitInput away = input;
  away.pose = {1, Eigen::Matrix3d::Identity(), 0.03 * diagonal(model.mesh.vertices) * Eigen::Vector3d::UnitX()};
  const FitResult moved = fit(away, options, context);
  EXPECT_LT((moved.fitted.vertices - there.fitted.vertices).rowwise().norm().maxCoeff(),
            0.01 * diagonal(model.mesh.vertices));
}

TEST(Fit, OfTheTemplateToItsOwnScanIsTheTemplate) {
  RunContext context;
  const GeneratedModel model = generate("table");
  ScanOptions options;
  options.views = 3;
  const PointCloud scan = virtual_scan(model.mesh, options, context);
  const FitResult result = fit({model.mesh, model.truth, scan, Similarity{}, {}, {}}, {}, context);
  EXPECT_TRUE(result.converged);
  const double worst = (result.fitted.vertices - model.mesh.vertices).rowwise().norm().maxCoeff();
  EXPECT_LT(worst, 0.01 * diagonal(model.mesh.vertices));
}

// Depth cameras err alike at neighbouring points: waves along the rays, which no average over neighbours takes out.
TEST(Fit, DoesNotFollowNoiseThatNeighboursShare) {
  constexpr double kHeight = 0.01;  // of the diagonal
  constexpr double kLength = 0.1;
  RunContext context;
  const GeneratedModel model = generate("table");
  const double size = diagonal(model.mesh.vertices);
  PointCloud scan = virtual_scan(model.mesh, {}, context);
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    const Eigen::Vector3d point = scan.points.row(i);
    const Eigen::Vector3d phase = 2 * std::numbers::pi / (kLength * size) * point;
    const double wave = kHeight * size * std::sin(phase.x()) * std::sin(phase.y() + phase.z());
    scan.points.row(i) += wave * (scan.viewpoints.row(i) - scan.points.row(i)).normalized();
  }
  const FitResult result = fit({model.mesh, model.truth, scan, Similarity{}}, {}, context);
  EXPECT_TRUE(result.converged) << result.stopped_because;
  EXPECT_GT(result.iterations.back().stiffness, 3 * FitOptions{}.last_stiffness);
  const Points off = result.fitted.vertices - model.mesh.vertices;
  EXPECT_LT(std::sqrt(off.rowwise().squaredNorm().mean()), kHeight / 2 * size);
}

// What stood before the table has been taken out of the scan: nothing is seen there, neither the table nor the floor.
TEST(Fit, IsNoLessConfidentWhereTheScanWasCutOff) {
  RunContext context;
  const GeneratedModel model = generate("table");
  PointCloud scan = virtual_scan(model.mesh, {}, context);
  const double size = diagonal(model.mesh.vertices);
  const double middle = bounding_box_centre(model.mesh.vertices).x();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    if (scan.points(i, 0) < middle + 0.1 * size) kept.push_back(i);
  }
  // How far the table goes on where the scan was cut is another matter.
  const auto fitted = [&] {
    FitResult result = fit({model.mesh, model.truth, scan, Similarity{}}, {}, context);
    EXPECT_GT(result.confidence, 0.95 * (1 - result.open_stretch()));
    return result;
  };
  const FitResult whole = fitted();
  EXPECT_EQ(whole.cut_off, 0);
  EXPECT_LT(whole.open_stretch(), 0.1);
  scan.points = Points(scan.points(kept, Eigen::all));
  scan.viewpoints = Points(scan.viewpoints(kept, Eigen::all));
  const FitResult cut = fitted();
  EXPECT_GT(cut.cut_off, 0.1);
  EXPECT_GE(cut.open_stretch(), 0.1);
}

// The crest of the taller back is nearer to the slat below it than to the template's crest.
TEST(Fit, OfAChairWithATallerBackFindsTheRightSlats) {
  RunContext context;
  const GeneratedModel model = generate("chair");
  const GeneratedModel truth =
      generate("chair", {{"back_height", 0.55}, {"leg_height", 0.5}, {"seat_width", 0.5}, {"seat_depth", 0.5}});
  ScanOptions scanner;
  scanner.views = 3;
  const PointCloud scan = virtual_scan(truth.mesh, scanner, context);
  const FitResult result = fit({model.mesh, model.truth, scan, Similarity{}}, {}, context);
  EXPECT_TRUE(result.converged) << result.stopped_because;
  EXPECT_EQ(result.pose.scale, 1);
  const Points off = result.fitted.vertices - truth.mesh.vertices;
  EXPECT_LT(off.rowwise().norm().mean(), 0.005 * diagonal(truth.mesh.vertices));
}

// \param noise of the diagonal
ScanOptions noisy_views(int views, double noise) {
  ScanOptions scanner;
  scanner.views = views;
  scanner.noise = noise;
  return scanner;
}

// ICP with scale makes up for other lengths; what then is too thick or too thin tells the scale.
TEST(Fit, OfOtherLengthsAnywhereFindsTheScaleOfTheParts) {
  RunContext context;
  const GeneratedModel model = generate("desk_fan");
  const GeneratedModel truth = generate("desk_fan", {{"height", 0.4}, {"radius", 0.22}, {"depth", 0.075}});
  PointCloud scan = virtual_scan(truth.mesh, noisy_views(3, 0.001), context);
  Random random(3, "pose of a desk fan");
  const Similarity pose{40, random.rotation(), 300 * random.direction()};
  for (Points* points : {&scan.points, &scan.viewpoints}) {
    for (Eigen::Index i = 0; i < points->rows(); ++i) points->row(i) = pose(points->row(i).transpose()).transpose();
  }
  FitOptions options;
  options.place = true;
  const FitResult result = fit({model.mesh, model.truth, scan, Similarity{}}, options, context);
  EXPECT_TRUE(result.converged) << result.stopped_because;
  const auto off = [&](const Similarity& found) { return std::abs(std::log(found.scale / pose.scale)); };
  EXPECT_GT(off(result.placements.front().pose), 0.1);
  EXPECT_LT(off(result.pose), 0.5 * off(result.placements.front().pose));
  EXPECT_LT(result.field_residual, 1e-12);
}

// A table of which two views tell little fits at several turns and scales.
TEST(Fit, ShortFitsChooseAmongPlacesThatTie) {
  RunContext context;
  const GeneratedModel model = generate("table");
  const GeneratedModel truth = generate("table", {{"width", 1.1}, {"height", 0.66}, {"apron_height", 0.12}});
  ScanOptions scanner = noisy_views(2, 0.002);
  scanner.elevation = 30;
  const PointCloud scan = virtual_scan(truth.mesh, scanner, context);
  FitOptions options;
  options.place = true;
  options.tie = 0.5;
  options.max_tied = 1;
  const auto found_of = [&](int max_tried) {
    options.max_tried = max_tried;
    return fit({model.mesh, model.truth, scan, {3, axis_rotation(Eigen::Vector3d::UnitX(), 1), {9, 9, 9}}}, options,
               context);
  };
  const FitResult first = found_of(1);
  const FitResult chosen = found_of(8);
  ASSERT_GT(first.placements.size(), 1U);
  EXPECT_EQ(first.iterations_in_all, static_cast<int>(first.iterations.size()));
  EXPECT_GT(chosen.iterations_in_all, static_cast<int>(chosen.iterations.size()));
  // What places are compared by: how much a fit explains, whatever the scan leaves open of it.
  const auto explains = [](const FitResult& result) {
    return result.confidence / ((1 - result.open_stretch()) * (1 - result.open_distance()));
  };
  EXPECT_GE(explains(chosen), explains(first) - 0.01);
  EXPECT_TRUE(chosen.converged) << chosen.stopped_because;
  context.threads = 2;  // the places side by side
  const FitResult shared = found_of(8);
  EXPECT_EQ(shared.fitted.vertices, chosen.fitted.vertices);
  EXPECT_EQ(shared.iterations_in_all, chosen.iterations_in_all);
  EXPECT_EQ(shared.confidence, chosen.confidence);
}

// Floating groups carry no leg that stands at another slant: its axis has another direction.
TEST(Fit, CarriesLegsThatSplayWhereGroupsMove) {
  RunContext context;
  const GeneratedModel model = generate("chair");
  const GeneratedModel truth = generate("chair", {{"leg_spread", 0.11}});
  ScanOptions scanner;
  scanner.views = 3;
  scanner.noise = 0.001;
  const PointCloud scan = virtual_scan(truth.mesh, scanner, context);
  FitOptions options;
  options.scan_points = 6000;
  const auto mean_error = [&](GroupMode mode) {
    options.subspace.mode = mode;
    const FitResult result = fit({model.mesh, model.truth, scan, Similarity{}}, options, context);
    EXPECT_LT(result.field_residual, 1e-12);
    const Points off = result.fitted.vertices - truth.mesh.vertices;
    return off.rowwise().norm().mean() / diagonal(truth.mesh.vertices);
  };
  EXPECT_LT(mean_error(GroupMode::moving), 0.003);
  EXPECT_GT(mean_error(GroupMode::floating), 0.006);
}

// What the scan leaves open stays where it is, however long the fit goes on (Kurz et al. 2014 see a partial table
// drift off).
struct Part {
  const char* name;
  Eigen::AlignedBox3d box;  // of the template's bounding box
  double most;              // mean error of the vertices, of the diagonal
};

void PrintTo(const Part& part, std::ostream* out) {
  *out << part.name;
}

class PartOfATable : public testing::TestWithParam<Part> {};

TEST_P(PartOfATable, DoesNotTakeTheRestAway) {
  RunContext context;
  const GeneratedModel model = generate("table");
  ScanOptions scanner;
  scanner.views = 3;
  scanner.noise = 0.002;
  PointCloud scan = virtual_scan(model.mesh, scanner, context);
  const Eigen::AlignedBox3d box(model.mesh.vertices.colwise().minCoeff().transpose(),
                                model.mesh.vertices.colwise().maxCoeff().transpose());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    const Eigen::Vector3d place = (scan.points.row(i).transpose() - box.min()).cwiseQuotient(box.sizes());
    if (GetParam().box.contains(place)) kept.push_back(i);
  }
  ASSERT_GT(kept.size(), 100U);
  scan.points = Points(scan.points(kept, Eigen::all));
  if (scan.normals.rows() > 0) scan.normals = Points(scan.normals(kept, Eigen::all));
  if (scan.viewpoints.rows() > 1) scan.viewpoints = Points(scan.viewpoints(kept, Eigen::all));
  FitOptions options;
  options.align = false;
  options.max_iterations = 200;
  for (const GroupMode mode : {GroupMode::floating, GroupMode::moving}) {
    options.subspace.mode = mode;
    const FitResult result = fit({model.mesh, model.truth, scan, Similarity{}}, options, context);
    const Points off = result.fitted.vertices - model.mesh.vertices;
    EXPECT_LT(off.rowwise().norm().mean(), GetParam().most * diagonal(model.mesh.vertices)) << to_string(mode);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fit, PartOfATable,
    testing::Values(Part{"OneCorner", {Eigen::Vector3d(0.5, 0.5, 0), Eigen::Vector3d(1, 1, 1)}, 0.002},
                    Part{"HalfItsTop", {Eigen::Vector3d(0, 0.5, 0.8), Eigen::Vector3d(1, 1, 1)}, 0.002},
                    Part{"OneFoot", {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.6, 0.6, 0.6)}, 0.005}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(Fit, OfAScanOfSomethingElseSaysThatItFailed) {
  RunContext context;
  const GeneratedModel model = generate("chair");
  PointCloud scan;
  Random random(5);
  scan.points.resize(3000, 3);
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    scan.points.row(i) = (Eigen::Vector3d(4, 4, 4) + 2 * random.direction()).transpose();
  }
  const FitResult result = fit({model.mesh, model.truth, scan, Similarity{}, {}, {}}, {}, context);
  EXPECT_FALSE(result.converged);
  EXPECT_FALSE(result.stopped_because.empty());
}

// Scans in which no chair is, however the template is put.
PointCloud not_a_chair(const std::string& name) {
  Random random(5);
  PointCloud scan;
  scan.points.resize(3000, 3);
  for (Eigen::Index i = 0; i < scan.points.rows(); ++i) {
    const Eigen::Vector3d at(random.uniform(), random.uniform(), random.uniform());
    if (name == "Ball") scan.points.row(i) = random.direction();
    if (name == "Square") scan.points.row(i) << at.x(), at.y(), 0;
    if (name == "Line") scan.points.row(i) << at.x(), 0, 0;
    if (name == "Dust") scan.points.row(i) = at;
  }
  return scan;
}

class FitOfNoChair : public testing::TestWithParam<const char*> {};

TEST_P(FitOfNoChair, SaysThatItFailed) {
  RunContext context;
  const GeneratedModel model = generate("chair");
  FitOptions options;
  options.place = true;
  const FitResult result =
      fit({model.mesh, model.truth, not_a_chair(GetParam()), Similarity{}, {}, {}}, options, context);
  EXPECT_FALSE(result.converged);
  EXPECT_FALSE(result.stopped_because.empty());
}

INSTANTIATE_TEST_SUITE_P(Scans, FitOfNoChair, testing::Values("Ball", "Square", "Line", "Dust"),
                         [](const auto& each) { return std::string(each.param); });

TEST(Fit, LandmarksTakePrecedenceOverThePose) {
  RunContext context;
  const GeneratedModel model = generate("table");
  const Similarity far{1.5, axis_rotation(Eigen::Vector3d::UnitX(), 2), {10, -3, 5}};
  PointCloud scan = virtual_scan(model.mesh, {}, context);
  for (Points* points : {&scan.points, &scan.viewpoints}) {
    for (Eigen::Index i = 0; i < points->rows(); ++i) {
      points->row(i) = far(points->row(i).transpose()).transpose();
    }
  }
  FitInput input{model.mesh, model.truth, scan, Similarity{}, {}, {}};
  for (const int vertex : {0, 1500, 3000, 5000}) {
    input.landmarks.push_back({vertex, far(model.mesh.vertices.row(vertex).transpose())});
  }
  const FitResult result = fit(input, {}, context);
  EXPECT_TRUE(result.converged) << result.stopped_because;
  EXPECT_LT(result.landmark_rms, 0.01);
  EXPECT_NEAR(result.pose.scale, 1.5, 1e-9);
}

TEST(Fit, RefusesAnEmptyScanAndOptionsThatMakeNoSense) {
  const GeneratedModel model = generate("bar");
  const PointCloud empty;
  EXPECT_THROW(fit({model.mesh, model.truth, empty, Similarity{}, {}, {}}, {}, RunContext{}), InputError);
  FitOptions options;
  options.trim = 0;
  EXPECT_THROW(options.validate(), UsageError);
  options = {};
  options.last_stiffness = 20;
  EXPECT_THROW(options.validate(), UsageError);
  options = {};
  options.max_tried = options.max_tied - 1;
  EXPECT_THROW(options.validate(), UsageError);
  options = {};
  options.max_iterations = 5;
  EXPECT_THROW(options.validate(), UsageError);
}

// Nothing tells the ends and sides of a square beam apart: fits from all places explain as much, but for the noise.
class PlacesThatTie : public testing::TestWithParam<int> {};

TEST_P(PlacesThatTie, AreDecidedByTheirPlacement) {
  RunContext context;
  context.seed = static_cast<std::uint64_t>(GetParam());
  const GeneratedModel beam = generate("bar", {{"length", 4}});
  ScanOptions scanner;
  scanner.views = 2;
  scanner.noise = 0.002;
  const PointCloud scan = virtual_scan(beam.mesh, scanner, context);
  const SymmetryAnnotation none = empty_annotation(beam.mesh, beam.truth.tolerance);
  FitOptions options;
  options.place = true;
  options.max_tried = options.max_tied;  // without short fits, which would choose
  options.subspace.samples = 60;
  const FitResult result = fit({beam.mesh, none, scan, Similarity{}}, options, context);
  ASSERT_GT(result.placements.size(), 1U);
  EXPECT_GT(result.placements[1].score(), options.tie * result.placements[0].score());
  const Eigen::Matrix3d turn = result.pose.linear * result.placements[0].pose.linear.transpose();
  EXPECT_LT(axis_angle(turn).angle, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PlacesThatTie, testing::Range(1, 5));

}  // namespace
}  // namespace orbifit
