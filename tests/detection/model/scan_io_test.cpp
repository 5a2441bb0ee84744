#include "orbifit/model/scan_io.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "base/random.h"
#include "files/file.h"
#include "mesh_samples.h"
#include "temporary_folder.h"

namespace orbifit {
namespace {

PointCloud sample_scan(bool normals, int viewpoints) {
  Random random(3, "scan");
  PointCloud scan;
  scan.points.resize(25, 3);
  for (double& coordinate : scan.points.reshaped()) coordinate = random.normal() * 10;
  if (normals) {
    scan.normals.resize(25, 3);
    for (int p = 0; p < 25; ++p) scan.normals.row(p) = random.direction().transpose();
  }
  scan.viewpoints.resize(viewpoints, 3);
  for (double& coordinate : scan.viewpoints.reshaped()) coordinate = random.normal() * 30;
  return scan;
}

double largest_difference(const Points& a, const Points& b) {
  if (a.rows() != b.rows()) return std::numeric_limits<double>::infinity();
  return a.rows() == 0 ? 0 : (a - b).cwiseAbs().maxCoeff();
}

struct ScanFormat {
  std::string ending;
  bool exact;
  bool normals;
};

class ScanRoundTrip : public testing::TestWithParam<ScanFormat> {};

TEST_P(ScanRoundTrip, KeepsPointsNormalsAndOrder) {
  const TemporaryFolder folder;
  for (const bool normals : {false, true}) {
    const PointCloud scan = sample_scan(normals, 0);
    const auto file = folder.file("a" + GetParam().ending);
    write_scan(file, scan);
    const PointCloud read = read_scan(file);
    if (GetParam().exact) {
      EXPECT_EQ(read.points, scan.points);
    } else {
      EXPECT_EQ(read.points, scan.points.cast<float>().cast<double>());
    }
    if (GetParam().normals) {
      EXPECT_LT(largest_difference(read.normals, scan.normals), 1e-7);
    } else {
      EXPECT_EQ(read.normals.rows(), 0);
    }
    EXPECT_EQ(read.viewpoints.rows(), 0);
    EXPECT_EQ(read.dropped, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ScanRoundTrip,
                         testing::Values(ScanFormat{".ply", true, true}, ScanFormat{".pcd", false, true},
                                         ScanFormat{".xyz", true, true}, ScanFormat{".pts", true, false}),
                         [](const auto& test) { return test.param.ending.substr(1); });

TEST(Scan, KeepsViewpoints) {
  const TemporaryFolder folder;
  for (const char* name : {"a.ply", "a.pcd"}) {
    const PointCloud each = sample_scan(true, 25);
    write_scan(folder.file(name), each);
    EXPECT_LT(largest_difference(read_scan(folder.file(name)).viewpoints, each.viewpoints), 1e-5) << name;
  }
  const PointCloud common = sample_scan(false, 1);
  write_scan(folder.file("b.pcd"), common);
  EXPECT_EQ(read_scan(folder.file("b.pcd")).viewpoints, common.viewpoints);
  write_scan(folder.file("b.ply"), common);
  EXPECT_EQ(read_scan(folder.file("b.ply")).viewpoints, common.viewpoints.replicate(25, 1));
}

TEST(Scan, LeavesOutPointsThatAreNotFinite) {
  const TemporaryFolder folder;
  PointCloud scan = sample_scan(true, 25);
  scan.points(3, 1) = std::numeric_limits<double>::quiet_NaN();
  scan.points(9, 0) = -std::numeric_limits<double>::infinity();
  write_scan(folder.file("a.ply"), scan);
  const PointCloud read = read_scan(folder.file("a.ply"));
  EXPECT_EQ(read.dropped, 2);
  ASSERT_EQ(read.points.rows(), 23);
  EXPECT_EQ(read.normals.rows(), 23);
  EXPECT_EQ(read.points.row(3), scan.points.row(4));
  EXPECT_EQ(read.viewpoints.row(22), scan.viewpoints.row(24));
}

TEST(Scan, AMeshServes) {
  const TemporaryFolder folder;
  const Mesh mesh = ragged_mesh();
  for (const char* name : {"a.obj", "a.off", "a.ply"}) {
    write_mesh(folder.file(name), mesh);
    EXPECT_EQ(read_scan(folder.file(name)).points, mesh.vertices) << name;
  }
  EXPECT_EQ(read_scan(folder.write("points.obj", "v 1 2 3\n")).points.rows(), 1);
}

TEST(Xyz, TellsNormalsFromColours) {
  const TemporaryFolder folder;
  const std::string normals = "x,y,z,nx,ny,nz\n1,2,3,0,0,1\n4;5;6;0;0.6;0.8\n";
  EXPECT_EQ(read_scan(folder.write("a.xyz", normals)).normals.rows(), 2);
  const PointCloud colours = read_scan(folder.write("b.xyz", "# c\n1 2 3 255 0 0\n4 5 6 0 1 0\n"));
  EXPECT_EQ(colours.normals.rows(), 0);
  EXPECT_EQ(colours.points.row(1), Eigen::RowVector3d(4, 5, 6));
}

TEST(Pts, ReadsScansOneAfterAnother) {
  const TemporaryFolder folder;
  const PointCloud scan = read_scan(folder.write("a.pts", "2\n0 0 0 -500 1 2 3\n1 0 0\n1\n2 2 2 7\n"));
  EXPECT_EQ(scan.points.rows(), 3);
}

std::string pcd_head(const std::string& data, int points = 2) {
  return "# .PCD v.7\nVERSION .7\nFIELDS x y z rgb normal_x normal_y normal_z _\nSIZE 4 4 4 4 4 4 4 1\n"
         "TYPE F F F U F F F U\nCOUNT 1 1 1 1 1 1 1 2\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " +
         data + "\n";
}

// Two points with colour, normal and two bytes of padding; row by row, or field by field as compressed files are.
std::string pcd_rows(bool field_by_field) {
  const float values[2][6] = {{1, 2, 3, 0, 0, 1}, {4, 5, 6, 0, 1, 0}};
  std::string bytes;
  const auto number = [&](int row, int k) { append_bytes(bytes, values[row][k]); };
  const auto colour = [&] { append_bytes(bytes, std::uint32_t{0xFF00FF}); };
  if (!field_by_field) {
    for (int row = 0; row < 2; ++row) {
      for (int k = 0; k < 3; ++k) number(row, k);
      colour();
      for (int k = 3; k < 6; ++k) number(row, k);
      bytes += "\x01\x02";
    }
    return bytes;
  }
  for (int k = 0; k < 6; ++k) {
    if (k == 3) {
      colour();
      colour();
    }
    for (int row = 0; row < 2; ++row) number(row, k);
  }
  return bytes + "\x01\x02\x01\x02";
}

void expect_pcd(const PointCloud& scan) {
  ASSERT_EQ(scan.points.rows(), 2);
  EXPECT_EQ(scan.points.row(1), Eigen::RowVector3d(4, 5, 6));
  ASSERT_EQ(scan.normals.rows(), 2);
  EXPECT_EQ(scan.normals.row(1), Eigen::RowVector3d(0, 1, 0));
  EXPECT_EQ(scan.viewpoints, Points(Eigen::RowVector3d(1, 2, 3)));
}

// Literal runs only: LZF that any decoder must accept.
std::string lzf_literals(const std::string& bytes) {
  std::string packed;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  return packed;
}

std::string compressed(const std::string& packed, std::size_t size) {
  std::string bytes;
  append_bytes(bytes, static_cast<std::uint32_t>(packed.size()));
  append_bytes(bytes, static_cast<std::uint32_t>(size));
  return bytes + packed;
}

TEST(Pcd, ReadsEveryEncoding) {
  const TemporaryFolder folder;
  expect_pcd(read_scan(folder.write("a.pcd", pcd_head("ascii") + "1 2 3 255 0 0 1 0 0\n4 5 6 255 0 1 0 0 0\n")));
  expect_pcd(read_scan(folder.write("b.pcd", pcd_head("binary") + pcd_rows(false))));
  const std::string rows = pcd_rows(true);
  expect_pcd(
      read_scan(folder.write("c.pcd", pcd_head("binary_compressed") + compressed(lzf_literals(rows), rows.size()))));
}

TEST(Pcd, UndoesBackReferences) {
  const TemporaryFolder folder;
  const std::string head =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 100\nHEIGHT 1\nPOINTS 100\nDATA "
      "binary_compressed\n";
  std::string one;
  append_bytes(one, 1.5F);
  // The first number, then copies of the four bytes before: 264 + 264 + 264 + 264 + 140 = 1196 bytes.
  std::string packed = std::string("\x03", 1) + one;
  for (int copy = 0; copy < 4; ++copy) packed += std::string("\xE0\xFF\x03", 3);
  packed += std::string("\xE0\x83\x03", 3);
  const PointCloud scan = read_scan(folder.write("a.pcd", head + compressed(packed, 1200)));
  EXPECT_EQ(scan.points, Points(Points::Constant(100, 3, 1.5)));
}

struct BrokenScan {
  std::string name, file, content, message;
};

std::vector<BrokenScan> broken_scans() {
  const std::string rows = pcd_rows(false);
  return {
      {"Empty", "a.ply", "", "is empty"},
      {"UnknownEnding", "a.las", "x", "unknown ending '.las'"},
      {"XyzEmpty", "a.xyz", "# only this\n", "has no points"},
      {"XyzNanOnly", "a.xyz", "nan 0 0\n0 0 inf\n", "has no finite point (2 are not)"},
      {"XyzWord", "a.xyz", "0 0 0\n1 two 3\n", "line 2: '1 two 3' is not a row of numbers"},
      {"XyzTwo", "a.xyz", "0 0 0\n1 2\n", "line 2: a point needs three coordinates"},
      {"XyzHuge", "a.xyz", "0 0 0\n1e200 0 0\n", "line 2: coordinate x is 1e+200: beyond 1e50"},
      {"PtsCount", "a.pts", "0 0 0\n", "line 1: the number of points must stand here"},
      {"PtsFew", "a.pts", "4000000000\n0 0 0\n", "the file ends after 1 of 4000000000 points"},
      {"PcdHeader", "a.pcd", "VERSION .7\nFIELDS x y\n", "the file ends before the line DATA"},
      {"PcdWord", "a.pcd", "hello\n", "line 1: not a PCD header"},
      {"PcdNoZ", "a.pcd", "FIELDS x y\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2\n", "the FIELDS lack x, y and z"},
      {"PcdData", "a.pcd", pcd_head("zip"), "DATA 'zip'"},
      {"PcdAsciiFew", "a.pcd", pcd_head("ascii") + "1 2 3 4 5 6 7 0 0\n", "the file ends after 1 of 2 points"},
      {"PcdAsciiShort", "a.pcd", pcd_head("ascii") + "1 2 3\n", "line 12: the line has fewer numbers"},
      {"PcdTruncated", "a.pcd", pcd_head("binary") + rows.substr(0, rows.size() - 1), "point 1: the file is truncated"},
      {"PcdHugeCount", "a.pcd", pcd_head("binary", 2000000000) + rows,
       "its header announces 2000000000 points, it holds 2"},
      {"PcdCompressedShort", "a.pcd", pcd_head("binary_compressed") + "abc", "the file is truncated"},
      {"PcdCompressedDamaged", "a.pcd", pcd_head("binary_compressed") + compressed("\xE0\xFF\x03", 60),
       "data are damaged"},
      {"PcdCompressedHuge", "a.pcd", pcd_head("binary_compressed") + compressed("abc", 4000000000), "data are damaged"},
      {"PlyNoPoints", "a.ply",
       "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
       "has no points"},
  };
}

class BrokenScanFile : public testing::TestWithParam<BrokenScan> {};

TEST_P(BrokenScanFile, IsRefusedWithFilePlaceAndReason) {
  const TemporaryFolder folder;
  const auto file = folder.write(GetParam().file, GetParam().content);
  try {
    read_scan(file);
    ADD_FAILURE() << "was read";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, BrokenScanFile, testing::ValuesIn(broken_scans()),
                         [](const auto& test) { return test.param.name; });

class ScanDamage : public testing::TestWithParam<std::string> {};

TEST_P(ScanDamage, GivesAScanOrAnError) {
  const TemporaryFolder folder;
  const auto file = folder.file("a" + GetParam().substr(0, 4));
  std::string content;
  if (GetParam() == ".pcd_compressed") {
    const std::string rows = pcd_rows(true);
    content = pcd_head("binary_compressed") + compressed(lzf_literals(rows), rows.size());
  } else {
    write_scan(file, sample_scan(true, 25));
    content = read_file(file);
  }
  int errors = 0;
  const auto read = [&](const std::string& damaged) {
    folder.write(file.filename().string(), damaged);
    try {
      const PointCloud scan = read_scan(file);
      ASSERT_GT(scan.points.rows(), 0);
      ASSERT_TRUE(scan.points.allFinite());
      ASSERT_TRUE(scan.normals.rows() == 0 || scan.normals.rows() == scan.points.rows());
    } catch (const InputError&) {
      ++errors;
    }
  };
  for (std::size_t length = 0; length < content.size(); ++length) read(content.substr(0, length));
  Random random(12, GetParam());
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = content;
    for (std::uint64_t flips = 1 + random.below(4); flips > 0; --flips) {
      damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    }
    read(damaged);
  }
  EXPECT_GT(errors, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, ScanDamage, testing::Values(".ply", ".pcd", ".xyz", ".pts", ".pcd_compressed"),
                         [](const auto& test) { return test.param.substr(1); });

}  // namespace
}  // namespace orbifit
