#include "deformation/supernodal_factor.h"

#include <algorithm>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace orbifit {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// Laplacians of random graphs and what holds them: lower half.
struct Graph {
  const char* name;
  int nodes;
  int edges_per_node;
  int reach;  // of an edge, in numbers of nodes
  int apart;  // no edge crosses a multiple of this number
};

std::ostream& operator<<(std::ostream& out, const Graph& graph) {
  return out << graph.name;
}

Sparse laplacian(const Graph& graph) {
  Random random(7, "graph");
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < graph.nodes; ++i) {
    entries.emplace_back(i, i, 1e-2);
    for (int edge = 0; edge < graph.edges_per_node; ++edge) {
      const int j = std::min(graph.nodes - 1, i + 1 + static_cast<int>(random.uniform(0, graph.reach)));
      if (j == i || i / graph.apart != j / graph.apart) continue;
      const double weight = random.uniform(0.5, 2);
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
      entries.emplace_back(j, i, -weight);
    }
  }
  Sparse result(graph.nodes, graph.nodes);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

class SupernodalFactorOf : public testing::TestWithParam<Graph> {
 protected:
  Sparse lower_ = laplacian(GetParam());
};

TEST_P(SupernodalFactorOf, SolvesWhatWasMultiplied) {
  SupernodalFactor factor;
  factor.analyse(lower_);
  Eigen::VectorXd wanted(lower_.rows());
  for (Eigen::Index i = 0; i < wanted.size(); ++i) wanted[i] = static_cast<double>(i % 11) - 5;
  for (const double scale : {1.0, 3.0}) {  // the analysis is good for other values
    const Sparse scaled = scale * lower_;
    ASSERT_TRUE(factor.factorise(scaled));
    Eigen::VectorXd found = scaled.selfadjointView<Eigen::Lower>() * wanted;
    factor.solve(found);
    EXPECT_LT((found - wanted).norm(), 1e-11 * wanted.norm());
  }
}

TEST_P(SupernodalFactorOf, RefusesWhatIsNotPositiveDefinite) {
  SupernodalFactor factor;
  factor.analyse(lower_);
  const Eigen::Index last = lower_.rows() - 1;
  for (const double wrong : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    Sparse spoilt = lower_;
    spoilt.coeffRef(last, last) = wrong;
    EXPECT_FALSE(factor.factorise(spoilt)) << wrong;
  }
  EXPECT_TRUE(factor.factorise(lower_));
}

// Every column is in one front, every child before its parent and in its parent's rows, and the factor that a plain
// elimination leaves has entries in no other rows.
TEST_P(SupernodalFactorOf, FrontsHoldTheWholeFactor) {
  const EliminationFronts elimination = elimination_fronts(lower_);
  const Eigen::Index size = lower_.rows();
  std::vector<int> place(elimination.order.indices().begin(), elimination.order.indices().end());
  std::ranges::sort(place);
  for (int i = 0; i < size; ++i) ASSERT_EQ(place[static_cast<std::size_t>(i)], i);

  Eigen::MatrixXd allowed = Eigen::MatrixXd::Zero(size, size);
  int columns = 0;
  std::vector<int> parents(elimination.fronts.size());
  for (std::size_t f = 0; f < elimination.fronts.size(); ++f) {
    const EliminationFront& front = elimination.fronts[f];
    EXPECT_EQ(front.first, columns);
    columns += front.width;
    EXPECT_TRUE(std::ranges::is_sorted(front.rows));
    for (int j = front.first; j < columns; ++j) {
      for (int i = j; i < columns; ++i) allowed(i, j) = 1;
      for (const int row : front.rows) allowed(row, j) = 1;
    }
    for (const int child : front.children) {
      EXPECT_LT(child, static_cast<int>(f));
      ++parents[static_cast<std::size_t>(child)];
      for (const int row : elimination.fronts[static_cast<std::size_t>(child)].rows) {
        EXPECT_TRUE(row < columns || std::ranges::binary_search(front.rows, row));
      }
    }
  }
  EXPECT_EQ(columns, size);
  for (std::size_t f = 0; f < parents.size(); ++f) EXPECT_EQ(parents[f], elimination.fronts[f].rows.empty() ? 0 : 1);

  const Eigen::MatrixXd full = Eigen::MatrixXd(lower_).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd factor = (elimination.order * full * elimination.order.transpose()).llt().matrixL();
  EXPECT_EQ(((factor.array() != 0).cast<double>() * (1 - allowed.array())).sum(), 0);
}

INSTANTIATE_TEST_SUITE_P(Graphs, SupernodalFactorOf,
                         testing::Values(Graph{"one", 1, 0, 1, 1}, Graph{"diagonal", 30, 0, 1, 30},
                                         Graph{"path", 60, 1, 1, 60}, Graph{"band", 200, 3, 8, 200},
                                         Graph{"apart", 200, 3, 8, 17}, Graph{"wide", 300, 2, 150, 300},
                                         Graph{"full", 40, 200, 40, 40}),
                         [](const testing::TestParamInfo<Graph>& of) { return std::string(of.param.name); });

TEST(SupernodalFactor, NothingHasAFactor) {
  SupernodalFactor factor;
  factor.analyse(Sparse(0, 0));
  ASSERT_TRUE(factor.factorise(Sparse(0, 0)));
  Eigen::VectorXd none(0);
  factor.solve(none);
  EXPECT_EQ(factor.entries(), 0);
}

// On a grid the factor has far fewer entries than a full one, so that the order and the fronts are of use.
TEST(SupernodalFactor, FrontsOfAGridAreSmall) {
  constexpr int kSide = 60;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < kSide * kSide; ++i) {
    entries.emplace_back(i, i, 4.1);
    if (i % kSide + 1 < kSide) entries.emplace_back(i + 1, i, -1);
    if (i + kSide < kSide * kSide) entries.emplace_back(i + kSide, i, -1);
  }
  Sparse grid(kSide * kSide, kSide * kSide);
  grid.setFromTriplets(entries.begin(), entries.end());
  SupernodalFactor factor;
  factor.analyse(grid);
  EXPECT_LT(factor.entries(), 40.0 * kSide * kSide);
}

}  // namespace
}  // namespace orbifit
