#include "orbifit/apps/render.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "orbifit/apps/annotation_pictures.h"
#include "orbifit/model/errors.h"

#include "base/stb_image.h"
#include "files/file.h"

namespace orbifit {
namespace {

Mesh sphere(const Eigen::RowVector3d& centre, double radius) {
  constexpr int kRound = 24;
  constexpr int kRows = 12;
  Mesh mesh;
  mesh.vertices.resize(kRound * (kRows + 1), 3);
  mesh.faces.resize(2 * kRound * kRows, 3);
  for (int row = 0; row <= kRows; ++row) {
    for (int i = 0; i < kRound; ++i) {
      const double polar = std::numbers::pi * row / kRows;
      const double around = 2 * std::numbers::pi * i / kRound;
      const Eigen::RowVector3d normal(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                                      std::cos(polar));
      mesh.vertices.row(row * kRound + i) = centre + radius * normal;
      if (row == kRows) continue;
      const int next = (i + 1) % kRound;
      const int face = 2 * (row * kRound + i);
      mesh.faces.row(face) << row * kRound + i, (row + 1) * kRound + i, row * kRound + next;
      mesh.faces.row(face + 1) << (row + 1) * kRound + i, (row + 1) * kRound + next, row * kRound + next;
    }
  }
  return mesh;
}

SurfaceLayer coloured(Mesh mesh, const Colour& colour) {
  SurfaceLayer layer;
  layer.mesh = std::move(mesh);
  layer.face_colours = {colour};
  return layer;
}

const Colour kRed{0.9F, 0.1F, 0.1F};
const Colour kBlue{0.1F, 0.1F, 0.9F};

ViewOptions small_view() {
  ViewOptions view;
  view.width = 120;
  view.height = 90;
  view.azimuth = 0;  // from +x
  view.elevation = 0;
  return view;
}

Eigen::Vector3i pixel(const Image& image, int x, int y) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

bool reddish(const Eigen::Vector3i& p) {
  return p[0] > 2 * p[2];
}
bool blueish(const Eigen::Vector3i& p) {
  return p[2] > 2 * p[0];
}

template <typename Predicate>
int count_pixels(const Image& image, const Predicate& holds) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) count += holds(pixel(image, x, y)) ? 1 : 0;
  }
  return count;
}

// Everything that can be drawn.
Scene full_scene() {
  Scene scene;
  scene.surfaces.push_back(coloured(sphere({0, 0, 0}, 1), kRed));
  scene.surfaces[0].edges = true;
  SurfaceLayer glass = coloured(sphere({0.5, 1, 0}, 0.8), kBlue);
  glass.opacity = 0.3;
  scene.surfaces.push_back(glass);
  PointLayer points;
  points.points = 1.02 * sphere({0, 0, 0}, 1).vertices;
  scene.points.push_back(points);
  SegmentLayer axis;
  axis.from = Eigen::RowVector3d(0, 0, -1.5);
  axis.to = Eigen::RowVector3d(0, 0, 1.5);
  axis.radius = 0.01;
  scene.segments.push_back(axis);
  return scene;
}

TEST(Render, GivesTheSameBytesWithAnyNumberOfThreads) {
  const Scene scene = full_scene();
  RunContext context;
  const Image alone = render(scene, small_view(), context);
  EXPECT_EQ(render(scene, small_view(), context).rgb, alone.rgb);
  context.threads = 3;
  EXPECT_EQ(render(scene, small_view(), context).rgb, alone.rgb);
}

TEST(Render, WhatIsInFrontHidesWhatIsBehind) {
  Scene scene;
  scene.surfaces.push_back(coloured(sphere({2, 0, 0}, 1), kRed));
  scene.surfaces.push_back(coloured(sphere({-2, 0, 0}, 1), kBlue));
  ViewOptions view = small_view();
  const Image from_red = render(scene, view, {});
  EXPECT_TRUE(reddish(pixel(from_red, 60, 45)));
  EXPECT_EQ(count_pixels(from_red, blueish), 0);
  view.azimuth = 180;
  const Image from_blue = render(scene, view, {});
  EXPECT_TRUE(blueish(pixel(from_blue, 60, 45)));
  EXPECT_EQ(count_pixels(from_blue, reddish), 0);
  view.azimuth = 90;  // from +y: +x is to the left
  const Image beside = render(scene, view, {});
  EXPECT_GT(count_pixels(beside, reddish), 300);
  EXPECT_GT(count_pixels(beside, blueish), 300);
  EXPECT_TRUE(reddish(pixel(beside, 15, 45)));
  EXPECT_TRUE(blueish(pixel(beside, 105, 45)));
}

