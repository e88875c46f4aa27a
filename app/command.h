// The verbs of the command line.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "show/run.h"

namespace chladni::app {

struct Command {
  std::string_view name;     ///< the word typed
  std::string_view summary;  ///< one line for --help
  void (*run)(const study::Study& study, show::Run& run);
};

extern const Command check_command;
extern const Command mesh_command;
extern const Command modes_command;
extern const Command export_command;
extern const Command place_command;
extern const Command priors_command;
extern const Command experiment_command;
extern const Command simulate_command;
extern const Command identify_command;
extern const Command interpolate_command;
extern const Command compare_command;
extern const Command observe_command;
extern const Command diagnose_command;
extern const Command study_command;

/// Verbs without a study. They return the exit code.
[[nodiscard]] int doctor(std::ostream& results);
[[nodiscard]] int list(std::string_view what, std::ostream& results);
[[nodiscard]] std::vector<std::string> listable();
/// What the command line says of a first study.
struct NewStudy {
  std::string what;              ///< a kind of body, or the file to write
  std::filesystem::path from;    ///< the body's file; empty: by its dimensions
  std::filesystem::path output;  ///< the file to write; empty: `what`, or named after the kind
  std::string unit;
};
[[nodiscard]] int new_study(const NewStudy& wanted, std::ostream& results);
[[nodiscard]] int cache(bool clear, bool json, std::ostream& results);
/// What the command line says of figures for a paper.
struct Figures {
  std::filesystem::path results;   ///< a folder that a verb left, or a result within it
  std::vector<std::string> names;  ///< empty: all that can be drawn
  std::filesystem::path output;    ///< folder; empty: that of the results
  std::vector<std::string> formats{"svg", "png"};
  double width_mm = 160.0;
  double dpi = 300.0;  ///< of PNG [1/inch]
  bool list = false, json = false;
};
[[nodiscard]] int figure(const Figures& asked, std::ostream& results);
/// @param unit  of what is read, where it states none
/// @param hdf5  a .mat becomes version 7.3
[[nodiscard]] int convert(const std::filesystem::path& from, const std::filesystem::path& to,
                          const std::string& unit, bool hdf5, std::ostream& results);
/// Measured data: the content of a file and suspect values; conversion between formats.
[[nodiscard]] int check_data(const std::filesystem::path& file, const show::Options& options,
                             std::ostream& results);
[[nodiscard]] int convert_data(const std::filesystem::path& from, const std::filesystem::path& to,
                               const std::string& unit, bool hdf5, std::ostream& results);

}  // namespace chladni::app
