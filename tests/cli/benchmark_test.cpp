#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/mesh_io.h"

#include "cube.h"
#include "files/file.h"
#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

class BenchmarkProgram : public testing::Test {
 protected:
  json result_of(const std::string& line) const {
    const ProgramResult result = program_.run(line + " --quiet --json result.json");
    EXPECT_EQ(result.code, 0) << line << "\n" << result.errors;
    EXPECT_EQ(result.errors, "");
    text_ = result.output;
    return json::parse(read_file(program_.folder().file("result.json")));
  }

  Program program_{ORBIFIT_BENCHMARK};
  mutable std::string text_;
};

TEST_F(BenchmarkProgram, Table1HasARowForEachModelAndNumberOfThreads) {
  const json rows = result_of("table1 --models bar --no-peers --repeat 1");
  ASSERT_EQ(rows.size(), 2U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const json& row = rows[i];
    EXPECT_EQ(row["model"], "bar");
    EXPECT_EQ(row["threads"], static_cast<int>(i) + 1);
    EXPECT_EQ(row["groups"], 1);
    EXPECT_NEAR(row["vertices"], 4000, 500);
    EXPECT_NEAR(row["triangles"], 8000, 1000);
    EXPECT_EQ(row["paper_samples"], 96);
    EXPECT_NEAR(row["samples"], 96, 9.6);
    EXPECT_GT(row["dof"], 5);
    EXPECT_LT(row["dof"], 60);
    for (const char* key :
         {"build_ms", "prefactor_ms", "solve5_ms", "lift_ms", "lift_floor_ms", "paper_vertices", "paper_triangles",
          "paper_groups", "paper_dof", "paper_prefactor_ms", "paper_solve5_ms", "paper_lift_ms"}) {
      ASSERT_TRUE(row.contains(key)) << key;
      EXPECT_GT(row[key], 0) << key;
    }
    EXPECT_LT(row["field_residual"], 1e-12);
    EXPECT_FALSE(row.contains("soft_solve5_ms"));
  }
  EXPECT_EQ(rows[0]["samples"], rows[1]["samples"]);
  EXPECT_EQ(rows[0]["field_residual"], rows[1]["field_residual"]);
}

TEST_F(BenchmarkProgram, Table1MeasuresThePeers) {
  const json rows = result_of("table1 --models bar --threads 1 --repeat 1");
  ASSERT_EQ(rows.size(), 1U);
  const json& row = rows[0];
  EXPECT_GT(row["soft_prefactor_ms"], 0);
  EXPECT_GT(row["soft_solve5_ms"], 0);
  ASSERT_EQ(row["soft"].size(), 3U);
  for (std::size_t i = 1; i < 3; ++i) EXPECT_LT(row["soft"][i]["residual"], row["soft"][i - 1]["residual"]);
  // CGAL need not be there; without figures there is a reason.
  ASSERT_TRUE(row.contains("arap_prefactor_ms"));
  ASSERT_TRUE(row.contains("arap_solve5_ms"));
  EXPECT_EQ(row["arap_prefactor_ms"].is_null(), row["arap_solve5_ms"].is_null());
  EXPECT_TRUE(!row["arap_solve5_ms"].is_null() || row["arap_note"] != "");
}

TEST_F(BenchmarkProgram, TablesFitAScreen) {
  result_of("table1 --models bar --repeat 1");
  std::istringstream lines(text_);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 120U) << line;
  EXPECT_GT(count, 10);
}

