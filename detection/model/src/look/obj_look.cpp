#include <array>
#include <limits>
#include <map>
#include <set>

#include "orbifit/model/errors.h"

#include "files/file.h"
#include "files/mesh_builder.h"
#include "files/text.h"
#include "look/look_formats.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

std::string rest_of(std::string_view line, std::string_view keyword) {
  const std::size_t at = line.find(keyword) + keyword.size();
  const std::size_t first = line.find_first_not_of(" \t", at);
  if (first == std::string_view::npos) return "";
  return std::string(line.substr(first, line.find_last_not_of(" \t\r") - first + 1));
}

class ObjLookReader {
 public:
  ObjLookReader(const fs::path& file, const Mesh& mesh) : file_(file), mesh_(mesh) {}

  Appearance read(std::string_view content) {
    LineReader lines(content);
    std::string_view line;
    std::string joined;
    while (lines.next(line)) {
      joined.assign(line);
      number_ = lines.line();
      while (continued(joined) && lines.next(line)) {
        joined.erase(joined.find_last_of('\\'));
        joined += ' ';
        joined += line;
      }
      read_statement(std::string_view(joined).substr(0, joined.find('#')));
    }
    return finish();
  }

 private:
  static bool continued(std::string_view line) {
    const std::size_t last = line.find_last_not_of(" \t");
    return !line.starts_with('#') && last != std::string_view::npos && line[last] == '\\';
  }

  void read_statement(std::string_view line) {
    WordReader words(line);
    const std::string_view keyword = words.word();
    if (keyword == "v") read_vertex(words);
    if (keyword == "vt") uvs_.push_back({coordinate(words, "vt"), words.at_end() ? 0 : coordinate(words, "vt")});
    if (keyword == "vn")
      normals_.push_back({coordinate(words, "vn"), coordinate(words, "vn"), coordinate(words, "vn")});
    if (keyword == "f" || keyword == "fo") read_face(words);
    if (keyword == "usemtl") use_material(rest_of(line, keyword));
    if (keyword == "o") begin_part({rest_of(line, keyword), ""});
    if (keyword == "g") begin_part({part_.object, group_name(rest_of(line, keyword))});
    if (keyword == "mtllib") read_library(rest_of(line, keyword));
  }

  double coordinate(WordReader& words, const char* keyword) const {
    const std::string_view word = words.word();
    const auto value = parse_number(word);
    if (!value) {
      throw InputError(
          file_.string(), place(number_, "", 0),
          word.empty() ? std::string(keyword) + " needs more numbers" : in_quotes(word) + " is not a number");
    }
    return *value;
  }

  // x y z, and what many programs write behind it: red, green, blue.
  void read_vertex(WordReader& words) {
    for (int k = 0; k < 3; ++k) words.word();
    std::array<double, 3> colour{kNone, kNone, kNone};
    std::size_t count = 0;
    while (!words.at_end() && count < 3) {
      const auto value = parse_number(words.word());
      if (!value) break;
      colour[count++] = *value;
    }
    if (count == 3 && words.at_end()) coloured_ = true;
    if (count < 3 || !words.at_end()) colour.fill(kNone);
    colours_.push_back(colour);
  }

  // -1 where the corner has none.
  std::int64_t index(std::string_view word, std::size_t count, const char* what) const {
    if (word.empty()) return -1;
    const auto number = parse_integer(word);
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t from_zero = !number ? -1 : *number > 0 ? *number - 1 : size + *number;
    if (!number || *number == 0 || from_zero < 0) {
      throw InputError(file_.string(), place(number_, "", 0), in_quotes(word) + " is no " + what);
    }
    return from_zero;
  }

  struct Corner {
    std::int64_t uv, normal;
    long long line;
  };

