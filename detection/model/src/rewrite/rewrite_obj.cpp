#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "files/text.h"
#include "rewrite/replacements.h"
#include "rewrite/rewriters.h"
#include "rewrite/turned_normals.h"

namespace orbifit {

namespace {

using Words = std::vector<std::string_view>;

constexpr double kSameNormal = 1e-9;  // between unit normals that differ by rounding only

// The statements of an OBJ file, with the words of each. A backslash at a line's end joins it to the next one.
class Statements {
 public:
  explicit Statements(std::string_view content) : lines_(content) {}

  bool next() {
    std::string_view line;
    if (!lines_.next(line)) return false;
    words_.clear();
    start_ = line.substr(0, 0);
    const bool comment = line.starts_with('#');
    add_words(line);
    while (!comment && continued(line) && lines_.next(line)) add_words(line);
    return true;
  }

  const Words& words() const { return words_; }
  std::string_view start() const { return start_; }  ///< empty, where the statement begins

 private:
  static bool continued(std::string_view line) {
    const std::size_t last = line.find_last_not_of(" \t");
    return last != std::string_view::npos && line[last] == '\\';
  }

  void add_words(std::string_view line) {
    if (continued(line)) line = line.substr(0, line.find_last_of('\\'));
    line = line.substr(0, line.find('#'));
    WordReader words(line);
    while (!words.at_end()) words_.push_back(words.word());
  }

  LineReader lines_;
  Words words_;
  std::string_view start_;
};

// One of the numbers of a face's corner, v/vt/vn: vertex from 0, normal from 0.
struct Corner {
  std::int64_t vertex = -1;
  std::int64_t normal = -1;
  std::string_view normal_word;  ///< empty without a normal
};

std::optional<std::int64_t> from_zero(std::string_view word, std::int64_t count) {
  const auto number = parse_integer(word);
  if (!number || *number == 0) return std::nullopt;
  return *number > 0 ? *number - 1 : count + *number;
}

Corner parse_corner(std::string_view word, std::int64_t vertices, std::int64_t normals) {
  Corner corner;
  const std::size_t first = word.find('/');
  corner.vertex = from_zero(word.substr(0, first), vertices).value_or(-1);
  const std::size_t second = first == std::string_view::npos ? first : word.find('/', first + 1);
  if (second == std::string_view::npos) return corner;
  const std::string_view normal = word.substr(second + 1);
  if (const auto number = from_zero(normal, normals); number && *number >= 0) {
    corner.normal = *number;
    corner.normal_word = normal;
  }
  return corner;
}

bool is_face(const Words& words) {
  return !words.empty() && (words.front() == "f" || words.front() == "fo");
}

// How each normal turns at each vertex where faces use it: one normal may serve many vertices, as the six of a box do,
// and be bent differently at each.
class ObjNormals {
 public:
  explicit ObjNormals(const MeshEdit& edit) : edit_(edit) {
    Statements statements(edit.content);
    std::int64_t vertices = 0;
    while (statements.next()) {
      const Words& words = statements.words();
      if (words.empty()) continue;
      if (words.front() == "v") ++vertices;
      if (words.front() == "vn") read_normal(words);
      if (is_face(words)) add_face(words, vertices);
    }
  }

  std::int64_t count() const { return static_cast<std::int64_t>(normals_.size()); }
  /// Whether a face names a normal that comes after it: then normals keep their numbers.
  bool forward() const { return forward_; }

  /// The normal as the first face that uses it has it after the edit.
  Eigen::Vector3d shared(std::int64_t normal) const {
    const auto index = static_cast<std::size_t>(normal);
    const auto first = first_vertex_.find(normal);
    return first == first_vertex_.end() ? normals_[index] : at(normal, first->second);
  }

  Eigen::Vector3d at(std::int64_t normal, std::int64_t vertex) const {
    const auto turn = turns_.find(key(normal, vertex));
    const Eigen::Vector3d& rest = normals_[static_cast<std::size_t>(normal)];
    return turn == turns_.end() ? rest : turn->second.apply(rest);
  }

  static std::int64_t key(std::int64_t normal, std::int64_t vertex) { return (normal << 32U) + vertex; }

 private:
  void read_normal(const Words& words) {
    Eigen::Vector3d& normal = normals_.emplace_back(Eigen::Vector3d::Zero());
    for (std::size_t k = 0; k < 3 && k + 1 < words.size(); ++k) {
      normal[static_cast<Eigen::Index>(k)] = parse_number(words[k + 1]).value_or(0);
    }
  }

