#include "picture_options.h"

#include <array>
#include <utility>

#include <CLI/CLI.hpp>

#include "orbifit/apps/upright.h"

#include "command.h"

namespace orbifit {

void add_up_option(CLI::App& app, std::vector<double>& values, const std::string& meaning) {
  app.add_option("--up", values, meaning + ": an axis, or three numbers; without it as the shape would stand")
      ->type_size(3)
      ->expected(1)
      ->type_name("x|y|z|-x|-y|-z");
}

Eigen::Vector3d picture_up(const std::vector<double>& option, const Mesh& mesh, const std::string& file,
                           const SymmetryAnnotation* annotation) {
  return option.empty() ? up_of(mesh, file, annotation) : to_direction("--up", option);
}

std::vector<std::string> with_up_in_numbers(const std::vector<std::string>& words) {
  constexpr std::array letters{'x', 'y', 'z'};
  std::vector<std::string> result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool joined = words[i].starts_with("--up=");
    result.push_back(joined ? "--up" : words[i]);
    if (!joined && (words[i] != "--up" || i + 1 == words.size())) continue;
    const std::string value = joined ? words[i].substr(5) : words[++i];
    const bool sign = value.starts_with('-') || value.starts_with('+');
    const std::string axis = value.substr(sign ? 1 : 0);
    if (axis.size() != 1 || axis.find_first_of("xyzXYZ") != 0) {
      result.push_back(value);
      continue;
    }
    for (const char letter : letters) {
      const bool chosen = (axis[0] | 0x20) == letter;  // in lower case
      result.emplace_back(!chosen ? "0" : value[0] == '-' ? "-1" : "1");
    }
  }
  return result;
}

}  // namespace orbifit