TEST(Render, IsSeenFromWhereOneLooksFrom) {
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 2, -3)}) {
    for (const Eigen::Vector3d& from : {Eigen::Vector3d(1, 2, 0.5), Eigen::Vector3d(-4, 1, -3), up}) {
      Scene scene;
      const Eigen::RowVector3d towards = from.normalized().transpose();
      scene.surfaces.push_back(coloured(sphere(2 * towards, 1), kRed));
      scene.surfaces.push_back(coloured(sphere(-2 * towards, 1), kBlue));
      ViewOptions view = small_view();
      view.up = up.normalized();
      look_from(from, view);
      const Image image = render(scene, view, {});
      EXPECT_TRUE(reddish(pixel(image, 60, 45)));
      EXPECT_EQ(count_pixels(image, blueish), 0);
    }
  }
}

TEST(Render, UpIsUpInThePicture) {
  for (int axis = 0; axis < 3; ++axis) {
    Scene scene;
    const Eigen::RowVector3d up = Eigen::RowVector3d::Unit(axis);
    scene.surfaces.push_back(coloured(sphere(1.5 * up, 1), kRed));
    scene.surfaces.push_back(coloured(sphere(-1.5 * up, 1), kBlue));
    ViewOptions view = small_view();
    view.up = up.transpose();
    view.elevation = 20;
    const Image image = render(scene, view, {});
    EXPECT_TRUE(reddish(pixel(image, 60, 20))) << axis;
    EXPECT_TRUE(blueish(pixel(image, 60, 70))) << axis;
  }
}

TEST(Render, TheShapeFillsThePictureAndNeverLeavesIt) {
  for (const double scale : {1e-6, 1.0, 1e7}) {
    for (const double azimuth : {0.0, 77.0, 200.0}) {
      Scene scene;
      Mesh mesh = sphere({5, 3, -2}, 1);
      mesh.vertices.col(2) *= 1.4;
      mesh.vertices *= scale;
      scene.surfaces.push_back(coloured(mesh, kRed));
      ViewOptions view = small_view();
      view.azimuth = azimuth;
      view.elevation = 30;
      const Image image = render(scene, view, {});
      EXPECT_GT(count_pixels(image, reddish), 120 * 90 / 4);
      for (int x = 0; x < 120; ++x) {
        EXPECT_FALSE(reddish(pixel(image, x, 0)));
        EXPECT_FALSE(reddish(pixel(image, x, 89)));
      }
    }
  }
}

TEST(Render, AFrameKeepsTheScale) {
  // The same sphere, once beside another that the frame leaves room for.
  ViewOptions view = small_view();
  view.frame.resize(2, 3);
  view.frame << -3, -3, -2, 3, 3, 2;
  view.ground_shadow = false;
  Scene one;
  one.surfaces.push_back(coloured(sphere({0, -1.5, 0}, 1), kRed));
  Scene two = one;
  two.surfaces.push_back(coloured(sphere({0, 1.5, 0}, 1), kBlue));
  const Image image_of_one = render(one, view, {});
  const Image image_of_two = render(two, view, {});
  int differing = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      differing += reddish(pixel(image_of_one, x, y)) != reddish(pixel(image_of_two, x, y)) ? 1 : 0;
    }
  }
  EXPECT_LE(differing, 12);  // the second sphere's shadow on the first
  EXPECT_GT(count_pixels(image_of_one, reddish), 300);
  EXPECT_GT(count_pixels(image_of_two, blueish), 300);
}

// A red sphere in a blue one.
Scene sphere_in_glass(double opacity) {
  Scene scene;
  scene.surfaces.push_back(coloured(sphere({0, 0, 0}, 1), kRed));
  scene.surfaces.push_back(coloured(sphere({0, 0, 0}, 1.5), kBlue));
  scene.surfaces.back().opacity = opacity;
  return scene;
}

