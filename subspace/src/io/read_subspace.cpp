#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "orbifit/subspace/subspace_io.h"

#include "basis/rest_basis.h"
#include "basis/subspace_parts.h"
#include "io/basis_format.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

Eigen::VectorXd get_vector(SectionReader& section, const char* field, std::size_t count) {
  const std::vector<double> numbers = section.array<double>(field, count);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(count));
}

std::vector<Motion> get_motions(SectionReader& section, const char* field, std::size_t count) {
  const std::vector<double> numbers = section.array<double>(field, kMotionNumbers * count);
  std::vector<Motion> motions(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Map<const MotionRows> rows(numbers.data() + kMotionNumbers * i);
    motions[i].linear = rows.leftCols<3>();
    motions[i].translation = rows.col(3);
  }
  return motions;
}

// Refuses the basis of another mesh or annotation.
void get_source(SectionReader section, const Mesh& mesh, const SymmetryAnnotation& annotation,
                SubspaceParts& subspace) {
  const auto vertices = section.integer("vertices"), faces = section.integer("faces");
  if (vertices != mesh.vertices.rows() || faces != mesh.faces.rows()) {
    section.refuse("mesh", "the basis is of a mesh of " + std::to_string(vertices) + " vertices and " +
                               std::to_string(faces) + " faces, not of this one of " +
                               std::to_string(mesh.vertices.rows()) + " and " + std::to_string(mesh.faces.rows()));
  }
  if (section.integer("mesh checksum") != static_cast<std::int64_t>(mesh_checksum(mesh))) {
    section.refuse("mesh", "the basis is of another mesh: its vertices or faces differ from this one's");
  }
  const auto regions = section.integer("regions"), patterns = section.integer("patterns");
  if (regions != std::ssize(annotation.regions) || patterns != std::ssize(annotation.patterns)) {
    section.refuse("annotation", "the basis is of an annotation of " + std::to_string(regions) + " regions and " +
                                     std::to_string(patterns) + " patterns, not of this one of " +
                                     std::to_string(annotation.regions.size()) + " and " +
                                     std::to_string(annotation.patterns.size()));
  }
  if (section.integer("annotation checksum") != static_cast<std::int64_t>(annotation_checksum(annotation))) {
    section.refuse("annotation",
                   "the basis is of another annotation: its groups, motions or faces differ from this one's");
  }
  subspace.mode = static_cast<GroupMode>(section.integer("mode", 0, static_cast<int>(GroupMode::moving)));
  subspace.lift_kind = static_cast<LiftKind>(section.integer("lift", 0, static_cast<int>(LiftKind::orbit)));
  subspace.diagonal = section.real("diagonal");
  section.end();
}

// Gives the sets their numbers again, in the same order.
void get_sets(SectionReader section, const RegionMap& regions) {
  const std::vector<int> starts = section.array<int>("starts");
  const std::vector<int> places = section.array<int>("places");
  for (std::size_t set = 0; set + 1 < starts.size(); ++set) {
    const int begin = starts[set], end = starts[set + 1];
    if (begin < 0 || begin > end || size_of(end) > places.size()) section.refuse("starts", "do not rise");
    const std::vector<int> members(places.begin() + begin, places.begin() + end);
    const bool known = members.empty() || (members.front() >= 0 && members.back() < regions.places());
    if (!known || std::ranges::adjacent_find(members, std::greater_equal{}) != members.end() ||
        regions.set_of(members) != static_cast<int>(set)) {
      section.refuse("places", "set " + std::to_string(set) + " is not one of this annotation");
    }
  }
  if (starts.empty() || size_of(starts.back()) != places.size() || regions.set_count() + 1 != std::ssize(starts)) {
    section.refuse("starts", "do not list the sets of this annotation");
  }
  section.end();
}

std::shared_ptr<GroupWords> get_words(SectionReader section, const RegionMap& regions, GroupMode mode) {
  const auto words = std::make_shared<GroupWords>(regions, mode != GroupMode::fixed);
  const std::vector<int> parents = section.array<int>("parents");
  const std::vector<int> places = section.numbers("places", parents.size(), 0, regions.places());
  const std::vector<int> elements = section.array<int>("elements", parents.size());
  const std::vector<Motion> motions = get_motions(section, "motions", parents.size());
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const int number = words->count();
    const bool turn = elements[i] == -1 && places[i] < regions.count();
    const bool element = elements[i] >= 0 && elements[i] < std::ssize(regions.elements(places[i]));
    if (parents[i] < 0 || parents[i] >= number || (!turn && !element) ||
        words->extended(parents[i], places[i], elements[i], motions[i]) != number) {
      section.refuse("elements", "word " + std::to_string(number) + " cannot be formed");
    }
  }
  section.end();
  return words;
}

