// Figures for a paper, drawn anew from the results in a folder: nothing is solved.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/json.h"
#include "io/picture_file.h"

namespace chladni::show {

/// A figure that verbs leave, or one that only `chladni figure` draws, in one folder.
struct FolderFigure {
  std::string name;                ///< of its files, without the ending
  std::string meaning;             ///< one line
  std::filesystem::path from;      ///< name of the file with its data; empty: there is none
  std::string reason;              ///< why it cannot be drawn; empty: it can
  std::vector<std::string> files;  ///< that were left
};

/// The folder that is meant by a folder or by a report or another result within it.
/// @throws InvalidInput  there is no such file or folder, or it holds no result of Chladni
[[nodiscard]] std::filesystem::path results_folder(const std::filesystem::path& results);

/// The figures of which there are data or pictures in the folder, those that can be drawn as
/// `print` says first.
/// @throws InvalidInput  a file with data of a figure is damaged (names it)
[[nodiscard]] std::vector<FolderFigure> figures_in(const std::filesystem::path& folder,
                                                   const io::Print& print);

struct FiguresWanted {
  std::filesystem::path folder;    ///< of the results
  std::filesystem::path output;    ///< folder to write to; empty: the same
  std::vector<std::string> names;  ///< empty: all that can be drawn; "fit:s1/a2": one response
  io::Print print;
};

/// Draws the figures that are wanted. Without names also says why others cannot be drawn.
/// What cannot be drawn at the width or resolution of `print` is found before a file is written.
/// @throws InvalidInput  a name that is none of figures_in(), or cannot be drawn (says why);
/// nothing
///                       can be drawn; a damaged file
/// @throws WorkerDied    a PNG cannot be painted (says why)
[[nodiscard]] std::vector<FolderFigure> draw_figures(const FiguresWanted& wanted);

/// A line per figure.
[[nodiscard]] std::string figures_text(const std::vector<FolderFigure>& figures);
/// What `--json` prints.
[[nodiscard]] io::Json figures_json(const std::filesystem::path& folder,
                                    const std::vector<FolderFigure>& figures);

}  // namespace chladni::show
