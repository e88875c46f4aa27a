// Groups items that belong together; the input is one pair after another.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace chladni::mesh {

/// Union-find with path halving (Tarjan 1975). Each join or look-up takes nearly constant time.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  [[nodiscard]] std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// Joins two sets. The lower root stays, so a set's root is its smallest member.
  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

  /// For each item the number of its set. Sets are numbered 0, 1, ... by their smallest members.
  [[nodiscard]] std::vector<std::int32_t> numbers() {
    std::vector<std::int32_t> number(parent_.size());
    std::int32_t count = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      const std::size_t r = root(i);
      number[i] = r == i ? count++ : number[r];
    }
    return number;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace chladni::mesh
