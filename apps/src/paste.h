#pragma once

#include "orbifit/apps/render.h"

namespace orbifit {

/// Copies a picture into a larger one, which must hold it. \param left, top  pixels
void paste(Image& sheet, const Image& image, int left, int top);

}  // namespace orbifit
