#include "show/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/error.h"
#include "host/atomic_file.h"
#include "show/figures/stored_figures.h"
#include "show/run/output_folder.h"
#include "show/version.h"
#include "study/problems.h"

namespace chladni::show {
namespace {

using Path = std::filesystem::path;

/// A picture whose data no verb stores.
struct BoundPicture {
  std::string_view name, verb, reason;
};

constexpr auto kBody = "a picture of the body, which its .vtu holds but no JSON";
constexpr auto kCurves = "its curves are not stored";

constexpr std::array kBound{
    BoundPicture{"mesh", "mesh", kBody},
    BoundPicture{"modes", "modes", kBody},
    BoundPicture{"heat_map", "place", kBody},
    BoundPicture{"layouts", "place", kBody},
    BoundPicture{"mode_field", "interpolate", kBody},
    BoundPicture{"cause_map", "diagnose", kBody},
    BoundPicture{"fit", "identify", kCurves},
    BoundPicture{"predicted", "interpolate", kCurves},
    BoundPicture{"responses", "compare", kCurves},
    BoundPicture{"prediction", "diagnose", kCurves},
    BoundPicture{"observer", "observe", kCurves},
    BoundPicture{"experiment", "experiment", kCurves},
};

// The files of which one is in every folder that a verb left.
constexpr std::array kResults{
    "modes.json",     "mesh.json",       "placement.json",     "priors.json",  "experiment.json",
    "simulated.json", "identified.json", "interpolation.json", "observe.json", "comparison.json",
    "diagnosis.json", "study.json",      "export.json",        "sweep.json"};

bool is_file(const Path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored);
}

// The content of a result.
io::Json stored(const Path& file) {
  try {
    auto json = io::parse_json(read_whole(file));
    require(std::holds_alternative<io::JsonObject>(json.value()), "expected an object");
    return json;
  } catch (const InvalidInput& fault) {
    throw InvalidInput(file.string() + ": not the whole result of a verb: " + fault.what());
  }
}

// Without the commit, which differs between builds of one version.
std::string release(const std::string& version) { return version.substr(0, version.find('+')); }

// "; it is of Chladni 0.1.0, and this is 0.2.0: run the verb again" where that is so.
std::string of_another_version(const io::Json& content) {
  std::string written = "an unknown version";
  try {
    written = release(content.at("chladni").string());
  } catch (const InvalidInput&) {  // no header
  }
  const auto own = release(version());
  if (written == own) return "";
  return fmt::format("; it is of Chladni {}, and this is {}: run its verb again", written, own);
}

// Why the data do not make the figure; empty: they do, and it is drawn if that is wanted.
std::string fault_of(const StoredFigure& figure, const Path& file, const io::Json& content,
                     const io::PictureFile& picture) {
  try {
    figure.draw(file, content, picture);
    return "";
  } catch (const InvalidInput& fault) {
    return file.filename().string() + ": " + fault.what() + of_another_version(content);
  }
}

/// A figure of the folder with its data.
struct Found {
  FolderFigure figure;
  const StoredFigure* drawn = nullptr;  ///< null: nothing is stored
  io::Json content;
};

// No file is left: what would be drawn is thrown away.
io::PictureFile nowhere() { return {Path(), nullptr, io::Print{.svg = false, .png = false}}; }

std::vector<Found> found_in(const Path& folder) {
  std::vector<Found> all;
  for (const auto& figure : stored_figures()) {
    for (const auto& name : figure.files) {
      if (!is_file(folder / name)) continue;
      auto content = stored(folder / name);
      auto reason = fault_of(figure, folder / name, content, nowhere());
      all.push_back({{std::string(figure.name), std::string(figure.meaning), name, reason, {}},
                     &figure,
                     std::move(content)});
      break;
    }
  }
  for (const auto& picture : kBound) {
    if (!is_file(folder / (std::string(picture.name) + ".png"))) continue;
    const auto reason =
        fmt::format("{}; `chladni {} STUDY --svg` draws it", picture.reason, picture.verb);
    all.push_back({{std::string(picture.name), "", {}, reason, {}}, nullptr, {}});
  }
  std::ranges::stable_partition(all, [](const Found& one) { return one.figure.reason.empty(); });
  return all;
}

// @throws InvalidInput  there is no such figure, or it cannot be drawn
void require_drawable(const std::vector<std::string>& names, const std::vector<Found>& all,
                      const Path& folder) {
  std::vector<std::string> known;
  for (const auto& one : all) known.push_back(one.figure.name);
  for (const auto& name : names) {
    const auto found = std::ranges::find(known, name);
    require(
        found != known.end(),
        fmt::format("{}: there is no figure \"{}\"; {}", folder.string(), name,
                    known.empty() ? "there is none at all" : "expected " + study::listed(known)));
    const auto& figure = all[static_cast<std::size_t>(found - known.begin())].figure;
    require(figure.reason.empty(),
            fmt::format("{}: \"{}\" cannot be drawn: {}", folder.string(), name, figure.reason));
  }
}

// Draws into `output`, and tells the files.
void draw(const Found& one, const Path& folder, const Path& output, const io::Print& print,
          FolderFigure& figure) {
  const auto png = output / (figure.name + ".png");
  const auto from = folder / figure.from;
  one.drawn->draw(from, one.content, {png, nullptr, print});
  if (print.svg) figure.files.push_back(figure.name + ".svg");
  if (print.png) figure.files.push_back(figure.name + ".png");
}

}  // namespace

