#include "residual_json.h"

#include <nlohmann/json.hpp>

namespace orbifit {

nlohmann::ordered_json to_json(const Residual& residual) {
  return {{"rms", residual.rms}, {"max", residual.max}};
}

}  // namespace orbifit
