#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "files/binary.h"
#include "files/mesh_formats.h"
#include "files/ply.h"
#include "files/text.h"
#include "rewrite/replacements.h"
#include "rewrite/rewriters.h"
#include "rewrite/turned_normals.h"

namespace orbifit {

namespace {

using Three = std::array<int, 3>;

Three find_three(const PlyElement& element, std::array<std::string_view, 3> names) {
  Three found{};
  for (std::size_t k = 0; k < 3; ++k) found[k] = element.find(names[k]);
  const bool scalars = std::ranges::all_of(
      found, [&](int p) { return p >= 0 && !element.properties[static_cast<std::size_t>(p)].count_type; });
  return scalars ? found : Three{-1, -1, -1};
}

bool fits_float(const Points& points) {
  return std::ranges::all_of(points.reshaped(),
                             [](double value) { return static_cast<double>(static_cast<float>(value)) == value; });
}

// A number at the end of `bytes` in the file's type and order; integers are rounded.
void store_as(std::string& bytes, double value, PlyType type, std::endian order, const std::filesystem::path& file) {
  std::string number;
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      store(number, static_cast<std::uint8_t>(std::llround(value)));
      break;
    case PlyType::int16:
    case PlyType::uint16:
      store(number, static_cast<std::uint16_t>(std::llround(value)));
      break;
    case PlyType::int32:
    case PlyType::uint32:
      store(number, static_cast<std::uint32_t>(std::llround(value)));
      break;
    case PlyType::float32:
      store(number, to_float(file, value));
      break;
    case PlyType::float64:
      store(number, value);
      break;
  }
  if (order == std::endian::big) std::ranges::reverse(number);
  bytes += number;
}

// The vertices' rows are written anew; header and the other elements stay. Coordinates become doubles where single
// precision, or integers, cannot hold where vertices have gone.
class PlyRewriter {
 public:
  explicit PlyRewriter(const MeshEdit& edit)
      : edit_(edit), header_(read_ply_header(edit.source.string(), edit.content)) {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") vertex_ = &element;
    }
    position_ = find_three(*vertex_, {"x", "y", "z"});
    normal_ = find_three(*vertex_, {"nx", "ny", "nz"});
    for (const int p : position_) {
      const PlyType type = vertex_->properties[static_cast<std::size_t>(p)].type;
      if (type == PlyType::float64) continue;
      widened_ = widened_ || type != PlyType::float32 || !fits_float(edit.edited.vertices);
    }
    if (normal_[0] >= 0) turns_ = vertex_normal_turns(edit.rest, edit.edited);
  }

  std::string run() {
    if (edit_.edited.vertices == edit_.rest.vertices) return std::string(edit_.content);
    const std::string header = new_header();
    const std::string_view body = edit_.content.substr(header_.size);
    return header + (header_.encoding == PlyEncoding::ascii ? text_body(body) : binary_body(body));
  }

 private:
  bool is_position(int property) const { return std::ranges::find(position_, property) != position_.end(); }

  std::string new_header() const {
    const std::string_view text = edit_.content.substr(0, header_.size);
    Replacements result(text);
    if (!widened_) return result.finish();
    LineReader lines(text);
    std::string_view line;
    bool in_vertices = false;
    while (lines.next(line)) {
      WordReader words(line);
      const std::string_view keyword = words.word();
      if (keyword == "element") in_vertices = words.word() == "vertex";
      if (keyword != "property" || !in_vertices) continue;
      const std::string_view type = words.word();
      const std::string_view name = words.word();
      if ((name == "x" || name == "y" || name == "z") && type != "double" && type != "float64") {
        result.replace(type, "double");
      }
    }
    return result.finish();
  }

