// The order of elimination: the worker's is METIS' own, hostile replies are refused, Ctrl-C is
// heard while METIS works.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <numeric>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"
#include "fem/factor/metis_order.h"

namespace chladni::fem {
namespace {

// n×n×n groups of 3 degrees of freedom, each beside those around it.
QuotientGraph cube(std::int32_t n) {
  QuotientGraph graph;
  graph.start.push_back(0);
  for (std::int32_t i = 0; i < n; ++i) {
    for (std::int32_t j = 0; j < n; ++j) {
      for (std::int32_t k = 0; k < n; ++k) {
        graph.first.push_back(3 * (n * (n * i + j) + k));
        for (std::int32_t c = 0; c < 27; ++c) {
          const std::int32_t x = i + c / 9 - 1;
          const std::int32_t y = j + c / 3 % 3 - 1;
          const std::int32_t z = k + c % 3 - 1;
          const bool is_there = std::min({x, y, z}) >= 0 && std::max({x, y, z}) < n;
          if (c != 13 && is_there) graph.neighbour.push_back(n * (n * x + y) + z);
        }
        graph.start.push_back(static_cast<std::int32_t>(graph.neighbour.size()));
      }
    }
  }
  graph.first.push_back(3 * n * n * n);
  return graph;
}

TEST(Ordering, IsTheSameInTheWorkerAsHere) {
  const auto graph = cube(12);
  const auto here = nested_dissection(graph);
  EXPECT_EQ(nested_dissection(graph, 0), here);
  auto sorted = here;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int32_t> all(sorted.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(sorted, all);
}

TEST(Ordering, OfGroupsThatDoNotTouchIsTheirOwn) {
  const QuotientGraph graph{{0, 3, 6}, {0, 0, 0}, {}};
  EXPECT_EQ(nested_dissection(graph, 0), (std::vector<std::int32_t>{0, 1}));
}

// METIS itself takes some ten seconds here.
TEST(Ordering, HearsAnInterrupt) {
  const auto graph = cube(96);
  catch_interrupts();
  std::thread user([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    std::raise(SIGINT);
  });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW((void)nested_dissection(graph), Interrupted);
  user.join();
  forget_interrupt();
  std::signal(SIGINT, SIG_DFL);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(Ordering, RefusesGraphsAndRepliesThatAreNone) {
  const auto graph = cube(3);
  EXPECT_EQ(graph_from(bytes_of(graph)).neighbour, graph.neighbour);
  const std::string bytes = bytes_of(graph);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_THROW((void)graph_from(bytes.substr(0, length)), InvalidInput) << length;
  }
  EXPECT_THROW((void)graph_from(bytes + '\0'), InvalidInput);
  auto wrong = graph;
  wrong.neighbour[5] = 27;
  EXPECT_THROW((void)graph_from(bytes_of(wrong)), InvalidInput);
  wrong = graph;
  wrong.start[4] = wrong.start[5] + 1;
  EXPECT_THROW((void)graph_from(bytes_of(wrong)), InvalidInput);
  EXPECT_THROW((void)order_from(bytes_of(std::vector<std::int32_t>{0, 1, 1}), 3), InvalidInput);
  EXPECT_THROW((void)order_from(bytes_of(std::vector<std::int32_t>{0, 3, 1}), 3), InvalidInput);
  EXPECT_THROW((void)order_from(bytes_of(std::vector<std::int32_t>{1, 0}), 3), InvalidInput);
  EXPECT_EQ(order_from(bytes_of(std::vector<std::int32_t>{1, 2, 0}), 3),
            (std::vector<std::int32_t>{1, 2, 0}));
}

}  // namespace
}  // namespace chladni::fem
