#include "study/extends.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <ranges>
#include <tuple>
#include <utility>
#include <vector>

#include "base/error.h"
#include "host/folder.h"
#include "study/named_materials.h"
#include "study/tables/array_places.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBases = 8;

using Kind = TomlNode::Kind;

bool are_named(const TomlNode& node) {
  return node.kind == Kind::array && !node.elements.empty() &&
         std::ranges::all_of(node.elements, [](const auto& e) { return !element_name(e).empty(); });
}

void put_at(TomlNode& node, const TomlNode& place) {
  std::tie(node.line, node.column) = std::pair(place.line, place.column);
  std::tie(node.end_line, node.end_column) = std::pair(place.end_line, place.end_column);
  for (auto& entry : node.members) {
    std::tie(entry.line, entry.column) = std::pair(place.line, place.column);
    put_at(entry.value, place);
  }
  for (auto& element : node.elements) put_at(element, place);
}

// Changes the base's file names so that they start at the folder of the study that extends it.
void lead_files(TomlNode& base, const fs::path& folder) {
  if (folder.empty() || folder == ".") return;
  const auto lead = [&](TomlNode& file) {
    file.text = (folder / file.text).lexically_normal().generic_string();
  };
  for (auto* file : relative_files(base)) lead(*file);
}

// Merges `own` into `base`.
class Merge {
 public:
  Merge(std::string file, Removed removed) : file_(std::move(file)), removed_(removed) {}

  void tables(TomlNode& base, const TomlNode& own) const {
    for (const auto& entry : own.members) {
      auto* there = member(base, entry.key);
      if (there == nullptr) {
        base.members.push_back(entry);
      } else {
        value(entry.key, *there, entry.value);
      }
    }
  }

 private:
  void value(std::string_view key, TomlNode& base, const TomlNode& own) const {
    if (base.kind == Kind::table && own.kind == Kind::table && !is_another_kind(key, base, own)) {
      tables(base, own);
      return;
    }
    if (are_named(base) && are_named(own)) {
      named(key, base, own);
      return;
    }
    base = own;
  }

  // True for geometry = { plate = ... } instead of { file = ... }.
  static bool is_another_kind(std::string_view key, const TomlNode& base, const TomlNode& own) {
    return key == "geometry" && std::ranges::none_of(own.members, [&](const auto& entry) {
             return member(base, entry.key) != nullptr;
           });
  }

  void named(std::string_view key, TomlNode& base, const TomlNode& own) const {
    const bool has_arrays = std::ranges::any_of(base.elements, is_array_of_devices);
    for (const auto& element : own.elements) {
      const auto name = element_name(element);
      const auto at = std::ranges::find(base.elements, name, element_name);
      const bool is_new = at == base.elements.end();
      // One that is not there may be of an array: expand_arrays finds it.
      const bool stays = removed_ == Removed::kept || (has_arrays && is_new);
      if (is_new && (stays || !is_removed(element))) {
        base.elements.push_back(element);
      } else if (is_removed(element) && stays) {
        *at = element;
      } else if (is_removed(element)) {
        require(!is_new,
                fmt::format("{}:{}:{}: {} \"{}\" is to be removed, but the study that is extended "
                            "has none of that name",
                            file_, element.line, element.column, key, name));
        base.elements.erase(at);
      } else {
        tables(*at, element);
      }
    }
  }

  std::string file_;
  Removed removed_;
};

// Removes `extends` from the document and returns its value; none if there is none.
std::optional<TomlNode> taken_out(TomlNode& document, const fs::path& file) {
  const auto at = std::ranges::find(document.members, "extends", &TomlMember::key);
  if (at == document.members.end()) return {};
  TomlNode value = at->value;
  require(value.kind == Kind::text && !value.text.empty(),
          fmt::format("{}:{}:{}: extends is {}, expected the file of a study", file.string(),
                      value.line, value.column, description(value)));
  document.members.erase(at);
  return value;
}

std::string place_of(const fs::path& file, const TomlNode& node) {
  return fmt::format("{}:{}:{}: extends \"{}\": ", file.string(), node.line, node.column,
                     node.text);
}

}  // namespace

void merge(TomlNode& base, const TomlNode& own, const std::string& file, Removed removed) {
  Merge(file, removed).tables(base, own);
}

WholeDocument with_bases(TomlNode own, const fs::path& file, const BaseReader& read) {
  WholeDocument whole{std::move(own), {}};
  put_material_names_into_tables(whole.tree);
  const auto folder = fs::absolute(file).parent_path();
  std::vector<TomlNode> extending;  // the study first, each extends the next
  while (const auto extends = taken_out(whole.tree, file)) {
    fs::path base_file;
    std::string text;
    try {
      text = read(extends->text, base_file);
    } catch (const InvalidInput& e) {
      throw InvalidInput(place_of(file, *extends) + e.what());
    }
    require(std::ranges::find(whole.bases, base_file) == whole.bases.end() &&
                fs::weakly_canonical(base_file) != fs::weakly_canonical(file),
            place_of(file, *extends) + "a study that extends itself");
    require(whole.bases.size() < kMostBases,
            place_of(file, *extends) + "more than eight studies that extend each other");
    whole.bases.push_back(base_file);
    TomlNode base = parse_toml(text, base_file.string());
    put_material_names_into_tables(base);
    std::erase_if(base.members, [](const auto& entry) {
      return entry.key == "expect" || entry.key == "specimen";
    });
    lead_files(base, path_from(folder, fs::absolute(base_file).parent_path()));
    put_at(base, *extends);
    extending.push_back(std::exchange(whole.tree, std::move(base)));
  }
  for (const auto& later : extending | std::views::reverse) {
    merge(whole.tree, later, file.string());
  }
  return whole;
}

}  // namespace chladni::study