  void read_face(WordReader& words) {
    std::vector<Corner> corners;
    while (!words.at_end()) {
      const std::string_view word = words.word();
      const std::size_t first = word.find('/');
      const std::size_t second = first == std::string_view::npos ? first : word.find('/', first + 1);
      const std::string_view uv = first == std::string_view::npos ? "" : word.substr(first + 1, second - first - 1);
      const std::string_view normal = second == std::string_view::npos ? "" : word.substr(second + 1);
      corners.push_back(
          {index(uv, uvs_.size(), "texture coordinate"), index(normal, normals_.size(), "normal"), number_});
    }
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      for (const std::size_t c : {std::size_t{0}, k, k + 1}) corners_.push_back(corners[c]);
      look_.material_of_face.push_back(material_);
      look_.part_of_face.push_back(part());
    }
  }

  static std::string group_name(const std::string& name) { return name == "default" ? "" : name; }

  void begin_part(Part part) {
    part_ = std::move(part);
    begun_ = true;
  }

  // The number of that which faces are in now; lines that no face follows begin none.
  int part() {
    if (begun_) look_.parts.push_back(part_);
    begun_ = false;
    return static_cast<int>(look_.parts.size()) - 1;
  }

  void use_material(const std::string& name) {
    const auto [entry, added] = materials_.try_emplace(name, static_cast<int>(look_.materials.size()));
    if (added) look_.materials.push_back({name, {1, 1, 1, 1}, "", ""});
    material_ = entry->second;
  }

  void read_library(const std::string& name) {
    std::error_code error;
    const fs::path path = file_.parent_path() / name;
    if (!within_folder(name)) {
      look_.warnings.push_back("material library " + in_quotes(name) + " is outside of the mesh's folder: not read");
    } else if (!fs::is_regular_file(path, error) || fs::file_size(path, error) == 0) {
      look_.warnings.push_back("material library " + in_quotes(name) + " is missing");
    } else {
      read_materials(read_file(path), fs::path(name).parent_path());
    }
  }

  void read_materials(const std::string& content, const fs::path& folder) {
    LineReader lines(content);
    std::string_view line;
    Material* material = nullptr;
    while (lines.next(line)) {
      WordReader words(line);
      const std::string keyword = lower_case(words.word());
      const std::string value = keyword.empty() ? "" : rest_of(lower_case(line), keyword);
      const std::string own =
          value.empty() ? ""
                        : std::string(line.substr(line.find_last_not_of(" \t\r") + 1 - value.size(), value.size()));
      if (keyword == "newmtl") material = &library_[own];
      if (material == nullptr) continue;
      if (keyword == "kd" || keyword == "d" || keyword == "tr") read_colour(keyword, words, *material);
      if (keyword == "map_kd") {
        const std::string texture = own.starts_with('-') ? own.substr(own.find_last_of(" \t") + 1) : own;
        material->texture = (folder / texture).generic_string();
      }
    }
  }

  static void read_colour(const std::string& keyword, WordReader& words, Material& material) {
    if (keyword == "kd") {
      const auto red = words.number();
      const auto green = words.number();
      const auto blue = words.number();
      if (!red) return;
      material.base_colour = {*red, green.value_or(*red), blue.value_or(*red), material.base_colour[3]};
    } else if (const auto value = words.number()) {
      material.base_colour[3] = keyword == "d" ? *value : 1 - *value;
    }
  }

  Appearance finish() {
    if (static_cast<Eigen::Index>(corners_.size()) != 3 * mesh_.faces.rows() ||
        static_cast<Eigen::Index>(colours_.size()) != mesh_.vertices.rows()) {
      throw InputError(file_.string(), "", "has changed since it was read: its vertices or faces are others");
    }
    for (const auto& [name, material] : library_) {
      const auto used = materials_.find(name);
      if (used == materials_.end()) continue;
      Material& target = look_.materials[static_cast<std::size_t>(used->second)];
      target = material;
      target.name = name;
      if (!target.texture.empty()) read_image(file_.parent_path(), target, look_.warnings);
    }
    if (look_.materials.empty()) look_.material_of_face.clear();
    if (look_.parts.empty()) look_.part_of_face.clear();
    fill_corners();
    return std::move(look_);
  }

  void fill_corners() {
    const auto rows = static_cast<Eigen::Index>(corners_.size());
    const bool with_uvs = std::ranges::any_of(corners_, [](const Corner& c) { return c.uv >= 0; });
    const bool with_normals = std::ranges::any_of(corners_, [](const Corner& c) { return c.normal >= 0; });
    if (with_uvs) look_.uvs = Appearance::Uvs::Constant(rows, 2, kNone);
    if (with_normals) look_.normals = Points::Constant(rows, 3, kNone);
    if (coloured_) look_.colours = Appearance::Colours::Ones(rows, 4);
    for (Eigen::Index row = 0; row < rows; ++row) {
      const Corner& corner = corners_[static_cast<std::size_t>(row)];
      if (corner.uv >= static_cast<std::int64_t>(uvs_.size()) ||
          corner.normal >= static_cast<std::int64_t>(normals_.size())) {
        throw InputError(file_.string(), place(corner.line, "", 0),
                         "names a texture coordinate or normal that there is not");
      }
      if (corner.uv >= 0) {
        const auto& uv = uvs_[static_cast<std::size_t>(corner.uv)];
        look_.uvs.row(row) << uv[0], uv[1];
      }
      if (corner.normal >= 0) {
        const auto& normal = normals_[static_cast<std::size_t>(corner.normal)];
        look_.normals.row(row) << normal[0], normal[1], normal[2];
        if (look_.normals.row(row).norm() > 0) look_.normals.row(row).normalize();
      }
      if (coloured_) {
        const auto& colour = colours_[static_cast<std::size_t>(mesh_.faces(row / 3, row % 3))];
        look_.colours.row(row).head<3>() << colour[0], colour[1], colour[2];
      }
    }
  }

  const fs::path& file_;
  const Mesh& mesh_;
  Appearance look_;
  long long number_ = 0;
  std::vector<std::array<double, 2>> uvs_;
  std::vector<std::array<double, 3>> normals_, colours_;
  std::vector<Corner> corners_;
  std::map<std::string, int> materials_;
  std::map<std::string, Material> library_;
  int material_ = -1;
  Part part_;
  bool begun_ = false;  // a part that has no face yet
  bool coloured_ = false;
};

