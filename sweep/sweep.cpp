#include "sweep/sweep.h"

#include <fmt/format.h>

#include <chrono>
#include <system_error>
#include <utility>
#include <variant>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/sha256.h"
#include "host/atomic_file.h"
#include "host/descriptor.h"
#include "host/folder.h"
#include "host/worker.h"
#include "show/version.h"
#include "study/origin.h"
#include "study/study.h"
#include "sweep/variant_lock.h"

namespace chladni::sweep {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHashDigits = 16;
constexpr std::size_t kLargestRecord = std::size_t{1} << 20U;
constexpr auto kLongest = std::chrono::hours(24 * 365);

// What the results depend on: keys, verb, program and the files that the study names. The title and
// the place of the folder are not among it.
std::string hash_of(const study::Study& read, const std::string& verb,
                    const std::vector<fs::path>& allowed, study::Fingerprints& fingerprints) {
  std::string inputs = read.text + "\n" + verb + "\n" + show::version();
  for (const auto& [name, file] : study::named_files(read, true, allowed)) {
    inputs += "\n" + name + " " + fingerprints.of(file);
  }
  return sha256(inputs).substr(0, kHashDigits);
}

std::optional<Record> record_in(const fs::path& folder) {
  const auto file = folder / "variant.json";
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  const auto json = io::parse_json(read_whole(file, kLargestRecord));
  Record record{static_cast<int>(json.at("exit").number()), json.at("error").string(), {}};
  const auto& seconds = json.at("seconds");
  if (!std::holds_alternative<std::monostate>(seconds.value())) record.seconds = seconds.number();
  return record;
}

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of("\n ");
  if (end == std::string::npos) return {};
  const auto begin = text.find_last_of('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1,
                     end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

void make_folder(const fs::path& folder) {
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault) throw_path_error(fault.value(), "cannot make the folder " + folder.string());
}

// `base` as seen from `folder`. A base that is a link stays one: its files lie beside the link.
std::string seen_from(const fs::path& folder, const fs::path& base) {
  return (path_from(folder, fs::absolute(base).parent_path()) / base.filename()).generic_string();
}

}  // namespace

const char* state(const std::optional<Record>& record) {
  if (!record) return "open";
  return record->exit == 0 ? "done" : "failed";
}

io::Json json_of_seconds(const std::optional<Record>& record) {
  return record && record->seconds ? io::Json(*record->seconds) : io::Json();
}

Sweep::Sweep(study::SweepPlan plan, SweepOptions options)
    : plan_(std::move(plan)), options_(std::move(options)), variants_(plan_) {}

Entry Sweep::entry(long long index) const {
  const auto variant = variants_.at(index);
  Entry entry;
  entry.index = index;
  entry.labels = variant.labels;
  // Read beside its base: its text does not depend on where the sweep's folder is.
  const auto beside = variants_.text(variant, plan_.base.filename().string(), false);
  try {
    const auto read =
        study::parse_study(beside, plan_.base.parent_path() / "variant.toml", options_.allowed);
    entry.hash = hash_of(read, plan_.verb, options_.allowed, fingerprints_);
  } catch (const InvalidInput& e) {
    throw InvalidInput(fmt::format("{}: variant {} ({}): {}", plan_.file.string(), index + 1,
                                   fmt::join(entry.labels, ", "), e.what()));
  }
  entry.folder = options_.folder / "variants" / entry.hash;
  entry.text = variants_.text(variant, seen_from(entry.folder, plan_.base), true);
  entry.record = record_in(entry.folder);
  return entry;
}

void Sweep::check() const {
  for (long long i = 0; i < size(); ++i) static_cast<void>(entry(i));
}

std::vector<std::string> Sweep::arguments(const fs::path& folder) const {
  std::vector<std::string> words{
      plan_.verb,  (folder / "study.toml").string(), "-o", folder.string(), "--quiet",
      "--threads", fmt::to_string(options_.threads)};
  const auto allow = [&](const fs::path& other) {
    words.emplace_back("--allow-outside");
    words.push_back(fs::absolute(other).lexically_normal().string());
  };
  if (!options_.cache) words.emplace_back("--no-cache");
  if (options_.reproducible) words.emplace_back("--reproducible");
  if (plan_.verb != "study") words.emplace_back("--no-pictures");  // its report has them
  allow(fs::absolute(plan_.base).parent_path());
  for (const auto& other : options_.allowed) allow(other);
  return words;
}

std::optional<Record> Sweep::called(const Entry& entry, const fs::path& part,
                                    std::string& why) const {
  remove_whole(part);  // of a run that was cut off
  make_folder(part);
  write_atomically(part / "study.toml", entry.text);
  Record record;
  const auto begin = std::chrono::steady_clock::now();
  try {
    const auto answer =
        run_program(options_.program, arguments(part), record.exit,
                    {.time = kLongest, .memory_bytes = 0, .output_bytes = std::size_t{64} << 20U});
    if (record.exit != 0) record.error = last_line(answer.errors);
  } catch (const WorkerDied& e) {
    why = e.what();
    return std::nullopt;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (!options_.reproducible) record.seconds = took.count();
  if (!options_.passing.contains(record.exit)) return record;
  why = record.error;
  return std::nullopt;
}

Met Sweep::run(long long index, bool again) const {
  throw_if_interrupted();  // before another process is started
  const auto entry = this->entry(index);
  if (entry.record && !(again && entry.record->exit != 0))
    return {Outcome::found, entry.record, {}};
  make_folder(options_.folder / "variants" / ".locks");
  const VariantLock lock(options_.folder / "variants" / ".locks" / entry.hash);
  if (lock.is_elsewhere()) return {Outcome::elsewhere, {}, {}};
  if (!entry.record) {
    if (const auto ended = record_in(entry.folder)) return {Outcome::found, ended, {}};
  }
  auto part = entry.folder;
  part += ".part";
  std::string why;
  const auto record = called(entry, part, why);
  if (!record) return {Outcome::passing, {}, why};
  io::write_json(part / "variant.json", json_of(entry, *record));
  remove_whole(entry.folder);  // what failed before
  fs::rename(part, entry.folder);
  return {Outcome::ran, record, {}};
}

io::Json Sweep::json_of(const Entry& entry, const Record& record) const {
  io::JsonObject axes;
  for (std::size_t a = 0; a < plan_.axes.size(); ++a) {
    axes.emplace_back(plan_.axes[a].name, entry.labels[a]);
  }
  return io::JsonObject{{"chladni", show::version()},
                        {"hash", entry.hash},
                        {"verb", plan_.verb},
                        {"axes", axes},
                        {"exit", record.exit},
                        {"error", record.error},
                        {"seconds", json_of_seconds(record)}};
}

}  // namespace chladni::sweep
