#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "bad_input/bad_input.h"
#include "program.h"

namespace orbifit {
namespace {

constexpr double kExact = 1e-9;  // of the diagonal

// A mirror plane x = const through the middle of the mesh, whether or not the mesh has that symmetry.
SymmetryAnnotation mirrored(const Mesh& mesh) {
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<int>(f);
  annotation.regions.push_back(make_region(*PointGroup::parse("Cs"), bounding_box_centre(mesh.vertices),
                                           frame_about(Eigen::Vector3d::UnitX()), std::move(faces), "all"));
  return annotation;
}

// For each vertex its image's number, where the mesh has the symmetry to rounding and no two vertices are at one place.
std::optional<std::vector<int>> images(const Mesh& mesh) {
  const double middle = bounding_box_centre(mesh.vertices).x();
  const double tolerance = 1e-12 * diagonal(mesh.vertices);
  std::vector<int> result;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    Eigen::RowVector3d image = mesh.vertices.row(v);
    image.x() = 2 * middle - image.x();
    std::vector<int> near;
    for (Eigen::Index w = 0; w < mesh.vertices.rows(); ++w) {
      if ((mesh.vertices.row(w) - image).norm() <= tolerance) near.push_back(static_cast<int>(w));
    }
    if (near.size() != 1) return std::nullopt;
    result.push_back(near.front());
  }
  return result;
}

// How far the vertices are from being mirror images, in diagonals; the plane may have moved.
double asymmetry(const Mesh& edited, const std::vector<int>& image_of) {
  const double twice = edited.vertices(0, 0) + edited.vertices(image_of[0], 0);
  double worst = 0;
  for (Eigen::Index v = 0; v < edited.vertices.rows(); ++v) {
    Eigen::RowVector3d image = edited.vertices.row(image_of[static_cast<std::size_t>(v)]);
    image.x() = twice - image.x();
    worst = std::max(worst, (edited.vertices.row(v) - image).norm());
  }
  return worst / diagonal(edited.vertices);
}

// What commands are to say of which shapes: those that fail, and how the line begins; all others succeed. Why a fit to
// another shape fails is not said: its figures are no promise.
std::map<std::string, std::string> expected_failures() {
  std::map<std::string, std::string> result;
  std::ifstream stream(ORBIFIT_FAILURES);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t tab = line.find('\t', line.find('\t') + 1);
    result[line.substr(0, tab)] = line.substr(tab + 1);
  }
  return result;
}

struct Call {
  std::string command, arguments;
};

const std::vector<Call> kCalls{
    {"info", "info shape.obj"},
    {"detect", "detect shape.obj -o found.json --time-budget 2"},
    {"subspace", "subspace shape.obj mirror.json"},
    {"deform", "deform shape.obj mirror.json --handles handles.json -o edited.ply"},
    {"symmetrize", "symmetrize shape.obj mirror.json -o symmetric.ply"},
    {"fit", "fit cube.obj shape.obj --annotation cube.json -o fitted.ply"},
    {"convert", "convert shape.obj copy.off"},
};

class HardShape : public testing::TestWithParam<std::string> {};

BadInput file_named(const std::string& name) {
  for (BadInput& file : bad_input()) {
    if (file.name == name) return std::move(file);
  }
  throw std::logic_error("no such file");
}

void write_inputs(const TemporaryFolder& folder, const Mesh& mesh) {
  write_annotation(folder.file("mirror.json"), mirrored(mesh));
  const double step = 0.1 * diagonal(mesh.vertices);
  std::ostringstream handles;
  handles.precision(17);
  handles << R"({"handles": [{"vertices": [0], "translation": [)" << step << ", " << 0.5 * step
          << R"(, 0]}, {"vertices": [)" << mesh.vertices.rows() - 1 << "]}]}";
  folder.write("handles.json", handles.str());
  folder.write("cube.obj", bad_input_cube());
  write_annotation(folder.file("cube.json"), mirrored(read_mesh(folder.file("cube.obj"))));
}

TEST_P(HardShape, EachCommandGivesARightResultOrAReason) {
  const Program program;
  const TemporaryFolder& folder = program.folder();
  const Mesh mesh = read_mesh(folder.write("shape.obj", file_named(GetParam()).content));
  write_inputs(folder, mesh);
  const auto failures = expected_failures();
  for (const Call& call : kCalls) {
    SCOPED_TRACE(call.command);
    const std::string key = GetParam() + "\t" + call.command;
    const ProgramResult result = program.run(call.arguments + " --quiet --timeout 60 --max-memory 4G");
    const auto failure = failures.find(key);
    const std::string outcome =
        result.code == 0 ? "" : std::to_string(result.code) + " " + result.errors.substr(0, result.errors.find('\n'));
    const std::string expected = failure == failures.end() ? "" : failure->second;
    EXPECT_EQ(outcome.substr(0, expected.empty() ? outcome.size() : expected.size()), expected)
        << key << "\t" << outcome;
  }
  const auto image_of = images(mesh);
  for (const char* name : {"edited.ply", "symmetric.ply", "fitted.ply", "copy.off"}) {
    SCOPED_TRACE(name);
    if (!std::filesystem::exists(folder.file(name))) continue;
    const Mesh written = read_mesh(folder.file(name));  // refuses numbers that are not finite
    if (std::string(name) == "copy.off") {
      EXPECT_EQ(written.vertices, mesh.vertices);
    }
    const bool edited = std::string(name) == "edited.ply" || std::string(name) == "symmetric.ply";
    if (edited && image_of) {
      const double digits = 16 * std::numeric_limits<double>::epsilon() * mesh.vertices.cwiseAbs().maxCoeff();
      EXPECT_LE(asymmetry(written, *image_of), kExact + digits / diagonal(mesh.vertices));
    }
  }
}

std::vector<std::string> hard_shapes() {
  std::vector<std::string> names;
  for (const BadInput& file : bad_input()) {
    const bool refused = file.name.find("1e99") != std::string::npos;  // by the reader: outcomes.tsv
    if (file.name.starts_with("shape_") && !refused) names.push_back(file.name);
  }
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& test) {
  std::string name;
  for (const char letter : test.param.substr(6, test.param.size() - 10)) name += std::isalnum(letter) ? letter : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(BadInput, HardShape, testing::ValuesIn(hard_shapes()), test_name);

}  // namespace
}  // namespace orbifit