std::filesystem::path results_folder(const std::filesystem::path& results) {
  std::error_code ignored;
  require(std::filesystem::exists(results, ignored),
          results.string() + ": there is no such folder or file");
  const bool is_folder = std::filesystem::is_directory(results, ignored);
  const auto folder = is_folder ? results : results.has_parent_path() ? results.parent_path() : ".";
  const auto is_there = [&](const char* name) { return is_file(folder / name); };
  require(std::ranges::any_of(kResults, is_there),
          folder.string() +
              ": no results of Chladni; expected a folder that a verb left, which has "
              "modes.json, comparison.json, diagnosis.json or the like");
  return folder;
}

std::vector<FolderFigure> figures_in(const std::filesystem::path& folder) {
  std::vector<FolderFigure> figures;
  for (auto& one : found_in(folder)) figures.push_back(std::move(one.figure));
  return figures;
}

std::vector<FolderFigure> draw_figures(const FiguresWanted& wanted) {
  const auto all = found_in(wanted.folder);
  require_drawable(wanted.names, all, wanted.folder);
  const auto is_wanted = [&](const Found& one) {
    return wanted.names.empty() || std::ranges::count(wanted.names, one.figure.name) > 0;
  };
  require(std::ranges::any_of(all, [](const Found& one) { return one.figure.reason.empty(); }),
          wanted.folder.string() +
              ": no figure can be drawn from what is there; `chladni figure "
              "RESULTS --list` says why");
  const OutputFolder output(wanted.output.empty() ? wanted.folder : wanted.output);
  std::vector<FolderFigure> figures;
  for (const auto& one : all) {
    if (!is_wanted(one)) continue;
    auto& figure = figures.emplace_back(one.figure);
    if (figure.reason.empty()) draw(one, wanted.folder, output.path(), wanted.print, figure);
  }
  return figures;
}

std::string figures_text(const std::vector<FolderFigure>& figures) {
  std::string text;
  for (const auto& one : figures) {
    const auto files = fmt::format("{}", fmt::join(one.files, ", "));
    text += fmt::format("{:<24} {}\n", one.name,
                        !one.reason.empty() ? "not drawn: " + one.reason
                        : one.files.empty() ? one.meaning + ", from " + one.from.string()
                                            : files);
  }
  return text.empty() ? "no figures\n" : text;
}

io::Json figures_json(const std::filesystem::path& folder,
                      const std::vector<FolderFigure>& figures) {
  io::JsonArray array;
  for (const auto& one : figures) {
    const auto or_null = [](const std::string& words) {
      return words.empty() ? io::Json() : io::Json(words);
    };
    array.push_back(io::JsonObject{{"name", one.name},
                                   {"meaning", or_null(one.meaning)},
                                   {"from", or_null(one.from.string())},
                                   {"files", io::Json::texts(one.files)},
                                   {"reason", or_null(one.reason)}});
  }
  return io::JsonObject{{"chladni", version()}, {"folder", folder.string()}, {"figures", array}};
}

}  // namespace chladni::show
