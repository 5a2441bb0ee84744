#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "program.h"

namespace orbifit {
namespace {

using nlohmann::json;

TEST(Contacts, AreKeptUnlessToldOtherwise) {
  const Program program;
  const auto file = [&](const std::string& name) { return program.folder().file(name); };
  ASSERT_EQ(program.run("generate stool --param detail=1 -o .").code, 0);
  write_file(file("handles.json"), R"({"handles": [
    {"centre": [0, 0, 0.46], "radius": 0.19},
    {"centre": [0.18, 0, 0], "radius": 0.05, "translation": [0.08, 0, 0]}]})");
  const std::string call = "deform stool.ply stool.annotation.json --handles handles.json --samples 400 --json -o ";
  const ProgramResult with = program.run(call + "with.ply");
  const ProgramResult without = program.run(call + "without.ply --no-contacts");
  ASSERT_EQ(with.code, 0) << with.errors;
  ASSERT_EQ(without.code, 0) << without.errors;
  EXPECT_GT(json::parse(with.output)["contacts"], 0);
  EXPECT_EQ(json::parse(without.output)["contacts"], 0);
  EXPECT_LT(json::parse(with.output)["field_residual"], 1e-12);
  const Points difference = read_mesh(file("with.ply")).vertices - read_mesh(file("without.ply")).vertices;
  EXPECT_GT(difference.rowwise().norm().maxCoeff(), 1e-4);  // m; a stool of 0.5 m
}

TEST(Contacts, AreAnOptionOfTheFit) {
  const Program program;
  EXPECT_NE(program.run("fit --help").output.find("--no-contacts"), std::string::npos);
}

}  // namespace
}  // namespace orbifit