TEST(Render, GlassLetsThroughWhatIsBehind) {
  Scene scene = sphere_in_glass(0.1);
  const Eigen::Vector3i middle = pixel(render(scene, small_view(), {}), 60, 45);
  EXPECT_TRUE(reddish(middle));
  scene.surfaces.pop_back();
  EXPECT_NE(pixel(render(scene, small_view(), {}), 60, 45), middle);
  scene.surfaces.push_back(coloured(sphere({0, 0, 0}, 1.5), kBlue));
  EXPECT_TRUE(blueish(pixel(render(scene, small_view(), {}), 60, 45)));
}

TEST(Render, PointsAndSegmentsAreDrawnInTheirColours) {
  Scene scene;
  PointLayer points;
  points.points = Eigen::RowVector3d(0, 1, 0);
  points.colour = kRed;
  points.radius = 0.1;
  SegmentLayer line;
  line.from = Eigen::RowVector3d(0, -1, -1);
  line.to = Eigen::RowVector3d(0, -1, 1);
  line.colour = kBlue;
  line.radius = 0.05;
  scene.points.push_back(points);
  scene.segments.push_back(line);
  const Image image = render(scene, small_view(), {});
  EXPECT_GT(count_pixels(image, reddish), 50);
  EXPECT_GT(count_pixels(image, blueish), 200);
}

TEST(Render, FewRaysSeeWhatManyDo) {
  // Where a mesh's edges are drawn every pixel gets all its rays: behind the eye they change nothing else.
  Scene scene = sphere_in_glass(0.2);
  SegmentLayer lines;
  lines.from = Points::Zero(2, 3);
  lines.to.resize(2, 3);
  lines.to << 0, 0, 1.8, 1.4, 0.4, 0.9;
  scene.segments.push_back(lines);
  ViewOptions view = small_view();
  view.ground_shadow = false;
  view.frame = scene.surfaces.back().mesh.vertices;
  const Image few = render(scene, view, RunContext{});
  SurfaceLayer behind = coloured(sphere({200, 200, 200}, 0.01), kRed);
  behind.edges = true;
  scene.surfaces.push_back(behind);
  const Image many = render(scene, view, RunContext{});
  ASSERT_EQ(few.rgb.size(), many.rgb.size());
  int most = 0;
  double sum = 0;
  for (std::size_t i = 0; i < few.rgb.size(); ++i) {
    const int off = std::abs(static_cast<int>(few.rgb[i]) - static_cast<int>(many.rgb[i]));
    most = std::max(most, off);
    sum += off;
  }
  EXPECT_LE(most, 39);  // glass that differs by .02 of the light, where it is darkest
  EXPECT_LT(sum / static_cast<double>(few.rgb.size()), 0.1);
}

TEST(Render, VertexColoursAreInterpolated) {
  Scene scene;
  SurfaceLayer layer;
  layer.mesh.vertices.resize(3, 3);
  layer.mesh.vertices << 0, -1, -1, 0, 1, -1, 0, 0, 1;
  layer.mesh.faces.resize(1, 3);
  layer.mesh.faces << 0, 1, 2;
  layer.vertex_colours = {kBlue, kRed, kRed};
  scene.surfaces.push_back(layer);
  const Image image = render(scene, small_view(), {});
  const auto violet = [](const Eigen::Vector3i& p) {
    return !reddish(p) && !blueish(p) && p[1] < p[0] / 2 && p[1] < p[2] / 2;
  };
  EXPECT_GT(count_pixels(image, reddish), 100);
  EXPECT_GT(count_pixels(image, blueish), 20);
  EXPECT_GT(count_pixels(image, violet), 20);
}

TEST(Render, TheGroundHasAShadowAndTheSkyNone) {
  Scene scene;
  scene.surfaces.push_back(coloured(sphere({0, 0, 0}, 1), kRed));
  ViewOptions view = small_view();
  view.elevation = 25;
  const auto shade = [](const Eigen::Vector3i& p) { return p[0] == p[2] && p[0] < 250; };
  EXPECT_GT(count_pixels(render(scene, view, {}), shade), 100);
  EXPECT_EQ(pixel(render(scene, view, {}), 0, 0), Eigen::Vector3i(255, 255, 255));
  view.ground_shadow = false;
  EXPECT_EQ(count_pixels(render(scene, view, {}), shade), 0);
}

