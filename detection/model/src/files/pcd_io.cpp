#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/lzf.h"
#include "files/mesh_formats.h"
#include "files/scan_formats.h"
#include "files/text.h"

namespace orbifit {

namespace {

struct Field {
  std::string name;
  std::size_t size = 4;  // bytes of one entry
  char type = 'F';       // signed I, unsigned U, float F
  std::size_t count = 1;
  std::size_t column = 0;  // of its first entry in an ascii row
  std::size_t offset = 0;  // of its first byte in a binary row
};

struct Header {
  std::vector<Field> fields;
  long long points = -1;
  std::size_t row_size = 0;
  std::size_t columns = 0;
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();
  std::string data;
};

class HeaderReader {
 public:
  HeaderReader(const std::string& file, LineReader& lines) : file_(file), lines_(lines) {}

  Header read() {
    std::string_view line;
    while (header_.data.empty()) {
      if (!lines_.next_content(line, '#')) refuse("the file ends before the line DATA");
      WordReader words(line);
      entry(words.word(), words);
    }
    if (header_.fields.empty()) refuse("the header has no FIELDS");
    if (header_.points < 0 && width_ >= 0 && height_ >= 0) {
      if (width_ > 0 && height_ > std::numeric_limits<std::int64_t>::max() / width_)
        refuse("WIDTH times HEIGHT is too large");
      header_.points = width_ * height_;
    }
    if (header_.points < 0) refuse("the header has no POINTS");
    for (Field& field : header_.fields) {
      field.column = header_.columns;
      field.offset = header_.row_size;
      header_.columns += field.count;
      header_.row_size += field.count * field.size;
    }
    if (header_.row_size == 0) refuse("the FIELDS hold nothing");
    if (header_.columns > 1'000'000) refuse("more than a million columns");
    return header_;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError(file_, place(std::max(lines_.line(), 1LL), "", 0), reason);
  }

  void entry(std::string_view keyword, WordReader& words) {
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      while (!words.at_end()) header_.fields.emplace_back().name = words.word();
    } else if (keyword == "SIZE") {
      for (Field& field : header_.fields) field.size = static_cast<std::size_t>(count(words, "SIZE", 1, 8));
    } else if (keyword == "COUNT") {
      for (Field& field : header_.fields) field.count = static_cast<std::size_t>(count(words, "COUNT", 0, 1'000'000));
    } else if (keyword == "TYPE") {
      for (Field& field : header_.fields) {
        const std::string_view type = words.word();
        if (type != "I" && type != "U" && type != "F") refuse("TYPE " + in_quotes(type) + ": I, U or F is needed");
        field.type = type.front();
      }
    } else if (keyword == "WIDTH") {
      width_ = count(words, "WIDTH", 0, std::numeric_limits<std::int64_t>::max());
    } else if (keyword == "HEIGHT") {
      height_ = count(words, "HEIGHT", 0, std::numeric_limits<std::int64_t>::max());
    } else if (keyword == "POINTS") {
      header_.points = count(words, "POINTS", 0, std::numeric_limits<std::int64_t>::max());
    } else if (keyword == "VIEWPOINT") {
      for (int k = 0; k < 3; ++k) {
        const auto number = words.number();
        if (!number || !std::isfinite(*number)) refuse("VIEWPOINT needs finite numbers");
        header_.viewpoint[k] = *number;
      }
    } else if (keyword == "DATA") {
      header_.data = lower_case(words.word());
      if (header_.data != "ascii" && header_.data != "binary" && header_.data != "binary_compressed") {
        refuse("DATA " + in_quotes(header_.data) + ": ascii, binary or binary_compressed is needed");
      }
    } else if (keyword != "VERSION") {
      refuse("not a PCD header: unknown word " + in_quotes(keyword));
    }
  }

  std::int64_t count(WordReader& words, const std::string& keyword, std::int64_t least, std::int64_t most) const {
    const std::string_view word = words.word();
    const auto number = parse_integer(word);
    if (!number || *number < least || *number > most) refuse(keyword + " " + in_quotes(word) + " is out of range");
    return *number;
  }

