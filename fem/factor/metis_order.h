// The order of elimination that METIS finds, here or in the program chladni-order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fem/factor/elimination_tree.h"

namespace chladni::fem {

/// new -> old group, by nested dissection. METIS cannot be stopped, and while it runs it takes
/// SIGTERM for itself: large graphs are better left to the worker (`nested_dissection`).
/// @throws OutOfResources  METIS gave up
[[nodiscard]] std::vector<std::int32_t> metis_order(const QuotientGraph& graph);

/// What the two sides of the worker's pipe say to each other: a count before each array,
/// little-endian, every count checked against the bytes that are there.
[[nodiscard]] std::string bytes_of(const QuotientGraph& graph);
[[nodiscard]] std::string bytes_of(const std::vector<std::int32_t>& order);
/// @throws InvalidInput  a count that the bytes do not hold, numbers out of range, bytes left over
[[nodiscard]] QuotientGraph graph_from(std::string_view bytes);
/// @throws InvalidInput  the same, or it is no order of `count` groups
[[nodiscard]] std::vector<std::int32_t> order_from(std::string_view bytes, std::size_t count);

}  // namespace chladni::fem
