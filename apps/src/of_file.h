#pragma once

#include <string>

#include "orbifit/model/errors.h"

namespace orbifit {

/// What `call()` returns, which knows what a file holds but not its name.
/// \throw InputError  as `call` does, with the file named
template <class Call>
auto of_file(const std::string& file, const Call& call) {
  try {
    return call();
  } catch (const InputError& error) {
    throw InputError(file, "", error.what());
  }
}

}  // namespace orbifit