  const std::string& file_;
  LineReader& lines_;
  Header header_;
  std::int64_t width_ = -1, height_ = -1;
};

double load_entry(const char* bytes, const Field& field) {
  switch (field.type) {
    case 'F':
      return field.size == 8 ? load<double>(bytes) : load<float>(bytes);
    case 'I':
      if (field.size == 1) return load<std::int8_t>(bytes);
      if (field.size == 2) return load<std::int16_t>(bytes);
      if (field.size == 4) return load<std::int32_t>(bytes);
      return static_cast<double>(load<std::int64_t>(bytes));
    default:
      if (field.size == 1) return load<std::uint8_t>(bytes);
      if (field.size == 2) return load<std::uint16_t>(bytes);
      if (field.size == 4) return load<std::uint32_t>(bytes);
      return static_cast<double>(load<std::uint64_t>(bytes));
  }
}

// The three fields with those names, or nothing unless all are there.
std::optional<std::array<const Field*, 3>> find_fields(const Header& header,
                                                       const std::array<std::string_view, 3>& names) {
  std::array<const Field*, 3> result{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto found = std::ranges::find(header.fields, names[k], &Field::name);
    if (found == header.fields.end() || found->count == 0) return std::nullopt;
    result[k] = &*found;
  }
  return result;
}

class BodyReader {
 public:
  BodyReader(const Header& header, ScanBuilder& builder) : header_(header), builder_(builder) {
    position_ = find_fields(header, {"x", "y", "z"});
    normal_ = find_fields(header, {"normal_x", "normal_y", "normal_z"});
    if (!normal_) normal_ = find_fields(header, {"nx", "ny", "nz"});
    viewpoint_ = find_fields(header, {"vx", "vy", "vz"});
    if (!viewpoint_) viewpoint_ = find_fields(header, {"vp_x", "vp_y", "vp_z"});
    if (!position_) throw InputError(builder.file(), "header", "the FIELDS lack x, y and z");
    for (const auto* triple : {&position_, &normal_, &viewpoint_}) {
      if (!triple->has_value()) continue;
      for (const Field* field : **triple) {
        const bool good = field->type == 'F'
                              ? field->size == 4 || field->size == 8
                              : field->size == 1 || field->size == 2 || field->size == 4 || field->size == 8;
        if (!good) {
          throw InputError(builder.file(), "header",
                           "field " + in_quotes(field->name) + " has " + std::to_string(field->size) +
                               " bytes, which no number of its type has");
        }
      }
    }
    if (normal_) builder.has_normals();
    if (viewpoint_) builder.has_viewpoints();
  }

  // value(field) gives the first entry of that field in the row.
  template <typename Value>
  void add(const Value& value, long long line) {
    double triples[3][3] = {};
    int t = 0;
    for (const auto* triple : {&position_, &normal_, &viewpoint_}) {
      for (std::size_t k = 0; triple->has_value() && k < 3; ++k) triples[t][k] = value(*(**triple)[k]);
      ++t;
    }
    builder_.add(triples[0], triples[1], triples[2], line);
  }

  void read_ascii(LineReader& lines) {
    std::string_view line;
    std::vector<double> row(header_.columns);
    for (long long p = 0; p < header_.points; ++p) {
      if (!lines.next_content(line)) {
        throw InputError(
            builder_.file(), place(std::max(lines.line(), 1LL), "", 0),
            "the file ends after " + std::to_string(p) + " of " + std::to_string(header_.points) + " points");
      }
      WordReader words(line);
      for (double& entry : row) {
        const std::string_view word = words.word();
        const auto number = parse_number(word);
        if (!number) {
          throw InputError(builder_.file(), place(lines.line(), "", 0),
                           word.empty() ? "the line has fewer numbers than the header announces"
                                        : in_quotes(word) + " is not a number");
        }
        entry = *number;
      }
      add([&](const Field& field) { return row[field.column]; }, lines.line());
    }
    if (lines.next_content(line)) {
      throw InputError(builder_.file(), place(lines.line(), "", 0),
                       "more points than the " + std::to_string(header_.points) + " that the header announces");
    }
  }

