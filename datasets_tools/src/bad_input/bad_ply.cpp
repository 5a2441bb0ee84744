#include <array>
#include <bit>
#include <functional>
#include <limits>
#include <string>

#include "bad_input/bad_input_lists.h"
#include "files/binary.h"
#include "files/mesh_formats.h"

namespace orbifit {

namespace {

const std::string kAscii =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string binary(const std::string& count_type, const std::string& counts, double x, const std::string& list) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + counts +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list " +
                      count_type + " int vertex_indices\nend_header\n";
  for (const double coordinate : {x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0}) store(bytes, coordinate);
  return bytes + list;
}

std::string triangle(int a, int b, int c) {
  std::string bytes(1, '\3');
  for (const int corner : {a, b, c}) store(bytes, corner);
  return bytes;
}

// Adds the ASCII file with the first `from` replaced.
using Change = std::function<void(const std::string& what, const std::string& from, const std::string& to)>;

void change_header(const Change& change) {
  change("other_word", "ply", "plx");
  change("format_unknown", "ascii 1.0", "utf8 1.0");
  change("format_missing", "format ascii 1.0\n", "");
  change("format_version", "ascii 1.0", "ascii 7.5");
  change("type_unknown", "float x", "quad x");
  change("property_first", "element vertex 3\n", "");
  change("property_nameless", "float x", "float");
  change("property_twice", "float y", "float x");
  change("property_list_of_floats", "list uchar int", "list uchar float");
  change("property_list_counted_by_floats", "list uchar int", "list float int");
  change("property_x_is_list", "float x", "list uchar float x");
  change("coordinate_missing", "property float z\n", "");
  change("corners_missing", "vertex_indices", "corner_numbers");
  change("corners_scalar", "list uchar int vertex_indices", "int vertex_indices");
  change("count_huge", "vertex 3", "vertex 4000000000");
  change("count_overflows", "vertex 3", "vertex 99999999999999999999");
  change("count_negative", "vertex 3", "vertex -3");
  change("count_fraction", "vertex 3", "vertex 3.5");
  change("count_too_large", "vertex 3", "vertex 4");
  change("count_too_small", "vertex 3", "vertex 2");
  change("faces_too_many", "face 1", "face 2");
  change("faces_none", "face 1", "face 0");
  change("element_unknown", "element face 1", "element edge 0\nproperty int a\nelement face 1");
  change("element_empty_huge", "element face 1", "element ghost 9000000000000000000\nelement face 1");
  change("element_twice", "element face 1",
         "element vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 1");
  change(
      "faces_first",
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      "element face 1\nproperty list uchar int vertex_indices\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n");
}

void change_rows(const Change& change) {
  change("list_huge", "3 0 1 2", "4000000000 0 1 2");
  change("list_negative", "3 0 1 2", "-1 0 1 2");
  change("list_too_short", "3 0 1 2", "3 0 1");
  change("list_of_two", "3 0 1 2", "2 0 1");
  change("index_beyond", "3 0 1 2", "3 0 1 3");
  change("index_negative", "3 0 1 2", "3 0 1 -1");
  change("index_fraction", "3 0 1 2", "3 0 1 1.5");
  change("index_nan", "3 0 1 2", "3 0 1 nan");
  change("index_1e30", "3 0 1 2", "3 0 1 1e30");
  change("coordinate_nan", "1 0 0", "nan 0 0");
  change("coordinate_infinite", "1 0 0", "-inf 0 0");
  change("coordinate_1e300", "1 0 0", "1e300 0 0");
  change("coordinate_word", "1 0 0", "one 0 0");
  change("row_short", "1 0 0", "1 0");
  change("row_long", "1 0 0", "1 0 0 7 8 9");
  change("comments", "format ascii 1.0\n", "comment before\nformat ascii 1.0\ncomment after\nobj_info none\n");
  change("comment_in_body", "1 0 0\n", "comment here\n1 0 0\n");
  change("blank_lines_in_body", "1 0 0\n", "\n\n1 0 0\n");
}

void add_ascii(BadInputs& files) {
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({"ply_" + what + ".ply", BadInputKind::mesh, content});
  };
  const auto change = [&](const std::string& what, const std::string& from, const std::string& to) {
    add(what, with(kAscii, from, to));
  };
  add_truncated(files, "ply", ".ply", BadInputKind::mesh, kAscii);
  add("empty", "");
  add("word_only", "ply");
  add("header_endless", "ply\nformat ascii 1.0\n" + std::string(10'000, '\n'));
  change_header(change);
  change_rows(change);
  add("goes_on", kAscii + "\n3 2 1 0\n");
  add("blank_lines_at_end", kAscii + "\n \r\n");
  add("byte_order_mark", "\xef\xbb\xbf" + kAscii);
  std::string crlf;
  for (const char letter : kAscii) crlf += letter == '\n' ? "\r\n" : std::string(1, letter);
  add("crlf", crlf);
}

void add_binary(BadInputs& files) {
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({"plyb_" + what + ".ply", BadInputKind::mesh, content});
  };
  const std::string whole = binary("uchar", "3", 0, triangle(0, 1, 2));
  add_truncated(files, "plyb", ".ply", BadInputKind::mesh, whole);
  add("cut_at_header", whole.substr(0, whole.find("end_header\n") + 11));
  add("cut_at_faces", binary("uchar", "3", 0, ""));
  add("whole", whole);
  add("goes_on", whole + triangle(2, 1, 0));
  add("filled_up", whole + std::string(7, '\0') + "\r\n");
  add("read_as_big_endian", with(whole, "binary_little_endian", "binary_big_endian"));
  add("crlf_header", with(whole, "end_header\n", "end_header\r\n"));
  add("count_huge", binary("uchar", "4000000000", 0, triangle(0, 1, 2)));
  add("count_overflows", binary("uchar", "9223372036854775807", 0, triangle(0, 1, 2)));
  add("count_overflows_size", binary("uchar", "768614336404564651", 0, triangle(0, 1, 2)));
  add("nan", binary("uchar", "3", std::numeric_limits<double>::quiet_NaN(), triangle(0, 1, 2)));
  add("infinite", binary("uchar", "3", std::numeric_limits<double>::infinity(), triangle(0, 1, 2)));
  add("1e300", binary("uchar", "3", 1e300, triangle(0, 1, 2)));
  add("denormal", binary("uchar", "3", 4.9e-324, triangle(0, 1, 2)));
  add("index_beyond", binary("uchar", "3", 0, triangle(0, 1, 3)));
  add("index_negative", binary("uchar", "3", 0, triangle(0, 1, -1)));
  add("index_least", binary("uchar", "3", 0, triangle(0, 1, std::numeric_limits<int>::min())));
  add("list_of_255", binary("uchar", "3", 0, "\xff" + triangle(0, 1, 2).substr(1)));
  add("list_of_2_32", binary("uint", "3", 0, std::string("\xff\xff\xff\xff", 4) + triangle(0, 1, 2).substr(1)));
  add("list_negative", binary("char", "3", 0, "\xff" + triangle(0, 1, 2).substr(1)));
  add("list_counted_by_nan", binary("float", "3", 0, std::string("\0\0\xc0\x7f", 4) + triangle(0, 1, 2).substr(1)));
  add("more_after_end", whole + std::string(1000, '\xff'));
}

}  // namespace

