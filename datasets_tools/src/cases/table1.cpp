#include "cases/table1.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "orbifit/model/errors.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

Motion moved_by(double x, double y, double z) {
  return {Eigen::Matrix3d::Identity(), Vector3d(x, y, z)};
}

// Turned about the handle's own centre, then moved.
Motion turned_and_moved(const Vector3d& centre, const Vector3d& axis, double degrees, const Vector3d& by) {
  return Motion{Eigen::Matrix3d::Identity(), by} * Motion::rotation(axis, degrees * std::numbers::pi / 180, centre);
}

// A generated model in place of the paper's, and an edit of it.
struct EditedModel {
  std::string generator;
  std::map<std::string, double> parameters;
  std::vector<Table1Handle> handles;
};

EditedModel edited_bar() {
  return {.generator = "bar",
          .parameters = {},
          .handles = {{"girdle", {0.5, 0.5, 2}, 0.3, {}},
                      {"waist", {0.5, 0.5, 0}, 0.4, moved_by(0.5, 0.5, 0)},
                      {"end", {0, 0, 4}, 0.6, moved_by(0, 0, 1.5)}}};
}

EditedModel edited_centre_piece() {
  return {.generator = "centre_piece",
          .parameters = {},
          .handles = {{"plinth", {0.14, 0.14, 0.06}, 0.06, {}},
                      {"candle", {0.26, 0, 0.5}, 0.06, moved_by(0.1, 0, 0.1)},
                      {"rim", {0.16, 0, 0.49}, 0.04, moved_by(0.04, 0, 0.06)}}};
}

EditedModel edited_plane() {
  const Vector3d wing_tip(0.3, 4.7, 0.1);
  const Motion folded = turned_and_moved(wing_tip, Vector3d::UnitX(), 55, {-0.3, -0.6, 1.75});
  return {.generator = "plane",
          .parameters = {{"detail", 13}},
          .handles = {{"cockpit", {0.2, 0, 0.7}, 0.6, {}},
                      {"wing tip", wing_tip, 0.6, folded},
                      {"tail", {-4.6, 0, 0.3}, 0.6, moved_by(-1.2, 0, 0.4)}}};
}

EditedModel edited_yard_tool() {
  const Vector3d grip(0.18, 0, 0.84);
  return {.generator = "yard_tool",
          .parameters = {},
          .handles = {{"shaft", {0, 0, 0.45}, 0.06, {}},
                      {"grip", grip, 0.05, turned_and_moved(grip, Vector3d::UnitY(), -50, {0.02, 0, 0.12})},
                      {"tine", {0.06, 0, -0.19}, 0.04, moved_by(0.09, 0, -0.06)}}};
}

EditedModel edited_car() {
  return {.generator = "car",
          .parameters = {},
          .handles = {{"tail", {-2, 0, 0.6}, 0.5, {}},
                      {"nose", {2, 0, 0.6}, 0.5, moved_by(0.7, 0, 0)},
                      {"roof", {-0.2, 0.3, 1.5}, 0.3, moved_by(0.2, 0, 0.2)}}};
}

EditedModel edited_wind_mill() {
  return {.generator = "wind_mill",
          .parameters = {},
          .handles = {{"foot", {2.6, 0, 0.2}, 1, {}},
                      {"gallery", {3.2, 0, 2.7}, 0.6, moved_by(0.8, 0, 0.3)},
                      {"sail tip", {5.4, -2.9, 10.2}, 0.9, moved_by(0.9, -0.9, 0)}}};
}

EditedModel edited_fan() {
  return {.generator = "desk_fan",
          .parameters = {},
          .handles = {{"foot", {0, 0.04, 0.02}, 0.12, {}},
                      {"rim", {0, 0, 0.53}, 0.05, moved_by(0, 0, 0.06)},
                      {"blade", {0.155, 0, 0.36}, 0.05, moved_by(0.03, 0.02, 0.02)}}};
}

EditedModel edited_chair() {
  return {.generator = "armchair",
          .parameters = {{"two_sided", 1}},
          .handles = {{"seat", {0, 0, 0.43}, 0.15, {}},
                      {"foot", {0.25, -0.25, 0.05}, 0.1, moved_by(0.08, -0.08, -0.12)},
                      {"crest", {0, 0.35, 0.9}, 0.15, moved_by(0, 0.15, 0.2)}}};
}

// A row as printed, and what makes our model of it.
struct PrintedRow {
  const char* name;
  EditedModel (*edited)();
  double vertices_k, triangles_k;
  int groups, samples, dof;
  double prefactor_ms, solve5_ms, lift_ms;
};

// The columns after the model are the paper's, in its order.
constexpr std::array<PrintedRow, 8> kRows{{{"bar", edited_bar, 4, 8, 1, 96, 18, 13, 2, 3},
                                           {"centre_piece", edited_centre_piece, 83, 165, 9, 690, 150, 1300, 21, 32},
                                           {"plane", edited_plane, 181, 359, 2, 160, 234, 75, 4, 51},
                                           {"yard_tool", edited_yard_tool, 50, 97, 2, 78, 27, 55, 3, 22},
                                           {"car", edited_car, 47, 95, 61, 675, 156, 4160, 35, 3},
                                           {"wind_mill", edited_wind_mill, 20, 40, 2, 156, 33, 97, 5, 7},
                                           {"fan", edited_fan, 2, 4, 3, 72, 27, 43, 3, 1},
                                           {"chair", edited_chair, 15, 58, 2, 32, 39, 4, 2, 1}}};

}  // namespace

const std::vector<std::string>& table1_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const PrintedRow& row : kRows) result.emplace_back(row.name);
    return result;
  }();
  return names;
}

Table1Model table1_model(const std::string& name) {
  const auto row = std::ranges::find(kRows, name, &PrintedRow::name);
  if (row == kRows.end()) {
    std::string known;
    for (const std::string& one : table1_names()) known.append(known.empty() ? "" : ", ").append(one);
    throw UsageError("unknown row of the table '" + name + "'; there are " + known);
  }
  EditedModel edited = row->edited();
  GeneratedModel model = generate(edited.generator, edited.parameters);
  return {.name = row->name,
          .generator = std::move(edited.generator),
          .parameters = std::move(edited.parameters),
          .model = std::move(model),
          .handles = std::move(edited.handles),
          .vertices_k = row->vertices_k,
          .triangles_k = row->triangles_k,
          .groups = row->groups,
          .samples = row->samples,
          .dof = row->dof,
          .prefactor_ms = row->prefactor_ms,
          .solve5_ms = row->solve5_ms,
          .lift_ms = row->lift_ms};
}

}  // namespace orbifit
