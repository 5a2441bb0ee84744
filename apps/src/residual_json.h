#pragma once

#include <nlohmann/json_fwd.hpp>

#include "orbifit/model/annotation.h"

namespace orbifit {

/// {"rms", "max"}: as the commands' reports write a residual.
nlohmann::ordered_json to_json(const Residual& residual);

}  // namespace orbifit
