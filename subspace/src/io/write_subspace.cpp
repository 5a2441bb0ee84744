#include <string>
#include <utility>
#include <vector>

#include "orbifit/subspace/subspace_io.h"

#include "basis/subspace_parts.h"
#include "files/file.h"
#include "io/basis_format.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

void append(std::vector<double>& numbers, const Motion& motion) {
  MotionRows rows;
  rows << motion.linear, motion.translation;
  numbers.insert(numbers.end(), rows.data(), rows.data() + kMotionNumbers);
}

void append(std::vector<double>& numbers, const Vector3d& vector) {
  numbers.insert(numbers.end(), vector.data(), vector.data() + 3);
}

void put_points(SectionWriter& file, const Points& points) {
  file.array(points.data(), size_of(points.size()));
}

template <class Items, class Part>
void put_each(SectionWriter& file, const Items& items, const Part& part) {
  std::vector<int> numbers;
  numbers.reserve(items.size());
  for (const auto& item : items) numbers.push_back(static_cast<int>(part(item)));
  file.array(numbers);
}

template <class Items, class Part>
void put_motions(SectionWriter& file, const Items& items, const Part& part) {
  std::vector<double> numbers;
  for (const auto& item : items) append(numbers, part(item));
  file.array(numbers);
}

void put_source(SectionWriter& file, const Subspace& subspace, const Mesh& mesh, const SymmetryAnnotation& annotation) {
  file.begin("source");
  file.integer(mesh.vertices.rows());
  file.integer(mesh.faces.rows());
  file.integer(static_cast<std::int64_t>(mesh_checksum(mesh)));
  file.integer(static_cast<std::int64_t>(annotation.regions.size()));
  file.integer(static_cast<std::int64_t>(annotation.patterns.size()));
  file.integer(static_cast<std::int64_t>(annotation_checksum(annotation)));
  file.integer(static_cast<int>(subspace->mode));
  file.integer(static_cast<int>(subspace->lift_kind));
  file.real(subspace->diagonal);
}

void put_sets(SectionWriter& file, const RegionMap& regions) {
  file.begin("sets");
  std::vector<int> starts{0}, places;
  for (int set = 0; set < regions.set_count(); ++set) {
    const std::vector<int>& members = regions.set_places(set);
    places.insert(places.end(), members.begin(), members.end());
    starts.push_back(static_cast<int>(places.size()));
  }
  file.array(starts);
  file.array(places);
}

void put_words(SectionWriter& file, const GroupWords& words) {
  file.begin("words");
  std::vector<GroupWords::Step> steps;
  for (int word = 1; word < words.count(); ++word) steps.push_back(words.step(word));
  put_each(file, steps, [](const auto& step) { return step.parent; });
  put_each(file, steps, [](const auto& step) { return step.place; });
  put_each(file, steps, [](const auto& step) { return step.element; });
  put_motions(file, steps, [](const auto& step) { return step.motion; });
}

// Structured bindings name every member here and below: a new one does not compile until it is stored.
void put_sampling(SectionWriter& file, const SymmetricSampling& sampling) {
  const auto& [radius, points, radii, orbit_of_sample, first_sample, words, sets, copies, shares, copy_counts,
               constraints] = sampling;
  file.begin("sampling");
  file.real(radius);
  put_points(file, points);
  file.array(radii.data(), size_of(radii.size()));
  file.array(first_sample);
  file.array(orbit_of_sample);
  file.array(words);
  file.array(sets);
  put_each(file, copies, [](const auto& copy) { return copy.place; });
  put_each(file, copies, [](const auto& copy) { return copy.first; });
  put_motions(file, copies, [](const auto& copy) { return copy.turn; });
  file.array(shares);
  file.array(copy_counts);
  put_each(file, constraints, [](const auto& constraint) { return constraint.orbit; });
  put_each(file, constraints, [](const auto& constraint) { return constraint.left; });
  put_each(file, constraints, [](const auto& constraint) { return constraint.right; });
}

