#include "basis/orbit_lift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <unordered_map>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "basis/alike_points.h"
#include "basis/plain_lift.h"
#include "geometry/grid_cell.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr double kQuantum = 1.0 / (1 << 24);
constexpr double kSameAtom = 1e-7;
constexpr double kSamePosition = 1e-3;  // of the radius

using Row = std::vector<std::pair<int, double>>;

// A random displacement of the basis, by which atoms are told apart.
struct Fingerprint {
  Points seeds;  // by orbit
  Eigen::VectorXd carriers;
};

Fingerprint random_displacement(const SymmetricSampling& sampling, const SymmetricBasis& basis) {
  Random random(7, "atoms");
  Eigen::VectorXd q(basis.degrees_of_freedom());
  for (double& coordinate : q) coordinate = random.normal();
  const Eigen::VectorXd moved = basis.columns * q;
  Fingerprint fingerprint;
  fingerprint.seeds.resize(sampling.orbits(), 3);
  for (int orbit = 0; orbit < sampling.orbits(); ++orbit) {
    fingerprint.seeds.row(orbit) =
        moved.segment<3>(3 * sampling.first_sample[static_cast<std::size_t>(orbit)]).transpose();
  }
  fingerprint.carriers = basis.carried * q;
  return fingerprint;
}

// The atoms known so far, each with its place and its displacement under the fingerprint; alike ones are one.
class AtomTable {
 public:
  AtomTable(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words,
            const SymmetricBasis& basis)
      : sampling_(sampling), regions_(regions), words_(words), fingerprint_(random_displacement(sampling, basis)) {
    transports_.words = words.transports({});
    transports_.samples = sample_transports(sampling, regions, transports_.words, words.floating());
    for (int k = 0; k < static_cast<int>(sampling.words.size()); ++k) add({k, 0, LiftAtom::Kind::full, -1});
  }

  int number(const LiftTerm& term, int word) {
    if (term.kind == LiftTerm::Kind::full && word == 0) return term.sample;
    const LiftAtom atom{term.sample, word, static_cast<LiftAtom::Kind>(term.kind), term.place};
    int& number = place_for(atom);
    if (number < 0) number = find_or_add(atom);
    return number;
  }

  /// Under the displacement by which atoms are told apart.
  const Eigen::VectorXd& carriers() const { return fingerprint_.carriers; }

  const std::vector<LiftAtom>& atoms() const { return atoms_; }
  std::vector<LiftAtom> take() { return std::move(atoms_); }

 private:
  struct Look {
    Vector3d position, displacement;
    int orbit;
  };

  Look look(const LiftAtom& atom) const {
    const AtomMap map = atom_map(atom, sampling_, regions_, transports_, words_.floating(), {});
    Look result{map.position, Vector3d::Zero(), map.orbit};
    if (map.orbit >= 0) result.displacement = map.frame * fingerprint_.seeds.row(map.orbit).transpose();
    if (fingerprint_.carriers.size() == 0) return result;
    for (const auto& [carrier, matrix] : map.carried) {
      result.displacement += matrix * fingerprint_.carriers.segment<3>(3 * carrier);
    }
    return result;
  }

  // Where the number of an atom is kept: by word and sample for the many, by all of it for the few.
  int& place_for(const LiftAtom& atom) {
    if (atom.kind != LiftAtom::Kind::full) {
      return pulled_parts_.try_emplace({atom.word, atom.sample, static_cast<int>(atom.kind), atom.place}, -1)
          .first->second;
    }
    const auto word = static_cast<std::size_t>(atom.word);
    if (pulled_.size() <= word) pulled_.resize(word + 1);
    if (pulled_[word].empty()) pulled_[word].assign(sampling_.words.size(), -1);
    return pulled_[word][static_cast<std::size_t>(atom.sample)];
  }

