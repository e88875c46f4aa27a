// Groups of degrees of freedom, and the order in which the groups are eliminated.
#include <algorithm>
#include <chrono>
#include <filesystem>

#include "fem/factor/elimination_tree.h"
#include "fem/factor/metis_order.h"
#include "host/worker.h"

namespace chladni::fem {
namespace {

// Whether column c + 1 has the rows of column c except row c. Both columns can then be eliminated
// together without extra zeros.
bool same_structure(const SparseMatrix& pattern, Eigen::Index c) {
  const auto* outer = pattern.outerIndexPtr();
  const auto* inner = pattern.innerIndexPtr();
  const auto* a = inner + outer[c];
  const auto* a_end = inner + outer[c + 1];
  const auto* b = inner + outer[c + 1];
  const auto* b_end = inner + outer[c + 2];
  return a_end - a == b_end - b + 1 && a[0] == c && a_end - a > 1 && a[1] == c + 1 &&
         std::equal(a + 1, a_end, b, b_end);
}

}  // namespace

QuotientGraph quotient_graph(const SparseMatrix& pattern) {
  const auto n = pattern.cols();
  QuotientGraph graph;
  std::vector<std::int32_t> group(static_cast<std::size_t>(n));
  for (Eigen::Index c = 0; c < n; ++c) {
    const bool joins = c > 0 && c - graph.first.back() < 3 && same_structure(pattern, c - 1);
    if (!joins) graph.first.push_back(static_cast<std::int32_t>(c));
    group[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(graph.first.size()) - 1;
  }
  const auto groups = graph.first.size();
  graph.first.push_back(static_cast<std::int32_t>(n));

  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::vector<std::int32_t> seen(groups, -1);
  for (std::size_t g = 0; g < groups; ++g) {
    for (auto c = graph.first[g]; c < graph.first[g + 1]; ++c) {
      for (SparseMatrix::InnerIterator entry(pattern, c); entry; ++entry) {
        const auto other = group[static_cast<std::size_t>(entry.row())];
        if (other == static_cast<std::int32_t>(g)) continue;
        auto& mark = seen[static_cast<std::size_t>(other)];
        if (mark == static_cast<std::int32_t>(g)) continue;
        mark = static_cast<std::int32_t>(g);
        edges.emplace_back(static_cast<std::int32_t>(g), other);
      }
    }
  }
  graph.start.assign(groups + 1, 0);
  for (const auto& [a, b] : edges) {
    ++graph.start[static_cast<std::size_t>(a) + 1];
    ++graph.start[static_cast<std::size_t>(b) + 1];
  }
  for (std::size_t g = 0; g < groups; ++g) graph.start[g + 1] += graph.start[g];
  graph.neighbour.resize(2 * edges.size());
  auto next = graph.start;
  for (const auto& [a, b] : edges) {
    graph.neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(a)]++)] = b;
    graph.neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(b)]++)] = a;
  }
  return graph;
}

std::vector<std::int32_t> nested_dissection(const QuotientGraph& graph, std::size_t large) {
  const std::size_t count = graph.first.size() - 1;
  if (count < large) return metis_order(graph);
  std::filesystem::path worker;
  try {
    worker = worker_path("chladni-order");
  } catch (const WorkerDied&) {  // a library without its programs: Ctrl-C then has to wait
    return metis_order(graph);
  }
  const WorkerLimits limits{.time = std::chrono::hours(24), .memory_bytes = 0, .confined = true};
  const auto reply = run_worker(worker, {}, bytes_of(graph), limits);
  return reply_of(worker, [&] { return order_from(reply.output, count); });
}

}  // namespace chladni::fem
