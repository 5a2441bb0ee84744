#pragma once

// What emscripten 3.1.6's standard library (libc++ 13) does not have yet, as far as the core calls it: the algorithms
// of std::ranges, each of which hands a range, its order and its projection to the algorithm on iterators;
// std::bit_cast; and numbers from and to text. Included before every file of the WebAssembly build (portable.cmake);
// other builds have the standard's.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

_LIBCPP_BEGIN_NAMESPACE_STD

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  return __builtin_bit_cast(To, from);
}

// Decimal numbers, "inf" and "nan", without white space or plus sign before them: by strtod, which rounds correctly
// here.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const bool negative = first != last && *first == '-';
  const char* start = negative ? first + 1 : first;
  const char begin = start != last ? *start : ' ';
  const bool starts =
      (begin >= '0' && begin <= '9') || begin == '.' || begin == 'i' || begin == 'I' || begin == 'n' || begin == 'N';
  const bool hexadecimal = begin == '0' && last - start > 1 && (start[1] == 'x' || start[1] == 'X');
  if (!starts) return {first, errc::invalid_argument};
  const std::string text(first, hexadecimal ? start + 1 : last);
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  const char* stop = first + (end - text.c_str());
  const bool digits = begin >= '0' && begin <= '9';
  const bool nonzero = text.substr(0, text.find_first_of("eE")).find_first_of("123456789") != std::string::npos;
  if ((digits || begin == '.') && (std::isinf(number) || (number == 0 && nonzero))) {
    return {stop, errc::result_out_of_range};
  }
  value = number;
  return {stop, errc{}};
}

// The fewest digits that give the number back.
inline to_chars_result to_chars(char* first, char* last, double value) {
  char text[40];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  const auto length = static_cast<ptrdiff_t>(std::strlen(text));
  if (length > last - first) return {last, errc::value_too_large};
  std::memcpy(first, text, static_cast<size_t>(length));
  return {first + length, errc{}};
}

// Its power series (Abramowitz and Stegun 9.6.10), whose terms are all positive. \pre 0 <= x < 700
inline double cyl_bessel_i(double order, double x) {
  double term = std::pow(x / 2, order) / std::tgamma(order + 1);
  double sum = term;
  for (int k = 1; term > 1e-17 * sum; ++k) {
    term *= x * x / (4 * k * (k + order));
    sum += term;
  }
  return sum;
}

namespace ranges {

namespace orbifit_detail {

template <class Order, class Projection>
auto projected(Order& order, Projection& projection) {
  return [&](const auto& left, const auto& right) {
    return std::invoke(order, std::invoke(projection, left), std::invoke(projection, right));
  };
}

template <class Predicate, class Projection>
auto applied(Predicate& predicate, Projection& projection) {
  return [&](auto&& value) -> bool { return std::invoke(predicate, std::invoke(projection, value)); };
}

}  // namespace orbifit_detail

#define ORBIFIT_ORDERED_ALGORITHM(name)                                                                 \
  template <class Range, class Order = ranges::less, class Projection = identity>                       \
  auto name(Range&& range, Order order = {}, Projection projection = {}) {                              \
    return std::name(std::begin(range), std::end(range), orbifit_detail::projected(order, projection)); \
  }
ORBIFIT_ORDERED_ALGORITHM(sort)
ORBIFIT_ORDERED_ALGORITHM(stable_sort)
ORBIFIT_ORDERED_ALGORITHM(min_element)
ORBIFIT_ORDERED_ALGORITHM(max_element)
ORBIFIT_ORDERED_ALGORITHM(is_sorted)
#undef ORBIFIT_ORDERED_ALGORITHM

#define ORBIFIT_PREDICATE_ALGORITHM(name)                                                                 \
  template <class Range, class Predicate, class Projection = identity>                                    \
  auto name(Range&& range, Predicate predicate, Projection projection = {}) {                             \
    return std::name(std::begin(range), std::end(range), orbifit_detail::applied(predicate, projection)); \
  }
ORBIFIT_PREDICATE_ALGORITHM(all_of)
ORBIFIT_PREDICATE_ALGORITHM(any_of)
ORBIFIT_PREDICATE_ALGORITHM(none_of)
ORBIFIT_PREDICATE_ALGORITHM(find_if)
ORBIFIT_PREDICATE_ALGORITHM(count_if)
#undef ORBIFIT_PREDICATE_ALGORITHM

template <class Range, class Value, class Projection = identity>
auto find(Range&& range, const Value& value, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](auto&& entry) -> bool { return std::invoke(projection, entry) == value; });
}

