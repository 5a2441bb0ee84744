#include "files/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "orbifit/model/errors.h"

#include "files/binary.h"
#include "files/text.h"

namespace orbifit {

namespace {

struct TypeName {
  std::string_view name, other_name;
  PlyType type;
  std::size_t size;
};

constexpr std::array<TypeName, 8> kTypes{{{"char", "int8", PlyType::int8, 1},
                                          {"uchar", "uint8", PlyType::uint8, 1},
                                          {"short", "int16", PlyType::int16, 2},
                                          {"ushort", "uint16", PlyType::uint16, 2},
                                          {"int", "int32", PlyType::int32, 4},
                                          {"uint", "uint32", PlyType::uint32, 4},
                                          {"float", "float32", PlyType::float32, 4},
                                          {"double", "float64", PlyType::float64, 8}}};

class HeaderReader {
 public:
  HeaderReader(const std::string& file, LineReader& lines) : file_(file), lines_(lines) {}

  PlyHeader read() {
    std::string_view line;
    if (!lines_.next(line) || WordReader(line).word() != "ply") refuse("not a PLY file: 'ply' must come first");
    PlyHeader header;
    bool has_format = false;
    while (true) {
      if (!lines_.next(line)) refuse("the file ends within the header");
      WordReader words(line);
      const std::string_view keyword = words.word();
      if (keyword == "end_header") break;
      if (keyword == "format") {
        header.encoding = encoding(words.word());
        has_format = true;
      } else if (keyword == "element") {
        header.elements.push_back(element(words));
      } else if (keyword == "property") {
        if (header.elements.empty()) refuse("a property before the first element");
        header.elements.back().properties.push_back(property(words));
      } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
        refuse("unknown word " + in_quotes(keyword) + " in the header");
      }
    }
    if (!has_format) refuse("the header names no format");
    return header;
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError(file_, place(std::max(lines_.line(), 1LL), "", 0), reason);
  }

  PlyEncoding encoding(std::string_view name) const {
    if (name == "ascii") return PlyEncoding::ascii;
    if (name == "binary_little_endian") return PlyEncoding::little;
    if (name == "binary_big_endian") return PlyEncoding::big;
    refuse("unknown format " + in_quotes(name));
  }

  PlyType type(std::string_view name) const {
    for (const TypeName& entry : kTypes) {
      if (name == entry.name || name == entry.other_name) return entry.type;
    }
    refuse("unknown type " + in_quotes(name));
  }

  PlyElement element(WordReader& words) const {
    PlyElement result;
    result.name = words.word();
    const std::string_view count = words.word();
    const auto number = parse_integer(count);
    if (!number || *number < 0) refuse("the count of element " + in_quotes(result.name) + " is " + in_quotes(count));
    result.count = *number;
    return result;
  }

  PlyProperty property(WordReader& words) const {
    PlyProperty result;
    std::string_view word = words.word();
    if (word == "list") {
      result.count_type = type(words.word());
      word = words.word();
    }
    result.type = type(word);
    result.name = words.word();
    if (result.name.empty()) refuse("a property without a name");
    return result;
  }

  const std::string& file_;
  LineReader& lines_;
};

// Numbers of one row after another; `fail` says what the file lacks.
class BinaryBody {
 public:
  BinaryBody(const std::string& file, std::string_view bytes, std::endian order)
      : file_(file), bytes_(bytes), order_(order) {}

  // A row takes so many bytes at least: a count that cannot be true is refused before any memory is asked for.
  void begin(const PlyElement& element) const {
    std::size_t least = 0;
    for (const PlyProperty& property : element.properties)
      least += size_of(property.count_type.value_or(property.type));
    if (least == 0 || static_cast<std::uint64_t>(element.count) <= bytes_.size() / least) return;
    truncated(element, static_cast<long long>(bytes_.size() / least));
  }

  void begin_row(const PlyElement& element, PlyRow& row) {
    element_ = &element;
    row_ = row.number;
  }
  double scalar(const PlyProperty& property) { return take(property.type); }
  void list(const PlyProperty& property, long long count, std::vector<double>& list) {
    if (static_cast<std::uint64_t>(count) > bytes_.size() / size_of(property.type)) truncated(*element_, row_);
    for (long long k = 0; k < count; ++k) list.push_back(take(property.type));
  }
  double take(PlyType type) {
    const std::size_t size = size_of(type);
    if (bytes_.size() < size) truncated(*element_, row_);
    const double number = ply_number(bytes_.data(), type, order_);
    bytes_.remove_prefix(size);
    return number;
  }
  // Blanks and zero bytes that fill up a file say nothing; more means that the header is wrong, or that line ends were
  // converted within the numbers, which are others then.
  void end() const {
    if (bytes_.find_first_not_of(std::string_view("\0 \t\r\n", 5)) == std::string_view::npos) return;
    throw InputError(file_, "",
                     "the file has " + std::to_string(bytes_.size()) + " bytes more than its header announces");
  }

