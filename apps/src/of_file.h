#pragma once

#include <string>

#include "orbifit/model/errors.h"

namespace orbifit {

/// What `call()` returns, which was given what a file holds, but not its name: of what it refuses the file is named.
template <class Call>
auto of_file(const std::string& file, const Call& call) {
  try {
    return call();
  } catch (const InputError& error) {
    throw InputError(file, "", error.what());
  }
}

}  // namespace orbifit
