// Named sets of node or element numbers of an input deck.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/cells/tets.h"

namespace chladni::io {

/// The sets of a deck. Names are compared without case and without the "Part-1-1." of an instance.
class InpSets {
 public:
  /// Declares the set; a new set is empty. Cost of each call: logarithmic.
  void declare(const std::string& name);
  void add(const std::string& name, std::int64_t id);
  void add_range(const std::string& name, std::int64_t first, std::int64_t last, std::int64_t step);
  void add_set(const std::string& name, const std::string& member);

  [[nodiscard]] bool has(const std::string& name) const;
  /// The names as first written, in the order of the deck.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The ids of the set that are in `all`, rising, each once. Sets may contain themselves or other
  /// sets several times; each set is visited once.
  [[nodiscard]] std::vector<std::int64_t> ids(const std::string& name, const Rows& all) const;

 private:
  struct Set {
    std::vector<std::array<std::int64_t, 3>> ranges;  // first, last, step
    std::vector<std::string> members;
  };
  Set& at(const std::string& name);

  std::vector<std::string> names_;
  std::map<std::string, Set> sets_;
};

}  // namespace chladni::io
