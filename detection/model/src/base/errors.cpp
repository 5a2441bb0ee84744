#include "orbifit/model/errors.h"

#include <charconv>

namespace orbifit {

void require(bool holds, const std::string& field, double value, const std::string& rule) {
  if (holds) return;
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  throw UsageError(field + " is " + std::string(digits, end) + "; it must be " + rule);
}

}  // namespace orbifit
