// TOML written: texts and whole trees.
#pragma once

#include <string>
#include <string_view>

#include "study/toml/toml_tree.h"

namespace chladni::study {

/// Text in quotes, with the escapes of TOML.
[[nodiscard]] std::string toml_text(std::string_view text);

/// The tree as a TOML text. parse_toml reads it back as the same tree, except for positions.
/// Comments are not part of a tree. Tables of the document have headers; deeper ones are in braces.
[[nodiscard]] std::string toml_text(const TomlNode& document);

}  // namespace chladni::study
