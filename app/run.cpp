#include <ostream>

#include "app/command.h"

namespace chladni::app {
namespace {

std::filesystem::path folder_of(const Study& study, const Options& options) {
  return options.folder.empty() ? std::filesystem::path("out") / study.name : options.folder;
}

unsigned seed_of(const Study& study, const Options& options) {
  return options.seed >= 0 ? static_cast<unsigned>(options.seed) : study.seed.value_or(1);
}

}  // namespace

Run::Run(const Study& study, Options options, std::ostream& results, Talk& talk)
    : study_(study),
      options_(std::move(options)),
      results_(results),
      talk_(talk),
      folder_(folder_of(study, options_)),
      seed_(seed_of(study, options_)) {}

std::filesystem::path Run::operator/(std::string_view name) const { return folder_.path() / name; }

void Run::show(std::string_view text) {
  talk_.clear_progress();
  if (!options_.json) results_ << part_ << text << std::flush;
}

std::vector<std::pair<std::string, double>> Run::seconds() const {
  return options_.reproducible ? std::vector<std::pair<std::string, double>>() : seconds_;
}

void Run::leave(const std::string& file, io::JsonObject content, bool main_result) {
  io::JsonObject seconds;
  for (const auto& [step, time] : this->seconds()) seconds.emplace_back(step, time);
  io::JsonObject all = {
      {"chladni", CHLADNI_VERSION},
      {"study", io::JsonObject{{"title", study_.title}, {"sha256", study_.sha256}}},
      {"seed", static_cast<long long>(seed_)},
      {"seconds", seconds}};
  all.insert(all.end(), content.begin(), content.end());
  const io::Json json(std::move(all));
  io::write_json(*this / file, json);
  talk_.clear_progress();
  if (options_.json && main_result) results_ << io::text(json) << std::flush;
}

}  // namespace chladni::app