// Rows written once, with their numbers.
class RowTable {
 public:
  RowTable(std::string& text, const char* keyword) : text_(text), keyword_(keyword) {}

  /// The row's number from 1, or 0 where it is not known.
  template <class Row>
  int number(const Row& row) {
    if (!row.allFinite()) return 0;
    const std::vector<double> key(row.data(), row.data() + row.size());
    const auto [entry, added] = numbers_.try_emplace(key, static_cast<int>(numbers_.size()) + 1);
    if (!added) return entry->second;
    text_ += keyword_;
    for (const double value : key) {
      text_ += ' ';
      append_number(text_, value);
    }
    text_ += '\n';
    return entry->second;
  }

 private:
  std::string& text_;
  const char* keyword_;
  std::map<std::vector<double>, int> numbers_;
};

// A name as OBJ can hold it, which ends at its line's end or at a comment.
std::string obj_name(std::string name, const char* otherwise) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < ' ' || c == '#' || c == '\\') c = '_';
  }
  const std::size_t first = name.find_first_not_of(' ');
  if (first == std::string::npos) return otherwise;
  return name.substr(first, name.find_last_not_of(' ') - first + 1);
}

// Names of materials, each another one, so that none takes another's place.
std::vector<std::string> obj_names(const std::vector<Material>& materials) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Material& material : materials) {
    const std::string name = obj_name(material.name, "unnamed");
    std::string own = name;
    for (int number = 2; !taken.insert(own).second; ++number) own = name + "-" + std::to_string(number);
    names.push_back(own);
  }
  return names;
}

std::string library_text(const std::vector<Material>& materials, const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const Material& material = materials[m];
    text += "newmtl " + names[m] + "\nKd";
    for (std::size_t k = 0; k < 3; ++k) {
      text += ' ';
      append_number(text, material.base_colour[k]);
    }
    text += "\nd ";
    append_number(text, material.base_colour[3]);
    text += '\n';
    if (!material.texture.empty()) text += "map_Kd " + material.texture + "\n";
  }
  return text;
}

