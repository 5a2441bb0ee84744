#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "orbifit/model/motion.h"

namespace orbifit {

/// A place in a JSON file, as messages name it: "regions[2].group".
std::string item_path(const std::string& list, std::size_t index);
std::string key_path(const std::string& where, const char* key);  ///< the key alone where `where` is empty

/// The shortest text that reads as the number.
std::string number_text(double number);

/// Reads values of a JSON file as what they must be. The object at `where` holds the key; a value is at `where` itself.
/// \throw InputError naming file, place and what is asked there
class JsonReader {
 public:
  explicit JsonReader(std::string file);

  [[noreturn]] void refuse(const std::string& where, const std::string& reason) const;

  const nlohmann::json& member(const nlohmann::json& object, const char* key, const std::string& where) const;
  const nlohmann::json& list(const nlohmann::json& object, const char* key, const std::string& where) const;
  std::string string(const nlohmann::json& object, const char* key, const std::string& where) const;
  double number(const nlohmann::json& object, const char* key, const std::string& where) const;
  std::int64_t integer(const nlohmann::json& object, const char* key, const std::string& where) const;
  /// At least 0.
  int identifier(const nlohmann::json& object, const char* key, const std::string& where) const;
  std::vector<Motion> motions(const nlohmann::json& object, const char* key, const std::string& where) const;

  /// At most 1e50 in size, as coordinates are.
  double finite(const nlohmann::json& value, const std::string& where) const;
  std::int64_t whole(const nlohmann::json& value, const std::string& where) const;
  Eigen::Vector3d vector(const nlohmann::json& value, const std::string& where) const;
  /// A unit vector of any vector that is not 0.
  Eigen::Vector3d direction(const nlohmann::json& value, const std::string& where) const;
  /// A 3x4 matrix whose linear part is orthogonal to 1e-6.
  Motion motion(const nlohmann::json& value, const std::string& where) const;

 private:
  std::string file_;
};

}  // namespace orbifit