void get_sampling(SectionReader section, const RegionMap& regions, int words, SymmetricSampling& sampling) {
  sampling.radius = section.real("radius");
  const std::vector<double> points = section.array<double>("points");
  const std::size_t count = points.size() / 3;
  if (count == 0 || points.size() % 3 != 0) section.refuse("points", "are not three numbers each");
  const int samples = static_cast<int>(count);
  sampling.points = Eigen::Map<const Points>(points.data(), samples, 3);
  sampling.radii = get_vector(section, "radii", count);
  sampling.first_sample = section.array<int>("first samples");
  const std::vector<int>& first = sampling.first_sample;
  if (first.size() < 2 || first.front() != 0 || first.back() != samples ||
      std::ranges::adjacent_find(first, std::greater_equal{}) != first.end()) {
    section.refuse("first samples", "do not rise from 0 to " + std::to_string(samples));
  }
  const int orbits = sampling.orbits();
  sampling.orbit_of_sample = section.numbers("orbits", count, 0, orbits);
  sampling.words = section.numbers("words", count, 0, words);
  sampling.sets = section.numbers("sets", count, 0, regions.set_count());
  const std::vector<int> places = section.numbers("places of copies", count, -1, regions.count());
  const std::vector<int> firsts = section.numbers("firsts of copies", count, 0, samples);
  const std::vector<Motion> turns = get_motions(section, "turns of copies", count);
  for (std::size_t k = 0; k < count; ++k) {
    if (places[k] >= 0 && regions.continuum(places[k]) == nullptr) {
      section.refuse("places of copies", "region " + std::to_string(places[k]) + " has no continuous group");
    }
    sampling.copies.push_back({places[k], firsts[k], turns[k]});
  }
  sampling.shares = section.array<double>("shares", count);
  sampling.copy_counts = section.numbers("numbers of copies", count, 1, samples + 1);
  const std::vector<int> constrained = section.array<int>("constrained orbits");
  const std::vector<int> left = section.numbers("left words", constrained.size(), 0, words);
  const std::vector<int> right = section.numbers("right words", constrained.size(), 0, words);
  for (std::size_t i = 0; i < constrained.size(); ++i) {
    if (constrained[i] < 0 || constrained[i] >= orbits) section.refuse("constrained orbits", "do not exist");
    sampling.constraints.push_back({constrained[i], left[i], right[i]});
  }
  section.end();
}

void get_orbits(SectionReader section, const RegionMap& regions, int words, std::size_t vertices,
                VertexOrbits& orbits) {
  orbits.tolerance = section.real("tolerance");
  const std::vector<int> representatives = section.array<int>("representatives", vertices);
  const std::vector<int> ways = section.numbers("words", vertices, 0, words);
  const std::vector<int> turned = section.array<int>("turned", vertices);
  const std::vector<int> places = section.array<int>("places of turns");
  const std::vector<Motion> motions = get_motions(section, "turns", places.size());
  const std::vector<double> positions = section.array<double>("positions");
  const std::size_t count = positions.size() / 3;
  if (positions.size() % 3 != 0) section.refuse("positions", "are not three numbers each");
  orbits.positions = Eigen::Map<const Points>(positions.data(), static_cast<Eigen::Index>(count), 3);
  orbits.followers.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    if (representatives[v] < 0 || size_of(representatives[v]) >= count || turned[v] < -1 ||
        turned[v] >= std::ssize(places)) {
      section.refuse("representatives", "vertex " + std::to_string(v) + " follows none");
    }
    orbits.followers[v] = {representatives[v], ways[v], turned[v]};
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] < 0 || places[i] >= regions.count()) section.refuse("places of turns", "are no regions");
    orbits.turns.push_back({places[i], motions[i]});
  }
  orbits.bound = section.array<int>("bindings", count);
  const std::vector<double> bound_at = section.array<double>("bound positions");
  const std::size_t bindings = bound_at.size() / 3;
  const std::vector<int> starts = section.array<int>("starts of pairs", bindings + 1);
  const std::vector<int> pairs = section.array<int>("pairs");
  for (std::size_t i = 0; i < bindings; ++i) {
    if (starts[i] < 0 || starts[i] > starts[i + 1] || size_of(starts[i + 1]) > pairs.size() || starts[i] % 2 != 0 ||
        starts[i + 1] % 2 != 0) {
      section.refuse("starts of pairs", "do not rise");
    }
    BoundPoint& binding = orbits.bindings.emplace_back();
    binding.position = Eigen::Map<const Vector3d>(bound_at.data() + 3 * i);
    for (int k = starts[i]; k < starts[i + 1]; k += 2) {
      const WordPair pair{pairs[size_of(k)], pairs[size_of(k) + 1]};
      if (pair.left < 0 || pair.left >= words || pair.right < 0 || pair.right >= words) {
        section.refuse("pairs", "are no words");
      }
      binding.words.push_back(pair);
    }
  }
  for (const int number : orbits.bound) {
    if (number < -1 || number >= std::ssize(orbits.bindings)) section.refuse("bindings", "do not exist");
  }
  orbits.point_words = section.array<int>("words of points");
  orbits.first_point = section.starts<std::int64_t>("first points", count, orbits.point_words.size());
  orbits.point_sets = section.numbers("sets of points", orbits.point_words.size(), 0, regions.set_count());
  for (const int word : orbits.point_words) {
    if (word < 0 || word >= words) section.refuse("words of points", "are no words");
  }
  orbits.images_are_vertices = section.integer("images are vertices", 0, 1) == 1;
  section.end();
}

