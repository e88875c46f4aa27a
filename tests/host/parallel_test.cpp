#include "host/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"

namespace chladni {
namespace {

TEST(ParallelRanges, CoverEveryIndexOnce) {
  for (const int threads : {1, 2, 3, 7}) {
    set_thread_count(threads);
    for (const std::size_t size : {0UL, 1UL, 2UL, 5UL, 1000UL}) {
      std::vector<std::atomic<int>> visits(size);
      parallel_ranges(size, [&](std::size_t begin, std::size_t end) {
        for (auto i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& count : visits) EXPECT_EQ(count, 1);
    }
  }
}

TEST(ParallelRanges, ThrowTheFirstExceptionAfterAllEnded) {
  set_thread_count(2);
  std::atomic<int> ended{0};
  EXPECT_THROW(parallel_ranges(2,
                               [&](std::size_t begin, std::size_t) {
                                 ++ended;
                                 if (begin == 0) throw std::runtime_error("first");
                               }),
               std::runtime_error);
  EXPECT_EQ(ended, 2);
}

TEST(ParallelRanges, GiveTheSameBitsForAnyNumberOfThreads) {
  const auto roots = [](int threads) {
    set_thread_count(threads);
    std::vector<double> values(10007);
    parallel_ranges(values.size(), [&](std::size_t begin, std::size_t end) {
      for (auto i = begin; i < end; ++i) values[i] = std::sqrt(static_cast<double>(i)) / 3.0;
    });
    return values;
  };
  EXPECT_EQ(roots(1), roots(2));
  EXPECT_EQ(roots(1), roots(5));
}

TEST(ParallelTasks, RunEachOnceWithLoopsWithin) {
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    std::vector<int> once(1000, 0);
    parallel_tasks(100, [&](std::size_t i) {
      parallel_ranges(5, [&](std::size_t begin, std::size_t end) {
        for (auto k = begin; k < end; ++k) ++once[10 * i + k];
      });
      parallel_tasks(5, [&](std::size_t k) { ++once[10 * i + 5 + k]; });
    });
    EXPECT_EQ(once, std::vector<int>(1000, 1));
    int after = 0;
    parallel_ranges(10, [&](std::size_t begin, std::size_t) {
      if (begin == 0) ++after;
    });
    EXPECT_EQ(after, 1);
  }
  parallel_tasks(0, [](std::size_t) { FAIL(); });
}

// How many threads a loop of two within the last task runs in, once the other task is over.
std::size_t threads_in_the_last_task(int threads) {
  set_thread_count(threads);
  std::size_t most = 0;
  parallel_tasks(2, [&](std::size_t i) {
    if (i == 0) return;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (most < 2 && std::chrono::steady_clock::now() < end) {
      std::array<std::thread::id, 2> ran;
      parallel_ranges(2, [&](std::size_t begin, std::size_t past) {
        for (auto k = begin; k < past; ++k) ran[k] = std::this_thread::get_id();
      });
      most = std::max<std::size_t>(most, ran[0] == ran[1] ? 1 : 2);
      if (threads == 1) return;
    }
  });
  return most;
}

TEST(ParallelTasks, LeaveTheirThreadsToLoopsWithinTheLast) {
  EXPECT_EQ(threads_in_the_last_task(1), 1U);
  EXPECT_EQ(threads_in_the_last_task(2), 2U);
}

TEST(ParallelTasks, ThrowTheExceptionOfTheLowestTask) {
  set_thread_count(3);
  for (int repeat = 0; repeat < 50; ++repeat) {
    try {
      parallel_tasks(20, [](std::size_t i) {
        if (i % 7 == 3) throw InvalidInput(std::to_string(i));
      });
      FAIL();
    } catch (const InvalidInput& e) {
      EXPECT_STREQ(e.what(), "3");
    }
  }
}

TEST(ParallelRanges, ThrowTheExceptionOfTheLowestRange) {
  set_thread_count(4);
  for (int repeat = 0; repeat < 50; ++repeat) {
    try {
      parallel_ranges(
          4, [](std::size_t begin, std::size_t) { throw InvalidInput(std::to_string(begin)); });
      FAIL();
    } catch (const InvalidInput& e) {
      EXPECT_STREQ(e.what(), "0");
    }
  }
}

TEST(InParallel, RethrowsFromEitherSide) {
  const auto fail = [] { throw NumericalFailure("x"); };
  const auto pass = [] {};
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    EXPECT_THROW(in_parallel(fail, pass), NumericalFailure);
    EXPECT_THROW(in_parallel(pass, fail), NumericalFailure);
  }
}

TEST(InParallel, RunsBoth) {
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    std::atomic<int> sum{0};
    in_parallel([&] { sum += 1; }, [&] { sum += 10; });
    EXPECT_EQ(sum, 11);
  }
}

TEST(ThreadCount, MustBePositive) { EXPECT_THROW(set_thread_count(0), InvalidInput); }

}  // namespace
}  // namespace chladni
