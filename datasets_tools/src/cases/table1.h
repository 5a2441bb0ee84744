#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/motion.h"

namespace orbifit {

/// A part of a model and where an edit takes it.
struct Table1Handle {
  std::string name;
  Eigen::Vector3d centre;  ///< the handle is the vertices within `radius` of it, in mesh units
  double radius = 0;
  Motion motion;  ///< the identity holds the handle in place
};

/// A row of Table 1 of Wu, Wand, Hildebrandt, Kohli, Seidel 2014 as printed, and a generated model in place of theirs:
/// of the same kind and size, with as many symmetric regions. Small parts of which there are many (the laths of a
/// sail, a spoke's ends) may have symmetries of their own beside those.
struct Table1Model {
  std::string name;  ///< the row's: "bar", "centre_piece", "plane", "yard_tool", "car", "wind_mill", "fan", "chair"
  std::string generator;                     ///< see generate()
  std::map<std::string, double> parameters;  ///< those that are not the generator's defaults
  GeneratedModel model;
  std::vector<Table1Handle> handles;  ///< a large edit natural to the model; the first ones hold it in place

  double vertices_k = 0, triangles_k = 0;  ///< thousands
  int groups = 0;                          ///< symmetric regions
  int samples = 0;
  int dof = 0;                                          ///< dimension of the symmetry-preserving space
  double prefactor_ms = 0, solve5_ms = 0, lift_ms = 0;  ///< on an Intel Xeon E5-1620, one thread
};

/// The models' names in the order of the table.
const std::vector<std::string>& table1_names();

/// \throw UsageError for a name that is none of table1_names()
Table1Model table1_model(const std::string& name);

}  // namespace orbifit