void add_bad_ply(BadInputs& files) {
  add_ascii(files);
  add_binary(files);
}

void add_bad_stl(BadInputs& files) {
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({"stl_" + what + ".stl", BadInputKind::mesh, content});
  };
  const std::string ascii =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
      "s\n";
  add_truncated(files, "stl", ".stl", BadInputKind::mesh, ascii);
  add("empty", "");
  add("solid_only", "solid\nendsolid\n");
  add("two_vertices", with(ascii, "vertex 1 0 0\n", ""));
  add("four_vertices", with(ascii, "vertex 1 0 0\n", "vertex 1 0 0\nvertex 1 1 0\n"));
  add("vertex_outside", with(ascii, "solid s\n", "solid s\nvertex 0 0 0\n"));
  add("facet_in_facet", with(ascii, "outer loop\n", "facet normal 0 0 1\n"));
  add("coordinate_missing", with(ascii, "vertex 1 0 0", "vertex 1 0"));
  add("coordinate_word", with(ascii, "vertex 1 0 0", "vertex one 0 0"));
  add("nan", with(ascii, "vertex 1 0 0", "vertex nan 0 0"));
  add("normal_nan", with(ascii, "normal 0 0 1", "normal nan nan nan"));
  add("upper_case",
      "SOLID S\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 "
      "0\nENDLOOP\nENDFACET\nENDSOLID\n");
  add("two_solids", ascii + ascii);
  add("byte_order_mark", "\xef\xbb\xbf" + ascii);
  const auto binary = [](const std::string& header, std::uint32_t count, float x, int facets = 1) {
    std::string bytes = header + std::string(80 - header.size(), ' ');
    store(bytes, count);
    for (int f = 0; f < facets; ++f) {
      for (const float value : {0.F, 0.F, 1.F, x, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) store(bytes, value);
      store(bytes, std::uint16_t{0});
    }
    return bytes;
  };
  const auto add_binary = [&](const std::string& what, const std::string& content) {
    files.push_back({"stlb_" + what + ".stl", BadInputKind::mesh, content});
  };
  add_truncated(files, "stlb", ".stl", BadInputKind::mesh, binary("binary", 1, 0));
  add_binary("header_solid", binary("solid", 1, 0));
  add_binary("count_none", binary("binary", 0, 0, 0));
  add_binary("count_too_small", binary("binary", 1, 0, 2));
  add_binary("count_too_large", binary("binary", 2, 0));
  add_binary("count_2_32", binary("binary", 0xffffffffU, 0));
  add_binary("nan", binary("binary", 1, std::numeric_limits<float>::quiet_NaN()));
  add_binary("infinite", binary("binary", 1, std::numeric_limits<float>::infinity()));
  add_binary("denormal", binary("binary", 1, 1e-45F));
  add_binary("largest_float", binary("binary", 1, std::numeric_limits<float>::max()));
}

}  // namespace orbifit
