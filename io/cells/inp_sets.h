// Named sets of node or element numbers of an input deck.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/cells/tets.h"

namespace chladni::io {

/// The sets of a deck, by name. Names are compared without case. Where no set has the whole name,
/// one without the "Part-1-1." of the deck's instance is meant.
class InpSets {
 public:
  /// The name of the deck's *INSTANCE, "Part-1-1".
  void set_instance(const std::string& name);
  /// Declares the set; a new set is empty. Cost of each call: logarithmic.
  void declare(const std::string& name);
  void add(const std::string& name, std::int64_t id);
  void add_range(const std::string& name, std::int64_t first, std::int64_t last, std::int64_t step);
  /// @param member  another set, or an id of the instance ("Part-1-1.7")
  void add_set(const std::string& name, const std::string& member);

  [[nodiscard]] bool has(const std::string& name) const;
  /// The names as first written, in the order of the deck.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The ids of the set that are in `all`, rising, each once. Sets may contain themselves or other
  /// sets several times; each set is visited once.
  /// @param also  further sets: those of one name are united
  [[nodiscard]] std::vector<std::int64_t> ids(const std::string& name, const Rows& all,
                                              const InpSets* also = nullptr) const;
  /// The members that are no set of these or of `also`, and no id: "'gone' of 'lower'".
  [[nodiscard]] std::vector<std::string> missing(const InpSets* also = nullptr) const;

 private:
  struct Set {
    std::vector<std::array<std::int64_t, 3>> ranges;  // first, last, step
    std::vector<std::string> members;
  };
  Set& at(const std::string& name);
  [[nodiscard]] const Set* find(const std::string& name) const;
  [[nodiscard]] std::string without_instance(const std::string& name) const;
  [[nodiscard]] std::optional<std::int64_t> id_of_instance(const std::string& name) const;

  std::string instance_;  // "PART-1-1."
  std::vector<std::string> names_;
  std::map<std::string, Set> sets_;  // by the name in upper case
};

}  // namespace chladni::io