  void read_binary(std::string_view bytes) {
    require(bytes.size());
    for (long long p = 0; p < header_.points; ++p) {
      const char* row = bytes.data() + static_cast<std::size_t>(p) * header_.row_size;
      add([&](const Field& field) { return load_entry(row + field.offset, field); }, 0);
    }
  }

  // Field after field instead of row after row, and compressed.
  void read_compressed(std::string_view bytes) {
    if (header_.points == 0) return;
    if (bytes.size() < 8) throw InputError(builder_.file(), "point 0", "the file is truncated");
    const std::size_t packed = load<std::uint32_t>(bytes.data());
    const std::size_t size = load<std::uint32_t>(bytes.data() + 4);
    if (packed > bytes.size() - 8) {
      throw InputError(builder_.file(), "point 0",
                       "the file is truncated: " + std::to_string(packed) + " compressed bytes are announced, " +
                           std::to_string(bytes.size() - 8) + " are there");
    }
    require(size);
    const auto data = lzf_decompress(bytes.substr(8, packed), size);
    if (!data) throw InputError(builder_.file(), "point 0", "the compressed data are damaged");
    const auto points = static_cast<std::size_t>(header_.points);
    for (std::size_t p = 0; p < points; ++p) {
      const auto value = [&](const Field& field) {
        return load_entry(data->data() + points * field.offset + p * field.count * field.size, field);
      };
      add(value, 0);
    }
  }

 private:
  void require(std::size_t bytes) const {
    const std::size_t held = bytes / header_.row_size;
    if (static_cast<std::uint64_t>(header_.points) <= held) return;
    throw InputError(builder_.file(), "point " + std::to_string(held),
                     "the file is truncated: its header announces " + std::to_string(header_.points) +
                         " points, it holds " + std::to_string(held));
  }

  const Header& header_;
  ScanBuilder& builder_;
  std::optional<std::array<const Field*, 3>> position_, normal_, viewpoint_;
};

}  // namespace

void read_pcd(std::string_view content, ScanBuilder& builder) {
  LineReader lines(content);
  const Header header = HeaderReader(builder.file(), lines).read();
  builder.set_viewpoint(header.viewpoint);
  BodyReader body(header, builder);
  if (header.data == "ascii") {
    body.read_ascii(lines);
  } else if (header.data == "binary") {
    body.read_binary(lines.rest());
  } else {
    body.read_compressed(lines.rest());
  }
}

std::string pcd_bytes(const std::string& file, const PointCloud& scan) {
  const Eigen::Index count = scan.points.rows();
  const bool normals = scan.normals.rows() == count && count > 0;
  const bool common = scan.viewpoints.rows() == 1;
  const bool each = !common && scan.viewpoints.rows() == count && count > 0;
  const int fields = 3 + (normals ? 3 : 0) + (each ? 3 : 0);
  const auto repeated = [&](const char* word) {
    std::string text;
    for (int f = 0; f < fields; ++f) text += word;
    return text + "\n";
  };
  std::string bytes = std::string("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z") +
                      (normals ? " normal_x normal_y normal_z" : "") + (each ? " vx vy vz" : "") + "\nSIZE" +
                      repeated(" 4") + "TYPE" + repeated(" F") + "COUNT" + repeated(" 1") + "WIDTH " +
                      std::to_string(count) + "\nHEIGHT 1\nVIEWPOINT";
  for (int k = 0; k < 3; ++k) append_number(bytes += ' ', common ? scan.viewpoints(0, k) : 0.0);
  bytes += " 1 0 0 0\nPOINTS " + std::to_string(count) + "\nDATA binary\n";
  const auto append_row = [&](const Points& rows, Eigen::Index p) {
    for (int k = 0; k < 3; ++k) store(bytes, to_float(file, rows(p, k)));
  };
  for (Eigen::Index p = 0; p < count; ++p) {
    append_row(scan.points, p);
    if (normals) append_row(scan.normals, p);
    if (each) append_row(scan.viewpoints, p);
  }
  return bytes;
}

}  // namespace orbifit
