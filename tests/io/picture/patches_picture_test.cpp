// Names of patches on a body: where they have room, what is hidden, that they are painted.
#include "io/patches_picture.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/figure/colours.h"
#include "io/figure/seen_parts.h"
#include "mesh/bodies.h"
#include "rotation/turn.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

// Two squares beside each other, 2 and 1 wide, and a third part below the first.
struct Squares {
  Points points{{0, 0, 0}, {2, 0, 0},  {2, 2, 0},  {0, 2, 0},  {3, 0, 0}, {3, 1, 0},
                {2, 1, 0}, {0, 0, -1}, {2, 0, -1}, {2, 2, -1}, {0, 2, -1}};
  Cells triangles{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 6}, {7, 9, 8}, {7, 10, 9}};
  Eigen::VectorXi part{{0, 0, 1, 1, 2, 2}};
};

TEST(SeenParts, AreWhereTheyHaveMostRoom) {
  const Squares of;
  const auto seen = seen_parts(of.points, of.triangles, of.part, 4);
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_NEAR(seen[0].area, 4.0, 0.05);
  EXPECT_NEAR(seen[0].radius, 1.0, 0.02);
  EXPECT_LT((seen[0].at - Eigen::Vector2d(1.0, 1.0)).norm(), 0.05);
  EXPECT_NEAR(seen[1].area, 1.0, 0.05);
  EXPECT_NEAR(seen[1].radius, 0.5, 0.02);
  EXPECT_LT((seen[1].at - Eigen::Vector2d(2.5, 0.5)).norm(), 0.05);
  EXPECT_EQ(seen[2].area, 0.0) << "it lies below";
  EXPECT_EQ(seen[3].area, 0.0) << "it has no triangle";
}

// The middle of a strip, not its end.
TEST(SeenParts, OfAStripAreInItsMiddle) {
  const Points points{{0, 0, 0}, {8, 0, 0}, {8, 1, 0}, {0, 1, 0}};
  const auto seen = seen_parts(points, Cells{{0, 1, 2}, {0, 2, 3}}, Eigen::Vector2i(0, 0), 1);
  EXPECT_LT((seen[0].at - Eigen::Vector2d(4.0, 0.5)).norm(), 0.1);
}

TEST(SeenParts, ChangeWithTheSideTheyAreSeenFrom) {
  Squares of;
  of.points.col(2) *= -1.0;
  const auto seen = seen_parts(of.points, of.triangles, of.part, 3);
  EXPECT_EQ(seen[0].area, 0.0);
  EXPECT_NEAR(seen[2].area, 4.0, 0.05);
}

TEST(SeenParts, RefuseWhatDoesNotFitTogether) {
  const Squares of;
  EXPECT_THROW((void)seen_parts(of.points, of.triangles, of.part, 2), InvalidInput);
  EXPECT_THROW((void)seen_parts(of.points, of.triangles, of.part.head(3), 3), InvalidInput);
}

class PatchesPicture : public testing::Test {
 protected:
  PatchesPicture() { fs::create_directories(folder_); }
  ~PatchesPicture() override { fs::remove_all(folder_); }

  // How many of the colours of parts a picture shows on 200 pixels or more.
  static int colours_in(const fs::path& png) {
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(png.c_str());
    reader->Update();
    auto* image = reader->GetOutput();
    const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer());
    const vtkIdType count = image->GetNumberOfPoints();
    int shown = 0;
    for (int c = 0; c < static_cast<int>(kCategories); ++c) {
      const Colour wanted = categorical(c);
      int near = 0;
      for (vtkIdType i = 0; i < count; ++i) {
        double off = 0.0;
        for (int k = 0; k < 3; ++k) {
          off = std::max(off,
                         std::abs(pixel[3 * i + k] / 255.0 - wanted[static_cast<std::size_t>(k)]));
        }
        if (off < 0.02) ++near;
      }
      if (near > 200) ++shown;
    }
    return shown;
  }

  fs::path folder_ = fs::temp_directory_path() / ("chladni_patches_" + std::to_string(::getpid()));
};

TEST_F(PatchesPicture, ShowsEachPatchInAColourOfItsOwn) {
  const auto mesh = with_order(mesh::layered(mesh::Plate{0.6, 0.4, 0.1}, 0.1, 1), 2);
  ASSERT_EQ(mesh.patch_names.size(), 6U);
  const auto png = folder_ / "mesh.png";
  draw_patches(png, mesh, "plate");
  EXPECT_GE(colours_in(png), 6);
  const auto bytes = read_whole(png);
  draw_patches(png, mesh, "plate");
  EXPECT_EQ(read_whole(png), bytes);
}

TEST_F(PatchesPicture, OfManyPatchesIsPaintedToo) {
  EVERY_FOURTH_LANDING();
  auto mesh = mesh::layered(mesh::Plate{0.6, 0.4, 0.02}, 0.04, 1);
  mesh.patch_names.clear();
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    mesh.face_patch(f) = static_cast<int>(f);
    mesh.patch_names.push_back("a long name of the face number " + std::to_string(f));
  }
  draw_patches(folder_ / "mesh.png", mesh, "many");
  EXPECT_EQ(colours_in(folder_ / "mesh.png"), static_cast<int>(kCategories));
}

TEST_F(PatchesPicture, RefusesAMeshWithoutPatches) {
  auto mesh = mesh::layered(mesh::Plate{0.6, 0.4, 0.1}, 0.2, 1);
  mesh.patch_names.clear();
  EXPECT_THROW(draw_patches(folder_ / "mesh.png", mesh, "none"), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
