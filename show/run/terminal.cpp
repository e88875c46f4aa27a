#include "show/run/terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cstdlib>
#include <ostream>

namespace chladni::show {
namespace {

using namespace std::chrono_literals;

constexpr int kToldOfAKind = 3;

// "no sensor sees mode 8" and "no sensor sees mode 15" are one kind.
std::string shape_of(std::string_view message) {
  std::string shape;
  bool quoted = false;
  for (const char letter : message) {
    if (letter == '"') quoted = !quoted;
    const bool digit = std::isdigit(static_cast<unsigned char>(letter)) != 0;
    if ((quoted && letter != '"') || (digit && !shape.empty() && shape.back() == '#')) continue;
    shape.push_back(digit ? '#' : letter);
  }
  return shape;
}

std::string seconds_text(std::chrono::steady_clock::duration time) {
  const auto all = std::chrono::duration_cast<std::chrono::seconds>(time).count();
  return all < 120 ? fmt::format("{} s", all) : fmt::format("{} min {:02} s", all / 60, all % 60);
}

}  // namespace

Manner manner_of_stderr(bool quiet) {
  const bool terminal = isatty(STDERR_FILENO) == 1;
  const char* no_colour = std::getenv("NO_COLOR");
  const bool colour = terminal && (no_colour == nullptr || *no_colour == '\0');
  return {.quiet = quiet,
          .progress = terminal && !quiet,
          .lines = !terminal && !quiet,
          .colour = colour};
}

Talk::~Talk() {
  {
    const std::scoped_lock lock(mutex_);
    ends_ = true;
  }
  ended_.notify_all();
  if (ticker_.joinable()) ticker_.join();
  try {
    tell_folded();
  } catch (const std::exception&) {
    return;  // no memory for a line that says less than those before it
  }
}

std::string Talk::painted(std::string_view text, std::string_view code) const {
  return manner_.colour ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
}

bool Talk::is_folded(std::string_view kind, std::string_view message) {
  if (manner_.all) return false;
  auto& fold = folds_[std::string(kind) + shape_of(message)];
  if (fold.count == 0) fold.first = fmt::format("{}{}", kind, message);
  return ++fold.count > kToldOfAKind;
}

void Talk::tell_folded() {
  const std::scoped_lock lock(mutex_);
  for (const auto& [shape, fold] : folds_) {
    if (fold.count <= kToldOfAKind) continue;
    clear();
    constexpr std::size_t kLongest = 72;
    const auto& first = fold.first;
    stream_ << fmt::format("{} more such as \"{}{}\"\n", fold.count - kToldOfAKind,
                           first.substr(0, kLongest), first.size() > kLongest ? "..." : "")
            << std::flush;
  }
  folds_.clear();
}

void Talk::note(std::string_view line) {
  const std::scoped_lock lock(mutex_);
  if (manner_.quiet || is_folded("", line)) return;
  clear();
  stream_ << line << '\n' << std::flush;
}

void Talk::warn(std::string_view message) {
  const std::scoped_lock lock(mutex_);
  if (is_folded("warning: ", message)) return;
  clear();
  stream_ << painted("warning: ", "33") << message << '\n' << std::flush;
}

void Talk::error(std::string_view message) {
  tell_folded();
  const std::scoped_lock lock(mutex_);
  clear();
  stream_ << painted("error: ", "31") << message << '\n' << std::flush;
}

void Talk::clear_progress() {
  const std::scoped_lock lock(mutex_);
  clear();
  step_.clear();
}

void Talk::clear() {
  stream_.clear();  // a line that could not be written keeps no later one
  if (drawn_) stream_ << "\r\033[K" << std::flush;
  drawn_ = false;
}

void Talk::draw() {
  last_drawn_ = Clock::now();
  drawn_ = true;
  const std::string percent = fraction_ < 0.0 ? "" : fmt::format("  {:3.0f} %", 100.0 * fraction_);
  const auto took = last_drawn_ - step_begin_;
  const std::string time = took < 2s ? "" : "  " + seconds_text(took);
  stream_ << "\r\033[K" << step_ << percent << time << std::flush;
}

void Talk::write_line() {
  last_drawn_ = Clock::now();
  const std::string percent = fraction_ < 0.0 ? "" : fmt::format(" {:.0f} %", 100.0 * fraction_);
  stream_ << fmt::format("{}: {}{}\n", seconds_text(last_drawn_ - begin_), step_, percent)
          << std::flush;
}

void Talk::heard(std::string_view step, double fraction) {
  const std::scoped_lock lock(mutex_);
  const auto now = Clock::now();
  const bool is_new = step != step_;
  if (is_new) step_begin_ = now;
  step_ = step;
  fraction_ = fraction;
  if (manner_.lines && now - last_drawn_ >= manner_.every) write_line();
  if (manner_.progress && (is_new || !drawn_ || now - last_drawn_ >= 100ms)) draw();
}

void Talk::tick() try {
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, std::min<std::chrono::milliseconds>(manner_.every, 1s),
                          [this] { return ends_; })) {
    if (step_.empty()) continue;
    if (manner_.progress && drawn_) draw();
    if (manner_.lines && Clock::now() - last_drawn_ >= manner_.every) write_line();
  }
} catch (const std::exception&) {
  return;  // no memory for a line of progress: the step goes on without
}

Progress Talk::progress() {
  if (!manner_.progress && !manner_.lines) return {};
  if (!ticker_.joinable()) {
    last_drawn_ = begin_;
    ticker_ = std::thread([this] { tick(); });
  }
  return [this](std::string_view step, double fraction) { heard(step, fraction); };
}

}  // namespace chladni::show
