#include <string>

#include "bad_input/bad_input_lists.h"
#include "files/binary.h"

namespace orbifit {

namespace {

std::string triangle_bytes() {
  std::string bytes;
  for (const float value : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) store(bytes, value);
  for (const std::uint16_t corner : {0, 1, 2, 0}) store(bytes, corner);  // the last one is padding
  return bytes;
}

std::string base64(const std::string& bytes) {
  constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0U);
    }
    for (int k = 3; k >= 0; --k) {
      const bool there = at + static_cast<std::size_t>(3 - k) <= bytes.size();
      text += there ? kLetters[group >> (6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
  }
  return text;
}

const std::string kGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
    R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],)"
    R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],)"
    R"("buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,@"}]})";

std::string glb(std::string json, const std::string& bytes, std::uint32_t version = 2, std::uint32_t more = 0) {
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string file = "glTF";
  store(file, version);
  store(file, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + bytes.size()));
  store(file, static_cast<std::uint32_t>(json.size()));
  file += "JSON" + json;
  store(file, static_cast<std::uint32_t>(bytes.size()) + more);
  return file + std::string("BIN\0", 4) + bytes;
}

void add_scenes(BadInputs& files, const std::string& whole) {
  const auto change = [&](const std::string& what, const std::string& from, const std::string& to) {
    files.push_back({"gltf_" + what + ".gltf", BadInputKind::mesh, with(whole, from, to)});
  };
  change("asset_missing", R"("asset":{"version":"2.0"},)", "");
  change("asset_version_1", "2.0", "1.0");
  change("asset_version_number", R"("2.0")", "2");
  change("scene_beyond", R"("scene":0)", R"("scene":1)");
  change("scene_negative", R"("scene":0)", R"("scene":-1)");
  change("scene_missing", R"("scene":0,"scenes":[{"nodes":[0]}],)", "");
  change("scene_word", R"("scene":0)", R"("scene":"first")");
  change("scene_empty", R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[]}])");
  change("node_beyond", R"("nodes":[0])", R"("nodes":[1])");
  change("node_negative", R"("nodes":[0])", R"("nodes":[-1])");
  change("node_2_64", R"("nodes":[0])", R"("nodes":[18446744073709551616])");
  change("node_2_64_less_1", R"("nodes":[0])", R"("nodes":[18446744073709551615])");
  change("node_twice", R"("nodes":[0])", R"("nodes":[0,0])");
  change("node_own_child", R"({"mesh":0})", R"({"mesh":0,"children":[0]})");
  change("node_cycle", R"([{"mesh":0}])", R"([{"children":[1]},{"children":[2]},{"mesh":0,"children":[0]}])");
  change("node_cycle_unreached", R"([{"mesh":0}])", R"([{"mesh":0},{"children":[2]},{"children":[1]}])");
  change("node_only_cycle", R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}])",
         R"("nodes":[{"mesh":0,"children":[1]},{"children":[0]}])");
  change("node_null", R"([{"mesh":0}])", R"([null])");
  change("node_children_word", R"({"mesh":0})", R"({"mesh":0,"children":"none"})");
  change("node_matrix_short", R"({"mesh":0})", R"({"mesh":0,"matrix":[1,0,0]})");
  change("node_matrix_huge", R"({"mesh":0})", R"({"mesh":0,"matrix":[1e300,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})");
  change("node_matrix_projective", R"({"mesh":0})", R"({"mesh":0,"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]})");
  change("node_matrix_singular", R"({"mesh":0})", R"({"mesh":0,"matrix":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1]})");
  change("node_mirrors", R"({"mesh":0})", R"({"mesh":0,"scale":[-1,1,1]})");
  change("node_scale_0", R"({"mesh":0})", R"({"mesh":0,"scale":[0,1,1]})");
  change("node_rotation_0", R"({"mesh":0})", R"({"mesh":0,"rotation":[0,0,0,0]})");
  change("node_rotation_denormal", R"({"mesh":0})", R"({"mesh":0,"rotation":[5e-324,0,0,0]})");
  change("node_rotation_huge", R"({"mesh":0})", R"({"mesh":0,"rotation":[1e300,0,0,0]})");
  change("node_translation_1e308", R"({"mesh":0})", R"({"mesh":0,"translation":[1e308,0,0]})");
  change("mesh_beyond", R"({"mesh":0})", R"({"mesh":1})");
  change("mesh_without_primitives", R"("primitives")", R"("others")");
  std::string deep = "[";
  for (int n = 0; n < 20'000; ++n) deep += R"({"children":[)" + std::to_string(n + 1) + "]},";
  change("node_depth_20000", R"([{"mesh":0}])", deep + R"({"mesh":0}])");
}

