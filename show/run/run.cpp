#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <ostream>
#include <system_error>

#include "base/error.h"
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
    if (has_left_) put_outdated_aside();
  } catch (const std::exception&) {
    return;  // the results are complete
  }
}

void Run::put_outdated_aside() {
  std::string others;
  for (const auto& name : study::outdated(folder_.path(), origin(true))) {
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

void Run::put_aside(const std::string& file) {
  const auto older = *this / file;
  std::error_code fault;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(older, fault))) return;
  const auto is_older = [&](const std::filesystem::path& read) {
    return std::filesystem::equivalent(older, read, fault);
  };
  const auto named = study::named_files(study_, true, options_.allowed);
  if (is_older(study_.file) || std::ranges::any_of(named, is_older, &study::NamedFile::file))
    return;
  fault.clear();
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
