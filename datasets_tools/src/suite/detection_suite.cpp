#include "suite/detection_suite.h"

#include <iterator>
#include <utility>

#include "suite/suite_lists.h"

namespace orbifit {

std::vector<SuiteModel> detection_suite() {
  std::vector<SuiteModel> all;
  for (std::vector<SuiteModel> (*theme)() :
       {axial_suite, dihedral_suite, polyhedral_suite, orbit_suite, nested_suite, pattern_suite, turned_suite,
        asymmetric_suite, near_miss_suite, generated_suite}) {
    std::vector<SuiteModel> models = theme();
    all.insert(all.end(), std::make_move_iterator(models.begin()), std::make_move_iterator(models.end()));
  }
  return all;
}

}  // namespace orbifit
