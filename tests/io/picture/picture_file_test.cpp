// Pictures that are painted while the program goes on.
#include "io/picture_file.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>

namespace chladni::io {
namespace {

std::filesystem::path png_of(const std::string& name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "picture_file";
  std::filesystem::create_directories(folder);
  std::filesystem::remove(folder / name);
  return folder / name;
}

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(PictureFile, IsPaintedAtOnceWithoutAQueue) {
  const auto png = png_of("at_once.png");
  PictureFile(png).paint([] { return std::string("png"); });
  EXPECT_EQ(content(png), "png");
}

TEST(PictureFile, WaitsForNoPainterWithAQueue) {
  PaintQueue queue;
  std::atomic<bool> may_paint = false;
  const auto png = png_of("later.png");
  PictureFile(png, &queue).paint([&] {
    while (!may_paint) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return std::string("png");
  });
  EXPECT_FALSE(std::filesystem::exists(png));
  may_paint = true;
  const auto all = queue.finish();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all.front().png, png);
  EXPECT_FALSE(all.front().failure);
  EXPECT_EQ(content(png), "png");
  EXPECT_TRUE(queue.finish().empty());  // each is told once
}

TEST(PictureFile, PicturesAreInTheirOrderAndNoFailureEndsTheQueue) {
  PaintQueue queue;
  std::string order;
  for (const char* name : {"a", "b", "c"}) {
    PictureFile(png_of(name), &queue).paint([&order, name]() -> std::string {
      order += name;  // one after the other: no lock
      if (*name == 'b') throw std::runtime_error("no paint");
      return name;
    });
  }
  const auto all = queue.finish();
  EXPECT_EQ(order, "abc");
  ASSERT_EQ(all.size(), 3U);
  EXPECT_FALSE(all[0].failure);
  EXPECT_THROW(std::rethrow_exception(all[1].failure), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(all[1].png));
  EXPECT_EQ(content(all[2].png), "c");
}

TEST(PictureFile, AQueueThatEndsHasPaintedEverything) {
  const auto png = png_of("end.png");
  {
    PaintQueue queue;
    PictureFile(png, &queue).paint([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      return std::string("png");
    });
  }
  EXPECT_EQ(content(png), "png");
}

}  // namespace
}  // namespace chladni::io
