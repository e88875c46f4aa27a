#include "io/picture.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "host/atomic_file.h"
#include "host/worker.h"
#include "io/bytes/message.h"
#include "io/figure/colours.h"
#include "io/figure/drawing.h"
#include "io/figure/painted.h"
#include "io/heat_map_picture.h"
#include "io/picture/letters.h"
#include "mesh/bodies.h"
#include "rotation/turn.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

class Picture : public testing::Test {
 protected:
  Picture() { fs::create_directories(folder_); }
  ~Picture() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path png() const { return folder_ / "modes.png"; }

  fs::path folder_ = fs::temp_directory_path() / ("chladni_picture_" + std::to_string(::getpid()));
  mesh::TetMesh mesh_ = with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.1, 1), 2);
};

using Shape = std::function<Eigen::Vector3d(const Eigen::RowVector3d&)>;

modal::Modes modes_of(const mesh::TetMesh& mesh, const std::vector<Shape>& shapes) {
  modal::Modes modes;
  const auto count = static_cast<Eigen::Index>(shapes.size());
  modes.frequency_hz = 100.0 * Eigen::VectorXd::LinSpaced(count, 1.0, static_cast<double>(count));
  modes.damping_ratio = Eigen::VectorXd::Zero(count);
  modes.shapes.resize(3 * mesh.node_count(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index i = 0; i < mesh.node_count(); ++i) {
      modes.shapes.col(k).segment<3>(3 * i) =
          shapes[static_cast<std::size_t>(k)](mesh.points.row(i));
    }
  }
  return modes;
}

Eigen::Vector3d twist(const Eigen::RowVector3d& p) { return {0.0, 0.0, p.x() * p.y()}; }

struct Counts {
  int width = 0, height = 0;
  int red = 0, blue = 0, black = 0, white = 0;
};

Counts counts_of(const fs::path& png) {
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(png.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  Counts counts{image->GetDimensions()[0], image->GetDimensions()[1]};
  const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer());
  for (int i = 0; i < counts.width * counts.height; ++i, pixel += 3) {
    const int r = pixel[0], b = pixel[2];
    counts.red += r > b + 60;
    counts.blue += b > r + 60;
    counts.black += r + pixel[1] + b < 60;
    counts.white += r + pixel[1] + b == 765;
  }
  return counts;
}

