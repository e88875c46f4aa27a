#include "show/run/terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <ostream>

namespace chladni::show {

Manner manner_of_stderr(bool quiet) {
  const bool terminal = isatty(STDERR_FILENO) == 1;
  const char* no_colour = std::getenv("NO_COLOR");
  const bool colour = terminal && (no_colour == nullptr || *no_colour == '\0');
  return {.quiet = quiet, .progress = terminal && !quiet, .colour = colour};
}

std::string Talk::painted(std::string_view text, std::string_view code) const {
  return manner_.colour ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
}

void Talk::note(std::string_view line) {
  if (manner_.quiet) return;
  clear_progress();
  stream_ << line << '\n' << std::flush;
}

void Talk::warn(std::string_view message) {
  clear_progress();
  stream_ << painted("warning: ", "33") << message << '\n' << std::flush;
}

void Talk::error(std::string_view message) {
  clear_progress();
  stream_ << painted("error: ", "31") << message << '\n' << std::flush;
}

void Talk::clear_progress() {
  if (drawn_) stream_ << "\r\033[K" << std::flush;
  drawn_ = false;
}

void Talk::draw(std::string_view step, double fraction) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  if (drawn_ && step == last_step_ && now - last_drawn_ < 100ms) return;
  last_step_ = step;
  last_drawn_ = now;
  drawn_ = true;
  const std::string percent = fraction < 0.0 ? "" : fmt::format("  {:3.0f} %", 100.0 * fraction);
  stream_ << "\r\033[K" << step << percent << std::flush;
}

Progress Talk::progress() {
  if (!manner_.progress) return {};
  return [this](std::string_view step, double fraction) { draw(step, fraction); };
}

}  // namespace chladni::show