 private:
  [[noreturn]] void truncated(const PlyElement& element, long long row) const {
    throw InputError(file_, place(0, element.name, row),
                     "the file is truncated: its header announces " + std::to_string(element.count) + " of element " +
                         in_quotes(element.name));
  }

  const std::string& file_;
  std::string_view bytes_;
  std::endian order_;
  const PlyElement* element_ = nullptr;
  long long row_ = 0;
};

class AsciiBody {
 public:
  AsciiBody(const std::string& file, LineReader& lines) : file_(file), lines_(lines), words_({}) {}

  void begin(const PlyElement& element) const {
    if (static_cast<std::uint64_t>(element.count) <= lines_.rest().size()) return;
    truncated(element, 0);
  }
  void begin_row(const PlyElement& element, PlyRow& row) {
    std::string_view line;
    if (!lines_.next_content(line)) truncated(element, row.number);
    row.line = lines_.line();
    words_ = WordReader(line);
  }
  double scalar(const PlyProperty& property) { return take(property.type); }
  void list(const PlyProperty& property, long long count, std::vector<double>& list) {
    for (long long k = 0; k < count; ++k) list.push_back(take(property.type));
  }
  double take(PlyType /*type*/) {
    const std::string_view word = words_.word();
    const auto number = parse_number(word);
    if (!number) {
      throw InputError(
          file_, place(lines_.line(), "", 0),
          word.empty() ? "the line has fewer numbers than the header announces" : in_quotes(word) + " is not a number");
    }
    return *number;
  }
  void end() {
    std::string_view line;
    if (!lines_.next_content(line)) return;
    throw InputError(file_, place(lines_.line(), "", 0),
                     "the file goes on after the last row that its header announces");
  }

 private:
  [[noreturn]] void truncated(const PlyElement& element, long long row) const {
    throw InputError(file_, place(lines_.line(), "", 0),
                     "the file ends after " + std::to_string(row) + " of " + std::to_string(element.count) +
                         " rows of element " + in_quotes(element.name));
  }

  const std::string& file_;
  LineReader& lines_;
  WordReader words_;
};

template <typename Body>
void visit_body(const std::string& file, const PlyHeader& header, Body body,
                const std::function<void(const PlyElement&)>& begin_element,
                const std::function<void(const PlyElement&, const PlyRow&)>& visit) {
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    body.begin(element);
    begin_element(element);
    PlyRow row;
    row.values.resize(element.properties.size());
    row.lists.resize(element.properties.size());
    for (row.number = 0; row.number < element.count; ++row.number) {
      body.begin_row(element, row);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!property.count_type) {
          row.values[p] = body.scalar(property);
          continue;
        }
        const double count = body.take(*property.count_type);
        if (!(count >= 0 && count <= 4294967295.0)) {
          throw InputError(file, place(row.line, element.name, row.number),
                           "the length of list " + in_quotes(property.name) + " is not a number of entries");
        }
        row.lists[p].clear();
        body.list(property, static_cast<long long>(count), row.lists[p]);
      }
      visit(element, row);
    }
  }
  body.end();
}

}  // namespace

std::size_t size_of(PlyType type) {
  return kTypes[static_cast<std::size_t>(type)].size;
}

double ply_number(const char* bytes, PlyType type, std::endian order) {
  switch (type) {
    case PlyType::int8:
      return load<std::int8_t>(bytes, order);
    case PlyType::uint8:
      return load<std::uint8_t>(bytes, order);
    case PlyType::int16:
      return load<std::int16_t>(bytes, order);
    case PlyType::uint16:
      return load<std::uint16_t>(bytes, order);
    case PlyType::int32:
      return load<std::int32_t>(bytes, order);
    case PlyType::uint32:
      return load<std::uint32_t>(bytes, order);
    case PlyType::float32:
      return load<float>(bytes, order);
    case PlyType::float64:
      return load<double>(bytes, order);
  }
  return 0;
}

PlyHeader read_ply_header(const std::string& file, std::string_view content) {
  LineReader lines(content);
  PlyHeader header = HeaderReader(file, lines).read();
  header.size = content.size() - lines.rest().size();
  return header;
}

int PlyElement::find(std::string_view property) const {
  const auto found = std::ranges::find(properties, property, &PlyProperty::name);
  return found == properties.end() ? -1 : static_cast<int>(found - properties.begin());
}

void visit_ply(const std::string& file, std::string_view content,
               const std::function<void(const PlyElement&)>& begin_element,
               const std::function<void(const PlyElement&, const PlyRow&)>& visit) {
  LineReader lines(content);
  const PlyHeader header = HeaderReader(file, lines).read();
  if (header.encoding == PlyEncoding::ascii) {
    visit_body(file, header, AsciiBody(file, lines), begin_element, visit);
  } else {
    const std::endian order = header.encoding == PlyEncoding::little ? std::endian::little : std::endian::big;
    visit_body(file, header, BinaryBody(file, lines.rest(), order), begin_element, visit);
  }
}

}  // namespace orbifit
