#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"
#include "orbifit/subspace/radius_field.h"

#include "files/file.h"
#include "files/json_text.h"

namespace orbifit {

namespace {

using Json = nlohmann::json;

class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const {
    throw InputError(file_.string(), key, reason);
  }

  double positive(const Json& object, const std::string& name, const std::string& inside) const {
    const Json& value = object.at(name);
    if (!value.is_number() || !std::isfinite(value.get<double>()) || !(value.get<double>() > 0)) {
      fail(inside + name, "is " + value.dump() + ": must be a positive number");
    }
    return value.get<double>();
  }

  PaintedArea area(const Json& object, const std::string& key) const {
    if (!object.is_object()) fail(key, "must be an object with centre, radius and factor");
    for (const char* name : {"centre", "radius", "factor"}) {
      if (!object.contains(name)) fail(key, std::string("needs ") + name);
    }
    const Json& centre = object.at("centre");
    const bool three = centre.is_array() && centre.size() == 3 && std::ranges::all_of(centre, [](const Json& value) {
                         return value.is_number() && std::isfinite(value.get<double>());
                       });
    if (!three) fail(key + ".centre", "is " + centre.dump() + ": must be three numbers");
    return {{centre[0].get<double>(), centre[1].get<double>(), centre[2].get<double>()},
            positive(object, "radius", key + "."),
            positive(object, "factor", key + ".")};
  }

 private:
  std::filesystem::path file_;
};

}  // namespace

RadiusFieldOptions read_radius_field(const std::filesystem::path& file, double base) {
  const Reader reader(file);
  const Json document = parse_json(file.string(), read_file(file));
  if (!document.is_object()) reader.fail("", "must be an object with areas, feature_size or both");
  RadiusFieldOptions options;
  options.base = base;
  if (document.contains("areas")) {
    const Json& areas = document.at("areas");
    if (!areas.is_array()) reader.fail("areas", "must be a list");
    for (std::size_t a = 0; a < areas.size(); ++a) {
      options.areas.push_back(reader.area(areas[a], "areas[" + std::to_string(a) + "]"));
    }
  }
  if (document.contains("feature_size")) {
    if (!document.at("feature_size").is_boolean()) {
      reader.fail("feature_size", "is " + document.at("feature_size").dump() + ": must be true or false");
    }
    options.feature_size = document.at("feature_size").get<bool>();
  }
  for (const auto& [name, value] : {std::pair{"smallest", &options.smallest}, std::pair{"largest", &options.largest},
                                    std::pair{"gradation", &options.gradation}}) {
    if (document.contains(name)) *value = reader.positive(document, name, "");
  }
  if (options.largest < options.smallest) {
    reader.fail("largest", "is " + std::to_string(options.largest) + ": must be at least smallest, " +
                               std::to_string(options.smallest));
  }
  return options;
}

}  // namespace orbifit
