// The small bodies in tests/io/data were written by OpenCASCADE 7.6.
#include "io/surface/step.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/read.h"
#include "mesh/tetrahedralize.h"
#include "rotation/turn.h"
#include "tests/io/samples.h"

namespace chladni::io {
namespace {

class Step : public testing::Test {
 protected:
  void SetUp() override {
#ifdef CHLADNI_WITH_STEP
    setenv("CHLADNI_LIBEXEC", CHLADNI_BINARY_DIR "/bin", 1);
#else
    GTEST_SKIP() << "built without OpenCASCADE: STEP is refused, and that is tested below";
#endif
  }
};

std::filesystem::path data(const std::string& name) {
  return std::string(CHLADNI_SOURCE_DIR) + "/tests/io/data/" + name;
}

mesh::Surface surface_of(const std::filesystem::path& file, const std::string& unit = "") {
  return std::get<mesh::Surface>(read_geometry(file, unit).body);
}

// Every edge is there twice, once each way: closed, manifold, oriented.
void expect_watertight(const mesh::Surface& surface) {
  std::map<std::pair<int, int>, int> uses;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      ++uses[{surface.triangles(t, k), surface.triangles(t, (k + 1) % 3)}];
    }
  }
  for (const auto& [edge, count] : uses) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(uses.contains({edge.second, edge.first}));
  }
}

TEST_F(Step, PlateWithAHoleIsClosedAndHasItsFaces) {
  const auto plate = surface_of(data("plate_with_hole.step"));
  expect_watertight(plate);
  const double exact = (60 * 40 - std::numbers::pi * 64) * 10 * 1e-9;
  EXPECT_NEAR(mesh::enclosed_volume(plate), exact, 2e-4 * exact);
  EXPECT_EQ(plate.patch_names.size(), 7U);
  EXPECT_EQ(plate.patch_names[0], "face_1");
  const auto box = mesh::bounding_box(plate.points);
  EXPECT_TRUE(box.row(1).isApprox(Eigen::RowVector3d(0.06, 0.04, 0.01), 1e-12));
}

// OpenCASCADE reads them and does not end.
TEST_F(Step, CoordinatesThatAreNoNumbersAreRefusedByTheirLine) {
  const std::string whole = read_whole(data("plate_with_hole.step"));
  const auto place = whole.find("CARTESIAN_POINT('',(") + 20;
  const auto end = whole.find(',', place);
  const auto line = 1 + std::count(whole.begin(), whole.begin() + static_cast<long>(place), '\n');
  const auto file = std::filesystem::temp_directory_path() /
                    ("chladni_step_" + std::to_string(getpid()) + ".step");
  for (const std::string word : {"NaN", "-nan", "inf", "-Infinity", "1.#QNAN"}) {
    std::string bytes = whole;
    bytes.replace(place, end - place, word);
    write_atomically(file, bytes);
    try {
      (void)surface_of(file);
      ADD_FAILURE() << word << " is taken";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("line " + std::to_string(line) + ": found "),
                std::string::npos)
          << error.what();
    }
  }
  std::string named = whole;  // a text may say what it likes
  named.replace(named.find("CARTESIAN_POINT('") + 17, 0, "(nan,inf)");
  write_atomically(file, named);
  EXPECT_NO_THROW((void)surface_of(file));
  std::filesystem::remove(file);
}

TEST_F(Step, SeamsArePutTogether) {
  const auto cylinder = surface_of(data("cylinder_inch.step"));  // radius 1 inch, height 2
  expect_watertight(cylinder);
  const double exact = std::numbers::pi * 2 * 0.0254 * 0.0254 * 0.0254;
  EXPECT_NEAR(mesh::enclosed_volume(cylinder), exact, 1e-2 * exact);
  EXPECT_LT(mesh::enclosed_volume(cylinder), exact);  // inscribed
  EXPECT_EQ(cylinder.patch_names.size(), 3U);
}