TEST_F(Picture, ShowsBothSignsAndTheNodalLinesOnWhite) {
  draw_modes(png(), mesh_, modes_of(mesh_, std::vector<Shape>(9, twist)), "plate");
  const Counts counts = counts_of(png());
  EXPECT_EQ(counts.width, 1400);
  EXPECT_GT(counts.height, 1000);
  EXPECT_LT(fs::file_size(png()), 1'000'000U);
  EXPECT_GT(counts.red, 50'000);
  EXPECT_GT(counts.blue, 50'000);
  EXPECT_GT(counts.black, 9 * 400);  // at least two lines in each panel
  EXPECT_GT(counts.white, counts.width * counts.height / 3);
}

TEST_F(Picture, AShapeOfOneSignHasOneColourAndNoNodalLine) {
  const Shape up = [](const Eigen::RowVector3d&) { return Eigen::Vector3d(0.0, 0.0, 1.0); };
  const Shape down = [](const Eigen::RowVector3d&) { return Eigen::Vector3d(0.0, 0.0, -1.0); };
  draw_modes(png(), mesh_, modes_of(mesh_, {up, up, up}), "");
  const Counts red = counts_of(png());
  draw_modes(png(), mesh_, modes_of(mesh_, {down, down, down}), "");
  const Counts blue = counts_of(png());
  draw_modes(png(), mesh_, modes_of(mesh_, {twist, twist, twist}), "");
  const Counts both = counts_of(png());
  EXPECT_GT(red.red, 20 * red.blue);
  EXPECT_GT(blue.blue, 20 * blue.red);
  EXPECT_LT(red.black, both.black / 2);
}

TEST_F(Picture, TheDirectionOfMostMotionGivesTheColour) {
  const Shape sideways = [](const Eigen::RowVector3d& p) {
    return Eigen::Vector3d(1.0, 0.1 * p.y(), 0.05 * p.x());
  };
  draw_modes(png(), mesh_, modes_of(mesh_, {sideways}), "");
  const Counts counts = counts_of(png());
  EXPECT_GT(counts.red, 10'000);
  EXPECT_LT(counts.blue, counts.red / 5);
}

TEST_F(Picture, TheSameInputGivesTheSameBytes) {
  const modal::Modes modes = modes_of(mesh_, {twist, twist});
  const std::vector<Marker> markers{{"s1", "sensor", {0.1, 0.1, 0.0}, {0.0, 0.0, 1.0}},
                                    {"a1", "actuator", {-0.1, 0.1, 0.0}, {0.0, 0.0, 1.0}}};
  draw_modes(png(), mesh_, modes, "plate", markers);
  const std::string first = read_whole(png());
  draw_modes(png(), mesh_, modes, "plate", markers);
  EXPECT_EQ(read_whole(png()), first);
}

TEST_F(Picture, AnyTitleAndAnyShapeOfBodyFit) {
  EVERY_FOURTH_LANDING();
  const std::string title = "Prüfstand µ 平台 " + std::string(400, 'W');
  for (const mesh::Plate& body :
       {mesh::Plate{0.5, 0.02, 0.002}, mesh::Plate{0.1, 0.1, 0.3}, mesh::Plate{0.002, 0.5, 0.02}}) {
    const mesh::TetMesh mesh = mesh::layered(body, 0.02, 1);
    draw_modes(png(), mesh, modes_of(mesh, {twist, twist, twist, twist}), title);
    const Counts counts = counts_of(png());
    EXPECT_EQ(counts.width, 1400);
    EXPECT_LT(counts.height, 2600);
    EXPECT_GT(counts.red + counts.blue, 500);
  }
}

TEST_F(Picture, WithoutAFlexibleModeThereIsNothingToDraw) {
  modal::Modes modes = modes_of(mesh_, {twist});
  modes.rigid_count = 1;
  EXPECT_THROW(draw_modes(png(), mesh_, modes, ""), InvalidInput);
  modes.rigid_count = 0;
  modes.shapes.conservativeResize(12, 1);
  EXPECT_THROW(draw_modes(png(), mesh_, modes, ""), InvalidInput);
  EXPECT_FALSE(fs::exists(png()));
}

TEST_F(Picture, WithoutADisplayThePackageIsNamed) {
  const std::string path = std::getenv("PATH");
  const char* display = std::getenv("DISPLAY");
  const std::string shown = display != nullptr ? display : "";
  ::setenv("PATH", folder_.c_str(), 1);
  ::unsetenv("DISPLAY");
  try {
    draw_modes(png(), mesh_, modes_of(mesh_, {twist}), "");
    ADD_FAILURE();
  } catch (const WorkerDied& died) {
    EXPECT_NE(std::string(died.what()).find("install the package xvfb"), std::string::npos);
  }
  ::setenv("PATH", path.c_str(), 1);
  if (display != nullptr) ::setenv("DISPLAY", shown.c_str(), 1);
  EXPECT_FALSE(fs::exists(png()));
}

TEST_F(Picture, ThePainterRefusesWhatIsNoRequest) {
  const fs::path painter = worker_path("chladni-painter");
  Message unknown;
  unknown.head = JsonObject{{"kind", "fresco"}};
  for (const std::string& request : {std::string(), std::string("garbage"), bytes(unknown)}) {
    EXPECT_THROW(static_cast<void>(run_worker(painter, {}, request)), WorkerDied);
  }
}

TEST_F(Picture, ThePainterRefusesASizeThatItCannotPaint) {
  for (const auto& [width, height] : {std::pair(1000, 8193), std::pair(8193, 100)}) {
    const Drawing drawing(width, height);
    try {
      static_cast<void>(painted(drawing.request()));
      ADD_FAILURE() << width << " x " << height;
    } catch (const WorkerDied& died) {
      EXPECT_NE(std::string(died.what()).find("expected 1 to 8192"), std::string::npos)
          << died.what();
    }
  }
  EXPECT_TRUE(painted(Drawing(100.0, 8192.0).request()).starts_with("\x89PNG"));
}

// A sensor that no fit saw was a green triangle, which is an actuator.
TEST_F(Picture, ASensorThatIsHeldOutIsNoActuator) {
  LayoutsPicture picture;
  picture.points = Points{{0.0, 0.0, 0.0}, {0.4, 0.0, 0.0}, {0.4, 0.3, 0.0}, {0.0, 0.3, 0.0}};
  picture.triangles = Cells{{0, 1, 2}, {0, 2, 3}};
  const auto green = [&](const char* kind) {
    picture.panels = {
        {"mode 7", "", Eigen::VectorXd::Ones(4), {{"s1", kind, {0.1, 0.1, 0.0}, {}}}}};
    draw_layouts(png(), picture);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName(png().c_str());
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer());
    int count = 0;
    for (int i = 0; i < image->GetDimensions()[0] * image->GetDimensions()[1]; ++i, pixel += 3) {
      count += pixel[1] < 130 && pixel[1] > pixel[0] + 40 && pixel[1] > pixel[2] + 20;
    }
    return count;
  };
  EXPECT_GT(green("actuator"), 100) << "on the body, and in the legend";
  EXPECT_EQ(green("held_out_sensor"), 0);
}

TEST(Letters, AreCutAsAWhole) {
  const std::string words = "Pr\u00fcfstand \u5e73\u53f0";
  std::vector<std::string> cut;
  for (std::size_t most = 0; most < 20; ++most) {
    cut.push_back(picture::shortened(words, [&](const std::string& part) {
      return picture::letters_of(part).size() <= std::max<std::size_t>(most, 3);
    }));
    for (const auto letter : picture::letters_of(cut.back())) {
      EXPECT_GT(picture::letter_size(letter), 0U) << cut.back();
    }
  }
  EXPECT_EQ(cut[0], "...");
  EXPECT_EQ(cut[6], "Pr\u00fc...");
  EXPECT_EQ(cut[10], "Pr\u00fcfsta...");
  EXPECT_EQ(cut[12], words);
}

TEST(Letters, ThatTheFontLacksAreAsked) {
  const auto latin = [](std::string_view letter) { return letter.size() == 2; };
  EXPECT_EQ(picture::paintable("a \u00e9 \u677f z", latin), "a \u00e9 ? z");
  EXPECT_EQ(picture::paintable("Gr\xF6\xDF"
                               "e \xE5\xB9",
                               latin),
            "Gr??e ??")
      << "no UTF-8";
  EXPECT_EQ(picture::paintable("", latin), "");
}

TEST_F(Picture, LettersThatTheFontLacksAreSeen) {
  const auto modes = modes_of(mesh_, {twist});
  draw_modes(png(), mesh_, modes, "????");
  const auto asked = read_whole(png());
  draw_modes(png(), mesh_, modes, "\u677f\u5e73\u53f0\u677f");
  EXPECT_EQ(read_whole(png()), asked);
  draw_modes(png(), mesh_, modes, "\u00e9\u00fc\u00b5\u00df");
  EXPECT_NE(read_whole(png()), asked);
}

TEST(Colours, ZeroIsWhiteAndBothSidesDarkenEvenly) {
  for (const double part : diverging(0.0)) EXPECT_NEAR(part, 1.0, 1e-12);
  const auto brightness = [](const Colour& c) { return 0.21 * c[0] + 0.72 * c[1] + 0.07 * c[2]; };
  for (int i = 1; i <= 100; ++i) {
    const double value = 0.01 * i;
    EXPECT_LT(brightness(diverging(value)), brightness(diverging(value - 0.01)));
    EXPECT_LT(brightness(diverging(-value)), brightness(diverging(0.01 - value)));
    EXPECT_GE(diverging(value)[0], diverging(value)[2]);
    EXPECT_LE(diverging(-value)[0], diverging(-value)[2]);
  }
  EXPECT_EQ(diverging(7.0), diverging(1.0));
}

}  // namespace
}  // namespace chladni::io
