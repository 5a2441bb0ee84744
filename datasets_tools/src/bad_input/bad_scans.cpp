#include <string>

#include "bad_input/bad_input_lists.h"
#include "files/binary.h"

namespace orbifit {

namespace {

const std::string kPcd =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n0 0 0\n1 0 0\n0 1 0\n";

void add_ascii_pcd(BadInputs& files) {
  const auto change = [&](const std::string& what, const std::string& from, const std::string& to) {
    files.push_back({"pcd_" + what + ".pcd", BadInputKind::scan, with(kPcd, from, to)});
  };
  add_truncated(files, "pcd", ".pcd", BadInputKind::scan, kPcd);
  files.push_back({"pcd_empty.pcd", BadInputKind::scan, ""});
  files.push_back({"pcd_byte_order_mark.pcd", BadInputKind::scan, "\xef\xbb\xbf" + kPcd});
  change("word_unknown", "VERSION 0.7", "VERSIONS 0.7");
  change("fields_missing", "FIELDS x y z\n", "");
  change("fields_without_z", "FIELDS x y z", "FIELDS x y w");
  change("fields_twice", "FIELDS x y z", "FIELDS x x x y z");
  change("sizes_too_few", "SIZE 4 4 4", "SIZE 4 4");
  change("size_3", "SIZE 4 4 4", "SIZE 3 3 3");
  change("size_huge", "SIZE 4 4 4", "SIZE 4 4 4000000000");
  change("type_unknown", "TYPE F F F", "TYPE F F Q");
  change("type_integer", "TYPE F F F", "TYPE I I I");
  change("count_0", "COUNT 1 1 1", "COUNT 0 1 1");
  change("count_huge", "COUNT 1 1 1", "COUNT 1 1 2000000000");
  change("count_negative", "COUNT 1 1 1", "COUNT 1 1 -1");
  change("width_huge", "WIDTH 3\nHEIGHT 1", "WIDTH 4000000000\nHEIGHT 4000000000");
  change("points_huge", "POINTS 3", "POINTS 9000000000000000000");
  change("points_negative", "POINTS 3", "POINTS -3");
  change("points_too_many", "POINTS 3", "POINTS 4");
  change("points_too_few", "POINTS 3", "POINTS 2");
  change("points_missing", "POINTS 3\n", "");
  change("points_none", "WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n0 0 0\n1 0 0\n0 1 0\n",
         "WIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA ascii\n");
  change("viewpoint_nan", "VIEWPOINT 0 0 0", "VIEWPOINT nan 0 0");
  change("viewpoint_short", "VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 0 0");
  change("data_unknown", "DATA ascii", "DATA text");
  change("nan", "1 0 0", "nan nan nan");
  change("all_nan", "0 0 0\n1 0 0\n0 1 0\n", "nan 0 0\nnan 0 0\nnan 0 0\n");
  change("1e300", "1 0 0", "1e300 0 0");
  change("word", "1 0 0", "one 0 0");
  change("row_short", "1 0 0", "1 0");
  change("comments", "SIZE 4 4 4\n", "# between\n\nSIZE 4 4 4 # beside\n");
}

void add_binary_pcd(BadInputs& files) {
  const std::string header = with(kPcd.substr(0, kPcd.find("0 0 0\n1")), "DATA ascii", "DATA binary");
  std::string body;
  for (const float value : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) store(body, value);
  const auto add = [&](const std::string& what, const std::string& content) {
    files.push_back({"pcdb_" + what + ".pcd", BadInputKind::scan, content});
  };
  add("whole", header + body);
  add("cut_at_header", header);
  add("cut_in_point", header + body.substr(0, 17));
  add("points_too_many", with(header, "POINTS 3", "POINTS 4") + body);
  add("points_2_60", with(header, "POINTS 3", "POINTS 1152921504606846976") + body);
  const std::string compressed = with(header, "DATA binary", "DATA binary_compressed");
  const auto packed = [&](std::uint32_t size, std::uint32_t whole, const std::string& data) {
    std::string bytes = compressed;
    store(bytes, size);
    store(bytes, whole);
    return bytes + data;
  };
  const std::string literal = "\x1f" + body.substr(0, 32) + "\x03" + body.substr(32);  // runs of 32 and 4 letters
  const auto size = static_cast<std::uint32_t>(literal.size());
  add("packed", packed(size, 36, literal));
  add("packed_run", packed(5, 36, std::string("\0a\xe0\x1a\0", 5)));  // one letter, then 35 times the one before
  add("packed_nothing", compressed);
  add("packed_cut", packed(size, 36, literal.substr(0, 20)));
  add("packed_size_2_32", packed(0xffffffffU, 36, literal));
  add("packed_whole_2_32", packed(size, 0xffffffffU, literal));
  add("packed_whole_too_small", packed(size, 12, literal));
  add("packed_run_before_begin", packed(3, 36, std::string("\xe0\xff\xff", 3)));
  add("packed_run_beyond_end", packed(4, 36, std::string("\0a\xe0\xff", 4)));
  add("packed_bomb", packed(5, 0x7fffffffU, std::string("\0a\xe0\xff\0", 5)));
}

void add_text_points(BadInputs& files) {
  const auto add = [&](const std::string& name, const std::string& content) {
    files.push_back({name, BadInputKind::scan, content});
  };
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  add("xyz_empty.xyz", "");
  add("xyz_comments.xyz", "# nothing\n");
  add("xyz_two_numbers.xyz", "0 0\n");
  add("xyz_word.xyz", points + "1 0 zero\n");
  add("xyz_header_words.xyz", "x y z\n" + points);
  add("xyz_commas.xyz", "0,0,0\n1,0,0\n0,1,0\n");
  add("xyz_semicolons.xyz", "0;0;0\n1;0;0\n");
  add("xyz_nan.xyz", points + "nan 0 0\n");
  add("xyz_all_infinite.xyz", "inf 0 0\n");
  add("xyz_1e300.xyz", points + "1e300 0 0\n");
  add("xyz_denormal.xyz", "5e-324 0 0\n0 5e-324 0\n0 0 5e-324\n");
  add("xyz_normals_0.xyz", "0 0 0 0 0 0\n1 0 0 0 0 0\n");
  add("xyz_normals_some.xyz", "0 0 0 0 0 1\n1 0 0\n");
  add("xyz_seven_columns.xyz", "0 0 0 0 0 1 9\n1 0 0 0 0 1 9\n");
  add("xyz_crlf.xyz", "0 0 0\r\n1 0 0\r\n");
  add("xyz_byte_order_mark.xyz", "\xef\xbb\xbf" + points);
  add("xyz_binary.xyz", std::string("\x7f"
                                    "ELF\0\1\2\3",
                                    8));
  add("xyz_one_point.xyz", "1 2 3\n");
  add("xyz_cut.xyz", "0 0 0\n1 0");
  add("pts_whole.pts", "3\n" + points);
  add("pts_count_missing.pts", points);
  add("pts_count_huge.pts", "4000000000\n" + points);
  add("pts_count_too_large.pts", "4\n" + points);
  add("pts_count_too_small.pts", "2\n" + points);
  add("pts_count_negative.pts", "-3\n" + points);
  add("pts_word.pts", "3\n0 0 0\none 0 0\n0 1 0\n");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nend_header\n";
  add("plys_normals_nan.ply", ply + "0 0 0 nan 0 0\n1 0 0 0 0 1\n");
  add("plys_nan.ply", ply + "nan 0 0 0 0 1\n1 0 0 0 0 1\n");
  add("plys_all_nan.ply", ply + "nan 0 0 0 0 1\n1 nan 0 0 0 1\n");
  add("plys_normals_lists.ply", with(ply, "float nx", "list uchar float nx") + "0 0 0 1 0 0 0\n1 0 0 0 0 0\n");
  add("plys_cut.ply", ply + "0 0 0 0 0 1\n");
  add("plys_without_vertices.ply",
      "ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n");
}

}  // namespace

void add_bad_scans(BadInputs& files) {
  add_ascii_pcd(files);
  add_binary_pcd(files);
  add_text_points(files);
}

}  // namespace orbifit
