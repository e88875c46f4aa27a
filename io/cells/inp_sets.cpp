#include "io/cells/inp_sets.h"

#include <algorithm>
#include <set>

#include "io/scan.h"

namespace chladni::io {
namespace {

std::string key_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return upper(dot == name.npos ? name : name.substr(dot + 1));
}

}  // namespace

InpSets::Set& InpSets::at(const std::string& name) {
  const auto [entry, is_new] = sets_.try_emplace(key_of(name));
  if (is_new) names_.push_back(name);
  return entry->second;
}

void InpSets::declare(const std::string& name) { static_cast<void>(at(name)); }

bool InpSets::has(const std::string& name) const { return sets_.contains(key_of(name)); }

void InpSets::add(const std::string& name, std::int64_t id) {
  auto& ranges = at(name).ranges;
  const bool goes_on = !ranges.empty() && ranges.back()[2] == 1 && ranges.back()[1] == id - 1;
  if (goes_on) {
    ranges.back()[1] = id;
  } else {
    ranges.push_back({id, id, 1});
  }
}

void InpSets::add_range(const std::string& name, std::int64_t first, std::int64_t last,
                        std::int64_t step) {
  at(name).ranges.push_back({first, last, step});
}

void InpSets::add_set(const std::string& name, const std::string& member) {
  at(name).members.push_back(member);
}

std::vector<std::int64_t> InpSets::ids(const std::string& name, const Rows& all) const {
  const auto existing = all.sorted();
  std::vector<bool> inside(existing.size(), false);
  std::set<std::string> seen;
  std::vector<std::string> to_see{key_of(name)};
  while (!to_see.empty()) {
    const std::string key = to_see.back();
    to_see.pop_back();
    const auto set = sets_.find(key);
    if (set == sets_.end() || !seen.insert(key).second) continue;
    for (const std::string& member : set->second.members) to_see.push_back(key_of(member));
    for (const auto& [first, last, step] : set->second.ranges) {
      auto entry = std::lower_bound(existing.begin(), existing.end(), std::pair(first, 0));
      for (; entry != existing.end() && entry->first <= last; ++entry) {
        if ((entry->first - first) % step != 0) continue;
        inside[static_cast<std::size_t>(entry - existing.begin())] = true;
      }
    }
  }
  std::vector<std::int64_t> found;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i]) found.push_back(existing[i].first);
  }
  return found;
}

}  // namespace chladni::io