void append_vertices(std::string& text, const Mesh& mesh, const Appearance& look) {
  std::vector<Eigen::Index> corner_of(static_cast<std::size_t>(mesh.vertices.rows()), -1);
  for (Eigen::Index c = 0; c < look.colours.rows(); ++c) {
    corner_of[static_cast<std::size_t>(mesh.faces(c / 3, c % 3))] = c;
  }
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    text += 'v';
    const auto add = [&](double number) {
      text += ' ';
      append_number(text, number);
    };
    for (int k = 0; k < 3; ++k) add(mesh.vertices(v, k));
    const Eigen::Index corner = corner_of[static_cast<std::size_t>(v)];
    for (int k = 0; corner >= 0 && look.colours.row(corner).allFinite() && k < 3; ++k) add(look.colours(corner, k));
    text += '\n';
  }
}

// The lines that begin a part. \param before  whose names faces have until then; null for none
std::string part_lines(const Part& part, const Part* before) {
  std::string text;
  const bool had_object = before != nullptr && !before->object.empty();
  const bool had_group = before != nullptr && !before->group.empty();
  if (!part.object.empty() || had_object) text += "o " + obj_name(part.object, "unnamed") + "\n";
  if (!part.group.empty() || had_group) text += "g " + obj_name(part.group, "default") + "\n";
  return text;
}

}  // namespace

Appearance obj_look(const fs::path& file, std::string_view content, const Mesh& mesh) {
  return ObjLookReader(file, mesh).read(content);
}

ObjFiles obj_with_look(const Mesh& mesh, const Appearance& look, const std::string& library_name) {
  ObjFiles files;
  const std::vector<std::string> names = obj_names(look.materials);
  if (!library_name.empty()) {
    files.library = library_text(look.materials, names);
    files.mesh += "mtllib " + library_name + "\n";
  }
  append_vertices(files.mesh, mesh, look);
  RowTable uvs(files.mesh, "vt");
  RowTable normals(files.mesh, "vn");
  std::vector<int> uv_of;
  std::vector<int> normal_of;
  for (Eigen::Index c = 0; c < look.uvs.rows(); ++c) uv_of.push_back(uvs.number(look.uvs.row(c)));
  for (Eigen::Index c = 0; c < look.normals.rows(); ++c) normal_of.push_back(normals.number(look.normals.row(c)));
  int material = -1;
  int part = -1;
  for (const PolygonRange& range : polygon_ranges(mesh)) {
    const auto first = static_cast<std::size_t>(range.first_face);
    const int own_part = look.part_of_face.empty() ? -1 : look.part_of_face[first];
    if (own_part != part) {
      const auto names_of = [&](int number) {
        return number < 0 ? nullptr : &look.parts[static_cast<std::size_t>(number)];
      };
      files.mesh += part_lines(own_part < 0 ? Part{} : *names_of(own_part), names_of(part));
      part = own_part;
    }
    const int own = look.material_of_face.empty() ? -1 : look.material_of_face[first];
    if (own != material && own >= 0 && !library_name.empty()) {
      files.mesh += "usemtl " + names[static_cast<std::size_t>(own)] + "\n";
    }
    material = own;
    files.mesh += 'f';
    // A fan's corners: those of its first triangle, then the last one of each.
    std::vector<std::size_t> rows{3 * first, 3 * first + 1};
    for (std::size_t k = 0; k < static_cast<std::size_t>(range.faces); ++k) rows.push_back(3 * (first + k) + 2);
    for (const std::size_t row : rows) {
      const int uv = uv_of.empty() ? 0 : uv_of[row];
      const int normal = normal_of.empty() ? 0 : normal_of[row];
      const auto corner = static_cast<Eigen::Index>(row);
      files.mesh += ' ' + std::to_string(mesh.faces(corner / 3, corner % 3) + 1);
      if (uv > 0 || normal > 0) files.mesh += '/' + (uv > 0 ? std::to_string(uv) : std::string());
      if (normal > 0) files.mesh += '/' + std::to_string(normal);
    }
    files.mesh += '\n';
  }
  return files;
}

}  // namespace orbifit
