#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

namespace orbifit {

/// Expects read_mesh() to refuse a file with a message that begins with its name and holds the reason.
inline void expect_mesh_refused(const std::filesystem::path& file, const std::string& reason) {
  try {
    read_mesh(file);
    ADD_FAILURE() << "was read, not refused: " << reason;
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ": ")) << error.what();
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

}  // namespace orbifit
