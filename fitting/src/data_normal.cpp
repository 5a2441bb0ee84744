#include "data_normal.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "orbifit/fitting/alignment.h"

namespace orbifit {

namespace {

// Rows of a least-squares problem that have much the same columns: multiplied out together, on those columns alone.
class Batch {
 public:
  /// \param last  columns that all rows have, the last ones
  Batch(Eigen::Index columns, int last) : last_(last), used_(static_cast<std::size_t>(columns), 0) {}

  void begin(Eigen::Index rows) {
    std::ranges::fill(used_, char{0});
    std::fill(used_.end() - last_, used_.end(), char{1});
    all_.setZero(rows, static_cast<Eigen::Index>(used_.size()));
    right_.setZero(rows);
  }

  // direction . u(vertex) is part of a row.
  void add_vertex(Eigen::Index row, const std::vector<VertexRows::Entry>& entries, const Eigen::Vector3d& direction) {
    double* to = all_.row(row).data();
    for (const VertexRows::Entry& entry : entries) {
      used_[static_cast<std::size_t>(entry.column)] = 1;
      to[entry.column] += direction.dot(entry.factor);
    }
  }

  // The unknowns of the pose, the right-hand side, and the weight of the row: its last step.
  void finish(Eigen::Index row, const Eigen::Matrix<double, 7, 1>& pose, double right, double weight) {
    all_.row(row).tail(last_) = pose.tail(last_);
    right_[row] = right;
    const double root = std::sqrt(weight);
    all_.row(row) *= root;
    right_[row] *= root;
  }

  // Columns in ascending order: the lower half on them is one of the whole matrix's.
  void add_to(DataNormal& normal) {
    columns_.clear();
    for (std::size_t j = 0; j < used_.size(); ++j) {
      if (used_[j] != 0) columns_.push_back(static_cast<int>(j));
    }
    local_ = all_(Eigen::all, columns_);
    gram_.setZero(local_.cols(), local_.cols());
    gram_.selfadjointView<Eigen::Lower>().rankUpdate(local_.transpose());
    side_.noalias() = local_.transpose() * right_;
    for (Eigen::Index b = 0; b < gram_.cols(); ++b) {
      const int column = columns_[static_cast<std::size_t>(b)];
      normal.side[column] += side_[b];
      double* to = normal.matrix.col(column).data();
      const double* from = gram_.col(b).data();
      for (Eigen::Index a = b; a < gram_.rows(); ++a) to[columns_[static_cast<std::size_t>(a)]] += from[a];
    }
  }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  int last_;
  std::vector<char> used_;  // by column
  std::vector<int> columns_;
  Rows all_, local_;  // on all columns, and on those used
  Eigen::MatrixXd gram_;
  Eigen::VectorXd right_, side_;
};

}  // namespace

Motion ScanStep::motion(const Eigen::Ref<const Eigen::Matrix<double, 6, 1>>& solved) const {
  return small_motion(solved.head<3>() / length, solved.tail<3>(), pivot);
}

std::vector<int> touched_vertices(const Mesh& mesh, const std::vector<Correspondence>& pairs,
                                  const std::vector<Pull>& pulls) {
  std::vector<int> vertices;
  for (const Correspondence& pair : pairs) {
    for (int k = 0; k < 3; ++k) vertices.push_back(mesh.faces(pair.face, k));
  }
  for (const Pull& pull : pulls) vertices.push_back(pull.vertex);
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

DataNormal data_normal(const VertexRows& rows, Eigen::Index columns, const Mesh& mesh, const ScanStep& step,
                       const std::vector<Correspondence>& pairs, double share, const Points& scan_points,
                       const std::vector<Pull>& pulls, const RunContext& context) {
  constexpr std::size_t kBlocks = 8;  // summed in turn: rounding does not depend on the number of threads
  constexpr std::size_t kRows = 48;   // of a batch
  const Eigen::Index all = columns + step.unknowns();
  const DataNormal zero{Eigen::MatrixXd::Zero(all, all), Eigen::VectorXd::Zero(all)};
  std::vector<DataNormal> blocks(std::min(kBlocks, 1 + pairs.size() / kRows), zero);
  const auto of_pose = [&](const Eigen::Vector3d& rest, const Eigen::Vector3d& goal, const Eigen::Vector3d& direction) {
    Eigen::Matrix<double, 7, 1> result;
    result << (rest - step.pivot).dot(direction) / step.length, -(goal - step.pivot).cross(direction) / step.length,
        -direction;
    return result;
  };
  // Neighbouring faces, mostly of neighbouring numbers, move with the same samples.
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return pairs[i].face; });
  parallel_for(context, blocks.size(), [&](std::size_t begin, std::size_t end) {
    Batch batch(all, step.unknowns());
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t last = (b + 1) * pairs.size() / blocks.size();
      for (std::size_t first = b * pairs.size() / blocks.size(); first < last; first += kRows) {
        const std::size_t count = std::min(kRows, last - first);
        batch.begin(static_cast<Eigen::Index>(count));
        for (std::size_t i = 0; i < count; ++i) {
          const Correspondence& pair = pairs[order[first + i]];
          const auto row = static_cast<Eigen::Index>(i);
          const Eigen::Vector3d rest =
              mesh.vertices(mesh.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
          const Eigen::Vector3d goal = scan_points.row(pair.scan_point);
          for (int k = 0; k < 3; ++k) {
            if (pair.barycentric[k] == 0) continue;
            batch.add_vertex(row, rows.of(mesh.faces(pair.face, k)), pair.barycentric[k] * pair.normal);
          }
          batch.finish(row, of_pose(rest, goal, pair.normal), pair.normal.dot(goal - rest), share * pair.weight);
        }
        batch.add_to(blocks[b]);
      }
    }
  });
  DataNormal total = zero;
  for (const DataNormal& block : blocks) {
    total.matrix += block.matrix;
    total.side += block.side;
  }
  Batch batch(all, step.unknowns());
  for (const Pull& pull : pulls) {
    const std::vector<VertexRows::Entry>& entries = rows.of(pull.vertex);
    const Eigen::Vector3d rest = mesh.vertices.row(pull.vertex);
    batch.begin(3);
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(c);
      batch.add_vertex(c, entries, direction);
      batch.finish(c, of_pose(rest, pull.target, direction), pull.target[c] - rest[c], pull.weight);
    }
    batch.add_to(total);
  }
  return total;
}

}  // namespace orbifit