void put_orbits(SectionWriter& file, const VertexOrbits& orbits) {
  // Offsets follow from the rest.
  const auto& [tolerance, followers, turns, positions, bound, bindings, first_point, point_words, point_sets, images,
               offsets] = orbits;
  file.begin("orbits");
  file.real(tolerance);
  put_each(file, followers, [](const auto& follower) { return follower.representative; });
  put_each(file, followers, [](const auto& follower) { return follower.word; });
  put_each(file, followers, [](const auto& follower) { return follower.turn; });
  put_each(file, turns, [](const auto& turn) { return turn.place; });
  put_motions(file, turns, [](const auto& turn) { return turn.motion; });
  put_points(file, positions);
  file.array(bound);
  std::vector<int> starts{0}, pairs;
  std::vector<double> places;
  for (const BoundPoint& binding : bindings) {
    append(places, binding.position);
    for (const WordPair& pair : binding.words) pairs.insert(pairs.end(), {pair.left, pair.right});
    starts.push_back(static_cast<int>(pairs.size()));
  }
  file.array(places);
  file.array(starts);
  file.array(pairs);
  file.array(point_words);
  file.array(first_point);
  file.array(point_sets);
  file.integer(images ? 1 : 0);
}

void put_lift(SectionWriter& file, const OrbitLift& lift) {
  const auto& [atoms, first, atom, weight, used] = lift;
  file.begin("lift");
  put_each(file, atoms, [](const auto& one) { return one.sample; });
  put_each(file, atoms, [](const auto& one) { return one.word; });
  put_each(file, atoms, [](const auto& one) { return one.kind; });
  put_each(file, atoms, [](const auto& one) { return one.place; });
  file.array(atom);
  file.array(first);
  file.array(weight);
  file.integer(used);
}

void put_basis(SectionWriter& file, const SymmetricBasis& basis) {
  const auto& [columns, offset, carried, carried_offset, conflict] = basis;
  file.begin("basis");
  Eigen::SparseMatrix<double> compressed = columns;
  compressed.makeCompressed();
  const auto entries = size_of(compressed.nonZeros());
  file.integer(compressed.cols());
  file.array(compressed.innerIndexPtr(), entries);
  file.array(compressed.outerIndexPtr(), size_of(compressed.cols()) + 1);
  file.array(compressed.valuePtr(), entries);
  file.array(offset.data(), size_of(offset.size()));
  file.integer(carried.rows());
  file.array(carried.data(), size_of(carried.size()));
  file.array(carried_offset.data(), size_of(carried_offset.size()));
  file.real(conflict);
}

}  // namespace

std::uint64_t mesh_checksum(const Mesh& mesh) {
  Checksum sum;
  sum.add(mesh.vertices.data(), size_of(mesh.vertices.size()) * sizeof(double));
  sum.add(mesh.faces.data(), size_of(mesh.faces.size()) * sizeof(int));
  return sum.value();
}

std::uint64_t annotation_checksum(const SymmetryAnnotation& annotation) {
  Checksum sum;
  const auto add = [&](const std::string& symbol, const std::vector<double>& numbers, const std::vector<int>& faces) {
    const std::vector<std::uint64_t> sizes{symbol.size(), numbers.size(), faces.size()};
    sum.add(sizes);
    sum.add(symbol.data(), symbol.size());
    sum.add(numbers);
    sum.add(faces);
  };
  for (const Region& region : annotation.regions) {
    std::vector<double> numbers;
    append(numbers, region.centre);
    append(numbers, region.axis);
    for (const Motion& element : region.elements) append(numbers, element);
    add(region.group.symbol(), numbers, region.faces);
  }
  for (const Pattern& pattern : annotation.patterns) {
    std::vector<double> numbers;
    for (const Motion& generator : pattern.generators) append(numbers, generator);
    add(to_string(pattern.kind), numbers, {});
    for (const PatternInstance& instance : pattern.instances) {
      numbers.clear();
      append(numbers, instance.motion);
      add("", numbers, instance.faces);
    }
  }
  return sum.value();
}

void write_subspace(const std::filesystem::path& file, const Subspace& subspace, const Mesh& mesh,
                    const SymmetryAnnotation& annotation) {
  SectionWriter writer(kBasisFormat, kBasisSections);
  put_source(writer, subspace, mesh, annotation);
  put_sets(writer, *subspace->regions);
  put_words(writer, *subspace->words);
  put_sampling(writer, subspace->sampling);
  put_orbits(writer, subspace->orbits);
  put_lift(writer, subspace->lift);
  put_basis(writer, subspace->basis);
  write_file(file, std::move(writer).finish());
}

}  // namespace orbifit
