#include "orbifit/model/errors.h"

#include "files/text.h"

namespace orbifit {

void require(bool holds, const std::string& field, double value, const std::string& rule) {
  if (holds) return;
  std::string message = field + " is ";
  append_number(message, value);
  throw UsageError(message + "; it must be " + rule);
}

}  // namespace orbifit