  void add_face(const Words& words, std::int64_t vertices) {
    corners_.clear();
    for (std::size_t w = 1; w < words.size(); ++w) corners_.push_back(parse_corner(words[w], vertices, count()));
    const Eigen::Vector3d rest = area_vector(edit_.rest.vertices);
    const Eigen::Vector3d edited = area_vector(edit_.edited.vertices);
    for (const Corner& corner : corners_) {
      if (corner.normal < 0 || corner.vertex < 0) continue;
      if (corner.normal >= count()) {
        forward_ = true;
        continue;
      }
      turns_[key(corner.normal, corner.vertex)].add(rest, edited);
      first_vertex_.emplace(corner.normal, corner.vertex);
    }
  }

  Eigen::Vector3d area_vector(const Points& vertices) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t c = 1; c + 1 < corners_.size(); ++c) {
      const Eigen::Vector3d first = vertices.row(corners_[0].vertex);
      const Eigen::Vector3d a = vertices.row(corners_[c].vertex).transpose() - first;
      sum += a.cross(vertices.row(corners_[c + 1].vertex).transpose() - first);
    }
    return sum;
  }

  const MeshEdit& edit_;
  std::vector<Eigen::Vector3d> normals_;
  std::unordered_map<std::int64_t, NormalTurn> turns_;           // by key()
  std::unordered_map<std::int64_t, std::int64_t> first_vertex_;  // by normal
  std::vector<Corner> corners_;
  bool forward_ = false;
};

// Writes the file anew, statement by statement. Where a normal turns differently at two vertices, the later one gets a
// normal of its own before the face that needs it, and the numbers of those that follow move on.
class ObjRewriter {
 public:
  explicit ObjRewriter(const MeshEdit& edit) : edit_(edit), normals_(edit), result_(edit.content) {}

  std::string run() {
    Statements statements(edit_.content);
    while (statements.next()) {
      const Words& words = statements.words();
      if (words.empty()) continue;
      if (words.front() == "v") {
        replace_numbers(words, edit_.edited.vertices.row(vertices_++));
      } else if (words.front() == "vn") {
        const auto normal = static_cast<std::int64_t>(number_of_.size());
        replace_numbers(words, normals_.shared(normal));
        number_of_.push_back(written_++);
      } else if (is_face(words) && !normals_.forward()) {
        write_face(words, statements.start());
      }
    }
    return result_.finish();
  }

 private:
  void replace_numbers(const Words& words, const Eigen::Vector3d& values) {
    for (std::size_t k = 0; k < 3 && k + 1 < words.size(); ++k) {
      const double value = values[static_cast<Eigen::Index>(k)];
      const auto number = parse_number(words[k + 1]);
      if (!number || *number == value) continue;
      std::string text;
      append_number(text, value);
      result_.replace(words[k + 1], text);
    }
  }

  void write_face(const Words& words, std::string_view start) {
    const auto known = static_cast<std::int64_t>(number_of_.size());
    corners_.clear();
    for (std::size_t w = 1; w < words.size(); ++w) corners_.push_back(parse_corner(words[w], vertices_, known));
    std::string added;
    numbers_.clear();
    for (const Corner& corner : corners_) numbers_.push_back(number_at(corner, added));
    if (!added.empty()) result_.replace(start, added);
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      const Corner& corner = corners_[c];
      if (numbers_[c] < 0) continue;
      const bool backwards = corner.normal_word.starts_with('-');
      const std::int64_t number = backwards ? numbers_[c] - written_ : numbers_[c] + 1;
      if (parse_integer(corner.normal_word) == number) continue;
      result_.replace(corner.normal_word, std::to_string(number));
    }
  }

  // The number, from 0, of the normal at a corner in the file that is written; -1 where it has none.
  std::int64_t number_at(const Corner& corner, std::string& added) {
    if (corner.normal < 0 || corner.normal >= static_cast<std::int64_t>(number_of_.size())) return -1;
    const Eigen::Vector3d normal = normals_.at(corner.normal, corner.vertex);
    if ((normal - normals_.shared(corner.normal)).norm() <= kSameNormal * normal.norm()) {
      return number_of_[static_cast<std::size_t>(corner.normal)];
    }
    const auto [own, is_new] = own_.emplace(ObjNormals::key(corner.normal, corner.vertex), written_);
    if (is_new) {
      added += "vn";
      for (const double entry : normal) {
        added += ' ';
        append_number(added, entry);
      }
      added += '\n';
      ++written_;
    }
    return own->second;
  }

  const MeshEdit& edit_;
  const ObjNormals normals_;
  Replacements result_;
  std::int64_t vertices_ = 0;
  std::int64_t written_ = 0;                            // normals, so far
  std::vector<std::int64_t> number_of_;                 // of each of the file's normals, in what is written
  std::unordered_map<std::int64_t, std::int64_t> own_;  // numbers of normals added, by ObjNormals::key()
  std::vector<Corner> corners_;
  std::vector<std::int64_t> numbers_;
};

}  // namespace

std::string rewritten_obj(const MeshEdit& edit) {
  return ObjRewriter(edit).run();
}

}  // namespace orbifit
