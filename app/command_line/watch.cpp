#include "app/command_line/watch.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <thread>

#include "app/command_line/exit_code.h"
#include "base/interrupt.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto kBetweenLooks = 100ms;
constexpr auto kSettled = 300ms;
constexpr auto kSettledWhereGone = 1s;
constexpr std::size_t kMostNamed = 4;  // on a line

// "stage.toml, part.step"
std::string listed(const std::vector<fs::path>& files) {
  const std::size_t named = std::min(files.size(), kMostNamed);
  std::string text;
  for (std::size_t i = 0; i < named; ++i) {
    text += (i == 0 ? "" : ", ") + files[i].filename().string();
  }
  return named == files.size() ? text : fmt::format("{} and {} more", text, files.size() - named);
}

// "stage.toml has changed; part.step is gone"
std::string news_of(const std::vector<fs::path>& changed) {
  std::vector<fs::path> there, gone;
  std::error_code ignored;
  for (const auto& file : changed) (fs::exists(file, ignored) ? there : gone).push_back(file);
  std::string text;
  if (!there.empty()) text = listed(there) + (there.size() == 1 ? " has" : " have") + " changed";
  if (gone.empty()) return text;
  return text + (text.empty() ? "" : "; ") + listed(gone) + (gone.size() == 1 ? " is" : " are") +
         " gone";
}

}  // namespace

WatchedFiles::WatchedFiles(std::vector<fs::path> files)
    : files_(std::move(files)), before_(now()) {}

WatchedFiles::State WatchedFiles::state_of(const fs::path& file) {
  struct stat status = {};
  if (stat(file.c_str(), &status) != 0) return {};
  return {.there = true,
          .device = status.st_dev,
          .node = status.st_ino,
          .bytes = status.st_size,
          .seconds = status.st_mtim.tv_sec,
          .nanoseconds = status.st_mtim.tv_nsec};
}

std::vector<WatchedFiles::State> WatchedFiles::now() const {
  std::vector<State> states;
  for (const auto& file : files_) states.push_back(state_of(file));
  return states;
}

std::vector<fs::path> WatchedFiles::wait_for_change() const {
  using Clock = std::chrono::steady_clock;
  auto last = before_;
  for (auto since = Clock::now();; std::this_thread::sleep_for(kBetweenLooks)) {
    throw_if_interrupted();
    const auto seen = now();
    if (seen != last) since = Clock::now();
    last = seen;
    std::vector<fs::path> changed;
    bool gone = false;
    for (std::size_t i = 0; i < files_.size(); ++i) {
      if (seen[i] == before_[i]) continue;
      changed.push_back(files_[i]);
      gone = gone || !seen[i].there;
    }
    const auto settled = Clock::now() - since;
    if (!changed.empty() && settled >= (gone ? kSettledWhereGone : kSettled)) return changed;
  }
}

void WatchedFiles::accept(const std::function<bool(const fs::path&)>& own) {
  for (std::size_t i = 0; i < files_.size(); ++i) {
    if (own(files_[i])) before_[i] = state_of(files_[i]);
  }
}

bool is_written(const Command& command, const fs::path& folder, const fs::path& file) {
  const auto from = fs::absolute(file).lexically_normal().lexically_relative(
      fs::absolute(folder).lexically_normal());
  const bool in_folder = !from.empty() && *from.begin() != "..";
  return (in_folder || command.name == "simulate") && file.extension() != ".toml";
}

int run_at_each_change(const Watch& watch) {
  for (;;) {
    WatchedFiles files(watch.files());  // as they are before the run: a change may overtake it
    const int status = watch.run();
    if (status == kInterrupted) return status;
    files.accept(watch.own);
    watch.note(fmt::format("waiting for a change of {}; Ctrl-C ends", listed(files.files())));
    watch.note(news_of(files.wait_for_change()) + ": once more");
  }
}

}  // namespace chladni::app
