#include "show/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
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

// "; it is of Chladni 0.1.0, and this is 0.2.0: run its verb again" where that is so.
std::string of_another_version(const io::Json& content) {
  std::string written;
  try {
    written = release(content.at("chladni").string());
  } catch (const InvalidInput&) {
    return "; it does not state which Chladni wrote it";
  }
  const auto own = release(version());
  if (written == own) return "";
  return fmt::format("; it is of Chladni {}, and this is {}: run its verb again", written, own);
}

/// What a name asks for: "mac", or "fit:s1/a2", a part of a figure.
struct Asked {
  std::string figure, part;
};

Asked asked_by(const std::string& name) {
  const auto colon = name.find(':');
  if (colon == std::string::npos) return {name, ""};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

// The stem of the files: "fit_s1_a2". Letters that a name of a file should not have become '-'.
std::string file_stem(const Asked& asked) {
  auto part = asked.part;
  std::ranges::replace(part, '/', '_');
  std::ranges::replace_if(
      part,
      [](char c) { return std::string_view(" \\:*?\"<>|").find(c) != std::string_view::npos; },
      '-');
  return asked.figure + (part.empty() ? "" : "_" + part);
}

void draw_stored(const StoredFigure& figure, const std::string& part, const Path& file,
                 const io::Json& content, const io::PictureFile& picture) {
  if (part.empty()) {
    figure.draw(file, content, picture);
  } else {
    figure.draw_part(content, part, picture);
  }
}

// Why the data do not make the figure; empty: they do, and it is drawn if that is wanted.
std::string fault_of(const StoredFigure& figure, const std::string& part, const Path& file,
                     const io::Json& content, const io::PictureFile& picture) {
  try {
    draw_stored(figure, part, file, content, picture);
    return "";
  } catch (const InvalidInput& fault) {
    const std::string reason = fault.what();
    // A key is missing or of another kind: the file has another layout.
    const bool is_of_layout = reason.starts_with("JSON: ");
    return file.filename().string() + ": " + reason +
           (is_of_layout ? of_another_version(content) : "");
  }
}

/// A figure of the folder with its data.
struct Found {
  FolderFigure figure;
  const StoredFigure* drawn = nullptr;      ///< null: nothing is stored
  std::shared_ptr<const io::Json> content;  ///< of the file; null: nothing is stored
  std::string part = {};                    ///< "s1/a2"; empty: all of it
};

// The files of a folder, each read once.
class StoredFiles {
 public:
  explicit StoredFiles(Path folder) : folder_(std::move(folder)) {}

  // null: there is no such file
  std::shared_ptr<const io::Json> content(std::string_view name) {
    const auto [place, is_new] = contents_.try_emplace(std::string(name));
    if (is_new && is_file(folder_ / name)) {
      place->second = std::make_shared<const io::Json>(stored(folder_ / name));
    }
    return place->second;
  }

 private:
  Path folder_;
  std::map<std::string, std::shared_ptr<const io::Json>> contents_;
};

// The first file from which the figure can be drawn; else all reasons. None: no file is there.
std::optional<Found> found_figure(const StoredFigure& figure, const Path& folder,
                                  StoredFiles& files, const io::Print& print) {
  const io::PictureFile nowhere(Path(), nullptr, print);
  std::optional<Found> one;
  for (const auto& name : figure.files) {
    auto content = files.content(name);
    if (!content) continue;
    const auto reason = fault_of(figure, "", folder / name, *content, nowhere);
    if (!one || reason.empty()) {
      one = {{std::string(figure.name), std::string(figure.meaning), name, reason, {}},
             &figure,
             std::move(content)};
    } else {
      one->figure.reason += "; " + reason;
    }
    if (reason.empty()) break;
  }
  return one;
}

std::vector<Found> found_in(const Path& folder, const io::Print& print) {
  std::vector<Found> all;
  StoredFiles files(folder);
  for (const auto& figure : stored_figures()) {
    if (auto one = found_figure(figure, folder, files, print)) all.push_back(*std::move(one));
  }
  for (const auto& picture : kBound) {
    if (!is_file(folder / (std::string(picture.name) + ".png"))) continue;
    const auto is_it = [&](const Found& one) { return one.figure.name == picture.name; };
    if (std::ranges::any_of(all, is_it)) continue;
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
    const auto found = std::ranges::find(known, asked_by(name).figure);
    require(
        found != known.end(),
        fmt::format("{}: there is no figure \"{}\"; {}", folder.string(), name,
                    known.empty() ? "there is none at all" : "expected " + study::listed(known)));
    const auto& one = all[static_cast<std::size_t>(found - known.begin())];
    const bool is_part = name.find(':') != std::string::npos && one.drawn != nullptr;
    require(
        is_part || one.figure.reason.empty(),
        fmt::format("{}: \"{}\" cannot be drawn: {}", folder.string(), name, one.figure.reason));
    require(!is_part || one.drawn->draw_part != nullptr,
            fmt::format("{}: \"{}\" has no parts; expected \"{}\"", folder.string(),
                        one.figure.name, one.figure.name));
  }
}

// @throws InvalidInput  there is no such part
Found part_of(Found whole, const Asked& asked, const Path& folder, const io::Print& print) {
  whole.part = asked.part;
  whole.figure.name = file_stem(asked);
  whole.figure.reason.clear();  // of all of it: that may be too large
  const io::PictureFile nowhere(Path(), nullptr, print);
  const auto fault =
      fault_of(*whole.drawn, whole.part, folder / whole.figure.from, *whole.content, nowhere);
  require(fault.empty(), fmt::format("{}: \"{}:{}\" cannot be drawn: {}", folder.string(),
                                     asked.figure, asked.part, fault));
  return whole;
}

// All, or those with the names, each once, in the order of `all`.
std::vector<Found> chosen_of(const std::vector<std::string>& names, const std::vector<Found>& all,
                             const Path& folder, const io::Print& print) {
  if (names.empty()) return all;
  std::vector<Found> chosen;
  for (const auto& one : all) {
    for (const auto& name : names) {
      const auto asked = asked_by(name);
      const auto stem = file_stem(asked);
      const auto is_it = [&](const Found& other) { return other.figure.name == stem; };
      if (asked.figure != one.figure.name || std::ranges::any_of(chosen, is_it)) continue;
      chosen.push_back(asked.part.empty() ? one : part_of(one, asked, folder, print));
    }
  }
  return chosen;
}

// A resolution that is too high for one figure is refused for all: no half of them is left.
// @throws InvalidInput  only the PNG of a figure cannot be made
void require_paintable(const std::vector<Found>& wanted, const Path& folder,
                       const io::Print& print) {
  auto lines = print;
  lines.png = false;
  for (const auto& one : wanted) {
    const auto& figure = one.figure;
    if (figure.reason.empty() || one.drawn == nullptr) continue;
    const io::PictureFile nowhere(Path(), nullptr, lines);
    const auto other = fault_of(*one.drawn, one.part, folder / figure.from, *one.content, nowhere);
    require(!other.empty(), fmt::format("{}: \"{}\" cannot be drawn: {}", folder.string(),
                                        figure.name, figure.reason));
  }
}

// Draws into `output`: all SVGs before the first PNG, which a painter can fail to make.
void draw(const std::vector<Found>& all, const Path& folder, const Path& output,
          const io::Print& print) {
  const auto leave = [&](const io::Print& format) {
    for (const auto& one : all) {
      if (!one.figure.reason.empty()) continue;
      const auto png = output / (one.figure.name + ".png");
      draw_stored(*one.drawn, one.part, folder / one.figure.from, *one.content,
                  {png, nullptr, format});
    }
  };
  auto only = print;
  only.png = false;
  if (print.svg) leave(only);
  only = print;
  only.svg = false;
  if (print.png) leave(only);
}

// Why none of them can be drawn.
std::string reasons_of(const std::vector<Found>& all) {
  std::string reasons;
  for (const auto& one : all) reasons += "\n  " + one.figure.name + ": " + one.figure.reason;
  return reasons;
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

std::vector<FolderFigure> figures_in(const std::filesystem::path& folder, const io::Print& print) {
  std::vector<FolderFigure> figures;
  for (auto& one : found_in(folder, print)) figures.push_back(std::move(one.figure));
  return figures;
}

std::vector<FolderFigure> draw_figures(const FiguresWanted& wanted) {
  const auto all = found_in(wanted.folder, wanted.print);
  require_drawable(wanted.names, all, wanted.folder);
  const auto chosen = chosen_of(wanted.names, all, wanted.folder, wanted.print);
  require_paintable(chosen, wanted.folder, wanted.print);
  require(std::ranges::any_of(chosen, [](const Found& one) { return one.figure.reason.empty(); }),
          wanted.folder.string() + ": no figure can be drawn from what is there" + reasons_of(all));
  const OutputFolder output(wanted.output.empty() ? wanted.folder : wanted.output);
  draw(chosen, wanted.folder, output.path(), wanted.print);
  std::vector<FolderFigure> figures;
  for (const auto& one : chosen) {
    auto& figure = figures.emplace_back(one.figure);
    if (!figure.reason.empty()) continue;
    if (wanted.print.svg) figure.files.push_back(figure.name + ".svg");
    if (wanted.print.png) figure.files.push_back(figure.name + ".png");
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
