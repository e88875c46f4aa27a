// Figures from the data that verbs have stored.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "io/json.h"
#include "io/picture_file.h"

namespace chladni::show {

/// A figure that can be drawn from one stored file.
struct StoredFigure {
  std::string_view name, meaning;
  std::vector<std::string_view>
      files;  ///< the first of these from which it can be drawn has the data
  /// @param content  of the file; null if that is no JSON
  /// @throws InvalidInput  the data of this figure are not in it
  void (*draw)(const std::filesystem::path& file, const io::Json& content,
               const io::PictureFile& picture);
  /// Likewise of one "sensor/actuator"; null: this figure has no parts.
  void (*draw_part)(const io::Json& content, std::string_view part,
                    const io::PictureFile& picture) = nullptr;
};

/// All of them. A new figure needs one line there.
[[nodiscard]] std::span<const StoredFigure> stored_figures();

/// The frequency deviation of each pair of modes, in the order of the simulated ones.
void draw_frequency_errors(const std::filesystem::path& file, const io::Json& content,
                           const io::PictureFile& picture);

}  // namespace chladni::show