void add_accessors(BadInputs& files, const std::string& whole) {
  const auto change = [&](const std::string& what, const std::string& from, const std::string& to) {
    files.push_back({"gltf_" + what + ".gltf", BadInputKind::mesh, with(whole, from, to)});
  };
  change("mode_points", R"("indices":1})", R"("indices":1,"mode":0})");
  change("mode_strip", R"("indices":1})", R"("indices":1,"mode":5})");
  change("mode_fan", R"("indices":1})", R"("indices":1,"mode":6})");
  change("mode_7", R"("indices":1})", R"("indices":1,"mode":7})");
  change("position_missing", "POSITION", "NORMAL");
  change("position_beyond", R"("POSITION":0)", R"("POSITION":7)");
  change("draco", R"("indices":1})", R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}}})");
  change("draco_of_other_bytes", R"("indices":1})",
         R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}})");
  change("draco_without_view", R"("indices":1})",
         R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"attributes":{"POSITION":0}}}})");
  change("instancing", R"({"mesh":0})", R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}})");
  change("instancing_by_indices", R"({"mesh":0})",
         R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}})");
  change("instancing_by_positions", R"({"mesh":0})",
         R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}})");
  change("indices_beyond", R"("indices":1)", R"("indices":2)");
  change("indices_float", "5123", "5126");
  change("indices_absent", R"(,"indices":1)", "");
  change("indices_of_4", R"("componentType":5123,"count":3)", R"("componentType":5123,"count":4)");
  change("indices_of_2", R"("componentType":5123,"count":3)", R"("componentType":5123,"count":2)");
  change("accessor_count_huge", R"("componentType":5126,"count":3)", R"("componentType":5126,"count":4000000000)");
  change("accessor_count_2_62", R"("componentType":5126,"count":3)",
         R"("componentType":5126,"count":4611686018427387904)");
  change("accessor_count_0", R"("componentType":5126,"count":3)", R"("componentType":5126,"count":0)");
  change("accessor_count_negative", R"("componentType":5126,"count":3)", R"("componentType":5126,"count":-3)");
  change("accessor_count_fraction", R"("componentType":5126,"count":3)", R"("componentType":5126,"count":3.5)");
  change("accessor_type", "VEC3", "VEC2");
  change("accessor_component", "5126", "5130");
  change("accessor_bytes_as_positions", "5126", "5120");
  change("accessor_sparse", R"("type":"VEC3")", R"("type":"VEC3","sparse":{"count":1})");
  const auto sparse = [&](const std::string& what, const std::string& count, const std::string& type) {
    change("accessor_sparse_" + what, R"("type":"VEC3")",
           R"("type":"VEC3","sparse":{"count":)" + count + R"(,"indices":{"bufferView":1,"componentType":)" + type +
               R"(},"values":{"bufferView":0}})");
  };
  sparse("whole", "2", "5123");
  sparse("of_bytes", "2", "5120");
  sparse("huge", "4000000000", "5123");
  sparse("many", "3000", "5121");
  change("accessor_without_view", R"({"bufferView":0,)", "{");
  change("accessor_view_beyond", R"({"bufferView":0,)", R"({"bufferView":9,)");
  change("accessor_offset_beyond", R"({"bufferView":0,)", R"({"bufferView":0,"byteOffset":36,)");
  change("accessor_offset_2_53", R"({"bufferView":0,)", R"({"bufferView":0,"byteOffset":9007199254740991,)");
  change("view_stride_1", R"("byteLength":36})", R"("byteLength":36,"byteStride":1})");
  change("view_stride_0", R"("byteLength":36})", R"("byteLength":36,"byteStride":0})");
  change("view_stride_huge", R"("byteLength":36})", R"("byteLength":36,"byteStride":4000000000})");
  change("view_length_beyond", R"("byteLength":36})", R"("byteLength":360})");
  change("view_length_2_53", R"("byteLength":36})", R"("byteLength":9007199254740991})");
  change("view_offset_beyond", R"("byteOffset":36)", R"("byteOffset":440)");
  change("view_compressed", R"("byteLength":36})", R"("byteLength":36,"extensions":{"EXT_meshopt_compression":{}}})");
  change("view_buffer_beyond", R"({"buffer":0,"byteOffset":0)", R"({"buffer":1,"byteOffset":0)");
}

