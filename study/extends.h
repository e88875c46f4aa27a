// A study that extends another one, merged into one document.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study/toml/toml_tree.h"

namespace chladni::study {

/// Reads the text of the study that `extends` names, and returns its place.
/// @throws InvalidInput  reading it is not allowed
using BaseReader = std::function<std::string(const std::string& text, std::filesystem::path& file)>;

struct WholeDocument {
  TomlNode tree;                             ///< without the key `extends`
  std::vector<std::filesystem::path> bases;  ///< the files that were read, the nearest first
};

/// Merges a document with the study that its key `extends` names, and so on.
///
/// Tables are merged key by key, and the values in `own` win. Elements of an array of tables that
/// have a `name` are merged by name; a new name is appended, and `removed = true` removes an
/// element. All other values are replaced, and so is a `geometry` of another kind. Expectations and
/// specimens of a base are not those of the merged study.
/// Values of the base get the position of `extends`, and its file names start at the folder of
/// `own`.
/// @param file  the file of `own`
/// @throws InvalidInput  a base that cannot be read, that extends itself, or that is more than
///                       eight studies away; a name that is removed but does not exist
[[nodiscard]] WholeDocument with_bases(TomlNode own, const std::filesystem::path& file,
                                       const BaseReader& read);

/// What becomes of an element with `removed = true`: it removes that of the base, or it is kept for
/// a base that comes later.
enum class Removed { applied, kept };

/// Merges `own` into `base` by the rules above.
/// @param file  of `own`, for messages. @throws InvalidInput  a name that is removed but not there
void merge(TomlNode& base, const TomlNode& own, const std::string& file,
           Removed removed = Removed::applied);

/// Table and key of each text that names a file from the study's folder, of an array of tables in
/// each of its elements. `extends` and the tables of places are beside these.
inline constexpr std::pair<std::string_view, std::string_view> kFileKeys[] = {
    {"geometry", "file"},          {"measurement", "frf"},       {"measurement", "time"},
    {"measurement", "validation"}, {"measurement", "shapes"},    {"measurement", "truth"},
    {"measurement", "modes"},      {"measurement", "reference"}, {"diagnosis", "tolerances"},
    {"experiment", "excitation"},  {"observer", "replay"},       {"observer", "truth"},
    {"specimen", "study"}};

/// The texts of a study's document that name a file from the study's folder.
template <typename Node>
[[nodiscard]] std::vector<Node*> relative_files(Node& document) {
  std::vector<Node*> named{member(document, "extends")};
  for (const auto& [part, key] : kFileKeys) {
    auto* table = member(document, part);
    if (table == nullptr) continue;
    named.push_back(member(*table, key));
    for (auto& element : table->elements) named.push_back(member(element, key));
  }
  for (const auto* part : {"sensor", "actuator", "attachment"}) {
    auto* list = member(document, part);
    if (list == nullptr) continue;
    for (auto& element : list->elements) {
      auto* at = member(element, "at");
      if (at != nullptr) named.push_back(member(*at, "csv"));
    }
  }
  std::erase_if(named, [](const Node* node) {
    return node == nullptr || node->kind != TomlNode::Kind::text || node->text.empty() ||
           std::filesystem::path(node->text).is_absolute();
  });
  return named;
}

}  // namespace chladni::study