TEST_F(BenchmarkProgram, ScalingCountsVertices) {
  const json result = result_of("scaling --most 100000");
  const json& rows = result["rows"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR(rows[0]["vertices"], 1e4, 3e3);
  EXPECT_NEAR(rows[1]["vertices"], 1e5, 3e4);
  for (const json& row : rows) {
    EXPECT_GT(row["seconds"], 0);
    EXPECT_GT(row["bytes_peak"], row["bytes_before"]);
    EXPECT_GE(row["samples"], 100);
  }
  EXPECT_TRUE(std::isfinite(result["exponent"].get<double>()));
}

TEST_F(BenchmarkProgram, DetectionIsScoredInEveryForm) {
  const json result = result_of("detection --models unequal_cross --cut");
  const json& rows = result["rows"];
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const json& row = rows[i];
    EXPECT_EQ(row["model"], "unequal_cross");
    EXPECT_EQ(row["kind"], "near miss");
    EXPECT_EQ(row["form"], i < 2 ? "assembly" : "remesh");
    EXPECT_EQ(row["noise"], 0);
    EXPECT_EQ(row["cut"], i % 2 == 1);
    EXPECT_EQ(row["failure"], "");
    EXPECT_GT(row["faces"], 0);
    EXPECT_GT(row["seconds"], 0);
    EXPECT_EQ(row["breaches"], 0);
    for (const char* key : {"precision", "f1"}) {
      EXPECT_GE(row[key], 0) << key;
      EXPECT_LE(row[key], 1) << key;
    }
  }
  // Its whole group, at least, is found on the model as it is.
  EXPECT_GT(rows[0]["expected"], 0);
  EXPECT_GT(rows[0]["strict_recall"], 0);
  EXPECT_LT(rows[0]["axis_error"], 1);
  EXPECT_LT(rows[3]["faces"], rows[2]["faces"]) << "a part is cut away";
  const json& means = result["means"]["by_form"];
  ASSERT_EQ(means.size(), 4U);
  EXPECT_EQ(means[0]["f1"], rows[0]["f1"]);
  EXPECT_EQ(result["means"]["by_kind"].size(), 1U);
  std::istringstream lines(text_);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 120U) << line;
}

TEST_F(BenchmarkProgram, DetectionIsTheSameInOtherOrdersAndPoses) {
  const json result = result_of("detection --models bowl --forms assembly --again");
  const json& row = result["rows"].at(0);
  EXPECT_EQ(row["regions"], 1);
  EXPECT_EQ(row["within_tolerance"], 1);
  EXPECT_EQ(row["again"], 1);
  EXPECT_EQ(result["means"]["by_form"][0]["again"], 1);
  EXPECT_GT(result["means"]["by_form"][0]["listed"], 0);
}

TEST_F(BenchmarkProgram, DetectionWritesTheSameFilesForTheSameSeed) {
  for (const char* folder : {"first", "second"}) {
    result_of("detection --models boulder --forms remesh --noise 0.003 --write " + std::string(folder));
  }
  result_of("detection --models boulder --forms remesh --noise 0.003 --seed 2 --write other");
  const auto content = [&](const std::string& folder, const std::string& ending) {
    return read_file(program_.folder().file(folder) / ("boulder-remesh-noise0.003" + ending));
  };
  for (const char* ending : {".ply", ".truth.json", ".detected.json"}) {
    EXPECT_EQ(content("first", ending), content("second", ending)) << ending;
  }
  EXPECT_NE(content("first", ".ply"), content("other", ".ply"));
  const json truth = json::parse(content("first", ".truth.json"));
  const json detected = json::parse(content("first", ".detected.json"));
  EXPECT_EQ(truth["mesh"]["faces"], detected["mesh"]["faces"]);
  EXPECT_TRUE(truth["optional_regions"].is_array());
}

