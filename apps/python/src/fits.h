#pragma once

#include "orbifit/fitting/fit.h"

#include "annotations.h"

namespace orbifit::python {

/// A fit and what it was made from, for pictures.
struct KeptFit {
  MeshPointer mesh;
  ScanPointer scan;  ///< of all scans that took part, in the frame of the first
  FitResult result;
};

}  // namespace orbifit::python
