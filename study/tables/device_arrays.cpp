#include "study/device_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "host/atomic_file.h"
#include "study/extends.h"
#include "study/schemas.h"
#include "study/tables/array_places.h"
#include "study/tables/mounts.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

using NodeKind = TomlNode::Kind;
using Resolved = std::function<std::filesystem::path(const std::string&)>;

constexpr const char* kLists[] = {"sensor", "actuator", "attachment"};

/// All that one expansion needs and leaves.
class Expansion {
 public:
  Expansion(const Resolved& resolved, Problems& problems, std::vector<std::filesystem::path>& files)
      : resolved_(resolved), problems_(problems), files_(files) {}

  bool lists(TomlNode& document) {
    for (const auto* key : kLists) {
      if (auto* list = member(document, key)) one_list(key, *list);
    }
    for (auto& list : all_named_lists(document)) put_members(*list.first, list.second);
    return any_;
  }

 private:
  void one_list(const std::string& key, TomlNode& list) {
    const auto is_array = [](const TomlNode& element) {
      return is_array_of_devices(element) || is_mount(element);
    };
    if (list.kind != NodeKind::array || std::ranges::none_of(list.elements, is_array)) return;
    any_ = true;
    std::vector<TomlNode> all;
    std::vector<std::string> made;  // names of elements that came from an array
    for (auto& element : list.elements) {
      if (is_array(element)) {
        for (auto& one : elements_of(key, element)) {
          made.push_back(element_name(one));
          all.push_back(std::move(one));
        }
      } else if (std::ranges::count(made, element_name(element)) > 0) {
        change(key, all, element);
      } else if (is_removed(element)) {
        problems_.add(
            element.line, element.column,
            key + " \"" + element_name(element) + "\" is to be removed, but there is none");
      } else {
        all.push_back(std::move(element));
      }
    }
    for (auto& [array, names] : members_[list_of(key)]) {
      std::erase_if(names, [&](const std::string& name) {
        return std::ranges::find(all, name, element_name) == all.end();
      });
    }
    list.elements = std::move(all);
  }

  /// "sensors", "actuators": the list of a layout in which its elements may stand.
  static std::string list_of(const std::string& key) { return key + "s"; }

  void change(const std::string& key, std::vector<TomlNode>& all, const TomlNode& by) {
    const auto at = std::ranges::find(all, element_name(by), element_name);
    if (at == all.end()) {
      problems_.add(by.line, by.column, key + " \"" + element_name(by) + "\" was removed before");
    } else if (is_removed(by)) {
      all.erase(at);
    } else {
      merge(*at, by, problems_.file());
    }
  }

  std::vector<TomlNode> elements_of(const std::string& key, const TomlNode& element) {
    const std::string name = element_name(element);
    if (name.empty()) {
      problems_.add(element.line, element.column,
                    key +
                        " lacks \"name\"; expected a text, with which the names of its elements "
                        "begin");
    }
    const auto places = array_places(element, key, resolved_, problems_, files_);
    std::vector<TomlNode> all;
    for (std::size_t i = 0; i < places.size(); ++i) {
      TomlNode one = element;
      if (is_array_of_devices(element)) put_place(one, places[i], name, i);
      members_[list_of(key)][name].push_back(element_name(one));
      if (!is_mount(one)) {
        all.push_back(std::move(one));
        continue;
      }
      for (auto& spring : springs_of(one, places[i], problems_)) all.push_back(std::move(spring));
    }
    return all;
  }

  void put_place(TomlNode& one, const ArrayPlace& place, const std::string& name,
                 std::size_t i) const {
    if (auto* called = member(one, "name")) {
      called->text = place.name.empty() ? fmt::format("{}{}", name, i + 1) : place.name;
    }
    *member(one, "at") = place_node(place.point, place.from_above, *member(one, "at"));
    if (auto* node = member(one, "node"); node != nullptr && node->kind == NodeKind::integer) {
      node->number += static_cast<double>(i);
      node->text = fmt::format("{:.0f}", node->number);
    }
  }

  // Lists of names in which the name of an array stands for its elements.
  static std::vector<std::pair<TomlNode*, std::string>> all_named_lists(TomlNode& document) {
    std::vector<std::pair<TomlNode*, std::string>> lists;
    const auto add = [&](TomlNode* table, const char* key, const char* of) {
      auto* list = table == nullptr ? nullptr : member(*table, key);
      if (list != nullptr && list->kind == NodeKind::array) lists.emplace_back(list, of);
    };
    if (auto* layouts = member(document, "layout")) {
      for (auto& layout : layouts->elements) {
        add(&layout, "sensors", "sensors");
        add(&layout, "actuators", "actuators");
      }
    }
    auto* measurement = member(document, "measurement");
    add(measurement, "hold_out", "sensors");
    add(measurement, "hold_out", "actuators");
    return lists;
  }

  void put_members(TomlNode& list, const std::string& of) {
    const auto& arrays = members_[of];
    std::vector<TomlNode> all;
    for (const auto& element : list.elements) {
      const auto found = element.kind == NodeKind::text ? arrays.find(element.text) : arrays.end();
      if (found == arrays.end()) {
        all.push_back(element);
        continue;
      }
      for (const auto& name : found->second) {
        all.push_back(element);
        all.back().text = name;
      }
    }
    list.elements = std::move(all);
  }

  const Resolved& resolved_;
  Problems& problems_;
  std::vector<std::filesystem::path>& files_;
  std::map<std::string, std::map<std::string, std::vector<std::string>>> members_;
  bool any_ = false;
};

}  // namespace

bool expand_arrays(TomlNode& document, const Resolved& resolved, Problems& problems,
                   std::vector<std::filesystem::path>& files) {
  return Expansion(resolved, problems, files).lists(document);
}

}  // namespace chladni::study
