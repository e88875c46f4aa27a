// Pictures that are painted while the program goes on.
#include "io/picture_file.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <latch>
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

// Two that wait for each other, and never more than two.
TEST(PictureFile, TwoArePaintedAtOnce) {
  PaintQueue queue;
  std::latch both(2);
  std::atomic<int> at_work = 0;
  std::atomic<int> most = 0;
  for (const char* name : {"1", "2", "3", "4", "5"}) {
    PictureFile(png_of(name), &queue).paint([&, name]() -> std::string {
      const int now = ++at_work;
      for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
      }
      if (*name == '1' || *name == '2') both.arrive_and_wait();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      --at_work;
      return name;
    });
  }
  EXPECT_EQ(queue.finish().size(), 5U);
  EXPECT_EQ(most, 2);
}

TEST(PictureFile, PicturesAreToldInTheirOrderAndNoFailureEndsTheQueue) {
  PaintQueue queue;
  for (const char* name : {"a", "b", "c"}) {
    PictureFile(png_of(name), &queue).paint([name]() -> std::string {
      if (*name == 'a') std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (*name == 'b') throw std::runtime_error("no paint");
      return name;
    });
  }
  const auto all = queue.finish();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].png.filename(), "a");
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
