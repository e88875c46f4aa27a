// The only file that includes METIS.
#include "fem/factor/metis_order.h"

#include <fmt/format.h>

#include <metis.h>

#include <bit>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"

namespace chladni::fem {
namespace {

static_assert(sizeof(idx_t) == sizeof(std::int32_t), "METIS with 32-bit indices");
static_assert(std::endian::native == std::endian::little, "the pipe's numbers are little-endian");

using Numbers = std::vector<std::int32_t>;

void append(std::string& bytes, const Numbers& numbers) {
  const auto count = static_cast<std::uint64_t>(numbers.size());
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(numbers[0]));
}

// Takes the next array from the front of `bytes`.
Numbers taken(std::string_view& bytes) {
  std::uint64_t count = 0;
  require(bytes.size() >= sizeof count, "ended before the count of an array");
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  require(count <= bytes.size() / sizeof(std::int32_t),
          fmt::format("{} numbers are announced and {} bytes are left", count, bytes.size()));
  Numbers numbers(count);
  if (count > 0) std::memcpy(numbers.data(), bytes.data(), count * sizeof(numbers[0]));
  bytes.remove_prefix(count * sizeof(std::int32_t));
  return numbers;
}

void check(const QuotientGraph& graph) {
  const auto& [first, start, neighbour] = graph;
  require(!first.empty() && first.size() == start.size() && start.front() == 0 &&
              static_cast<std::size_t>(start.back()) == neighbour.size(),
          "the arrays of the graph do not fit together");
  const auto count = static_cast<std::int32_t>(first.size() - 1);
  for (std::size_t g = 0; g + 1 < first.size(); ++g) {
    require(start[g] <= start[g + 1] && first[g] < first[g + 1], "an array does not ascend");
  }
  for (const auto other : neighbour) require(other >= 0 && other < count, "no such neighbour");
}

}  // namespace

Numbers metis_order(const QuotientGraph& graph) {
  auto count = static_cast<idx_t>(graph.first.size() - 1);
  Numbers order(static_cast<std::size_t>(count));
  Numbers position(order.size());
  if (graph.neighbour.empty()) {
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
    return order;
  }
  std::vector<idx_t> weight(order.size());
  for (std::size_t g = 0; g < order.size(); ++g) weight[g] = graph.first[g + 1] - graph.first[g];
  auto start = graph.start;  // METIS takes pointers to non-const and may renumber in place
  auto neighbour = graph.neighbour;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  // The two halves may differ by 3 to 1, which allows a smaller separator. On plates this saves a
  // tenth of the fill and a seventh of the work. (At 1000 one half may be empty, and METIS does not
  // end.)
  options[METIS_OPTION_UFACTOR] = 500;
  const LongStep step;
  const int status = METIS_NodeND(&count, start.data(), neighbour.data(), weight.data(), options,
                                  order.data(), position.data());
  if (status != METIS_OK) {
    throw OutOfResources("ordering: METIS failed with status " + fmt::to_string(status) + " on " +
                         fmt::to_string(count) + " nodes");
  }
  return order;
}

std::string bytes_of(const QuotientGraph& graph) {
  std::string bytes;
  bytes.reserve(24 + 4 * (graph.first.size() + graph.start.size() + graph.neighbour.size()));
  for (const auto* numbers : {&graph.first, &graph.start, &graph.neighbour})
    append(bytes, *numbers);
  return bytes;
}

std::string bytes_of(const Numbers& order) {
  std::string bytes;
  append(bytes, order);
  return bytes;
}

QuotientGraph graph_from(std::string_view bytes) {
  QuotientGraph graph;
  for (auto* numbers : {&graph.first, &graph.start, &graph.neighbour}) *numbers = taken(bytes);
  require(bytes.empty(), fmt::format("{} bytes too many", bytes.size()));
  check(graph);
  return graph;
}

Numbers order_from(std::string_view bytes, std::size_t count) {
  Numbers order = taken(bytes);
  require(bytes.empty() && order.size() == count,
          fmt::format("{} numbers and {} bytes more, expected {} numbers", order.size(),
                      bytes.size(), count));
  std::vector<char> seen(count, 0);
  for (const auto group : order) {
    const bool is_new = group >= 0 && static_cast<std::size_t>(group) < count &&
                        std::exchange(seen[static_cast<std::size_t>(group)], 1) == 0;
    require(is_new, fmt::format("group {} is out of range or there twice", group));
  }
  return order;
}

}  // namespace chladni::fem
