#pragma once

#include "orbifit/fitting/fit.h"

#include "annotations.h"

namespace orbifit::python {

/// A fit and what it was made from, for pictures.
struct KeptFit {
  MeshPointer mesh;
  ScanPointer scan;
  FitResult result;
};

}  // namespace orbifit::python
