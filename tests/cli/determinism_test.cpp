#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/file.h"
#include "program.h"

namespace orbifit {
namespace {

struct Stage {
  std::string name, arguments;  ///< the inputs are in $in; the output is $out, and its ending the line's
};

// The same call under other circumstances, none of which is to change a byte of what it writes.
struct Circumstance {
  std::string name, before, options;
};

const std::vector<Circumstance>& circumstances() {
  static const std::vector<Circumstance> all{{"again", "", "--threads 1"},
                                             {"2 threads", "", "--threads 2"},
                                             {"7 threads", "", "--threads 7"},
                                             {"another working directory", "cd /; ", "--threads 2"},
                                             {"no randomised addresses", "$fixed ", "--threads 2"},
                                             {"a locale with decimal commas", "$commas ", "--threads 2"}};
  return all;
}

class Determinism : public testing::TestWithParam<Stage> {
 protected:
  void SetUp() override {
    ASSERT_EQ(run("$orbifit generate table -o $in --quiet && $orbifit scan $in/table.ply --views 2 --noise 0.002 "
                  "-o $in/scan.ply --quiet")
                  .code,
              0);
    shell_.folder().write("handles.json",
                          R"({"handles": [{"name": "a", "vertices": [0], "translation": [0.1, 0.03, 0.02]}]})");
  }

  // Where there is no setarch, or no locale can be made, these variables are empty: the call is as usual.
  ProgramResult run(const std::string& line) const {
    const std::string folder = shell_.folder().path().string();
    return shell_.run(std::vector<std::string>{
        "-c", "orbifit=" ORBIFIT_PROGRAM "; in=" + folder + "; out=" + folder +
                  "/out; fixed=; setarch -R true 2>/dev/null && fixed='setarch -R'; commas=; [ -d " + folder +
                  "/de_DE.UTF-8 ] && commas='env LOCPATH=" + folder + " LC_ALL=de_DE.UTF-8'; " + line});
  }

  std::string output(const Circumstance& circumstance) {
    const auto file = shell_.folder().file("out" + ending_);
    std::filesystem::remove(file);
    const ProgramResult result =
        run(circumstance.before + "$orbifit " + GetParam().arguments + " " + circumstance.options + " --quiet");
    EXPECT_EQ(result.code, 0) << circumstance.name << ": " << result.errors;
    return result.code == 0 ? read_file(file) : "";
  }

  Program shell_{"/bin/sh"};
  std::string ending_;
};

TEST_P(Determinism, NothingChangesAByte) {
  ending_ = GetParam().arguments.substr(GetParam().arguments.find("$out") + 4);
  run("localedef -i de_DE -f UTF-8 $in/de_DE.UTF-8");
  const std::string first = output({"at first", "", "--threads 1"});
  ASSERT_FALSE(first.empty());
  for (const Circumstance& circumstance : circumstances()) {
    EXPECT_TRUE(output(circumstance) == first) << circumstance.name;
  }
  if (run("[ \"$fixed\" ] && [ \"$commas\" ]").code != 0) {
    GTEST_SKIP()
        << "all is equal, but addresses without randomisation or a locale with decimal commas are not to be had";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Stages, Determinism,
    testing::Values(Stage{"detect", "detect $in/table.ply -o $out.json"},
                    Stage{"subspace", "subspace $in/table.ply $in/table.annotation.json -o $out.basis"},
                    Stage{"deform",
                          "deform $in/table.ply $in/table.annotation.json --handles $in/handles.json -o $out.obj"},
                    Stage{"symmetrize", "symmetrize $in/table.ply $in/table.annotation.json -o $out.ply"},
                    Stage{"fit", "fit $in/table.ply $in/scan.ply --annotation $in/table.annotation.json -o $out.obj"}),
    [](const auto& stage) { return stage.param.name; });

}  // namespace
}  // namespace orbifit
