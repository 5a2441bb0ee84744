#pragma once

#include "orbifit/model/errors.h"

namespace orbifit {

/// What is said of handles whose system has no solution in doubles.
[[noreturn]] inline void refuse_unsolvable() {
  throw NoResultError("the handles' system could not be factorised");
}

}  // namespace orbifit
