// Copies that no finite group relates: rows, grids, arcs, screws and scattered ones.

#include <cmath>
#include <string>

#include "base/random.h"
#include "suite/suite_builder.h"
#include "suite/suite_lists.h"
#include "suite/suite_parts.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;
using Kind = Pattern::Kind;

TruthModel colonnade() {
  SuiteBuilder model;
  model.add(model.kind(
      {"steps", tapered(rectangle_outline(2.5, 0.42, 8), -0.2, 0.02, 0.96, 2), group("C2v"), OwnRegion::silent}));
  model.add(model.kind(
      {"beam", tapered(rectangle_outline(2.35, 0.3, 8), 1.48, 1.8, 1.03, 2), group("C2v"), OwnRegion::silent}));
  const int column = model.kind({"column",
                                 turned_part({{0, 0, 0, 1},
                                              {0.2, 0, 0, 1},
                                              {0.2, 0.1, 0.04, 1},
                                              {0.14, 0.16, 0.02, 6},
                                              {0.11, 1.3, 0.02, 1},
                                              {0.21, 1.42, 0, 1},
                                              {0.21, 1.5, 0, 1},
                                              {0, 1.5, 0, 1}},
                                             40, 3),
                                 group("Cinfv")});
  std::vector<std::vector<int>> row;
  for (int i = 0; i < 7; ++i) row.push_back({model.add(column, shift(0.7 * (i - 3), 0, 0))});
  model.expect(group("C2v"));
  model.expect_pattern("columns", Kind::translation_1d, {shift(0.7, 0, 0)}, row);
  return model.finish();
}

// Windows in a grid of 6 by 4, four of them missing.
TruthModel facade() {
  SuiteBuilder model;
  model.add(model.kind({"wall", box({2.2, 0.2, 1.7}, {16, 2, 12}, 0, 0), group("D2h"), OwnRegion::optional}));
  const int frame = model.kind({"window", box({0.2, 0.12, 0.26}, {4, 2, 4}, 0.02, 1), group("D2h"), OwnRegion::silent});
  const int sill = model.kind({"sill", box({0.27, 0.14, 0.06}, {4, 2, 2}, 0, 0), group("D2h"), OwnRegion::silent});
  std::vector<std::vector<int>> grid;
  for (int floor = 0; floor < 4; ++floor) {
    for (int i = 0; i < 6; ++i) {
      const bool missing =
          (floor == 0 && i == 1) || (floor == 1 && i == 4) || (floor == 2 && i == 0) || (floor == 3 && i == 3);
      if (missing) continue;
      const Motion at = shift(0.68 * (i - 2.5), -0.2, 0.76 * (floor - 1.5) + 0.05);
      grid.push_back({model.add(frame, at), model.add(sill, at * shift(0, -0.04, -0.29))});
    }
  }
  model.expect(group("Cs"), across(Vector3d::UnitX()));
  model.expect_pattern("windows", Kind::translation_2d, {shift(0.68, 0, 0), shift(0, 0, 0.76)}, grid);
  return model.finish();
}

TruthModel spiral_stairs() {
  SuiteBuilder model;
  model.add(model.kind({"post", cylinder(0.2, 1.7, 72, 0.02), group("Dinfh")}), shift(0, 0, 0.05));
  // Broader outside and above.
  const Mesh step = swept(rectangle_outline(0.12, 0.09, 3), 10, [](double share) {
    return Section{0.12 + 0.88 * share, 0.75 + 0.55 * share, 0, {0, 0}};
  });
  Mesh sloped = step;
  for (Eigen::Index v = 0; v < sloped.vertices.rows(); ++v) sloped.vertices(v, 1) *= 1 - 2.4 * sloped.vertices(v, 0);
  const int kind = model.kind({"step", sloped, {}});
  const Motion screw = turn_z(24) * shift(0, 0, 0.2);
  Motion at = shift(0, 0, -1.45) * turn_y(90);
  std::vector<std::vector<int>> steps;
  for (int i = 0; i < 15; ++i) {
    steps.push_back({model.add(kind, at)});
    at = screw * at;
  }
  model.expect_pattern("steps", Kind::screw, {screw}, steps);
  return model.finish();
}

TruthModel ladder() {
  SuiteBuilder model;
  const int rail = model.kind({"rail", box({0.07, 0.1, 1.6}, {2, 2, 24}, 0.02, 1), group("D2h"), OwnRegion::optional});
  model.orbit(rail, shift(0.5, 0, 0), group("D2h"));
  const int rung = model.kind({"rung", moved(cylinder(0.065, 0.5, 24), turn_y(90)), group("Dinfh"), OwnRegion::optional,
                               frame_about(Vector3d::UnitX())});
  std::vector<std::vector<int>> rungs;
  for (int i = 0; i < 8; ++i) rungs.push_back({model.add(rung, shift(0, 0, 0.38 * (i - 3.5)))});
  model.expect_pattern("rungs", Kind::translation_1d, {shift(0, 0, 0.38)}, rungs);
  return model.finish();
}

