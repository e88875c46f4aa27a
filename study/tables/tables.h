// The parts of a study. One function reads each part into `study`.
#pragma once

#include <filesystem>
#include <vector>

#include "io/json.h"
#include "study/study.h"
#include "study/toml/table_reader.h"

namespace chladni::study {

/// Folders from which the study may read files.
struct StudyFolder {
  std::filesystem::path folder;                ///< the study's own
  std::vector<std::filesystem::path> allowed;  ///< from --allow-outside
  /// Gets each path that the study names, there or not; null: nobody asks for them.
  std::vector<std::filesystem::path>* named = nullptr;

  /// `text` as a path below one of them, with symbolic links resolved.
  /// @throws InvalidInput  it lies elsewhere
  [[nodiscard]] std::filesystem::path resolved(const std::string& text) const;
};

void read_geometry_part(TableReader& root, const StudyFolder& folder, Study& study);
void read_mesh_part(TableReader& root, Study& study);
void read_materials(TableReader& root, Study& study);
void read_modes_part(TableReader& root, Study& study);
void read_supports(TableReader& root, Study& study);
void read_attachments(TableReader& root, Study& study);
void read_variations(TableReader& root, Study& study);
void read_channels(TableReader& root, Study& study);  ///< sensors and actuators
void read_layouts(TableReader& root, Study& study);   ///< after the channels
void read_placement(TableReader& root, Study& study);
void read_measurement(TableReader& root, const StudyFolder& folder, Study& study);
/// After the channels.
void read_experiment(TableReader& root, const StudyFolder& folder, Study& study);
void read_design(TableReader& root, Study& study);
void read_identification(TableReader& root, Study& study);
void read_state_space(TableReader& root, Study& study);
void read_interpolation(TableReader& root, Study& study);
void read_observer(TableReader& root, const StudyFolder& folder, Study& study);
void read_priors(TableReader& root, Study& study);
void read_diagnosis(TableReader& root, const StudyFolder& folder, Study& study);
void read_specimens(TableReader& root, const StudyFolder& folder, Study& study);
void read_expectations(TableReader& root, Study& study);

/// The path of `key`, which is added to the files of the study; empty if the key is missing. A path
/// outside the folders is a problem, and `hint` ends its message.
[[nodiscard]] std::filesystem::path read_path(TableReader& table, const StudyFolder& folder,
                                              std::string_view key, Study& study,
                                              const std::string& hint = {});

/// "at" of a channel or attachment: two or three lengths. A missing or wrong value is a problem.
[[nodiscard]] Place read_place(TableReader& table, std::string_view key);

/// "on": names of patches or { facing = "z" }. A wrong value is a problem.
[[nodiscard]] FacePlan read_faces(TableReader& table, std::string_view key);

/// The same in study.json.
[[nodiscard]] io::Json faces_json(const FacePlan& on);

/// "direction": "z", ... or "normal".
void read_motion(TableReader& table, std::optional<Eigen::Vector3d>& direction, bool& along_normal);
/// The same in study.json.
[[nodiscard]] io::Json motion_json(const std::optional<Eigen::Vector3d>& direction);

/// The SI unit of all sensors; "m" without sensors, empty where their quantities differ.
[[nodiscard]] std::string sensor_unit(const Study& study);

/// "mass", "spring", ...
[[nodiscard]] const std::vector<std::string>& attachment_kinds();

inline constexpr int kMostModes = 5000;
inline constexpr int kLongestPeriod = 1 << 24;  // samples

/// Reports each name of `key` that is not `known`, with the nearest known one.
void refuse_strangers(TableReader& table, std::string_view key, const std::string& what,
                      const std::vector<std::string>& wanted,
                      const std::vector<std::string>& known);

/// Checks that names are not empty and are different; a message gives both lines.
class Names {
 public:
  explicit Names(std::string what) : what_(std::move(what)) {}
  void add(TableReader& table, const std::string& name);

 private:
  std::string what_;
  std::vector<std::pair<std::string, int>> seen_;
};

}  // namespace chladni::study
