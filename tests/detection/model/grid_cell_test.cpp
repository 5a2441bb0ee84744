#include "geometry/grid_cell.h"

#include <limits>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

namespace orbifit {
namespace {

TEST(GridCell, IsTheFloor) {
  EXPECT_EQ(grid_cell(0.0), 0);
  EXPECT_EQ(grid_cell(2.999), 2);
  EXPECT_EQ(grid_cell(-1e-300), -1);
  EXPECT_EQ(grid_cell(-0x1p60 - 256), -(1LL << 60) - 256);
  EXPECT_EQ(grid_cell(Eigen::Vector3d(1, -1, 7), 2.0), (std::array<std::int64_t, 3>{0, -1, 3}));
}

// Where no integer has that number, a cast would be undefined; neighbours of the last cells have numbers too.
TEST(GridCell, HasAnEnd) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::int64_t last = 1LL << 62;
  for (const double far : {0x1p62, 1e19, 1e300, infinity}) {
    EXPECT_EQ(grid_cell(far), last) << far;
    EXPECT_EQ(grid_cell(-far), -last) << far;
  }
  EXPECT_EQ(grid_cell(std::numeric_limits<double>::quiet_NaN()), -last);
  EXPECT_EQ(grid_cell(Eigen::Vector3d(1, 0, -1), 0.0)[0], last);
}

TEST(Require, NamesTheValueWithAllItsDigits) {
  const auto message = [](double value) {
    try {
      require(false, "radius", value, "above 0");
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(1e-9), "radius is 1e-09; it must be above 0");
  EXPECT_EQ(message(-3), "radius is -3; it must be above 0");
  EXPECT_NO_THROW(require(true, "radius", 1, "above 0"));
}

}  // namespace
}  // namespace orbifit