TEST_F(BenchmarkProgram, RealMeshesAreFoundInFoldersDetectedAndDragged) {
  const TemporaryFolder& folder = program_.folder();
  for (const char* name : {"meshes", "meshes/original", "meshes/further"}) {
    std::filesystem::create_directory(folder.file(name));
  }
  const Mesh cube = cube_mesh();
  write_mesh(folder.file("meshes/cube.obj"), cube);
  write_mesh(folder.file("meshes/further/cube.off"), cube);
  write_mesh(folder.file("meshes/original/box.obj"), cube);
  folder.write("meshes/scan.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
               "end_header\n0 0 0\n");
  folder.write("meshes/torn.stl", "solid torn\n");
  folder.write("meshes/notes.txt", "no mesh\n");
  const std::string line = "real meshes --annotations detected --csv real.csv";
  const ProgramResult result = program_.run(line);
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_NE(result.errors.find("1 file without faces passed over"), std::string::npos) << result.errors;
  EXPECT_NE(result.output.find("3 meshes, 2 of 3 (66.7 %) without any failure"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("torn"), std::string::npos);
  EXPECT_EQ(result.output.find("box"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder.file("detected/meshes_cube.json")));
  EXPECT_TRUE(std::filesystem::exists(folder.file("detected/further_cube.json")));
  std::istringstream rows(read_file(folder.file("real.csv")));
  std::string row;
  std::getline(rows, row);
  int exact = 0;
  while (std::getline(rows, row)) {
    std::vector<std::string> cells;
    std::istringstream columns(row);
    for (std::string one; std::getline(columns, one, ',');) cells.push_back(one);
    if (cells[0] == "\"torn\"") continue;
    ASSERT_GE(cells.size(), 18U) << row;
    EXPECT_EQ(cells[4], cells[10]) << "of a cube all is kept: " << row;
    EXPECT_EQ(cells[12], "1") << row;
    EXPECT_LE(std::stod(cells[15]), 1e-12) << row;
    EXPECT_LE(std::stod(cells[16]), 1e-12) << row;
    EXPECT_GE(std::stol(cells[17]), 48 * cube.vertices.rows()) << "each image of each vertex is a vertex: " << row;
    ++exact;
  }
  EXPECT_EQ(exact, 6);
  const ProgramResult again = program_.run(line);
  EXPECT_NE(again.output.find("  read"), std::string::npos) << again.output;
}

TEST_F(BenchmarkProgram, ScansAreFittedAndComparedWithTheirTemplates) {
  const TemporaryFolder& folder = program_.folder();
  const auto made = [&](const std::string& line) {
    const ProgramResult result = Program{ORBIFIT_PROGRAM}.run(line);
    ASSERT_EQ(result.code, 0) << result.errors;
  };
  const std::string here = folder.path().string() + "/";
  made("generate chair -o " + here);
  Mesh longer = read_mesh(folder.file("chair.ply"));
  longer.vertices.col(2) *= 1.2;
  write_mesh(folder.file("longer.ply"), longer);
  made("scan " + here + "chair.ply --views 3 -o " + here + "of_same.ply");
  made("scan " + here + "longer.ply --views 3 -o " + here + "of_longer.ply");
  std::filesystem::create_directory(folder.file("known"));
  std::filesystem::copy(folder.file("chair.annotation.json"), folder.file("known/chair.json"));
  folder.write("pairs.tsv",
               "# template, scan\nchair.ply\tof_same.ply\tsame\nchair.ply\tof_longer.ply\tkind\n"
               "chair.ply\tmissing.ply\tkind\t0 0 5\n");
  const ProgramResult result = program_.run("scans pairs.tsv --annotations known --csv scans.csv");
  EXPECT_EQ(result.code, 0) << result.errors;
  EXPECT_NE(result.output.find("3 pairs, 2 taken for fitted\n1 scan of the very thing: 1 with"), std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("missing failed: "), std::string::npos) << result.output;
  std::istringstream rows(read_file(folder.file("scans.csv")));
  std::string row;
  std::getline(rows, row);
  const auto bent = [&] {
    std::getline(rows, row);
    std::vector<std::string> cells;
    std::istringstream columns(row);
    for (std::string one; std::getline(columns, one, ',');) cells.push_back(one.substr(1, one.size() - 2));
    return cells.size() < 10 ? -1 : std::stod(cells[9]);
  };
  const double of_same = bent();
  EXPECT_GE(of_same, 0) << row;
  EXPECT_LT(of_same, 0.5) << row;
  EXPECT_GT(bent(), 1) << row;
  for (const char* line : {"chair.ply", "chair.ply\tof_same.ply\tother", "chair.ply\tof_same.ply\tsame\t0 0"}) {
    folder.write("pairs.tsv", std::string("\n") + line + "\n");
    const ProgramResult bad = program_.run("scans pairs.tsv");
    EXPECT_EQ(bad.code, 3) << line;
    EXPECT_NE(bad.errors.find("line 2"), std::string::npos) << bad.errors;
  }
}

TEST_F(BenchmarkProgram, RefusesWhatItCannotMeasure) {
  for (const char* line :
       {"", "table2", "table1 --models teapot", "table1 --repeat 0", "table1 --threads 0", "scaling --most 3",
        "scaling --most nan", "scaling --model teapot", "detection --models cube", "detection --forms soup", "real",
        "real . --modes turned", "real . --threads 0", "real . --stage-limit -1", "detection --noise -1",
        "detection --noise nan", "detection --threads 0", "detection --tolerance 1"}) {
    const ProgramResult result = program_.run(line);
    EXPECT_EQ(result.code, 2) << line;
    EXPECT_TRUE(result.errors.starts_with("orbifit")) << result.errors;
  }
  EXPECT_EQ(program_.run("table1 --models bar --json missing/table.json").code, 3);
  EXPECT_EQ(program_.run("detection --models boulder --write missing/cases").code, 3);
  EXPECT_EQ(program_.run("real missing").code, 3);
  EXPECT_EQ(program_.run("scans missing").code, 3);
}

}  // namespace
}  // namespace orbifit
