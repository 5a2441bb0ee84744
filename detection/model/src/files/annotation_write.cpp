#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "orbifit/model/annotation_io.h"
#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/text.h"

namespace orbifit {

namespace {

class AnnotationWriter {
 public:
  std::string write(const SymmetryAnnotation& annotation) {
    text_ = "{\n  \"format\": \"symmetry-annotation\",\n  \"version\": 1,\n  \"mesh\": { \"vertices\": ";
    text_ += std::to_string(annotation.mesh_vertices) + ", \"faces\": " + std::to_string(annotation.mesh_faces);
    text_ +=
        ", \"diagonal\": " + number(annotation.mesh_diagonal) + " },\n  \"tolerance\": " + number(annotation.tolerance);
    if (annotation.up) text_ += ",\n  \"up\": " + vector(*annotation.up);
    text_ += ",\n  \"regions\": [";
    for (std::size_t r = 0; r < annotation.regions.size(); ++r) {
      text_ += r == 0 ? "\n" : ",\n";
      region(annotation.regions[r]);
    }
    text_ += annotation.regions.empty() ? "],\n  \"patterns\": [" : "\n  ],\n  \"patterns\": [";
    for (std::size_t p = 0; p < annotation.patterns.size(); ++p) {
      text_ += p == 0 ? "\n" : ",\n";
      pattern(annotation.patterns[p]);
    }
    text_ += annotation.patterns.empty() ? "]\n}\n" : "\n  ]\n}\n";
    return std::move(text_);
  }

 private:
  static std::string number(double value) {
    if (!std::isfinite(value)) throw InputError("", "annotation", "holds a number that is not finite");
    std::string text;
    append_number(text, value == 0 ? 0.0 : value);  // no -0, which only puzzles
    return text;
  }
  // In a string, characters outside of UTF-8 are replaced.
  static std::string string(const std::string& value) {
    return nlohmann::json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  static std::string vector(const Eigen::Vector3d& value) {
    return "[" + number(value.x()) + ", " + number(value.y()) + ", " + number(value.z()) + "]";
  }
  static std::string motion(const Motion& value) {
    std::string text = "[";
    for (int i = 0; i < 3; ++i) {
      text += i == 0 ? "[" : ", [";
      for (int j = 0; j < 3; ++j) text += number(value.linear(i, j)) + ", ";
      text += number(value.translation[i]) + "]";
    }
    return text + "]";
  }
  static std::string runs(std::vector<int> faces) {
    std::ranges::sort(faces);
    std::string text = "[";
    for (std::size_t i = 0; i < faces.size();) {
      std::size_t end = i + 1;
      while (end < faces.size() && faces[end] <= faces[end - 1] + 1) ++end;
      text += (i == 0 ? "[" : ", [") + std::to_string(faces[i]) + ", " + std::to_string(faces[end - 1] - faces[i] + 1) +
              "]";
      i = end;
    }
    return text + "]";
  }
  static std::string residual(const Residual& value) {
    return "\"residual\": { \"rms\": " + number(value.rms) + ", \"max\": " + number(value.max) + " }";
  }

  void motions(const char* key, const std::vector<Motion>& values) {
    text_ += std::string("      \"") + key + "\": [";
    for (std::size_t i = 0; i < values.size(); ++i)
      text_ += (i == 0 ? "\n        " : ",\n        ") + motion(values[i]);
    text_ += values.empty() ? "],\n" : "\n      ],\n";
  }

  void importance(const std::optional<double>& value) {
    if (value) text_ += ",\n      \"importance\": " + number(*value);
  }

  void region(const Region& value) {
    text_ += "    {\n      \"id\": " + std::to_string(value.id) + ",\n      \"name\": " + string(value.name) + ",\n";
    text_ += "      \"group\": \"" + value.group.symbol() + "\",\n      \"centre\": " + vector(value.centre) + ",\n";
    if (value.group.has_axis()) text_ += "      \"axis\": " + vector(value.axis) + ",\n";
    motions("generators", value.generators);
    motions("elements", value.elements);
    text_ += "      \"faces\": " + runs(value.faces) + ",\n      \"parent\": ";
    text_ += (value.parent ? std::to_string(*value.parent) : "null") + ",\n      " + residual(value.residual);
    importance(value.importance);
    text_ += "\n    }";
  }

  void pattern(const Pattern& value) {
    text_ += "    {\n      \"id\": " + std::to_string(value.id) + ",\n      \"name\": " + string(value.name) + ",\n";
    text_ += "      \"kind\": \"" + to_string(value.kind) + "\",\n";
    motions("generators", value.generators);
    text_ += "      \"instances\": [";
    for (std::size_t i = 0; i < value.instances.size(); ++i) {
      text_ += (i == 0 ? "\n" : ",\n") + ("        { \"motion\": " + motion(value.instances[i].motion)) +
               ",\n          \"faces\": " + runs(value.instances[i].faces) + " }";
    }
    text_ += std::string(value.instances.empty() ? "" : "\n      ") + "],\n      " + residual(value.residual);
    importance(value.importance);
    text_ += "\n    }";
  }

  std::string text_;
};

}  // namespace

std::string to_json(const SymmetryAnnotation& annotation) {
  return AnnotationWriter().write(annotation);
}

void write_annotation(const std::filesystem::path& file, const SymmetryAnnotation& annotation) {
  write_file(file, to_json(annotation));
}

}  // namespace orbifit
