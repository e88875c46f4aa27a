// Evaluates fields at many places block by block, so that the data of a block stay in the cache.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "host/parallel.h"

namespace chladni::priors {

/// Calls body(first, count) for blocks that cover [0, n), on all cores.
template <typename Body>
void for_blocks(Eigen::Index n, const Body& body) {
  constexpr Eigen::Index kBlock = 512;
  const auto blocks = static_cast<std::size_t>((n + kBlock - 1) / kBlock);
  parallel_ranges(blocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto first = static_cast<Eigen::Index>(b) * kBlock;
      body(first, std::min(kBlock, n - first));
    }
  });
}

}  // namespace chladni::priors
