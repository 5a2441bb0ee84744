#pragma once

#include <vector>

#include "suite/detection_suite.h"

namespace orbifit {

// The suite's models by theme.
std::vector<SuiteModel> orbit_suite();       ///< one finite group each: chiral bodies on a ball
std::vector<SuiteModel> axial_suite();       ///< objects with a Cn, Cnv or Cnh
std::vector<SuiteModel> dihedral_suite();    ///< objects with a Dn, Dnh or Dnd
std::vector<SuiteModel> polyhedral_suite();  ///< objects with a T to Ih
std::vector<SuiteModel> nested_suite();      ///< regions within regions, several axes
std::vector<SuiteModel> pattern_suite();     ///< rows, grids, arcs, screws, scattered copies
std::vector<SuiteModel> turned_suite();      ///< shapes of the lathe
std::vector<SuiteModel> asymmetric_suite();  ///< no symmetry at all
std::vector<SuiteModel> near_miss_suite();   ///< just not symmetric
std::vector<SuiteModel> generated_suite();   ///< the models of generate()

}  // namespace orbifit