template <class Range, class Value, class Projection = identity>
auto count(Range&& range, const Value& value, Projection projection = {}) {
  return std::count_if(std::begin(range), std::end(range),
                       [&](auto&& entry) -> bool { return std::invoke(projection, entry) == value; });
}

template <class Range, class Value, class Order = ranges::less, class Projection = identity>
auto lower_bound(Range&& range, const Value& value, Order order = {}, Projection projection = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value, [&](const auto& entry, const Value& bound) {
    return std::invoke(order, std::invoke(projection, entry), bound);
  });
}

template <class Range, class Value, class Order = ranges::less, class Projection = identity>
auto upper_bound(Range&& range, const Value& value, Order order = {}, Projection projection = {}) {
  return std::upper_bound(std::begin(range), std::end(range), value, [&](const Value& bound, const auto& entry) {
    return std::invoke(order, bound, std::invoke(projection, entry));
  });
}

template <class Range, class Value>
bool binary_search(Range&& range, const Value& value) {
  return std::binary_search(std::begin(range), std::end(range), value);
}

template <class Range, class Call>
void for_each(Range&& range, Call call) {
  std::for_each(std::begin(range), std::end(range), [&](auto&& entry) { std::invoke(call, entry); });
}

template <class Range, class Output, class Call>
void transform(Range&& range, Output output, Call call) {
  std::transform(std::begin(range), std::end(range), output, [&](auto&& entry) { return std::invoke(call, entry); });
}

template <class Range, class Output, class Predicate>
void copy_if(Range&& range, Output output, Predicate predicate) {
  std::copy_if(std::begin(range), std::end(range), output,
               [&](auto&& entry) -> bool { return std::invoke(predicate, entry); });
}

template <class Range, class Output>
void copy(Range&& range, Output output) {
  std::copy(std::begin(range), std::end(range), output);
}

template <class Range, class Predicate, class Value>
void replace_if(Range&& range, Predicate predicate, const Value& value) {
  std::replace_if(std::begin(range), std::end(range), predicate, value);
}

template <class Range>
auto adjacent_find(Range&& range) {
  return std::adjacent_find(std::begin(range), std::end(range));
}

template <class Range, class Predicate>
auto adjacent_find(Range&& range, Predicate predicate) {
  return std::adjacent_find(std::begin(range), std::end(range), predicate);
}

template <class Range, class Iterator>
void nth_element(Range&& range, Iterator nth) {
  std::nth_element(std::begin(range), nth, std::end(range));
}

template <class Range>
void reverse(Range&& range) {
  std::reverse(std::begin(range), std::end(range));
}

template <class Range, class Value>
void fill(Range&& range, const Value& value) {
  std::fill(std::begin(range), std::end(range), value);
}

template <class Left, class Right>
bool includes(Left&& left, Right&& right) {
  return std::includes(std::begin(left), std::end(left), std::begin(right), std::end(right));
}

#define ORBIFIT_SET_ALGORITHM(name)                                                          \
  template <class Left, class Right, class Output>                                           \
  void name(Left&& left, Right&& right, Output output) {                                     \
    std::name(std::begin(left), std::end(left), std::begin(right), std::end(right), output); \
  }
ORBIFIT_SET_ALGORITHM(set_difference)
ORBIFIT_SET_ALGORITHM(set_intersection)
ORBIFIT_SET_ALGORITHM(set_union)
#undef ORBIFIT_SET_ALGORITHM

}  // namespace ranges

_LIBCPP_END_NAMESPACE_STD