  int find_or_add(const LiftAtom& atom) {
    const Look seen = look(atom);
    const double same = kSamePosition * sampling_.radius;
    int found = -1;
    const auto consider = [&](int number) {
      const auto other = static_cast<std::size_t>(number);
      if (found >= 0 && number > found) return;
      if (is_position(atoms_[other].kind) != is_position(atom.kind)) return;
      if ((positions_[other] - seen.position).norm() >= same) return;
      if ((displacements_[other] - seen.displacement).norm() < kSameAtom) found = number;
    };
    const Cell low = cell_of(seen.position.array() - same);
    const Cell high = cell_of(seen.position.array() + same);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto [begin, end] = by_cell_.equal_range(key_of(seen.orbit, {x, y, z}));
          for (auto entry = begin; entry != end; ++entry) consider(entry->second);
        }
      }
    }
    return found >= 0 ? found : add(atom);
  }

  using Cell = std::array<std::int64_t, 3>;

  Cell cell_of(const Vector3d& position) const {
    constexpr double kWidth = 0.1;  // of the radius: many times what makes atoms one, so that mostly one cell is asked
    return grid_cell(position, kWidth * sampling_.radius);
  }

  static std::uint64_t key_of(int orbit, const Cell& cell) {
    auto key = static_cast<std::uint64_t>(orbit);
    for (const std::int64_t coordinate : cell) {
      key = (key ^ static_cast<std::uint64_t>(coordinate)) * 0x9e3779b97f4a7c15ULL;
      key ^= key >> 31U;
    }
    return key;
  }

  int add(const LiftAtom& atom) {
    const Look seen = look(atom);
    const int number = static_cast<int>(atoms_.size());
    atoms_.push_back(atom);
    positions_.push_back(seen.position);
    displacements_.push_back(seen.displacement);
    by_cell_.emplace(key_of(seen.orbit, cell_of(seen.position)), number);
    return number;
  }

  const SymmetricSampling& sampling_;
  const RegionMap& regions_;
  const GroupWords& words_;
  Fingerprint fingerprint_;
  CarriedTransports transports_;
  std::vector<LiftAtom> atoms_;
  std::vector<Vector3d> positions_, displacements_;
  std::unordered_multimap<std::uint64_t, int> by_cell_;
  std::vector<std::vector<int>> pulled_;
  std::map<std::array<int, 4>, int> pulled_parts_;
};

// Rounds weights so that floats hold them exactly and those that must sum to 1 do.
void quantise(Row& row, const std::vector<LiftAtom>& kinds_of) {
  double sum = 0;
  std::size_t largest = row.size();
  for (std::size_t i = 0; i < row.size(); ++i) {
    row[i].second = std::round(row[i].second / kQuantum) * kQuantum;
    const LiftAtom::Kind kind = kinds_of[static_cast<std::size_t>(row[i].first)].kind;
    if (kind != LiftAtom::Kind::full && kind != LiftAtom::Kind::centre) continue;
    sum += row[i].second;
    if (largest == row.size() || row[i].second > row[largest].second) largest = i;
  }
  if (largest < row.size()) row[largest].second += 1 - sum;
  std::erase_if(row, [](const auto& entry) { return entry.second == 0; });
}

using Block = std::array<Row, OrbitLift::kLanes>;

// Appends the rows with the union of their atoms, and clears them.
void append_block(Block& block, OrbitLift& lift) {
  std::vector<int> atoms;
  for (const Row& row : block) {
    for (const auto& entry : row) atoms.push_back(entry.first);
  }
  std::ranges::sort(atoms);
  atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
  const std::size_t start = lift.atom.size();
  lift.atom.insert(lift.atom.end(), atoms.begin(), atoms.end());
  lift.weight.resize(OrbitLift::kLanes * lift.atom.size(), 0.0F);
  for (std::size_t lane = 0; lane < block.size(); ++lane) {
    std::size_t at = 0;
    for (const auto& [atom, weight] : block[lane]) {
      while (atoms[at] != atom) ++at;
      lift.weight[OrbitLift::kLanes * (start + at) + lane] = static_cast<float>(weight);
    }
    lift.used += static_cast<std::int64_t>(block[lane].size());
    block[lane].clear();
  }
  lift.first.push_back(static_cast<std::int64_t>(lift.atom.size()));
}

// Where words take places: for each word and place the one of which that is the image, -1 where none is known.
class PlacesBefore {
 public:
  PlacesBefore(const RegionMap& regions, const GroupWords& words)
      : places_(static_cast<std::size_t>(regions.places())) {
    std::vector<int> image(places_);
    std::iota(image.begin(), image.end(), 0);
    before_ = image;
    std::vector<int> images = image;  // by word and place
    std::map<std::pair<int, int>, std::vector<int>> by_step;
    for (int word = 1; word < words.count(); ++word) {
      const GroupWords::Step& step = words.step(word);
      const auto [entry, added] = by_step.try_emplace({step.place, step.element});
      if (added) entry->second = regions.exact_images(step.place, step.element);
      std::vector<int> before(places_, -1);
      for (std::size_t place = 0; place < places_; ++place) {
        const int parent = images[static_cast<std::size_t>(step.parent) * places_ + place];
        image[place] = parent >= 0 ? entry->second[static_cast<std::size_t>(parent)] : -1;
        if (image[place] >= 0) before[static_cast<std::size_t>(image[place])] = static_cast<int>(place);
      }
      images.insert(images.end(), image.begin(), image.end());
      before_.insert(before_.end(), before.begin(), before.end());
    }
  }