TruthModel bookshelf() {
  SuiteBuilder model;
  const int side = model.kind({"side", box({0.05, 0.31, 1.2}, {2, 4, 16}, 0, 0), group("D2h"), OwnRegion::optional});
  model.orbit(side, shift(0.8, 0, 0), group("C2v"),
              {frame_about(Vector3d::UnitY(), Vector3d(Vector3d::UnitX())), Vector3d::Zero()});
  model.add(model.kind({"back", box({0.78, 0.05, 1.17}, {12, 2, 16}, 0, 0), group("D2h"), OwnRegion::optional}),
            shift(0, 0.24, 0));
  const int shelf = model.kind({"shelf", box({0.79, 0.26, 0.05}, {12, 4, 2}, 0, 0), group("D2h"), OwnRegion::optional});
  std::vector<std::vector<int>> shelves;
  for (int i = 0; i < 5; ++i) shelves.push_back({model.add(shelf, shift(0, -0.015, 0.5 * (i - 2)))});
  model.expect_pattern("shelves", Kind::translation_1d, {shift(0, 0, 0.5)}, shelves);
  return model.finish();
}

// Seats on an arc that does not close.
TruthModel amphitheatre() {
  SuiteBuilder model;
  model.add(model.kind({"floor", cylinder(1.5, 0.1, 90, 0.02), group("Dinfh"), OwnRegion::optional}));
  const int seat =
      model.kind({"seat", tapered(rectangle_outline(0.16, 0.13, 3), 0, 0.32, 0.9, 3), group("C2v"), OwnRegion::silent});
  const int back =
      model.kind({"back", tapered(rectangle_outline(0.05, 0.14, 3), 0, 0.65, 0.8, 5), group("C2v"), OwnRegion::silent});
  std::vector<std::vector<int>> seats;
  for (int i = 0; i < 8; ++i) {
    const Motion at = turn_z(17.0 * (i - 3.5)) * shift(1.15, 0, 0.07);
    seats.push_back({model.add(seat, at), model.add(back, at * shift(0.15, 0, 0.01))});
  }
  model.expect(group("Cs"), across(Vector3d::UnitY()));
  model.expect_pattern("seats", Kind::rotation, {turn_z(17)}, seats);
  return model.finish();
}

TruthModel lattice() {
  SuiteBuilder model;
  const int knot = model.kind({"knot", cubic_ball(0.2, 2), group("Kh"), OwnRegion::silent});
  const Vector3d step(0.8, 0.95, 0.7);
  const auto rods = [&](int axis) {
    const Motion turn = axis == 0 ? turn_y(90) : axis == 1 ? turn_x(90) : Motion{};
    return model.kind({"rod", moved(cylinder(0.09, (axis == 2 ? 1.05 : step[axis]) + 0.02 * (axis + 1), 16), turn),
                       group("Dinfh"), OwnRegion::silent, frame_about(Vector3d::Unit(axis))});
  };
  const std::array<int, 3> kinds{rods(0), rods(1), rods(2)};
  const auto place = [&](double i, double j, double k) { return shift(step.x() * i, step.y() * j, step.z() * k); };
  std::vector<std::vector<int>> knots;
  for (int k = 0; k < 4; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) knots.push_back({model.add(knot, place(i, j, k - 1.5))});
      model.add(kinds[0], place(0, j, k - 1.5));
    }
    for (int i = -1; i <= 1; ++i) model.add(kinds[1], place(i, 0, k - 1.5));
  }
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) model.add(kinds[2], place(i, j, 0));
  }
  model.expect(group("D2h"));
  model.expect_pattern("knots", Kind::translation_3d, {place(1, 0, 0), place(0, 1, 0), place(0, 0, 1)}, knots);
  return model.finish();
}

