// The places of an array of devices.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "study/problems.h"
#include "study/toml/toml_tree.h"

namespace chladni::study {

struct ArrayPlace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< [m]
  bool from_above = true;                             ///< x and y alone
  std::string name;                                   ///< of a CSV file; empty: counted
  Eigen::Vector2d outward = Eigen::Vector2d::Zero();  ///< from the array's centre; 0: it is there
};

/// True if `at` is a table: { ring = ... }, { grid = ... }, { hexagon = ... } or { csv = ... }.
[[nodiscard]] bool is_array_of_devices(const TomlNode& element);
[[nodiscard]] bool is_removed(const TomlNode& element);
/// Empty: it has none.
[[nodiscard]] std::string element_name(const TomlNode& element);

/// The places of an element: those of its array, or its own. Problems are reported, and places then
/// may be missing.
[[nodiscard]] std::vector<ArrayPlace> array_places(
    const TomlNode& element, const std::string& key,
    const std::function<std::filesystem::path(const std::string&)>& resolved, Problems& problems,
    std::vector<std::filesystem::path>& files);

/// ["0.085 m", "0 m"], at the position of `like`.
[[nodiscard]] TomlNode place_node(const Eigen::Vector3d& point, bool from_above,
                                  const TomlNode& like);
/// A text at the position of `like`.
[[nodiscard]] TomlNode text_node(const std::string& text, const TomlNode& like);

}  // namespace chladni::study