void get_lift(SectionReader section, const SubspaceParts& subspace, OrbitLift& lift) {
  const auto samples = static_cast<int>(subspace.sampling.points.rows());
  const std::vector<int> sample = section.array<int>("samples");
  const std::size_t atoms = sample.size();
  const std::vector<int> words = section.numbers("words", atoms, 0, subspace.words->count());
  const std::vector<int> kinds = section.numbers("kinds", atoms, 0, static_cast<int>(LiftAtom::Kind::centre) + 1);
  const std::vector<int> places = section.numbers("places", atoms, -1, subspace.regions->count());
  for (std::size_t a = 0; a < atoms; ++a) {
    const auto kind = static_cast<LiftAtom::Kind>(kinds[a]);
    const bool central = kind == LiftAtom::Kind::centre;
    const bool sampled = sample[a] >= 0 && sample[a] < samples;
    const bool turned = places[a] >= 0 && subspace.regions->continuum(places[a]) != nullptr;
    if ((!sampled && !(central && sample[a] == -1)) || (kind != LiftAtom::Kind::full && !turned)) {
      section.refuse("samples", "atom " + std::to_string(a) + " has no sample or centre");
    }
    lift.atoms.push_back({sample[a], words[a], kind, places[a]});
  }
  lift.atom = section.array<std::int32_t>("atoms of entries");
  for (const std::int32_t atom : lift.atom) {
    if (atom < 0 || size_of(atom) >= atoms)
      section.refuse("atoms of entries", "holds " + std::to_string(atom) + ", which is no atom");
  }
  const auto representatives = size_of(subspace.orbits.representatives());
  const std::size_t blocks = (representatives + OrbitLift::kLanes - 1) / OrbitLift::kLanes;
  lift.first = section.starts<std::int64_t>("first entries", blocks, lift.atom.size());
  lift.weight = section.array<float>("weights", OrbitLift::kLanes * lift.atom.size());
  lift.used = section.integer("weights used", 0);
  section.end();
}

void get_basis(SectionReader section, const SubspaceParts& subspace, SymmetricBasis& basis) {
  const auto rows = static_cast<int>(3 * subspace.sampling.points.rows());
  const auto columns =
      static_cast<int>(section.integer("degrees of freedom", 0, rows + 3 * subspace.regions->carriers()));
  const std::vector<int> inner = section.array<int>("rows");
  const std::vector<int> starts = section.starts<int>("starts of columns", size_of(columns), inner.size());
  const std::vector<double> values = section.array<double>("values", inner.size());
  for (int column = 0; column < columns; ++column) {
    int before = -1;
    for (int k = starts[size_of(column)]; k < starts[size_of(column) + 1]; ++k) {
      const int row = inner[size_of(k)];
      if (row <= before || row >= rows) section.refuse("rows", "column " + std::to_string(column) + " is out of order");
      before = row;
    }
  }
  basis.columns = Eigen::Map<const Eigen::SparseMatrix<double>>(rows, columns, static_cast<Eigen::Index>(inner.size()),
                                                                starts.data(), inner.data(), values.data());
  basis.offset = get_vector(section, "offset", size_of(rows));
  const int carriers = subspace.mode == GroupMode::fixed ? 0 : 3 * subspace.regions->carriers();
  section.integer("rows of carried", carriers, carriers);
  const std::vector<double> carried = section.array<double>("carried", size_of(carriers) * size_of(columns));
  basis.carried = Eigen::Map<const Eigen::MatrixXd>(carried.data(), carriers, columns);
  basis.carried_offset = get_vector(section, "carried offset", size_of(carriers));
  basis.conflict = section.real("conflict");
  section.end();
}

}  // namespace

Subspace read_subspace(const std::filesystem::path& file, const Mesh& mesh, const SymmetryAnnotation& annotation,
                       const RunContext& context) {
  context.progress("reading the basis", 0);
  const SectionFile stored(file, kBasisFormat);
  const auto parts = std::make_shared<SubspaceParts>();
  SubspaceParts& subspace = *parts;
  get_source(stored.section("source"), mesh, annotation, subspace);
  subspace.regions = std::make_shared<RegionMap>(mesh, annotation, context);
  get_sets(stored.section("sets"), *subspace.regions);
  subspace.words = get_words(stored.section("words"), *subspace.regions, subspace.mode);
  const int words = subspace.words->count();
  get_sampling(stored.section("sampling"), *subspace.regions, words, subspace.sampling);
  get_orbits(stored.section("orbits"), *subspace.regions, words, size_of(mesh.vertices.rows()), subspace.orbits);
  if (subspace.mode == GroupMode::moving) {
    subspace.orbits.offsets = follower_offsets(mesh, *subspace.regions, subspace.orbits, *subspace.words);
  }
  get_lift(stored.section("lift"), subspace, subspace.lift);
  get_basis(stored.section("basis"), subspace, subspace.basis);
  context.progress("reading the basis", 0.5);
  complete_rest_basis(subspace);
  context.progress("reading the basis", 1);
  return Subspace(parts);
}

}  // namespace orbifit
