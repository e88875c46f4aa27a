// A study that extends another: one document of both.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/study/toml/toml_tree.h"

namespace chladni::app {

/// Reads the text of the study `extends` names and says where it lies.
/// @throws InvalidInput  it may not be read
using BaseReader = std::function<std::string(const std::string& text, std::filesystem::path& file)>;

struct WholeDocument {
  TomlNode tree;                             ///< without the key `extends`
  std::vector<std::filesystem::path> bases;  ///< the files that were read, the nearest first
};

/// The document with the study that its key `extends` names below it, and so on.
///
/// Tables are merged key by key, and what stands in `own` counts. Elements of an array of tables
/// that have a `name` are merged by their names; a new name is appended, and `removed = true`
/// takes an element away. All else is replaced. A `geometry` of another kind is replaced, too, and
/// what a base expects is not expected of the whole.
/// Values of the base get the place of `extends`, and its files are named from the folder of `own`.
/// @param file  the file of `own`
/// @throws InvalidInput  a base that cannot be read, that extends itself, that is more than eight
///                       studies away; a name that is removed but not there
[[nodiscard]] WholeDocument with_bases(TomlNode own, const std::filesystem::path& file,
                                       const BaseReader& read);

/// The tree as a TOML text that parse_toml reads back as the same tree, places apart. Comments are
/// not part of a tree. Tables of the document stand under their headers, deeper ones in braces.
[[nodiscard]] std::string toml_text(const TomlNode& document);

}  // namespace chladni::app
