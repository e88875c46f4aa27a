#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <exception>
#include <ostream>
#include <system_error>

#include "base/error.h"
#include "host/atomic_file.h"
#include "host/cache.h"
#include "host/memory.h"
#include "show/run.h"
#include "show/version.h"

namespace chladni::show {
namespace {

std::filesystem::path folder_of(const study::Study& study, const Options& options) {
  return options.folder.empty() ? std::filesystem::path("out") / study.name : options.folder;
}

unsigned seed_of(const study::Study& study, const Options& options) {
  return options.seed >= 0 ? static_cast<unsigned>(options.seed) : study.seed.value_or(1);
}

// Null where the user or the environment wants none.
std::shared_ptr<const Cache> cache_of(const Options& options) {
  const auto place = cache_place();
  if (!options.cache || place.folder.empty()) return nullptr;
  return std::make_shared<const Cache>(place.folder, place.most_bytes);
}

stage::WorkOptions work_options(const study::Study& study, const Options& options) {
  return {.seed = seed_of(study, options),
          .certificate = options.certificate,
          .keep_best = options.keep_best,
          .keep_times = !options.reproducible,
          .engine = options.engine,
          .memory_limit_bytes = bytes_of_gigabytes(options.memory_limit_gb),
          .allowed = options.allowed,
          .folder = folder_of(study, options),
          .cache = cache_of(options)};
}

/// True if the result may depend on data beside the body: unless it is of the body alone.
bool stands_on_data(const std::string& file) {
  constexpr std::array of_body = {"experiment.json", "export.json", "mesh.json",      "modes.json",
                                  "placement.json",  "priors.json", "simulated.json", "study.json"};
  return std::ranges::find(of_body, file) == of_body.end();
}

/// What a verb leaves beside a result only in some runs: with an option, or where the study asks
/// for it.
struct Companions {
  std::string_view result;
  std::vector<std::string_view> files;
};

const std::array kCompanions{
    Companions{"modes.json", {"modes.pvd", "modes.png", "channels.vtu"}},
    Companions{"mesh.json", {"mesh.png"}},
    Companions{"placement.json", {"heat_map.png", "layouts.png", "observer_layouts.png"}},
    Companions{"experiment.json", {"experiment.png", "experiment.svg", "hammer_points.csv"}},
    Companions{"identified.json", {"fit.png", "fit.svg", "stabilisation.png", "stabilisation.svg"}},
    Companions{"interpolation.json",
               {"mode_field.png", "mode_field.csv", "predicted.csv", "predicted_band.csv",
                "predicted.png", "predicted.svg", "spatio_temporal.mat"}},
    Companions{"observe.json", {"observer.png", "observer.svg"}},
    Companions{
        "comparison.json",
        {"responses.png", "responses.svg", "errors.png", "errors.svg", "mac.png", "mac.svg"}},
    Companions{"diagnosis.json",
               {"prediction.png", "prediction.svg", "errors_over_frequency.png",
                "errors_over_frequency.svg", "mac.png", "mac.svg"}},
};

/// A virtual experiment plays a file, and writes those of the measurement.
void add_excitation(const study::Study& study, study::Fingerprints& fingerprints,
                    study::Origin& origin) {
  if (!study.experiment) return;
  for (const auto& [name, file] : study::named_files(study, true)) {
    if (file == study.experiment->excitation) origin.inputs[name] = fingerprints.of(file);
  }
}

// Name of what stood here before this run: a_before.toml for a.toml.
std::string before(const std::filesystem::path& file) {
  return file.stem().string() + "_before" + file.extension().string();
}

// The frames that an animation lists go with it: a_before_00.vtu for a_00.vtu.
void put_frames_aside(const std::filesystem::path& animation) {
  const auto stem = animation.stem().string(), newer = stem + "_before";
  auto list = read_whole(animation);
  for (int frame = 0;; ++frame) {
    const auto number = fmt::format("_{:02}.vtu", frame);
    const auto at = list.find("\"" + stem + number + "\"");
    if (at == std::string::npos) break;
    list.replace(at + 1, stem.size(), newer);
    std::error_code missing;
    std::filesystem::rename(animation.parent_path() / (stem + number),
                            animation.parent_path() / (newer + number), missing);
  }
  write_atomically(animation, list);
}

bool is_regular(const std::filesystem::path& file) {
  std::error_code missing;
  return std::filesystem::is_regular_file(std::filesystem::symlink_status(file, missing));
}

io::JsonArray inputs_of(const study::Origin& origin) {
  io::JsonArray inputs;
  for (const auto& [name, digits] : origin.inputs) {
    inputs.emplace_back(io::JsonObject{{"file", name}, {"sha256", digits}});
  }
  return inputs;
}

}  // namespace

Run::Run(const study::Study& study, Options options, std::ostream& results, Talk& talk)
    : stage::Work(work_options(study, options)),
      study_(study),
      options_(std::move(options)),
      results_(results),
      talk_(talk),
      folder_(choices().folder) {
  const auto note = cache_place().note;
  if (options_.cache && !note.empty()) talk_.note(note);
}

Run::~Run() {
  try {
    if (!has_left_) return;
    const auto outdated = study::outdated(folder_.path(), origin(true));
    put_companions_aside(outdated);
    put_outdated_aside(outdated);
  } catch (const std::exception&) {
    return;  // the results are complete
  }
}

void Run::put_companions_aside(const std::vector<std::string>& outdated) {
  // A result of the present state may own a file that several verbs leave.
  const auto is_present = [&](const std::string& result) {
    return !replaced_.contains(result) && is_regular(*this / result) &&
           std::ranges::count(outdated, result) == 0;
  };
  const auto is_owned = [&](std::string_view file) {
    return std::ranges::any_of(kCompanions, [&](const Companions& one) {
      return std::ranges::count(one.files, file) > 0 && is_present(std::string(one.result));
    });
  };
  std::vector<std::string> kept;
  const auto began = folder_.began();
  for (const auto& [result, files] : kCompanions) {
    if (!replaced_.contains(std::string(result))) continue;
    for (const auto file : files) {
      const auto older = *this / file;
      if (!is_regular(older) || std::filesystem::last_write_time(older) >= began) continue;
      if (is_owned(file) || is_read(older)) continue;
      if (older.extension() == ".pvd") put_frames_aside(older);
      std::filesystem::rename(older, *this / before(older));
      kept.push_back(before(older));
    }
  }
  if (kept.empty()) return;
  talk_.warn(fmt::format(
      "{}: what stood beside results of an earlier state of the study or of its files is now {}",
      folder_.path().string(), fmt::join(kept, ", ")));
}

void Run::put_outdated_aside(const std::vector<std::string>& outdated) {
  std::string others;
  for (const auto& name : outdated) {
    if (name == "report.html") {
      std::filesystem::rename(*this / name, *this / before(name));
      talk_.warn(folder_.path().string() +
                 ": report.html was of an earlier state of the study or of its files; it is " +
                 before(name) + " now, and `chladni study` writes a new one");
    } else {
      others += (others.empty() ? "" : ", ") + name;
    }
  }
  if (others.empty()) return;
  talk_.warn(folder_.path().string() + ": " + others +
             " and the pictures and fields that were left with it are of an earlier state of the "
             "study or of its files; run their verbs again, or choose another folder with -o");
}

study::Origin Run::origin(bool measured) {
  study::Origin origin{study_.sha256, {}};
  for (const auto& [name, file] : study::named_files(study_, measured, options_.allowed)) {
    origin.inputs[name] = fingerprints_.of(file);
  }
  return origin;
}

void Run::paint(const std::string& file,
                const std::function<void(const io::PictureFile& png)>& draw) {
  if (!options_.pictures) return;
  try {
    draw({*this / file, &pictures_, options_.vectors});
  } catch (const InvalidInput& fault) {  // too much to be drawn, or nothing
    warn_not_painted(file, fault.what());
  }
}

// Whether the study is read from it.
bool Run::is_read(const std::filesystem::path& file) const {
  const auto is_it = [&](const std::filesystem::path& read) {
    std::error_code missing;
    return std::filesystem::equivalent(file, read, missing);
  };
  const auto named = study::named_files(study_, true, options_.allowed);
  return is_it(study_.file) || std::ranges::any_of(named, is_it, &study::NamedFile::file);
}

void Run::put_aside(const std::string& file) {
  const auto older = *this / file;
  if (!is_regular(older) || is_read(older)) return;
  std::error_code fault;
  std::filesystem::rename(older, *this / before(file), fault);
  warn(fault ? file + " is of an earlier run and cannot be renamed: " + fault.message()
             : file + " was of an earlier run; it is " + before(file) + " now");
}

void Run::warn_not_painted(const std::string& file, const std::string& why) {
  const bool again = last_fault_ == why;
  talk_.warn(again ? file + " is not painted either"
                   : fmt::format("{} is not painted: {}; everything else is there; "
                                 "--no-pictures paints nothing",
                                 file, why));
  last_fault_ = why;
}

void Run::finish_pictures() {
  for (const auto& picture : pictures_.finish()) {
    const std::string file = picture.png.filename().string();
    try {
      if (picture.failure) std::rethrow_exception(picture.failure);
      painted_.insert(file);
    } catch (const WorkerDied& fault) {
      std::error_code ignored;
      std::filesystem::remove(picture.png, ignored);
      warn_not_painted(file, fault.what());
    }
  }
}

std::filesystem::path Run::operator/(std::string_view name) const { return folder_.path() / name; }

void Run::show(std::string_view text) {
  talk_.clear_progress();
  if (!options_.json) results_ << part() << text << std::flush;
}

void Run::leave(const std::string& file, io::JsonObject content, bool main_result) {
  auto from = origin(stands_on_data(file));
  const auto older = study::origin_of(*this / file);
  if (older && study::differ(*older, from)) replaced_.insert(file);
  if (file == "simulated.json") add_excitation(study_, fingerprints_, from);
  io::JsonObject seconds;
  for (const auto& [step, time] : this->seconds()) seconds.emplace_back(step, time);
  io::JsonObject all = {{"chladni", version()},
                        {"study", io::JsonObject{{"title", study_.title},
                                                 {"sha256", study_.sha256},
                                                 {"inputs", inputs_of(from)}}},
                        {"seed", static_cast<long long>(seed())},
                        {"seconds", seconds}};
  all.insert(all.end(), content.begin(), content.end());
  const io::Json json(std::move(all));
  io::write_json(*this / file, json);
  has_left_ = true;
  talk_.clear_progress();
  if (options_.json && main_result) results_ << io::text(json) << std::flush;
}

}  // namespace chladni::show