TEST(Render, OfNothingIsBackground) {
  ViewOptions view = small_view();
  view.background = {0.2F, 0.4F, 0.6F};
  const Image image = render({}, view, {});
  EXPECT_EQ(count_pixels(image, [](const Eigen::Vector3i& p) { return p == Eigen::Vector3i(51, 102, 153); }), 120 * 90);
}

TEST(Render, RefusesImpossibleViews) {
  const auto refused = [](auto change) {
    ViewOptions view = small_view();
    change(view);
    EXPECT_THROW(render({}, view, {}), UsageError);
  };
  refused([](ViewOptions& view) { view.width = 0; });
  refused([](ViewOptions& view) { view.height = 100000; });
  refused([](ViewOptions& view) { view.samples = 8; });
  refused([](ViewOptions& view) { view.field_of_view = 180; });
  refused([](ViewOptions& view) { view.up.setZero(); });
}

TEST(Render, DegenerateFacesDoNoHarm) {
  Scene scene;
  Mesh mesh = sphere({0, 0, 0}, 1);
  mesh.faces.conservativeResize(mesh.faces.rows() + 2, 3);
  mesh.faces.bottomRows(2) << 0, 0, 0, 30, 40, 30;
  scene.surfaces.push_back(coloured(mesh, kRed));
  EXPECT_GT(count_pixels(render(scene, small_view(), {}), reddish), 1000);
}

TEST(RegionColour, NeighboursAreDistinct) {
  for (int a = 0; a < 24; ++a) {
    EXPECT_EQ(region_colour(a), region_colour(a));
    for (int b = 0; b < a; ++b) {
      EXPECT_GT((region_colour(a) - region_colour(b)).norm(), 0.1F) << a << " and " << b;
    }
  }
  for (const int number : {-1, 24, 1000, 123456789}) {
    EXPECT_GE(region_colour(number).minCoeff(), 0);
    EXPECT_LE(region_colour(number).maxCoeff(), 1);
  }
}

TEST(HeatColour, RunsFromBlueToRed) {
  EXPECT_GT(heat_colour(0)[2], 2 * heat_colour(0)[0]);
  EXPECT_GT(heat_colour(1)[0], 2 * heat_colour(1)[2]);
  EXPECT_NEAR(heat_colour(0.5)[0], heat_colour(0.5)[2], 0.05);
  EXPECT_EQ(heat_colour(-3), heat_colour(0));
  EXPECT_EQ(heat_colour(7), heat_colour(1));
  EXPECT_EQ(heat_colour(std::nan("")), heat_colour(std::nan("")));
}

TEST(RegionScene, MarksFacesAxisAndPlanes) {
  const Mesh mesh = sphere({0, 0, 0}, 1);
  PointGroup group;
  group.family = PointGroup::Family::Cnv;
  group.n = 4;
  const Region region = make_region(group, Eigen::Vector3d::Zero(), GroupFrame::Identity(), {0, 1, 2, 3, 100}, "patch");
  const Scene scene = region_scene(mesh, region);
  ASSERT_EQ(scene.surfaces.size(), 5U);  // the mesh and the panes of four planes
  const auto& colours = scene.surfaces[0].face_colours;
  EXPECT_EQ(std::count(colours.begin(), colours.end(), region_colour(region.id)), 5);
  ASSERT_EQ(scene.segments.size(), 2U);
  const SegmentLayer& axis = scene.segments[0];
  ASSERT_EQ(axis.from.rows(), 1);
  EXPECT_LT(axis.from.leftCols(2).norm() + axis.to.leftCols(2).norm(), 1e-12);
  EXPECT_EQ(scene.segments[1].from.rows(), 16);
  for (std::size_t s = 1; s < 5; ++s) {
    EXPECT_LT(scene.surfaces[s].opacity, 1);
    // Every plane of C4v holds the axis.
    const Eigen::Vector3d normal = face_normals(scene.surfaces[s].mesh).row(0);
    EXPECT_LT(std::abs(normal.z()), 1e-12);
  }
}

