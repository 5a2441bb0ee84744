#include "other_program.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include <unistd.h>

#include "command.h"
#include "console.h"

namespace orbifit {

int become_program(const std::string& name, char* const* arguments) {
  std::error_code code;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", code);
  std::string path = (self.parent_path() / name).string();
  std::vector<char*> words{path.data()};
  while (*arguments != nullptr) words.push_back(*arguments++);
  words.push_back(nullptr);
  if (!code) ::execv(path.c_str(), words.data());
  if (code || errno == ENOENT) {
    path = name;
    words[0] = path.data();
    ::execvp(path.c_str(), words.data());
  }
  const std::string reason =
      errno == ENOENT
          ? "it is neither beside orbifit nor in PATH; it has a package of its own, and a build makes it with "
            "-DORBIFIT_BUILD_BASELINES=ON"
          : std::string("it cannot be started: ") + std::strerror(errno);
  Console(false).error("this command needs the program " + name + ": " + reason);
  return kNoResult;
}

}  // namespace orbifit
