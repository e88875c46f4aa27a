#include "io/matrix_picture.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cmath>

#include "base/error.h"
#include "host/atomic_file.h"
#include "rotation/turn.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

MatrixPicture picture_of(Eigen::Index rows, Eigen::Index columns) {
  MatrixPicture picture;
  picture.title = "likeness";
  picture.row_label = "simulated";
  picture.column_label = "measured";
  for (Eigen::Index i = 0; i < rows; ++i) picture.rows.push_back(std::to_string(i) + " Hz");
  for (Eigen::Index j = 0; j < columns; ++j) picture.columns.push_back(std::to_string(j) + " Hz");
  picture.value = Eigen::MatrixXd::Zero(rows, columns);
  return picture;
}

class DrawMatrix : public testing::Test {
 protected:
  ~DrawMatrix() override { fs::remove(png_); }

  // Pixels as dark as the dark end of the colours.
  int dark_pixels(const MatrixPicture& picture) {
    draw_matrix(png_, picture);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(png_.c_str());
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    const int count = image->GetDimensions()[0] * image->GetDimensions()[1];
    const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer());
    int dark = 0;
    for (int i = 0; i < count; ++i, pixel += 3) {
      dark += pixel[2] > pixel[1] + 50 && pixel[0] + pixel[1] + pixel[2] < 255;
    }
    return dark;
  }

  fs::path png_ =
      fs::temp_directory_path() / ("chladni_matrix_" + std::to_string(::getpid()) + ".png");
};

TEST_F(DrawMatrix, SquaresAreAsDarkAsTheirValues) {
  auto picture = picture_of(4, 6);
  EXPECT_LT(dark_pixels(picture), 50);
  picture.value(1, 2) = 1.0;
  const int one = dark_pixels(picture);
  EXPECT_GT(one, 1000);
  picture.value(3, 5) = 1.0;
  EXPECT_NEAR(dark_pixels(picture), 2 * one, 0.1 * one);
  picture.value.setConstant(std::nan(""));
  EXPECT_LT(dark_pixels(picture), 50);
}

// A window that is larger than what the display can paint stays black.
TEST_F(DrawMatrix, AsManyRowsAsItTakesArePainted) {
  EVERY_FOURTH_LANDING();
  for (const Eigen::Index rows : {130, 200}) {
    auto picture = picture_of(rows, 1);
    EXPECT_LT(dark_pixels(picture), 50) << rows;
    picture.value(rows - 1, 0) = 1.0;
    EXPECT_GT(dark_pixels(picture), 500) << rows;
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(png_.c_str());
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    EXPECT_LE(image->GetDimensions()[1], 6500) << rows;
    const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer());
    EXPECT_EQ(static_cast<int>(pixel[0]), 255) << rows;
  }
}

TEST_F(DrawMatrix, TheSameInputGivesTheSameBytes) {
  EVERY_FOURTH_LANDING();
  auto picture = picture_of(40, 40);
  picture.value.diagonal().setOnes();
  draw_matrix(png_, picture);
  const std::string first = read_whole(png_);
  draw_matrix(png_, picture);
  EXPECT_EQ(first, read_whole(png_));
}

TEST_F(DrawMatrix, RefusesWhatDoesNotFit) {
  auto picture = picture_of(4, 6);
  picture.rows.pop_back();
  EXPECT_THROW(draw_matrix(png_, picture), InvalidInput);
  EXPECT_THROW(draw_matrix(png_, picture_of(0, 0)), InvalidInput);
  EXPECT_THROW(draw_matrix(png_, picture_of(1, 201)), InvalidInput);
  EXPECT_FALSE(fs::exists(png_));
}

// Squares beside long names lie on the sheet: the picture is as wide as they need.
TEST_F(DrawMatrix, LongNamesMakeTheScreensPictureWider) {
  auto picture = picture_of(2, 3);
  picture.rows[0] = std::string(150, 'm');
  picture.value.setOnes();
  EXPECT_GT(dark_pixels(picture), 3 * 2 * 4);
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(png_.c_str());
  reader->Update();
  EXPECT_GT(reader->GetOutput()->GetDimensions()[0], 1000);
}

// Without a file only the refusal is left.
TEST_F(DrawMatrix, WhatIsDrawnNowhereLeavesNothing) {
  const auto picture = picture_of(4, 6);
  const auto on = [](double width_mm, double dpi) {
    return PictureFile({}, nullptr, Print{.width_mm = width_mm, .dpi = dpi});
  };
  draw_matrix(on(88.0, 300.0), picture);
  EXPECT_THROW(draw_matrix(on(400.0, 600.0), picture), InvalidInput);
  EXPECT_THROW(draw_matrix(on(88.0, 300.0), picture_of(1, 200)), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