  std::string text_body(std::string_view body) const {
    Replacements result(body);
    LineReader lines(body);
    std::string_view line;
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      for (long long row = 0; row < element.count && lines.next_content(line); ++row) {
        if (&element == vertex_) replace_row(line, row, result);
      }
    }
    return result.finish();
  }

  void replace_row(std::string_view line, long long row, Replacements& result) const {
    WordReader words(line);
    std::vector<std::string_view> values(vertex_->properties.size());
    for (std::size_t p = 0; p < values.size(); ++p) {
      values[p] = words.word();
      if (!vertex_->properties[p].count_type) continue;
      const long long entries = parse_integer(values[p]).value_or(0);
      for (long long k = 0; k < entries; ++k) words.word();
    }
    std::vector<std::pair<std::string_view, double>> changed;
    const auto change = [&](const Three& properties, const Eigen::Vector3d& value) {
      for (std::size_t k = 0; k < 3; ++k) {
        changed.emplace_back(values[static_cast<std::size_t>(properties[k])], value[static_cast<Eigen::Index>(k)]);
      }
    };
    change(position_, edit_.edited.vertices.row(row));
    if (normal_[0] >= 0) {
      Eigen::Vector3d normal;
      for (std::size_t k = 0; k < 3; ++k) {
        normal[static_cast<Eigen::Index>(k)] = parse_number(values[static_cast<std::size_t>(normal_[k])]).value_or(0);
      }
      change(normal_, turns_[static_cast<std::size_t>(row)].apply(normal));
    }
    std::ranges::sort(changed, {}, [](const auto& each) { return each.first.data(); });
    for (const auto& [word, value] : changed) {
      if (parse_number(word) == value) continue;
      std::string text;
      append_number(text, value);
      result.replace(word, text);
    }
  }

  std::string binary_body(std::string_view body) const {
    const std::endian order = header_.encoding == PlyEncoding::big ? std::endian::big : std::endian::little;
    std::string result;
    result.reserve(body.size() + (widened_ ? 12 * static_cast<std::size_t>(vertex_->count) : 0));
    for (const PlyElement& element : header_.elements) {
      for (long long row = 0; row < element.count && !element.properties.empty(); ++row) {
        const std::size_t size = row_size(element, body, order);
        if (&element == vertex_) {
          store_row(body.substr(0, size), row, order, result);
        } else {
          result += body.substr(0, size);
        }
        body.remove_prefix(size);
      }
    }
    return result.append(body);
  }

  static std::size_t list_size(const PlyProperty& property, std::string_view at, std::endian order) {
    const double count = ply_number(at.data(), *property.count_type, order);
    return size_of(*property.count_type) + static_cast<std::size_t>(count) * size_of(property.type);
  }

  static std::size_t row_size(const PlyElement& element, std::string_view body, std::endian order) {
    std::size_t size = 0;
    for (const PlyProperty& property : element.properties) {
      size += property.count_type ? list_size(property, body.substr(size), order) : size_of(property.type);
    }
    return size;
  }

  void store_row(std::string_view bytes, long long row, std::endian order, std::string& result) const {
    const Eigen::Vector3d point = edit_.edited.vertices.row(row);
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    if (normal_[0] >= 0) normal = turns_[static_cast<std::size_t>(row)].apply(normal_of(bytes, order));
    for (std::size_t p = 0; p < vertex_->properties.size(); ++p) {
      const PlyProperty& property = vertex_->properties[p];
      const auto number = static_cast<int>(p);
      const std::size_t size = property.count_type ? list_size(property, bytes, order) : size_of(property.type);
      if (const auto at = std::ranges::find(position_, number); at != position_.end()) {
        store_as(result, point[at - position_.begin()], widened_ ? PlyType::float64 : property.type, order,
                 edit_.source);
      } else if (const auto turned = std::ranges::find(normal_, number); turned != normal_.end()) {
        store_as(result, normal[turned - normal_.begin()], property.type, order, edit_.source);
      } else {
        result += bytes.substr(0, size);
      }
      bytes.remove_prefix(size);
    }
  }

  Eigen::Vector3d normal_of(std::string_view bytes, std::endian order) const {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t p = 0; p < vertex_->properties.size(); ++p) {
      const PlyProperty& property = vertex_->properties[p];
      const auto at = std::ranges::find(normal_, static_cast<int>(p));
      if (at != normal_.end()) normal[at - normal_.begin()] = ply_number(bytes.data(), property.type, order);
      bytes.remove_prefix(property.count_type ? list_size(property, bytes, order) : size_of(property.type));
    }
    return normal;
  }

  const MeshEdit& edit_;
  const PlyHeader header_;
  const PlyElement* vertex_ = nullptr;
  Three position_{}, normal_{};  // which properties they are; -1: none
  bool widened_ = false;
  std::vector<NormalTurn> turns_;
};

}  // namespace

std::string rewritten_ply(const MeshEdit& edit) {
  return PlyRewriter(edit).run();
}

}  // namespace orbifit
