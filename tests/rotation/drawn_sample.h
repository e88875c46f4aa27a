// Which kinds of effects a run of the tests hides: all of them would take half an hour.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace chladni::rotation {

/// One number says all: its rest by four which kinds, the other part which seed.
struct DrawnSample {
  unsigned number = 2;
  bool all = false;
  unsigned half = 0;  ///< which half of a quarter's dearest kinds: 0 or 1
  std::string from;   ///< where the number comes from, in words

  [[nodiscard]] unsigned seed() const { return 1 + number / 4 % 1000; }
  /// True for every fourth kind in their order, counted from 0.
  [[nodiscard]] bool has(std::size_t kind) const { return all || kind % 4 == number % 4; }
  /// 0 to 7: the quarter, and 4 more in the second half.
  [[nodiscard]] unsigned eighth() const { return number % 4 + 4 * half; }
  /// The same for every eighth kind: minutes each.
  [[nodiscard]] bool has_half(std::size_t kind) const {
    return all || (has(kind) && kind / 4 % 2 == half);
  }
};

/// What git says of the tree; empty where it says nothing.
struct TreeState {
  std::string commit;          ///< hash
  unsigned long landings = 0;  ///< commits on the line of first parents
  bool is_shallow = false;     ///< then `landings` counts what was fetched
};
/// Cost: three calls of git, some 10 ms.
[[nodiscard]] TreeState tree_state(const std::filesystem::path& source);

/// The quarter of the kinds is the rest by four of the number of commits on the line of first
/// parents: four merges (or commits) in a row hide every kind once. In a shallow clone, where
/// nobody knows that number, the commit's hash gives it: a kind is then left out n times in a row
/// with (3/4)^n. Without git: 2. The seed is 1: one draw in some twenty-five is missed by chance
/// (bench/README.md counts them), which says nothing of a commit. Numbers from 4 on ask for others.
/// The half changes with every fourth landing, and is the next bit of a number that was asked for.
/// @param asked  CHLADNI_STUDIES: "all" (seed 1), or a number that repeats a sample; or empty
/// @throws InvalidInput  another word
[[nodiscard]] DrawnSample drawn_sample(const std::string& asked, const TreeState& tree);

}  // namespace chladni::rotation
