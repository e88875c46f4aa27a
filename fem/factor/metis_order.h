// The order of elimination by METIS, in this process or in the program chladni-order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fem/factor/elimination_tree.h"

namespace chladni::fem {

/// The order of the groups (new -> old) by nested dissection. METIS cannot be stopped, and it
/// catches SIGTERM while it runs. So large graphs should go to the worker (`nested_dissection`).
/// @throws OutOfResources  METIS gave up
[[nodiscard]] std::vector<std::int32_t> metis_order(const QuotientGraph& graph);

/// The messages on the worker's pipe. A count stands before each array; numbers are little-endian.
/// The reader checks every count against the bytes that are there.
[[nodiscard]] std::string bytes_of(const QuotientGraph& graph);
[[nodiscard]] std::string bytes_of(const std::vector<std::int32_t>& order);
/// @throws InvalidInput  a count that the bytes do not hold, numbers out of range, bytes left over
[[nodiscard]] QuotientGraph graph_from(std::string_view bytes);
/// @throws InvalidInput  as graph_from, or the numbers are no order of `count` groups
[[nodiscard]] std::vector<std::int32_t> order_from(std::string_view bytes, std::size_t count);

}  // namespace chladni::fem
