#include "domains/closed_sets.h"

#include <algorithm>
#include <map>
#include <set>

#include "domains/domain_map.h"

namespace orbifit {

namespace {

// Sets that the motions reach: where they are more, the groups do not close, which is found as soon as an orbit is
// made.
constexpr std::size_t kMaxSets = 20000;
// Elements that differ by less are one, in entries of their matrices: the next are farther apart by far.
constexpr double kSameElement = 1e-6;

int element_like(const std::vector<Motion>& elements, const Motion& motion) {
  const auto found = std::ranges::find_if(
      elements, [&](const Motion& m) { return (m.linear - motion.linear).cwiseAbs().maxCoeff() < kSameElement; });
  return found == elements.end() ? -1 : static_cast<int>(found - elements.begin());
}

enum class Question { images, groups };  // where motions take sets, or whether groups close there

class Check {
 public:
  Check(Question question, const DomainMap& domains, const SymmetryAnnotation& annotation, const RunContext& context)
      : question_(question), annotation_(annotation), context_(context), domains_(domains) {
    for (std::size_t r = 0; r < annotation.regions.size(); ++r) claims_.push_back({false, r});
    for (std::size_t p = 0; p < annotation.patterns.size(); ++p) {
      claims_.insert(claims_.end(), annotation.patterns[p].instances.size(), {true, p});
    }
    family_.resize(claims_.size());
    for (std::size_t place = 0; place < claims_.size(); ++place) {  // a pattern's instances are one claim
      family_[place] = static_cast<int>(place);
      if (domains_.first_of_same_pattern(static_cast<int>(place)) >= 0) {
        family_[place] = domains_.first_of_same_pattern(static_cast<int>(place));
      }
    }
    products_.resize(static_cast<std::size_t>(domains_.count()));
    for (const int set : by_vertex(domains_.points())) reach(set);
    for (const int set : domains_.sets_of_faces()) reach(set);
  }

  Disagreements run() {
    for (std::size_t head = 0; head < queue_.size() && queue_.size() < kMaxSets; ++head) {
      context_.check();
      const int set = queue_[head];
      const std::vector<int> places = domains_.set_places(set);
      if (question_ == Question::groups) {
        for (const auto& [a, b] : domains_.unclosed(set)) blame(Question::groups, a, b);
      }
      for (const int place : places) {
        for (int element = 0; element < static_cast<int>(domains_.elements(place).size()); ++element) {
          follow(set, places, place, element);
        }
      }
    }
    return std::move(result_);
  }

  std::vector<ClaimFamily> families() {
    std::map<int, std::set<Claim>> members;
    for (std::size_t place = 0; place < claims_.size(); ++place) {
      members[root(static_cast<int>(place))].insert(claims_[place]);
    }
    std::vector<ClaimFamily> result;
    result.reserve(members.size());
    for (const auto& [first, claims] : members) result.emplace_back(claims.begin(), claims.end());
    std::ranges::sort(result);
    return result;
  }

 private:
  struct Product {
    int first, second, both;  // elements: second after first
  };

  void reach(int set) {
    if (reached_.insert(set).second) queue_.push_back(set);
  }

  void follow(int set, const std::vector<int>& places, int place, int element) {
    const int there = domains_.carried_set(set, place, element);
    reach(there);
    for (const int other : places) {
      // What holds all of it need not come along: of finite groups all elements are tried from wherever they act.
      if (domains_.around(other, place) && domains_.continuum(other) == nullptr) continue;
      const std::vector<int> images = domains_.images_of(other, place, element);
      if (images.empty()) blame(Question::images, other, place);
      if (!domains_.around(place, other)) continue;
      for (const int image : images) family_[static_cast<std::size_t>(root(image))] = root(other);
    }
    const int arrival = domains_.arrival(place, element);
    expect(domains_.carried_set(there, arrival, domains_.inverse_element(place, element)), set, place);
    if (place < domains_.count()) {
      for (const Product& product : products(place)) {
        if (product.first != element) continue;
        expect(domains_.carried_set(there, place, product.second), domains_.carried_set(set, place, product.both),
               place);
      }
    } else {  // to any instance by the first
      const int first = domains_.first_of_same_pattern(place);
      expect(domains_.carried_set(domains_.carried_set(set, place, 0), first, element), there, place);
    }
  }

  // The elements of a finite group after which one of its generators goes, and what comes of it.
  const std::vector<Product>& products(int region) {
    const auto r = static_cast<std::size_t>(region);
    std::vector<Product>& known = products_[r];
    if (!known.empty() || domains_.continuum(region) != nullptr) return known;
    const std::vector<Motion>& elements = domains_.elements(region);
    for (const Motion& generator : annotation_.regions[r].generators) {
      const int second = element_like(elements, generator);
      if (second < 0) continue;
      for (int first = 0; first < static_cast<int>(elements.size()); ++first) {
        const int both = element_like(elements, generator * elements[static_cast<std::size_t>(first)]);
        if (both >= 0) known.push_back({first, second, both});
      }
    }
    return known;
  }

  int root(int place) {
    int& above = family_[static_cast<std::size_t>(place)];
    return above == place ? place : above = root(above);
  }

  void expect(int set, int due, int place) {
    if (set == due) return;
    for (const int other : domains_.set_places(set)) {
      if (!domains_.holds(due, other)) blame(Question::images, other, place);
    }
    for (const int other : domains_.set_places(due)) {
      if (!domains_.holds(set, other)) blame(Question::images, other, place);
    }
  }

  void blame(Question by, int a, int b) {
    if (by != question_) return;
    const auto pair = std::minmax(claims_[static_cast<std::size_t>(a)], claims_[static_cast<std::size_t>(b)]);
    ++result_[{pair.first, pair.second}];
  }

  Question question_;
  const SymmetryAnnotation& annotation_;
  const RunContext& context_;
  const DomainMap& domains_;
  std::vector<Claim> claims_;  // by place
  std::vector<int> family_;    // by place, another one of its family, nearer to the family's first
  std::vector<std::vector<Product>> products_;
  std::set<int> reached_;
  std::vector<int> queue_;
  Disagreements result_;
};

Disagreements answer(Question question, const DomainMap& domains, const SymmetryAnnotation& annotation,
                     const RunContext& context, std::vector<ClaimFamily>* families) {
  Check check(question, domains, annotation, context);
  Disagreements result = check.run();
  if (families != nullptr) *families = check.families();
  return result;
}

}  // namespace

std::vector<std::vector<Motion>> instance_motions(const SymmetryAnnotation& annotation) {
  std::vector<std::vector<Motion>> result;
  for (const Pattern& pattern : annotation.patterns) {
    result.emplace_back();
    for (const PatternInstance& instance : pattern.instances) result.back().push_back(instance.motion);
  }
  return result;
}

Disagreements disagreements(const DomainMap& domains, const SymmetryAnnotation& annotation, const RunContext& context,
                            std::vector<ClaimFamily>* families) {
  return answer(Question::images, domains, annotation, context, families);
}

Disagreements disagreements(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context,
                            std::vector<ClaimFamily>* families) {
  return disagreements(DomainMap(mesh, annotation, instance_motions(annotation)), annotation, context, families);
}

Disagreements unclosed_groups(const DomainMap& domains, const SymmetryAnnotation& annotation, const RunContext& context,
                              std::vector<ClaimFamily>* families) {
  return answer(Question::groups, domains, annotation, context, families);
}

}  // namespace orbifit
