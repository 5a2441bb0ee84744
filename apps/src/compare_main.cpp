// The program orbifit-compare, which `orbifit compare` starts. It is apart because the methods that it compares with
// link Ceres and SuiteSparse, parts of which are under the GPL.
#include <array>
#include <exception>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "program.h"

int main(int argc, char** argv) {
  using namespace orbifit;
  try {
    // What people call is `orbifit compare`; help and messages say so.
    std::string program = "orbifit";
    std::string name = commands::kCompare.name;
    std::vector<char*> words{program.data(), name.data()};
    for (int i = 1; i < argc; ++i) words.push_back(argv[i]);
    words.push_back(nullptr);
    std::array table{commands::kCompare};
    table[0].define = commands::compare;
    table[0].program = nullptr;
    return run_program(table, static_cast<int>(words.size()) - 1, words.data());
  } catch (const std::exception& error) {
    Console(false).error(std::string("internal error: ") + error.what());
    return kNoResult;
  }
}
