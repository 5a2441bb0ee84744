#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "orbifit/model/mesh.h"

#include "base/random.h"

namespace orbifit {

/// Triangles without regularity, coordinates with all their digits; two vertices at one place and one unused.
inline Mesh ragged_mesh() {
  Random random(5, "ragged mesh");
  Mesh mesh;
  mesh.vertices.resize(40, 3);
  for (double& coordinate : mesh.vertices.reshaped()) coordinate = random.uniform(-3, 1e3) / 7;
  mesh.vertices.row(7) = mesh.vertices.row(3);
  mesh.vertices(2, 1) = 0;
  mesh.vertices(2, 2) = -0.0;
  mesh.vertices(4, 0) = 1e-300;
  mesh.vertices(5, 2) = -12345678901234567.0;
  mesh.faces.resize(60, 3);
  for (int& corner : mesh.faces.reshaped()) corner = static_cast<int>(random.below(39));
  return mesh;
}

/// Two quads, a triangle and a pentagon over a sheet of points.
inline Mesh polygon_mesh() {
  Mesh mesh;
  mesh.vertices.resize(9, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0.1, 2, 0, 0, 0, 1, 0.3, 1, 1, 0, 2, 1, 0.7, 0, 2, 0, 1, 2, 0.2, 2, 2, 0;
  mesh.faces.resize(8, 3);
  mesh.faces << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 3, 4, 6, 4, 5, 8, 4, 8, 7, 4, 7, 6;
  mesh.polygon_of_face = {0, 0, 1, 1, 2, 3, 3, 3};
  return mesh;
}

template <typename Number>
void append_bytes(std::string& bytes, Number number, bool big_endian = false) {
  std::string part(sizeof number, '\0');
  std::memcpy(part.data(), &number, sizeof number);
  if (big_endian) part.assign(part.rbegin(), part.rend());
  bytes += part;
}

/// A PLY as other programs write it, in any encoding; T is the coordinates' type.
template <typename T>
std::string ply_of(const Mesh& mesh, const std::string& encoding) {
  const std::string type = sizeof(T) == 8 ? "double" : "float";
  std::string bytes = "ply\nformat " + encoding + " 1.0\ncomment written by a test\nelement vertex " +
                      std::to_string(mesh.vertices.rows()) + "\nproperty " + type + " x\nproperty " + type +
                      " y\nproperty uchar quality\nproperty " + type + " z\nelement face " +
                      std::to_string(mesh.faces.rows()) +
                      "\nproperty list uchar uint vertex_index\nproperty short flags\nend_header\n";
  const bool ascii = encoding == "ascii";
  const bool big = encoding == "binary_big_endian";
  const auto put = [&](auto number) {
    if (!ascii) return append_bytes(bytes, number, big);
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g ", static_cast<double>(number));
    bytes += buffer;
  };
  const auto end_row = [&] {
    if (ascii) bytes += "\n";
  };
  for (const auto& row : mesh.vertices.rowwise()) {
    put(static_cast<T>(row[0]));
    put(static_cast<T>(row[1]));
    put(std::uint8_t{200});
    put(static_cast<T>(row[2]));
    end_row();
  }
  for (const auto& row : mesh.faces.rowwise()) {
    put(std::uint8_t{3});
    for (const int corner : row) put(static_cast<std::uint32_t>(corner));
    put(std::int16_t{-5});
    end_row();
  }
  return bytes;
}

}  // namespace orbifit
