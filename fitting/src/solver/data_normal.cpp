#include "solver/data_normal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "basis/gram.h"
#include "registration/alignment.h"
#include "solver/gram_sum.h"

namespace orbifit {

namespace {

// Rows of a least-squares problem that have much the same columns: multiplied out together, on those columns alone.
class Batch {
 public:
  /// \param step  whose unknowns are the last columns, which all rows have
  Batch(const VertexRows& rows, Eigen::Index columns, const ScanStep& step)
      : rows_(rows),
        last_(step.unknowns()),
        common_(step.common()),
        local_of_(static_cast<std::size_t>(columns), -1),
        place_of_(rows.representatives(), -1) {}

  /// Of each vertex whose displacement is part of a row; then begin().
  void use(int vertex) {
    const VertexRows::Way& way = rows_.way(vertex);
    int& place = place_of_[static_cast<std::size_t>(way.representative)];
    if (place < 0) {
      place = static_cast<int>(representatives_.size());
      representatives_.push_back(way.representative);
      use(rows_.own(way.representative).columns);
    }
    const auto shift = static_cast<std::size_t>(way.shift);
    if (shift_used_.size() <= shift) shift_used_.resize(shift + 1, 0);
    if (shift_used_[shift] == 0) {
      shift_used_[shift] = 1;
      shifts_.push_back(way.shift);
      use(rows_.shift(way.shift).columns);
    }
    use(way.more.columns);
  }

  void begin(Eigen::Index rows) {
    for (int k = last_; k > 0; --k) use_column(static_cast<int>(local_of_.size()) - k);
    std::ranges::sort(columns_);
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      local_of_[static_cast<std::size_t>(columns_[j])] = static_cast<int>(j);
    }
    const auto count = whole_fours(static_cast<Eigen::Index>(columns_.size()));
    all_.setZero(rows, count);
    right_.setZero(rows);
    own_.setZero(3 * static_cast<Eigen::Index>(representatives_.size()), count);
    for (std::size_t i = 0; i < representatives_.size(); ++i) {
      const VertexRows::Rows& own = rows_.own(representatives_[i]);
      for (std::size_t j = 0; j < own.columns.size(); ++j) {
        own_.block<3, 1>(3 * static_cast<Eigen::Index>(i), local(own.columns[j])) = own.factors[j];
      }
    }
  }

  // Parts of a row: the sum of direction . u(vertex).
  struct Part {
    int vertex;
    Eigen::Vector3d direction;
  };
  void add(Eigen::Index row, const std::vector<Part>& parts) {
    auto to = all_.row(row);
    const auto add_factor = [&](int column, double factor) { to[local(column)] += factor; };
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const VertexRows::Way& way = rows_.way(parts[i].vertex);
      const Eigen::Index place = 3 * place_of_[static_cast<std::size_t>(way.representative)];
      const Eigen::Vector3d direction = way.along.transpose() * parts[i].direction;
      for (int c = 0; c < 3; ++c) to += direction[c] * own_.row(place + c);
      way.more.visit(parts[i].direction, add_factor);
      // Corners of a face are mostly carried alike.
      Eigen::Vector3d shared = Eigen::Vector3d::Zero();
      bool first = true;
      for (std::size_t j = 0; j < parts.size(); ++j) {
        if (rows_.way(parts[j].vertex).shift != way.shift) continue;
        first = first && j >= i;
        shared += parts[j].direction;
      }
      if (first) rows_.shift(way.shift).visit(shared, add_factor);
    }
  }

  // The unknowns of the pose, the number of the scan, the right-hand side, and the weight of the row: its last step.
  void finish(Eigen::Index row, const Eigen::Matrix<double, 7, 1>& pose, int view, double right, double weight) {
    const auto count = static_cast<Eigen::Index>(columns_.size());
    all_.row(row).segment(count - common_, common_) = pose.tail(common_);
    if (view > 0) all_.row(row).segment<6>(count - last_ + 6 * (view - 1)) = pose.tail<6>();
    right_[row] = right;
    const double root = std::sqrt(weight);
    all_.row(row) *= root;
    right_[row] *= root;
  }

  // Leaves the batch empty.
  void multiply_out(GramPart& product) {
    for (const int column : columns_) local_of_[static_cast<std::size_t>(column)] = -1;
    for (const int representative : representatives_) place_of_[static_cast<std::size_t>(representative)] = -1;
    for (const int shift : shifts_) shift_used_[static_cast<std::size_t>(shift)] = 0;
    representatives_.clear();
    shifts_.clear();
    product.columns = std::move(columns_);
    columns_.clear();
    lower_gram(all_, product.gram);
    product.side.noalias() = all_.transpose() * right_;
  }

 private:
  Eigen::Index local(int column) const { return local_of_[static_cast<std::size_t>(column)]; }

  void use(const std::vector<int>& columns) {
    for (const int column : columns) use_column(column);
  }
  void use_column(int column) {
    int& local = local_of_[static_cast<std::size_t>(column)];
    if (local >= 0) return;
    local = 0;
    columns_.push_back(column);
  }