void add_buffers(BadInputs& files, const std::string& whole) {
  const auto change = [&](const std::string& what, const std::string& from, const std::string& to) {
    files.push_back({"gltf_" + what + ".gltf", BadInputKind::mesh, with(whole, from, to)});
  };
  const std::string uri = whole.substr(whole.find("data:"), whole.rfind("\"}]}") - whole.find("data:"));
  change("buffer_longer_than_data", R"("byteLength":44)", R"("byteLength":4400)");
  change("buffer_length_missing", R"("byteLength":44,)", "");
  change("buffer_without_uri", R"("byteLength":44,"uri":)", R"("byteLength":44,"other":)");
  change("buffer_missing_file", uri, "missing.bin");
  change("buffer_leaves_folder", uri, "../../../../../../etc/passwd");
  change("buffer_absolute", uri, "/etc/passwd");
  change("buffer_leaves_folder_encoded", uri, "%2e%2e%2f%2e%2e%2fetc%2fpasswd");
  change("buffer_leaves_folder_backslash", uri, R"(..\\..\\secret.bin)");
  change("buffer_http", uri, "http://example.org/mesh.bin");
  change("buffer_file_scheme", uri, "file:///etc/passwd");
  change("buffer_folder", uri, ".");
  change("buffer_device", uri, "/dev/zero");
  change("buffer_zero_byte", uri, R"(mesh\u0000.bin)");
  change("buffer_itself", uri, "gltf_buffer_itself.gltf");
  change("buffer_data_not_base64", "base64,", "base64,!!!");
  change("buffer_data_without_comma", "base64,", "base64");
  change("buffer_data_other_media", "application/octet-stream", "text/html");
  change("buffer_data_plain", ";base64", "");
}

}  // namespace

void add_bad_gltf(BadInputs& files) {
  const std::string whole = with(kGltf, "@", base64(triangle_bytes()));
  add_truncated(files, "gltf", ".gltf", BadInputKind::mesh, whole);
  const auto add = [&](const std::string& name, const std::string& content) {
    files.push_back({name, BadInputKind::mesh, content});
  };
  add("gltf_empty.gltf", "");
  add("gltf_whole.gltf", whole);
  add("gltf_list.gltf", "[]");
  add("gltf_null.gltf", "null");
  add("gltf_object.gltf", "{}");
  add("gltf_nested_lists.gltf", std::string(200'000, '['));
  add("gltf_nested_objects.gltf", [] {
    std::string text;
    for (int n = 0; n < 50'000; ++n) text += R"({"a":)";
    return text;
  }());
  add("gltf_comment.gltf", "// made by hand\n" + whole);
  add("gltf_byte_order_mark.gltf", "\xef\xbb\xbf" + whole);
  add("gltf_wrong_utf8.gltf", with(whole, R"("scene":0)", "\"name\":\"\xff\xfe\",\"scene\":0"));
  add_scenes(files, whole);
  add_accessors(files, whole);
  add_buffers(files, whole);

  const std::string inside = with(kGltf, R"(,"uri":"data:application/octet-stream;base64,@")", "");
  const std::string bytes = triangle_bytes();
  add_truncated(files, "glb", ".glb", BadInputKind::mesh, glb(inside, bytes));
  add("glb_whole.glb", glb(inside, bytes));
  add("glb_version_1.glb", glb(inside, bytes, 1));
  add("glb_chunk_too_long.glb", glb(inside, bytes, 2, 1000));
  add("glb_chunk_2_32.glb", glb(inside, bytes, 2, 0xffffff00U));
  add("glb_header_only.glb", glb(inside, bytes).substr(0, 12));
  add("glb_without_binary.glb", glb(inside, ""));
  add("glb_json_damaged.glb", glb(with(inside, "{", "("), bytes));
  add("glb_binary_first.glb", with(glb(inside, bytes), "JSON", std::string("BIN\0", 4)));
  add("glb_nan.glb", [&] {
    std::string spoiled = bytes;
    spoiled.replace(0, 4, std::string("\0\0\xc0\x7f", 4));
    return glb(inside, spoiled);
  }());
  add("glb_index_beyond.glb", glb(inside, bytes.substr(0, 36) + std::string("\0\0\1\0\xff\xff\0\0", 8)));
}

}  // namespace orbifit
