#include "io/cells/inp_sets.h"

#include <algorithm>
#include <set>

#include "io/scan.h"

namespace chladni::io {

void InpSets::set_instance(const std::string& name) {
  instance_ = name.empty() ? "" : upper(name) + ".";
}

// In upper case.
std::string InpSets::without_instance(const std::string& name) const {
  const std::string key = upper(name);
  return key.starts_with(instance_) ? key.substr(instance_.size()) : key;
}

// The 7 of "Part-1-1.7".
std::optional<std::int64_t> InpSets::id_of_instance(const std::string& name) const {
  const std::string id = without_instance(name);
  return id.size() < name.size() ? integer_in(id) : std::nullopt;
}

InpSets::Set& InpSets::at(const std::string& name) {
  const auto [entry, is_new] = sets_.try_emplace(upper(name));
  if (is_new) names_.push_back(name);
  return entry->second;
}

const InpSets::Set* InpSets::find(const std::string& name) const {
  auto found = sets_.find(upper(name));
  if (found == sets_.end()) found = sets_.find(without_instance(name));
  return found == sets_.end() ? nullptr : &found->second;
}

void InpSets::declare(const std::string& name) { static_cast<void>(at(name)); }

bool InpSets::has(const std::string& name) const { return find(name) != nullptr; }

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

std::vector<std::int64_t> InpSets::ids(const std::string& name, const Rows& all,
                                       const InpSets* also) const {
  const auto existing = all.sorted();
  std::vector<bool> inside(existing.size(), false);
  const auto take = [&](std::int64_t first, std::int64_t last, std::int64_t step) {
    auto entry = std::lower_bound(existing.begin(), existing.end(), std::pair(first, 0));
    for (; entry != existing.end() && entry->first <= last; ++entry) {
      if ((entry->first - first) % step != 0) continue;
      inside[static_cast<std::size_t>(entry - existing.begin())] = true;
    }
  };
  std::set<const Set*> seen;
  std::vector<std::string> to_see{name};
  while (!to_see.empty()) {
    const std::string next = std::move(to_see.back());
    to_see.pop_back();
    bool is_set = false;
    for (const InpSets* const sets : {this, also}) {
      const Set* const set = sets == nullptr ? nullptr : sets->find(next);
      is_set = is_set || set != nullptr;
      if (set == nullptr || !seen.insert(set).second) continue;
      to_see.insert(to_see.end(), set->members.begin(), set->members.end());
      for (const auto& [first, last, step] : set->ranges) take(first, last, step);
    }
    if (is_set) continue;
    if (const auto id = id_of_instance(next)) take(*id, *id, 1);
  }
  std::vector<std::int64_t> found;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i]) found.push_back(existing[i].first);
  }
  return found;
}

std::vector<std::string> InpSets::missing(const InpSets* also) const {
  std::vector<std::string> found;
  for (const std::string& name : names_) {
    for (const std::string& member : find(name)->members) {
      const bool known = has(member) || (also != nullptr && also->has(member)) ||
                         id_of_instance(member).has_value();
      if (!known) found.push_back(shown(member) + " of " + shown(name));
    }
  }
  return found;
}

}  // namespace chladni::io
