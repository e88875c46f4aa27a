// The light-weighted table that came as STEP and STL, from file to mesh and modes. The files are
// no part of the project.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "io/json.h"

namespace {

namespace fs = std::filesystem;
using chladni::io::Json;

class Imported : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    file_ = fs::path(CHLADNI_SOURCE_DIR "/../shared/data/wafer-table") / GetParam();
    if (!fs::exists(file_)) GTEST_SKIP() << file_ << " is not here";
    folder_ = fs::temp_directory_path() / ("chladni_imported_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    fs::copy(file_, folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  /// What `chladni VERB` leaves in `name`.
  Json result(const std::string& verb, const std::string& name) const {
    std::ofstream(folder_ / "study.toml")
        << "title = \"table\"\ngeometry = { file = \"" << GetParam() << "\", unit = \"mm\" }\n"
        << "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 "
           "kg/m^3\" }\nmodes = { count = 12 }\n";
    const std::string command = "cd " + folder_.string() +
                                " && " CHLADNI_BINARY_DIR "/bin/chladni " + verb +
                                " study.toml -o out > said 2>&1";
    const int status = std::system(command.c_str());
    EXPECT_EQ(status, 0) << text(folder_ / "said");
    return chladni::io::parse_json(text(folder_ / "out" / name));
  }

  static std::string text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    return bytes.str();
  }

  fs::path file_, folder_;
};

TEST_P(Imported, TableMeshesWellAtTheDefault) {
  const Json mesh = result("mesh", "mesh.json");
  EXPECT_NEAR(mesh.at("volume_m3").number(), 5752800e-9, 1e-9 * 5752800e-9);
  EXPECT_GT(mesh.at("quality").at("smallest_dihedral_degrees").number(), 8.0);
  EXPECT_EQ(mesh.at("order").number(), 3);
  EXPECT_LT(mesh.at("tetrahedra").number(), 45'000);
}

INSTANTIATE_TEST_SUITE_P(WaferTable, Imported,
                         testing::Values("wafer_table.stl", "wafer_table.step"),
                         [](const auto& given) {
                           return given.param.ends_with("stl") ? "Stl" : "Step";
                         });

}  // namespace
