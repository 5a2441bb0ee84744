#include <string>

#include "bad_input/bad_input_lists.h"

namespace orbifit {

namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

std::string utf16(const std::string& text) {
  std::string result = "\xff\xfe";
  for (const char letter : text) result += {letter, '\0'};
  return result;
}

std::string with_line_ends(const std::string& text, const std::string& end) {
  std::string result;
  for (const char letter : text) result += letter == '\n' ? end : std::string(1, letter);
  return result;
}

void add_obj_faces(const AddText& add) {
  add("index_zero", kTriangle + "f 0 1 2\n");
  add("index_beyond", kTriangle + "f 1 2 4\n");
  add("index_negative", kTriangle + "f -3 -2 -1\n");
  add("index_too_negative", kTriangle + "f -4 -2 -1\n");
  add("index_2_31", kTriangle + "f 1 2 2147483648\n");
  add("index_2_63", kTriangle + "f 1 2 9223372036854775808\n");
  add("index_least", kTriangle + "f 1 2 -9223372036854775808\n");
  add("index_fraction", kTriangle + "f 1 2 2.5\n");
  add("index_word", kTriangle + "f 1 2 three\n");
  add("index_slashes", kTriangle + "f 1//1 2//1 3//1\n");
  add("index_slash_first", kTriangle + "f /1 /2 /3\n");
  add("index_many_slashes", kTriangle + "f 1/1/1/1 2/2/2/2 3///\n");
  add("face_of_two", kTriangle + "f 1 2\n");
  add("face_of_none", kTriangle + "f\n");
  add("face_before_vertices", "f 1 2 3\n" + kTriangle);
  add("face_repeats_corner", kTriangle + "f 1 1 2\n");
  add("faces_missing", kTriangle);
}

void add_obj_vertices(const AddText& add) {
  add("vertex_of_two", "v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_of_none", "v\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_with_colour", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
  add("vertex_word", "v 0 zero 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_nan", "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_infinite", "v 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_negative_infinite", "v 0 0 -infinity\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_overflows", "v 0 1e400 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_1e300", "v 0 1e300 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_1e50", "v 0 1e50 0\nv 1 0 0\nv 0 -1e50 0\nf 1 2 3\n");
  add("vertex_1e51", "v 0 1e51 0\nv 1 0 0\nv 0 -1e51 0\nf 1 2 3\n");
  add("vertex_denormal", "v 0 0 0\nv 4.9e-324 0 0\nv 0 4.9e-324 0\nf 1 2 3\n");
  add("vertex_underflows", "v 0 0 0\nv 1e-400 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_hexadecimal", "v 0x1p3 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_comma", "v 0,5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_plus", "v +0.5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_two_points", "v 0.5.1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  add("vertex_many_digits", "v 0." + std::string(100'000, '3') + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
}

void add_obj_encodings(const AddText& add) {
  add("crlf", with_line_ends(kTriangle + "f 1 2 3\n", "\r\n"));
  add("cr", with_line_ends(kTriangle + "f 1 2 3\n", "\r"));
  add("byte_order_mark", "\xef\xbb\xbf" + kTriangle + "f 1 2 3\n");
  add("utf16", utf16(kTriangle + "f 1 2 3\n"));
  add("zero_bytes", kTriangle + std::string("f 1 2\0 3\n", 9));
  add("binary", std::string("\x7f"
                            "ELF\x02\x01\x01\0\0\0\xff\xfe",
                            12));
  add("latin_1_comment",
      "# gr\xf6\xdf"
      "er\n" +
          kTriangle + "f 1 2 3 # \xe9\n");
}

void add_obj_lines(const AddText& add) {
  add("comment_in_line", "v 0 0 0 # here\nv 1 0 0#there\nv 0 1 0\nf 1 2 3 # 4\n");
  add("continued_line", "v 0 0 0\nv 1 0 \\\n0\nv 0 1 0\nf 1 2 \\\n3\n");
  add("no_line_end", kTriangle + "f 1 2 3");
  add("unknown_words", "vx 1 2\nmystery\n" + kTriangle + "s off\nusemtl none\nf 1 2 3\nend\n");
  add("long_line", kTriangle + "# " + std::string(1 << 20, 'x') + "\nf 1 2 3\n");
  add("long_word", kTriangle + "f 1 2 " + std::string(1 << 16, '9') + "\n");
  add("polygon_of_10000", [] {
    std::string text;
    std::string face = "f";
    for (int v = 1; v <= 10'000; ++v) {
      text += "v " + std::to_string(v) + " " + std::to_string(v % 7) + " 0\n";
      face += " " + std::to_string(v);
    }
    return text + face + "\n";
  }());
  add("free_form", "vp 0 1\ncstype bezier\ndeg 2\ncurv 0 1 1 2 3\nend\n" + kTriangle + "f 1 2 3\n");
  add("cut_in_number", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 0 -");
  add("cut_in_face", kTriangle + "f 1 2 3\nf 1 2");
}

}  // namespace

void add_bad_obj(BadInputs& files) {
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({"obj_" + what + ".obj", BadInputKind::mesh, content});
  };
  add("empty", "");
  add("blanks", " \n\t\n\r\n");
  add("comments_only", "# nothing\n# at all\n");
  add_obj_faces(add);
  add_obj_vertices(add);
  add_obj_encodings(add);
  add_obj_lines(add);
}

void add_bad_off(BadInputs& files) {
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({"off_" + what + ".off", BadInputKind::mesh, content});
  };
  const std::string whole = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  add_truncated(files, "off", ".off", BadInputKind::mesh, whole);
  add("empty", "");
  add("other_word", with(whole, "OFF", "FOO"));
  add("counts_beside_word", with(whole, "OFF\n", "OFF "));
  add("no_word", with(whole, "OFF\n", ""));
  add("binary", with(whole, "OFF", "OFF BINARY"));
  add("four_dimensions", with(whole, "OFF", "4OFF"));
  add("colours", with(whole, "OFF", "COFF"));
  add("count_huge", with(whole, "3 1 0", "3000000000 1 0"));
  add("count_overflows", with(whole, "3 1 0", "99999999999999999999 1 0"));
  add("count_negative", with(whole, "3 1 0", "-3 1 0"));
  add("faces_huge", with(whole, "3 1 0", "3 9223372036854775807 0"));
  add("faces_none", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
  add("all_none", "OFF\n0 0 0\n");
  add("vertices_too_few", with(whole, "3 1 0", "4 1 0"));
  add("vertices_too_many", with(whole, "3 1 0", "2 1 0"));
  add("corners_huge", with(whole, "3 0 1 2", "1000000000 0 1 2"));
  add("corners_negative", with(whole, "3 0 1 2", "-3 0 1 2"));
  add("corners_two", with(whole, "3 0 1 2", "2 0 1"));
  add("index_beyond", with(whole, "3 0 1 2", "3 0 1 3"));
  add("index_negative", with(whole, "3 0 1 2", "3 0 1 -1"));
  add("index_huge", with(whole, "3 0 1 2", "3 0 1 4294967296"));
  add("nan", with(whole, "1 0 0", "nan 0 0"));
  add("1e300", with(whole, "1 0 0", "1e300 0 0"));
  add("comments", "# first\nOFF # word\n# counts\n3 1 0 # these\n\n0 0 0\n# between\n1 0 0 # beside\n0 1 0\n3 0 1 2\n");
  add("crlf", "OFF\r\n3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n");
  add("byte_order_mark", "\xef\xbb\xbf" + whole);
  add("more_after_end", whole + "3 0 1 2\n");
  add("face_colours", with(whole, "3 0 1 2", "3 0 1 2 0.5 0.5 0.5 1"));
}

}  // namespace orbifit
