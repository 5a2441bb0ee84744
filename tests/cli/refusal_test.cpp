#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "files/file.h"
#include "program.h"

namespace orbifit {
namespace {

/// A call that must fail: with this exit code, these words in its one line on stderr, nothing on stdout, and nothing
/// written.
struct Refusal {
  std::string name;
  std::string arguments;
  int code;
  std::string message;

  friend void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << "orbifit " << refusal.arguments; }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void write_inputs(const TemporaryFolder& folder) {
  const Mesh cube = cube_mesh();
  write_mesh(folder.file("cube.ply"), cube);
  write_mesh(folder.file("cube.obj"), cube);
  write_mesh(folder.file("other.ply"), cube_mesh(2));
  write_annotation(folder.file("cube.json"), cube_annotation(cube));
  write_annotation(folder.file("other.json"), cube_annotation(cube_mesh(2)));
  const std::string annotation = read_file(folder.file("cube.json"));
  folder.write("skewed.json", replaced(annotation, "[[0, -1, 0, 0]", "[[0.01, -1, 0, 0]"));
  folder.write("open.json", annotation.substr(0, annotation.size() / 2));
  const std::string ply = read_file(folder.file("cube.ply"));
  folder.write("truncated.ply", ply.substr(0, ply.size() - 7));
  folder.write("empty.obj", "");
  folder.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  folder.write("nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  folder.write("empty.xyz", "# no point\n");
  folder.write("handles.json",
               R"({"handles": [{"name": "far", "centre": [50, 0, 0], "radius": 0.1, "translation": [1, 0, 0]}]})");
  std::filesystem::create_symlink("/dev/full", folder.file("full.obj"));
  std::filesystem::create_directory(folder.file("folder.obj"));
}

class RefusedCall : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedCall, NamesTheReasonAndLeavesNothing) {
  const Program program;
  write_inputs(program.folder());
  const auto before = program.folder().listing();
  const ProgramResult result = program.run(GetParam().arguments);
  EXPECT_EQ(result.code, GetParam().code) << result.errors;
  EXPECT_NE(result.errors.find(GetParam().message), std::string::npos) << result.errors;
  EXPECT_TRUE(result.errors.starts_with("orbifit: ")) << result.errors;
  EXPECT_EQ(std::ranges::count(result.errors, '\n'), 1) << result.errors;
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(program.folder().listing(), before);
}

std::string test_name(const testing::TestParamInfo<Refusal>& test) {
  return test.param.name;
}

INSTANTIATE_TEST_SUITE_P(
    Input, RefusedCall,
    testing::Values(
        Refusal{"MissingFile", "info none.obj", 3, "none.obj: no such file"},
        Refusal{"Folder", "info folder.obj", 3, "folder.obj: is a folder, not a file"},
        Refusal{"EmptyFile", "detect empty.obj -o out.json", 3, "empty.obj: is empty"},
        Refusal{"UnknownEnding", "info cube.json", 3, "cube.json: unknown ending '.json'"},
        Refusal{"TruncatedPly", "detect truncated.ply -o out.json", 3,
                "truncated.ply: face 383: the file is truncated: its header announces 384 of element 'face'"},
        Refusal{"IndexOutOfRange", "convert index.obj out.ply", 3, "index.obj: line 4: vertex index 3"},
        Refusal{"NanVertex", "convert nan.obj out.ply", 3, "nan.obj: line 2: coordinate y is nan"},
        Refusal{"NoFaces", "detect points.obj -o out.json", 3, "points.obj: has no faces"},
        Refusal{"NoArea", "detect flat.obj -o out.json", 3, "area"},
        Refusal{"MissingAnnotation", "check cube.ply none.json", 3, "none.json: no such file"},
        Refusal{"AnnotationOfAnotherMesh", "check cube.ply other.json", 3,
                "other.json: mesh.faces: the annotation is of a mesh with 96 faces, this one has 384"},
        Refusal{"MatrixNotOrthogonal", "check cube.ply skewed.json", 3, "is not orthogonal: |R R^T - 1| is"},
        Refusal{"AnnotationCutShort", "check cube.ply open.json", 3, "is not JSON"},
        Refusal{"DeformedIsAnother", "check cube.ply cube.json --deformed other.ply", 3,
                "other.ply: is no deformation of cube.ply"},
        Refusal{"EmptyScan", "convert empty.xyz out.ply", 3, "empty.xyz: has no points"},
        Refusal{"EmptyScanDrawn", "render cube.ply --points empty.xyz -o out.png", 3, "empty.xyz: has no points"},
        Refusal{"EmptyScanFitted", "fit cube.ply empty.xyz --annotation cube.json -o out.ply", 3,
                "empty.xyz: has no points"},
        Refusal{"HandleOnNoVertex", "deform cube.ply cube.json --handles handles.json -o out.ply", 3, "far"}),
    test_name);

INSTANTIATE_TEST_SUITE_P(
    Usage, RefusedCall,
    testing::Values(
        Refusal{"NoCommand", "", 2, "a command is needed"},
        Refusal{"UnknownRegion", "fit cube.ply cube.ply --annotation cube.json --without 99 -o out.ply", 2,
                "the annotation has no region 99"},
        Refusal{"UnknownMethod", "compare cube.ply cube.ply --annotation cube.json --methods magic -o out", 2,
                "methods has 'magic'"},
        Refusal{"NothingToCompareOn", "compare cube.ply --annotation cube.json -o out", 2, "a scan, or --handles"},
        Refusal{"ViewpointOfTwoNumbers", "fit cube.ply cube.ply --viewpoint 1 2 -o out.ply", 2, "--viewpoint"},
        Refusal{"UnknownCommand", "polish cube.ply", 2, "unknown command 'polish'"},
        Refusal{"UnknownOption", "info cube.ply --sharp", 2, "unexpected argument --sharp"},
        Refusal{"MissingArgument", "detect", 2, "MESH is required"},
        Refusal{"TooMany", "info cube.ply cube.obj", 2, "unexpected argument cube.obj"},
        Refusal{"NotANumber", "detect cube.ply --tolerance small -o out.json", 2, "--tolerance"},
        Refusal{"Tolerance", "detect cube.ply --tolerance 0.5 -o out.json", 2, "tolerance"},
        Refusal{"Samples", "detect cube.ply --samples 3 -o out.json", 2, "samples"},
        Refusal{"Mode", "check cube.ply cube.json --mode loose", 2, "--mode is 'loose': must be fixed, posed"},
        Refusal{"Limit", "check cube.ply cube.json --max-residual -1", 2, "--max-residual is -1"},
        Refusal{"Threads", "info cube.ply --threads 0", 2, "--threads is 0: must be from 1 to 4096"},
        Refusal{"Timeout", "info cube.ply --timeout -1", 2, "--timeout is -1: must be a positive number"},
        Refusal{"Memory", "info cube.ply --max-memory 0", 2, "--max-memory is 0: must be a positive size"},
        Refusal{"MemoryUnit", "info cube.ply --max-memory 3parsecs", 2, "--max-memory"},
        Refusal{"Seed", "info cube.ply --seed x", 2, "--seed"},
        Refusal{"UnknownModel", "generate teapot -o out", 2, "teapot"},
        Refusal{"NoModel", "generate -o out", 2, "a model's NAME is needed"},
        Refusal{"UnknownParameter", "generate bar --param wheels=3 -o out", 2, "wheels"},
        Refusal{"ParameterShape", "generate bar --param length -o out", 2, "--param 'length': must be NAME=NUMBER"},
        Refusal{"ParameterTwice", "generate bar --param length=4 --param length=5 -o out", 2, "given twice"},
        Refusal{"ParameterRange", "generate bar --param length=1e9 -o out", 2, "length"},
        Refusal{"Views", "scan cube.ply --views 0 -o out.ply", 2, "views"},
        Refusal{"Up", "scan cube.ply --up 0 0 0 -o out.ply", 2, "--up must be three numbers, not all 0"},
        Refusal{"UpShort", "scan cube.ply --up 0 1 -o out.ply", 2, "--up: wrong number of values"},
        Refusal{"Ending", "scan cube.ply -o out.obj", 2, "out.obj: the ending must be .ply, .pcd, .xyz or .pts"},
        Refusal{"OverwritesInput", "scan cube.ply -o cube.ply", 2, "would overwrite the input cube.ply"},
        Refusal{"Region", "render cube.ply --annotation cube.json --region 7 -o out.png", 2,
                "--region: the annotation has no region 7; there are 0 (cube)"}),
    test_name);

INSTANTIATE_TEST_SUITE_P(
    Output, RefusedCall,
    testing::Values(Refusal{"NoFolder", "detect cube.ply -o none/out.json", 3, "the folder none does not exist"},
                    Refusal{"NoFolderForMesh", "convert cube.ply none/out.obj", 3, "the folder none does not exist"},
                    Refusal{"IsFolder", "convert cube.ply folder.obj", 3,
                            "folder.obj: cannot be written: it is a folder"},
                    Refusal{"NoParent", "generate bar -o none/out", 3, "none/out: is no folder and cannot be made"},
                    Refusal{"FolderIsFile", "generate bar -o cube.obj", 3, "cube.obj: is no folder"},
                    Refusal{"DiskFull", "convert cube.ply full.obj", 3, "full.obj: cannot be written: No space left"}),
    test_name);

INSTANTIATE_TEST_SUITE_P(Timeout, RefusedCall,
                         testing::Values(Refusal{"Detect", "detect cube.ply -o out.json --timeout 1e-6", 4, "time"},
                                         Refusal{"Check", "check cube.ply cube.json --timeout 1e-6", 4, "time"},
                                         Refusal{"Scan", "scan cube.ply -o out.ply --timeout 1e-6", 4, "time"},
                                         Refusal{"Convert", "convert cube.ply out.obj --timeout 1e-6", 4, "time"},
                                         Refusal{"Render", "render cube.ply -o out.png --timeout 1e-6", 4, "time"},
                                         Refusal{"Generate", "generate bar -o out --timeout 1e-6", 4, "time"}),
                         test_name);

TEST(Interruption, ExitsWith130AndLeavesNothing) {
  const Program program;
  write_inputs(program.folder());
  const auto before = program.folder().listing();
  const ProgramResult result = program.run_and_interrupt("render cube.ply --width 2048 --height 2048 -o out.png");
  EXPECT_EQ(result.code, 130) << result.errors;
  EXPECT_NE(result.errors.find("orbifit: "), std::string::npos) << result.errors;
  EXPECT_EQ(program.folder().listing(), before);
}

}  // namespace
}  // namespace orbifit