  const int* of(int word) const { return before_.data() + static_cast<std::size_t>(word) * places_; }

 private:
  std::size_t places_;
  std::vector<int> before_;  // by word and place
};

struct RawTerm {
  LiftTerm term;
  int word;
};

// The terms of representatives' lifts, each the mean over the points of its orbit, taken back.
class OrbitTerms {
 public:
  OrbitTerms(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words,
             const std::vector<int>& stood_for, const VertexOrbits& vertices, bool averaged)
      : words_(words),
        stood_for_(stood_for),
        vertices_(vertices),
        plain_(sampling, regions, averaged),
        places_(regions, words) {}

  // \param terms  those of representative r
  void of(std::size_t r, PlainLift::Scratch& scratch, std::vector<RawTerm>& terms) const {
    terms.clear();
    const Vector3d position = vertices_.positions.row(static_cast<Eigen::Index>(r)).transpose();
    const std::int64_t points = vertices_.first_point[r + 1] - vertices_.first_point[r];
    PlainLift::begin_orbit(scratch);
    for (std::int64_t k = 0; k < points; ++k) {
      const auto at = static_cast<std::size_t>(vertices_.first_point[r] + k);
      if (stood_for_[at] == 0) continue;
      const int word = vertices_.point_words[at];
      const PlainLift::Origin origin{position, places_.of(word)};
      plain_.terms(words_.motion(word)(position), vertices_.point_sets[at], scratch, static_cast<std::size_t>(k),
                   &origin);
      for (LiftTerm term : scratch.terms) {
        term.weight *= static_cast<double>(stood_for_[at]) / static_cast<double>(points);
        terms.push_back({term, word});
      }
    }
  }

 private:
  const GroupWords& words_;
  const std::vector<int>& stood_for_;
  const VertexOrbits& vertices_;
  PlainLift plain_;
  PlacesBefore places_;
};

// Rows of terms that are summed by atom.
class RowSums {
 public:
  void sum(const std::vector<RawTerm>& terms, AtomTable& table, Row& row) {
    row.clear();
    for (const RawTerm& raw : terms) {
      const auto atom = static_cast<std::size_t>(table.number(raw.term, raw.word));
      if (sums_.size() <= atom) sums_.resize(atom + 256, 0);
      if (sums_[atom] == 0) row.emplace_back(static_cast<int>(atom), 0);
      sums_[atom] += raw.term.weight;
    }
    for (auto& [atom, weight] : row) weight = std::exchange(sums_[static_cast<std::size_t>(atom)], 0);
    std::ranges::sort(row);
  }

 private:
  std::vector<double> sums_;  // by atom, 0 between rows
};

}  // namespace

OrbitLift orbit_lift(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words,
                     const SymmetricBasis& basis, const VertexOrbits& vertices, bool averaged,
                     const RunContext& context) {
  if (averaged) regions.prepare(context);
  AtomTable table(sampling, regions, words, basis);
  std::vector<int> stood_for(vertices.point_words.size(), 1);
  if (averaged) stood_for = points_stood_for(sampling, regions, words, table.carriers(), vertices);
  const OrbitTerms orbits(sampling, regions, words, stood_for, vertices, averaged);
  OrbitLift lift;
  const auto count = static_cast<std::size_t>(vertices.representatives());
  lift.first.reserve(count / OrbitLift::kLanes + 2);
  lift.first.push_back(0);

  // In blocks: terms on all threads, atoms numbered in order on one, so that the numbers never depend on the threads.
  constexpr std::size_t kBlock = 16384;
  constexpr std::size_t kRowsBetweenChecks = 256;  // a few milliseconds
  std::vector<std::vector<RawTerm>> terms;
  RowSums sums;
  Row row;
  Block block;
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    context.progress("lift", static_cast<double>(begin) / static_cast<double>(count));
    const std::size_t size = std::min(kBlock, count - begin);
    terms.resize(size);
    parallel_for(context, size, [&](std::size_t from, std::size_t to) {
      PlainLift::Scratch scratch;
      for (std::size_t i = from; i < to; ++i) {
        if (i % kRowsBetweenChecks == 0) context.check();
        orbits.of(begin + i, scratch, terms[i]);
      }
    });
    for (std::size_t i = 0; i < size; ++i) {
      if (i % kRowsBetweenChecks == 0) context.check();
      sums.sum(terms[i], table, row);
      quantise(row, table.atoms());
      block[(begin + i) % OrbitLift::kLanes] = row;
      if ((begin + i + 1) % OrbitLift::kLanes == 0 || begin + i + 1 == count) append_block(block, lift);
    }
  }
  lift.atoms = table.take();
  return lift;
}

}  // namespace orbifit