// A ball within a ball: what of the inner one is seen.
TEST(VisibleRegionScene, SeesThroughWhatHidesTheRegion) {
  Mesh mesh = sphere({0, 0, 0}, 1);
  const Mesh inner = sphere({0, 0, 0}, 0.4);
  const auto vertices = mesh.vertices.rows();
  const auto faces = mesh.faces.rows();
  mesh.vertices.conservativeResize(vertices + inner.vertices.rows(), 3);
  mesh.vertices.bottomRows(inner.vertices.rows()) = inner.vertices;
  mesh.faces.conservativeResize(2 * faces, 3);
  mesh.faces.bottomRows(faces) = inner.faces.array() + static_cast<int>(vertices);
  std::vector<int> hidden(8);
  std::iota(hidden.begin(), hidden.end(), static_cast<int>(faces));
  const PointGroup mirror{PointGroup::Family::Cs, 1};
  const GroupFrame frame = GroupFrame::Identity();
  const Region inside = make_region(mirror, Eigen::Vector3d::Zero(), frame, hidden, "inside");
  const Region outside = make_region(mirror, Eigen::Vector3d::Zero(), frame, {0, 1, 2, 3, 4, 5, 6, 7}, "outside");
  ViewOptions from_above = small_view();
  from_above.elevation = 89;
  EXPECT_LT(visible_region_scene(mesh, inside, from_above, {}).surfaces[0].opacity, 1);
  EXPECT_EQ(visible_region_scene(mesh, outside, from_above, {}).surfaces[0].opacity, 1);
  const Scene seen = region_scene(mesh, inside, true);
  EXPECT_EQ(seen.surfaces[0].mesh.faces.rows() + seen.surfaces[1].mesh.faces.rows(), mesh.faces.rows());
  EXPECT_EQ(seen.surfaces[1].mesh.faces.rows(), 8);
}

TEST(Window, ShowsAPartOfThePictureEnlarged) {
  Scene scene;
  scene.surfaces.push_back(coloured(sphere({0, 0, 0}, 1), kRed));
  ViewOptions view = small_view();
  view.ground_shadow = false;
  const Image whole = render(scene, view, {});
  view.window = {0.25, 0.25, 0.5, 0.5};
  const Image middle = render(scene, view, {});
  int different = 0;
  for (int y = 0; y < view.height; y += 2) {
    for (int x = 0; x < view.width; x += 2) {
      const Eigen::Vector3i shown = pixel(whole, view.width / 4 + x / 2, view.height / 4 + y / 2);
      different += (pixel(middle, x, y) - shown).cwiseAbs().maxCoeff() > 40 ? 1 : 0;
    }
  }
  EXPECT_LT(different, 30);  // along the sphere's rim
  view.window[2] = 0;
  EXPECT_THROW(render(scene, view, {}), UsageError);
}

TEST(AnnotationPictures, ShowEveryRegionWithItsName) {
  const Mesh mesh = sphere({0, 0, 0}, 1);
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  const PointGroup mirror{PointGroup::Family::Cs, 1};
  for (int i = 0; i < 30; ++i) {
    annotation.regions.push_back(make_region(mirror, Eigen::Vector3d::Zero(), GroupFrame::Identity(),
                                             {4 * i, 4 * i + 1}, "patch " + std::to_string(i)));
    annotation.regions.back().id = i;
  }
  ViewOptions view = small_view();
  view.samples = 1;
  const auto pictures = annotation_pictures(mesh, annotation, view, {});
  ASSERT_EQ(pictures.size(), 30U);
  EXPECT_EQ(pictures[7].title, "region 7  Cs: patch 7");
  EXPECT_NE(pictures[7].detail.find(" % of the area"), std::string::npos);
  EXPECT_NE(pictures[7].detail.find(" % of the diagonal"), std::string::npos);
  EXPECT_GT(contact_sheet(pictures, 4).height, 8 * view.height);
}

