#include "diagnosis/modes/specimens/series.h"

#include <algorithm>

namespace chladni::diagnosis {

using Eigen::Index;

Index entry_of(const Series& series, Index body, const std::string& key) {
  const auto found = std::ranges::find_if(series.entries, [&](const Series::Entry& one) {
    return one.body == body && one.stated.name == key;
  });
  return found == series.entries.end() ? -1 : found - series.entries.begin();
}

Index constant_of(const Series& series, const std::string& key) {
  const auto found = std::ranges::find_if(
      series.constants, [&](const Series::Constant& one) { return one.stated.name == key; });
  return found == series.constants.end() ? -1 : found - series.constants.begin();
}

}  // namespace chladni::diagnosis