TruthModel egg_tray() {
  SuiteBuilder model;
  model.add(model.kind({"tray", box({1.65, 1.15, 0.12}, {12, 8, 2}, 0.03, 1), group("D2h"), OwnRegion::optional}));
  const int egg = model.kind(
      {"egg",
       turned_part({{0, -0.12, 0, 1}, {0.2, -0.1, 0.05, 2}, {0.2, 0.1, 0.1, 2}, {0.1, 0.42, 0.1, 1}, {0, 0.45, 0, 1}},
                   24, 2),
       group("Cinfv")});
  std::vector<std::vector<int>> eggs;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 6; ++i) eggs.push_back({model.add(egg, shift(0.52 * (i - 2.5), 0.54 * (j - 1.5), 0.12))});
  }
  model.expect(group("C2v"));
  model.expect_pattern("eggs", Kind::translation_2d, {shift(0.52, 0, 0), shift(0, 0.54, 0)}, eggs);
  return model.finish();
}

// Links in turn upright and lying, each through its neighbours.
TruthModel chain() {
  SuiteBuilder model;
  constexpr int kAround = 48;
  std::vector<Ring> rings;
  for (int k = 0; k < kAround; ++k) {
    const Motion turn = turn_z(360.0 * k / kAround);
    const Vector3d out = turn(Vector3d::UnitX());
    const double straight = k == kAround / 4 || k == 3 * kAround / 4 ? 0 : std::copysign(0.25, out.x());
    Ring& ring = rings.emplace_back();
    for (int j = 0; j < 16; ++j) {
      const Vector3d around = turn_z(360.0 * j / 16)(Vector3d::UnitX());
      ring.emplace_back((0.42 + 0.13 * around.x()) * out + Vector3d(straight, 0, 0.13 * around.y()));
    }
  }
  const int link = model.kind({"link", closed_loft(rings), group("D2h"), OwnRegion::expected});
  const Motion screw = shift(0.82, 0, 0) * turn_x(90);
  Motion at = shift(-0.82 * 2.5, 0, 0);
  std::vector<std::vector<int>> links;
  for (int i = 0; i < 6; ++i) {
    links.push_back({model.add(link, at)});
    at = screw * at;
  }
  model.expect(group("D2d"), {frame_about(Vector3d::UnitX(), Vector3d(0, 1, 1)), Vector3d::Zero()});
  model.expect_pattern("links", Kind::screw, {screw}, links);
  return model.finish();
}

TruthModel scattered_stones() {
  SuiteBuilder model;
  model.add(model.kind({"plate", box({1.5, 1.1, 0.1}, {12, 8, 2}, 0.03, 1), group("D2h"), OwnRegion::optional}));
  Mesh mesh = lump(21, 16);
  mesh.vertices *= 0.3;
  const int stone = model.kind({"stone", mesh, {}});
  Random random(5, "scattered stones");
  std::vector<std::vector<int>> stones;
  for (const auto& [x, y] :
       {std::pair{-1.0, -0.55}, {-0.2, -0.6}, {0.7, -0.4}, {1.0, 0.5}, {0.1, 0.45}, {-0.85, 0.5}}) {
    stones.push_back({model.add(stone, Motion{random.rotation(), {x, y, 0.22}})});
  }
  model.expect_pattern("stones", Kind::congruent, {}, stones);
  return model.finish();
}

TruthModel bolted_box() {
  SuiteBuilder model;
  model.add(model.kind({"box", box({1.2, 0.8, 0.5}, {10, 8, 6}, 0.05, 2), group("D2h"), OwnRegion::optional}));
  const int bolt = model.kind({"bolt", tapered(polygon_outline(6, 0.17, 2), -0.08, 0.2, 0.85, 3), group("C6v"),
                               OwnRegion::expected, upright().frame});
  std::vector<std::vector<int>> bolts;
  for (const auto& [x, y, turn] :
       {std::array{-0.8, -0.4, 10.0}, {-0.1, 0.35, 25.0}, {0.5, -0.2, 47.0}, {0.85, 0.4, 3.0}}) {
    bolts.push_back({model.add(bolt, shift(x, y, 0.5) * turn_z(turn))});
  }
  bolts.push_back({model.add(bolt, shift(1.2, 0.2, -0.1) * turn_y(90) * turn_z(17))});
  model.expect_pattern("bolts", Kind::congruent, {}, bolts);
  return model.finish();
}

}  // namespace

std::vector<SuiteModel> pattern_suite() {
  return {{"colonnade", "pattern", colonnade},
          {"facade", "pattern", facade},
          {"spiral_stairs", "pattern", spiral_stairs},
          {"ladder", "pattern", ladder},
          {"bookshelf", "pattern", bookshelf},
          {"amphitheatre", "pattern", amphitheatre},
          {"lattice", "pattern", lattice},
          {"egg_tray", "pattern", egg_tray},
          {"chain", "pattern", chain},
          {"scattered_stones", "pattern", scattered_stones},
          {"bolted_box", "pattern", bolted_box}};
}

}  // namespace orbifit
