#include "study/origin.h"

#include <algorithm>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "base/sha256.h"
#include "host/atomic_file.h"
#include "host/folder.h"
#include "io/json.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestResult = std::size_t{256} << 20U;
constexpr std::string_view kReportLine = "<dt>sha256 of ";
constexpr std::size_t kDigits = 64;

void add(std::vector<NamedFile>& files, const Study& study, const fs::path& file) {
  std::error_code fault;
  if (file.empty() || !fs::is_regular_file(file, fault)) return;
  const fs::path folder = fs::absolute(study.file).parent_path().lexically_normal();
  const fs::path name = fs::absolute(file).lexically_normal().lexically_relative(folder);
  files.push_back({name.generic_string(), file});
}

// With `measured` also the files of its measurement. A truth stands by its modes alone: it may
// extend the study that names it, and has then inherited itself as its truth.
void add_study(std::vector<NamedFile>& files, const Study& study, const fs::path& other,
               bool measured, std::vector<fs::path> allowed) {
  add(files, study, other);
  if (other.empty() || files.empty() || files.back().file != other) return;
  try {
    allowed.push_back(fs::absolute(study.file).parent_path());  // a series lends its folder
    const auto read = read_study(other, allowed);
    if (!read.specimens.empty()) return;  // a series has no series as a specimen
    for (const auto& one : named_files(read, measured, allowed)) add(files, study, one.file);
  } catch (const InvalidInput&) {
    return;  // the step that needs that study reports the error
  }
}

Origin origin_in_json(const io::Json& json) {
  const auto& study = json.at("study");
  Origin origin{study.at("sha256").string(), {}};
  const auto& keys = std::get<io::JsonObject>(study.value());
  const bool has_inputs =
      std::any_of(keys.begin(), keys.end(), [](const auto& key) { return key.first == "inputs"; });
  if (!has_inputs) return origin;  // result of an earlier version
  for (const auto& input : study.at("inputs").array()) {
    origin.inputs[input.at("file").string()] = input.at("sha256").string();
  }
  return origin;
}

// Finds <dt>sha256 of NAME</dt><dd>64 digits</dd>, the form of facts in io/report/report.cpp.
std::optional<Origin> origin_in_page(std::string_view page) {
  constexpr std::string_view between = "</dt><dd>";
  Origin origin;
  for (auto at = page.find(kReportLine); at != page.npos; at = page.find(kReportLine, at)) {
    at += kReportLine.size();
    const auto end = page.find(between, at);
    if (end == page.npos) break;
    const std::string name(page.substr(at, end - at));
    const std::string digits(page.substr(end + between.size(), kDigits));
    (name == "the study" ? origin.study : origin.inputs[name]) = digits;
  }
  if (origin.study.empty()) return std::nullopt;
  return origin;
}

}  // namespace

std::string Fingerprints::of(const fs::path& file) {
  const std::scoped_lock lock(mutex_);
  auto known = known_.find(file);
  if (known == known_.end()) known = known_.emplace(file, sha256_of_file(file)).first;
  return known->second;
}

std::vector<NamedFile> named_files(const Study& study, bool measured,
                                   const std::vector<fs::path>& allowed) {
  std::vector<NamedFile> files;
  for (const auto& base : study.bases) add(files, study, base);
  for (const auto& file : study.files) {
    const bool is_body = file.key.starts_with("geometry.");
    if (!is_body && !measured) continue;
    const bool is_specimen = file.key.starts_with("specimen");
    if (is_specimen || file.key.ends_with(".truth")) {
      add_study(files, study, file.path, is_specimen, allowed);
    } else {
      add(files, study, file.path);
    }
  }
  return files;
}

std::optional<Origin> origin_of(const fs::path& result) {
  try {
    const std::string text = read_whole(result, kLargestResult);
    if (result.extension() == ".html") return origin_in_page(text);
    return origin_in_json(io::parse_json(text));
  } catch (const InvalidInput&) {
    return std::nullopt;  // not a result of Chladni
  }
}

bool differ(const Origin& one, const Origin& other) {
  if (one.study != other.study) return true;
  return std::any_of(one.inputs.begin(), one.inputs.end(), [&](const auto& input) {
    const auto same = other.inputs.find(input.first);
    return same != other.inputs.end() && same->second != input.second;
  });
}

std::vector<std::string> outdated(const fs::path& folder, const Origin& now) {
  std::vector<std::string> names;
  for (const auto& file : entries_of(folder)) {
    if (file.extension() != ".json" && file.filename() != "report.html") continue;
    const auto origin = origin_of(file);
    if (origin && differ(*origin, now)) names.push_back(file.filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace chladni::study
