// The mesher's program and what it is told over the pipe.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "base/error.h"
#include "host/worker.h"
#include "mesh/mesher/wire.h"
#include "said.h"
#include "shapes.h"

namespace chladni::mesh {
namespace {

using shapes::box;
using shapes::cube;

class Mesher : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { setenv("CHLADNI_LIBEXEC", CHLADNI_BINARY_DIR "/bin", 1); }
};

wire::Request request_of(const Surface& surface) {
  wire::Request request;
  request.largest_radius_edge = 1.6;
  request.smallest_dihedral_degrees = 10.0;
  request.largest_volume = 0.1;
  request.points.assign(surface.points.data(), surface.points.data() + surface.points.size());
  request.triangles.assign(surface.triangles.data(),
                           surface.triangles.data() + surface.triangles.size());
  request.markers.assign(static_cast<std::size_t>(surface.triangles.rows()), 1);
  return request;
}

std::string answer(const std::string& bytes) {
  return run_worker(worker_path("chladni-tetgen"), {}, bytes, {std::chrono::seconds(20)}).output;
}

TEST_F(Mesher, DiesOnAnInputThatKillsTetGenAsAnException) {
  const Surface crossed = shapes::both(cube(), box({0.3, 0.4, 0.5}, {0.6, 0.7, 1.5}));
  EXPECT_THROW((void)answer(wire::bytes_of(request_of(crossed))), WorkerDied);
  EXPECT_THROW((void)answer(wire::bytes_of(request_of(box({0, 0, 0}, {1, 1, 0})))), WorkerDied);
}

TEST_F(Mesher, RefusesGarbage) {
  for (const std::string& bytes :
       {std::string(), std::string("solid cube"), std::string(1000, 'x'), std::string("CHLplc02"),
        "CHLplc02" + std::string(500, '\xff')}) {
    EXPECT_THROW((void)answer(bytes), WorkerDied);
  }
  expect_words(message_of<WorkerDied>([] { (void)answer("solid cube"); }), {"CHLplc02"});
}

TEST_F(Mesher, RefusesCountsThatLie) {
  const std::string sound = wire::bytes_of(request_of(cube()));
  EXPECT_GT(wire::reply_from(answer(sound)).tets.size(), 0U);
  std::string huge = sound;
  huge.replace(32, 8, std::string("\xff\xff\xff\xff\xff\xff\xff\x0f", 8));  // the count of points
  expect_words(message_of<WorkerDied>([&] { (void)answer(huge); }), {"bytes are left"});
  expect_words(message_of<WorkerDied>([&] { (void)answer(sound + "x"); }), {"1 bytes too many"});
  expect_words(message_of<WorkerDied>([&] { (void)answer(sound.substr(0, sound.size() - 3)); }),
               {"number"});
}

TEST(Wire, ReadsWhatItWrote) {
  wire::Request request = request_of(cube());
  request.seeds = {{0.5, 0.25, 0.125, 1e-3}};
  const wire::Request again = wire::request_from(wire::bytes_of(request));
  EXPECT_EQ(again.points, request.points);
  EXPECT_EQ(again.triangles, request.triangles);
  EXPECT_EQ(again.markers, request.markers);
  ASSERT_EQ(again.seeds.size(), 1U);
  EXPECT_EQ(again.seeds[0].y, 0.25);
}

TEST(Wire, RefusesEveryTruncation) {
  const std::string sound = wire::bytes_of(request_of(cube()));
  for (std::size_t size = 0; size < sound.size(); ++size) {
    EXPECT_THROW((void)wire::request_from(sound.substr(0, size)), std::runtime_error) << size;
  }
}

TEST(Wire, RefusesIndicesAndNumbersThatCannotBe) {
  wire::Request request = request_of(cube());
  request.triangles[5] = 8;
  EXPECT_THROW((void)wire::request_from(wire::bytes_of(request)), std::runtime_error);
  request = request_of(cube());
  request.points[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)wire::request_from(wire::bytes_of(request)), std::runtime_error);
  wire::Reply reply;
  reply.points = {0, 0, 0};
  reply.tets = {0, 0, 0, 1};
  reply.parts = {1};
  EXPECT_THROW((void)wire::reply_from(wire::bytes_of(reply)), std::runtime_error);
}

}  // namespace
}  // namespace chladni::mesh
