#pragma once

#include <filesystem>
#include <string>

#include <unistd.h>

namespace orbifit {

/// A file that is written again and again, in memory where there is such a folder; one process, one file of an ending.
inline std::filesystem::path scratch_file(const std::string& ending) {
  const std::filesystem::path memory("/dev/shm");
  const std::filesystem::path folder =
      std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  return folder / ("orbifit-fuzz-" + std::to_string(::getpid()) + ending);
}

}  // namespace orbifit