// Two faces of a sphere are small: in the close-up they are many times larger.
TEST(AnnotationPictures, EnlargeWhatIsSmall) {
  const Mesh mesh = sphere({0, 0, 0}, 1);
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  const int face = 2 * (6 * 24);  // on the equator, towards +x
  Region region = make_region({PointGroup::Family::Ci, 1}, Eigen::Vector3d::Zero(), GroupFrame::Identity(),
                              {face, face + 1}, "speck");
  region.id = 3;  // red
  annotation.regions.push_back(region);
  const ViewOptions view = small_view();
  const Image plain = render(visible_region_scene(mesh, region, view, {}), view, {});
  const Image enlarged = annotation_pictures(mesh, annotation, view, {}).front().image;
  EXPECT_EQ(enlarged.width, plain.width);
  EXPECT_GT(count_pixels(enlarged, reddish), 3 * count_pixels(plain, reddish));
  EXPECT_GT(count_pixels(plain, reddish), 0);
}

TEST(PatternScene, ColoursEveryInstance) {
  const Mesh mesh = sphere({0, 0, 0}, 1);
  Pattern pattern;
  pattern.instances = {{Motion{}, {0, 1}}, {Motion{}, {5}}};
  const Scene scene = pattern_scene(mesh, pattern);
  EXPECT_EQ(scene.surfaces[0].face_colours[1], region_colour(0));
  EXPECT_EQ(scene.surfaces[0].face_colours[5], region_colour(1));
  EXPECT_EQ(scene.surfaces[0].face_colours[7], region_colour(-1));
}

TEST(Png, DecodesToTheSamePixels) {
  const Image image = render(full_scene(), small_view(), {});
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "orbifit_render_test.png";
  write_png(file, image);
  const std::string bytes = read_file(file);
  EXPECT_EQ(bytes, encode_png(image));
  int width = 0;
  int height = 0;
  int channels = 0;
  stbi_uc* pixels = stbi_load_from_memory(std::bit_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                                          &width, &height, &channels, 0);
  ASSERT_NE(pixels, nullptr);
  EXPECT_EQ(width, image.width);
  EXPECT_EQ(height, image.height);
  ASSERT_EQ(channels, 3);
  EXPECT_TRUE(std::equal(image.rgb.begin(), image.rgb.end(), pixels));
  stbi_image_free(pixels);
  std::filesystem::remove(file);
}

TEST(Png, RefusesAnIllFormedImage) {
  EXPECT_THROW(encode_png({}), UsageError);
  EXPECT_THROW(encode_png({2, 2, std::vector<std::uint8_t>(11)}), UsageError);
}

TEST(ContactSheet, PlacesPicturesInRowsWithCaptions) {
  const auto plain = [](int width, int height, std::uint8_t red) {
    Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), 0)};
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) image.rgb[i] = red;
    return image;
  };
  const std::vector<Image> images{plain(60, 40, 201), plain(60, 40, 202), plain(50, 30, 203)};
  const Image captioned =
      contact_sheet(images, {"C4v", "a caption that is far too long for its picture", "x\xC3\xA4"}, 2);
  const Image blank = contact_sheet(images, {"", "", ""}, 2);
  ASSERT_EQ(captioned.width, blank.width);
  ASSERT_EQ(captioned.height, blank.height);
  EXPECT_GT(captioned.width, 120);
  EXPECT_GT(captioned.height, 80);
  for (const auto& [red, pixels] : {std::pair{201, 2400}, std::pair{202, 2400}, std::pair{203, 1500}}) {
    const auto is_it = [red = red](const Eigen::Vector3i& p) { return p == Eigen::Vector3i(red, 0, 0); };
    EXPECT_EQ(count_pixels(captioned, is_it), pixels);  // no caption runs into a picture
    EXPECT_EQ(count_pixels(blank, is_it), pixels);
  }
  const auto dark = [](const Eigen::Vector3i& p) { return p.maxCoeff() < 100; };
  EXPECT_EQ(count_pixels(blank, dark), 0);
  EXPECT_GT(count_pixels(captioned, dark), 100);
}

TEST(ContactSheet, RefusesWhatDoesNotMatch) {
  EXPECT_THROW(contact_sheet({}, {"one"}, 2), UsageError);
  EXPECT_THROW(contact_sheet({}, {}, 0), UsageError);
  EXPECT_THROW(contact_sheet({Image{}}, {"one"}, 2), UsageError);
  EXPECT_GT(contact_sheet({}, {}, 3).width, 0);
}

}  // namespace
}  // namespace orbifit
