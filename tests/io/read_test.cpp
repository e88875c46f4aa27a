#include "io/read.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "mesh/check.h"
#include "tests/io/samples.h"

namespace chladni::io {
namespace {

class Read : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("chladni_read_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path written(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  std::filesystem::path folder_;
};

const std::string kTriangles =
    "OFF\n4 4 6\n0 0 0\n1000 0 0\n0 1000 0\n0 0 1000\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

TEST_F(Read, NumbersBecomeMetres) {
  const auto file = written("tet.off", kTriangles);
  const auto in_mm = std::get<mesh::Surface>(read_geometry(file, "mm").body);
  const auto in_inch = std::get<mesh::Surface>(read_geometry(file, "inch").body);
  EXPECT_NEAR(mesh::enclosed_volume(in_mm), 1.0 / 6.0, 1e-15);
  EXPECT_TRUE(in_inch.points.isApprox(25.4 * in_mm.points, 1e-14));
}

TEST_F(Read, TellsReadersByTheEndingWhateverItsCase) {
  for (const char* name : {"tet.OFF", "tet.Off"}) {
    EXPECT_NO_THROW(static_cast<void>(read_geometry(written(name, kTriangles), "m")));
  }
  const auto tets = read_geometry(written("box.MSH", sample("msh/box_41.msh")), "mm");
  EXPECT_NEAR(mesh::volume(std::get<mesh::TetMesh>(tets.body)), 3e-9, 1e-20);
  EXPECT_EQ(tets.notes.size(), 1U);
  const auto deck = read_geometry(written("box.inp", sample("inp/box_gmsh_quadratic.inp")), "m");
  EXPECT_NEAR(mesh::volume(std::get<mesh::TetMesh>(deck.body)), 3.0, 1e-12);
  EXPECT_TRUE(says(refusal([&] { return read_geometry(written("a.iges", ""), "mm"); }),
                   "ending '.iges', expected .step"));
}

TEST_F(Read, WantsAUnitWhereTheFormatHasNone) {
  const auto file = written("tet.off", kTriangles);
  EXPECT_TRUE(
      says(refusal([&] { return read_geometry(file, ""); }), "expected one: unit = \"mm\""));
  EXPECT_THROW(static_cast<void>(read_geometry(file, "kg")), InvalidInput);
}

TEST_F(Read, NamesFileLineAndWhatWasExpected) {
  const auto file = written("wafer.stl",
                            "solid wafer\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
                            "   vertex 1,5 0 0\n");
  EXPECT_TRUE(says(refusal([&] { return read_geometry(file, "mm"); }), "wafer.stl: line 5: "));
  EXPECT_TRUE(says(refusal([&] { return read_geometry(file, "mm"); }),
                   "found '1,5', expected a number with a decimal point"));
}

TEST_F(Read, TextInUtf16IsCalledSo) {
  for (const auto* ending : {".stl", ".off", ".ply", ".obj", ".msh", ".inp", ".step", ".stp"}) {
    for (const std::string mark : {"\xFF\xFE", ""}) {
      std::string wide = mark;
      for (const char c : std::string("solid wafer\n facet normal 0 0 1\n")) wide += {c, '\0'};
      const auto file = written(std::string("wide") + ending, wide);
      EXPECT_TRUE(says(refusal([&] { return read_geometry(file, "mm"); }),
                       "this file is text in UTF-16; save it as UTF-8"))
          << ending;
    }
  }
}

TEST_F(Read, TakesRegularFilesOnly) {
  for (const char* ending : {".stl", ".off", ".ply", ".obj", ".msh", ".inp", ".vtu", ".step"}) {
    const auto gone = folder_ / (std::string("gone") + ending);
    const auto a_folder = folder_ / (std::string("folder") + ending);
    const auto fifo = folder_ / (std::string("fifo") + ending);
    const auto zero = folder_ / (std::string("zero") + ending);
    std::filesystem::create_directory(a_folder);
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    std::filesystem::create_symlink("/dev/zero", zero);
    for (const auto& file : {gone, a_folder, fifo, zero}) {
      EXPECT_TRUE(says(refusal([&] { return read_geometry(file, "mm"); }), file.string()));
    }
  }
}

TEST_F(Read, ReadsTheWaferTable) {
  const std::filesystem::path file =
      CHLADNI_SOURCE_DIR "/../shared/data/wafer-table/wafer_table.stl";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  auto table = std::get<mesh::Surface>(read_geometry(file, "mm").body);
  EXPECT_EQ(table.triangles.rows(), 2120);
  EXPECT_EQ(table.points.rows(), 1062);  // closed and of genus 0: 2 + 2120 / 2
  // 500 of its triangles are inside out: read as they stand, turned by the check of the surface.
  EXPECT_TRUE(mesh::check_and_repair(table).fit());
  EXPECT_NEAR(mesh::enclosed_volume(table) * 1e9, 5752800.0, 1e-6 * 5752800.0);
}

}  // namespace
}  // namespace chladni::io
