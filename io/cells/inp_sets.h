// Named sets of node or element numbers, as an input deck spells them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/cells/tets.h"

namespace chladni::io {

/// Names are compared without case, and without the "Part-1-1." of an instance.
class InpSets {
 public:
  /// Makes the set known, empty where it is new. Cost of each call: logarithmic.
  void declare(const std::string& name);
  void add(const std::string& name, std::int64_t id);
  void add_range(const std::string& name, std::int64_t first, std::int64_t last, std::int64_t step);
  void add_set(const std::string& name, const std::string& member);

  [[nodiscard]] bool has(const std::string& name) const;
  /// As first written, in the order of the deck.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Those ids of the set that are in `all`, rising, each once. A set that names itself, or others
  /// again and again, is gone through once.
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