  const VertexRows& rows_;
  int last_, common_;
  std::vector<int> local_of_;  // by column: its place among those used; -1: not used
  std::vector<int> place_of_;  // by representative, likewise
  std::vector<char> shift_used_;
  std::vector<int> columns_, representatives_, shifts_;
  RowMajorMatrix own_;  // three rows of each representative, on the columns used, filled up with zeros to fours
  RowMajorMatrix all_;  // likewise
  Eigen::VectorXd right_;
};

// Images of one another, and then neighbours, move with the same samples.
std::vector<std::size_t> by_representatives(const VertexRows& rows, const Mesh& mesh,
                                            const std::vector<Correspondence>& pairs) {
  std::vector<std::pair<int, std::size_t>> order;
  order.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto corner = [&](int k) { return rows.way(mesh.faces(pairs[i].face, k)).representative; };
    order.emplace_back(std::min({corner(0), corner(1), corner(2)}), i);
  }
  std::ranges::sort(order);
  std::vector<std::size_t> result;
  result.reserve(order.size());
  for (const auto& [representative, i] : order) result.push_back(i);
  return result;
}

}  // namespace

Motion ScanStep::motion(const Eigen::Ref<const Eigen::Matrix<double, 6, 1>>& solved) const {
  return small_motion(solved.head<3>() / length, solved.tail<3>(), pivot);
}

std::vector<Motion> ScanStep::other_motions(const Eigen::VectorXd& solved) const {
  std::vector<Motion> result;
  for (int k = 0; k < others; ++k) result.push_back(motion(solved.segment<6>(6 * k)));
  return result;
}

std::vector<int> touched_vertices(const Mesh& mesh, const std::vector<Correspondence>& pairs,
                                  const std::vector<Pull>& pulls) {
  std::vector<int> vertices;
  std::vector<char> met(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  const auto add = [&](int vertex) {
    if (std::exchange(met[static_cast<std::size_t>(vertex)], 1) == 0) vertices.push_back(vertex);
  };
  for (const Correspondence& pair : pairs) {
    for (int k = 0; k < 3; ++k) add(mesh.faces(pair.face, k));
  }
  for (const Pull& pull : pulls) add(pull.vertex);
  return vertices;
}

void add_data(const VertexRows& rows, const Mesh& mesh, const ScanStep& step, const std::vector<Correspondence>& pairs,
              double share, const Points& scan_points, const std::vector<Pull>& pulls, const RunContext& context,
              NormalEquations& normal) {
  constexpr std::size_t kRows = 48;      // of a batch
  constexpr std::size_t kBatches = 256;  // at a time: summed in turn, so that rounding does not depend on the threads
  const Eigen::Index all = normal.side.size();
  const auto of_pose = [&](const Eigen::Vector3d& rest, const Eigen::Vector3d& goal, const Eigen::Vector3d& direction) {
    Eigen::Matrix<double, 7, 1> result;
    result << (rest - step.pivot).dot(direction) / step.length, -(goal - step.pivot).cross(direction) / step.length,
        -direction;
    return result;
  };
  const std::vector<std::size_t> order = by_representatives(rows, mesh, pairs);
  const auto multiply_out = [&](std::size_t first, Batch& batch, GramPart& product) {
    const std::size_t count = std::min(kRows, pairs.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Correspondence& pair = pairs[order[first + i]];
      for (int k = 0; k < 3; ++k) {
        if (pair.barycentric[k] != 0) batch.use(mesh.faces(pair.face, k));
      }
    }
    batch.begin(static_cast<Eigen::Index>(count));
    std::vector<Batch::Part> parts;
    for (std::size_t i = 0; i < count; ++i) {
      const Correspondence& pair = pairs[order[first + i]];
      const auto row = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d rest = mesh.vertices(mesh.faces.row(pair.face), Eigen::all).transpose() * pair.barycentric;
      const Eigen::Vector3d goal = scan_points.row(pair.scan_point);
      parts.clear();
      for (int k = 0; k < 3; ++k) {
        if (pair.barycentric[k] != 0) parts.push_back({mesh.faces(pair.face, k), pair.barycentric[k] * pair.normal});
      }
      batch.add(row, parts);
      batch.finish(row, of_pose(rest, goal, pair.normal), pair.view, pair.normal.dot(goal - rest), share * pair.weight);
    }
    batch.multiply_out(product);
  };
  const std::size_t batches = (pairs.size() + kRows - 1) / kRows;
  std::vector<GramPart> products(std::min(batches, kBatches));
  for (std::size_t first = 0; first < batches; first += kBatches) {
    const std::size_t count = std::min(kBatches, batches - first);
    parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
      Batch batch(rows, all, step);
      for (std::size_t b = begin; b < end; ++b) multiply_out((first + b) * kRows, batch, products[b]);
    });
    add_parts({products.data(), count}, context, normal.matrix, normal.side);
  }
  Batch batch(rows, all, step);
  GramPart product;
  for (const Pull& pull : pulls) {
    const Eigen::Vector3d rest = mesh.vertices.row(pull.vertex);
    batch.use(pull.vertex);
    batch.begin(3);
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(c);
      batch.add(c, {{pull.vertex, direction}});
      batch.finish(c, of_pose(rest, pull.target, direction), 0, pull.target[c] - rest[c], pull.weight);
    }
    batch.multiply_out(product);
    add_parts({&product, 1}, context, normal.matrix, normal.side);
  }
}

}  // namespace orbifit
