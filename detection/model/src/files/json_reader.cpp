#include "files/json_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "orbifit/model/errors.h"

#include "files/mesh_builder.h"
#include "files/text.h"

namespace orbifit {

namespace {

using Json = nlohmann::json;

constexpr double kOrthogonal = 1e-6;

}  // namespace

std::string number_text(double number) {
  std::string text;
  append_number(text, number);
  return text;
}

std::string item_path(const std::string& list, std::size_t index) {
  return list + "[" + std::to_string(index) + "]";
}

std::string key_path(const std::string& where, const char* key) {
  return where.empty() ? key : where + "." + key;
}

JsonReader::JsonReader(std::string file) : file_(std::move(file)) {}

void JsonReader::refuse(const std::string& where, const std::string& reason) const {
  throw InputError(file_, where, reason);
}

const nlohmann::json& JsonReader::member(const Json& object, const char* key, const std::string& where) const {
  if (!object.is_object()) refuse(where, "must be an object");
  const auto found = object.find(key);
  if (found == object.end()) refuse(key_path(where, key), "is missing");
  return *found;
}

std::string JsonReader::string(const Json& object, const char* key, const std::string& where) const {
  const Json& value = member(object, key, where);
  if (!value.is_string()) refuse(key_path(where, key), "must be a string");
  return value.get<std::string>();
}

double JsonReader::number(const Json& object, const char* key, const std::string& where) const {
  return finite(member(object, key, where), key_path(where, key));
}

double JsonReader::finite(const Json& value, const std::string& where) const {
  if (!value.is_number()) refuse(where, "must be a number");
  const auto result = value.get<double>();
  if (!(std::abs(result) <= kLargestCoordinate)) refuse(where, "must be a number of at most 1e50 in size");
  return result;
}

std::int64_t JsonReader::whole(const Json& value, const std::string& where) const {
  if (!value.is_number_integer() || (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX)) {
    refuse(where, "must be an integer");
  }
  return value.get<std::int64_t>();
}

std::int64_t JsonReader::integer(const Json& object, const char* key, const std::string& where) const {
  return whole(member(object, key, where), key_path(where, key));
}

int JsonReader::identifier(const Json& object, const char* key, const std::string& where) const {
  const std::int64_t value = integer(object, key, where);
  if (value < 0 || value > std::numeric_limits<int>::max())
    refuse(key_path(where, key), "must be an integer, at least 0");
  return static_cast<int>(value);
}

const nlohmann::json& JsonReader::list(const Json& object, const char* key, const std::string& where) const {
  const Json& value = member(object, key, where);
  if (!value.is_array()) refuse(key_path(where, key), "must be a list");
  return value;
}

Eigen::Vector3d JsonReader::vector(const Json& value, const std::string& where) const {
  if (!value.is_array() || value.size() != 3) refuse(where, "must be a list of three numbers");
  Eigen::Vector3d result;
  for (std::size_t k = 0; k < 3; ++k) result[static_cast<Eigen::Index>(k)] = finite(value[k], item_path(where, k));
  return result;
}

Eigen::Vector3d JsonReader::direction(const Json& value, const std::string& where) const {
  const Eigen::Vector3d result = vector(value, where);
  const double length = result.stableNorm();
  if (!(length > 0)) refuse(where, "must not be all 0");
  return result / length;
}

Motion JsonReader::motion(const Json& value, const std::string& where) const {
  const bool rows = value.is_array() && value.size() == 3 &&
                    std::ranges::all_of(value, [](const Json& row) { return row.is_array() && row.size() == 4; });
  if (!rows) refuse(where, "must be a 3x4 matrix: three rows of four numbers");
  Motion result;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double entry = finite(value[i][j], item_path(item_path(where, i), j));
      const auto row = static_cast<Eigen::Index>(i);
      (j < 3 ? result.linear(row, static_cast<Eigen::Index>(j)) : result.translation[row]) = entry;
    }
  }
  const double error = orthogonality_error(result.linear);
  if (!(error <= kOrthogonal)) {
    refuse(where, "is not orthogonal: |R R^T - 1| is " + number_text(error) + ", at most 1e-6 is allowed");
  }
  return result;
}

std::vector<Motion> JsonReader::motions(const Json& object, const char* key, const std::string& where) const {
  const Json& values = list(object, key, where);
  std::vector<Motion> result;
  for (std::size_t i = 0; i < values.size(); ++i)
    result.push_back(motion(values[i], item_path(key_path(where, key), i)));
  return result;
}

}  // namespace orbifit