TEST_F(Step, PolesArePutTogether) {
  const auto sphere = surface_of(data("sphere.step"));  // radius 0.1, in metres
  expect_watertight(sphere);
  const double exact = 4.0 / 3.0 * std::numbers::pi * 1e-3;
  EXPECT_NEAR(mesh::enclosed_volume(sphere), exact, 1e-2 * exact);
  EXPECT_LT(mesh::enclosed_volume(sphere), exact);
}

TEST_F(Step, TheUnitIsTheFilesOwn) {
  const auto own = surface_of(data("cylinder_inch.step"));
  EXPECT_EQ(surface_of(data("cylinder_inch.step"), "inch").points, own.points);
  EXPECT_TRUE(says(refusal([] { return surface_of(data("cylinder_inch.step"), "mm"); }),
                   "the file's length unit is 'INCH', not 'mm'"));
  const auto geometry = read_geometry(data("sphere.step"), "");
  ASSERT_EQ(geometry.notes.size(), 1U);
  EXPECT_TRUE(says(geometry.notes[0], "length unit metre, from the file"));
}

// 60 x 40 x 10 mm, fillets of 8 mm on the uprights and 2 mm around the top, bores of 12 and 3 mm.
TEST_F(Step, ADrilledAndFilletedPartMeshesWell) {
  EVERY_FOURTH_LANDING();
  const auto part = surface_of(data("drilled_filleted.step"));
  expect_watertight(part);
  const double exact = 22091.477934e-9;  // of the solid, by OpenCASCADE
  EXPECT_NEAR(mesh::enclosed_volume(part), exact, 2e-3 * exact);
  const mesh::TetMesh cells = tetrahedralize(part, {});
  EXPECT_NEAR(mesh::volume(cells), exact, 2e-3 * exact);
  EXPECT_NEAR(mesh::volume(cells), mesh::enclosed_volume(part), 1e-3 * mesh::enclosed_volume(part));
  EXPECT_GT(quality(cells).smallest_dihedral_degrees, 8.0);
  EXPECT_LT(cells.tet_count(), 80'000);
  EXPECT_EQ(cells.patch_names, part.patch_names);
}

TEST_F(Step, RefusesWhatIsNotOneSolid) {
  EXPECT_TRUE(says(refusal([] { return surface_of(data("two_solids.step")); }),
                   "2 solids, expected one: unite them or export them apart; volumes 1 2 mm3"));
  EXPECT_TRUE(says(refusal([] { return surface_of(data("one_face.step")); }),
                   "no solid in the file, but 1 faces"));
}

TEST_F(Step, RefusesWhatIsNoStepOrCutOff) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("chladni_step_test_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto written = [&](const std::string& bytes) {
    std::ofstream(folder / "bad.stp", std::ios::binary) << bytes;
    return folder / "bad.stp";
  };
  std::ifstream in(data("plate_with_hole.step"));
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  EXPECT_TRUE(
      says(refusal([&] { return surface_of(written("solid cube\n")); }), "expected a STEP file"));
  EXPECT_TRUE(says(refusal([&] { return surface_of(folder); }), "chladni_step_test"));
  for (const std::size_t part : {8, 4, 2}) {
    EXPECT_THROW(static_cast<void>(surface_of(written(whole.substr(0, whole.size() / part)))),
                 std::exception);
  }
  std::filesystem::remove_all(folder);
}

TEST_F(Step, ReadsTheWaferTable) {
  const std::filesystem::path file =
      CHLADNI_SOURCE_DIR "/../shared/data/wafer-table/wafer_table.step";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const auto table = surface_of(file);
  expect_watertight(table);
  EXPECT_NEAR(mesh::enclosed_volume(table) * 1e9, 5752800.0, 1e-4 * 5752800.0);
  EXPECT_EQ(table.patch_names.size(), 411U);
}

#ifndef CHLADNI_WITH_STEP
TEST(StepOff, SaysWhichPackageIsMissing) {
  EXPECT_TRUE(
      says(refusal([] { return surface_of(data("sphere.step")); }), "libocct-data-exchange-dev"));
}
#endif

}  // namespace
}  // namespace chladni::io
