#include "show/excerpt.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <new>
#include <optional>

#include "base/error.h"
#include "base/text_stream.h"
#include "host/atomic_file.h"

namespace chladni::show {
namespace {

constexpr std::size_t kLargestFile = std::size_t{16} << 20U;
constexpr std::size_t kWidth = 100;  // of an excerpt
constexpr std::size_t kAhead = 40;   // of the caret, where the line is longer

// A whole number at the front of `text`, with the colon behind it; both are taken away.
std::optional<int> taken_number(std::string_view& text) {
  int value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  const auto length = static_cast<std::size_t>(end - text.data());
  if (fault != std::errc() || value < 1 || length >= text.size() || text[length] != ':') return {};
  text.remove_prefix(length + 1);
  return value;
}

// "FILE:LINE:COLUMN: MESSAGE" or "FILE:LINE: MESSAGE"; none for another text.
std::optional<PlacedError> placed(std::string_view text) {
  for (auto colon = text.find(':'); colon != text.npos; colon = text.find(':', colon + 1)) {
    auto rest = text.substr(colon + 1);
    const auto line = taken_number(rest);
    if (!line || colon == 0) continue;
    const int column = taken_number(rest).value_or(0);
    if (!rest.starts_with(' ')) continue;
    return PlacedError{std::string(text.substr(0, colon)), *line, column,
                       std::string(rest.substr(1))};
  }
  return {};
}

std::optional<std::string> line_of(const std::string& file, int number) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  try {
    TextReader text(read_whole(file, kLargestFile));
    std::string line;
    for (int i = 0; i < number; ++i) {
      if (!std::getline(text, line)) return {};
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  } catch (const InvalidInput&) {
    return {};
  } catch (const OutOfResources&) {
    return {};
  } catch (const std::bad_alloc&) {
    return {};
  }
}

bool is_inside_a_letter(const std::string& text, std::size_t at) {
  return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
}

// The line of the file, and a caret in a line below it. Columns count letters, not bytes.
std::string excerpt(const PlacedError& error) {
  auto line = line_of(error.file, error.line);
  if (!line) return "";
  for (char& letter : *line) {
    if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
  }
  std::size_t caret = 0;  // in bytes
  for (int column = 1; column < error.column && caret < line->size(); ++column) {
    do ++caret;
    while (is_inside_a_letter(*line, caret));
  }
  std::size_t from = 0;
  if (line->size() > kWidth && caret > kWidth - kAhead) from = caret - kAhead;
  while (is_inside_a_letter(*line, from)) ++from;
  std::size_t to = std::min(line->size(), from + kWidth);
  while (is_inside_a_letter(*line, to)) --to;
  const auto letters = std::count_if(
      line->begin() + static_cast<std::ptrdiff_t>(from),
      line->begin() + static_cast<std::ptrdiff_t>(caret),
      [](char letter) { return (static_cast<unsigned char>(letter) & 0xC0U) != 0x80U; });
  const auto number = fmt::to_string(error.line);
  std::string text = fmt::format("\n  {} | {}", number, line->substr(from, to - from));
  if (error.column > 0) {
    text += fmt::format("\n  {:{}} | {:{}}^", "", number.size(), "", letters);
  }
  return text;
}

io::Json remedy_json(const stage::Remedy& remedy) {
  io::JsonObject mesh;
  if (remedy.edge_length_m > 0.0) {
    mesh.emplace_back("edge_length", stage::millimetres(remedy.edge_length_m));
  }
  if (remedy.order > 0) mesh.emplace_back("order", static_cast<long long>(remedy.order));
  io::JsonObject study;
  if (!mesh.empty()) study.emplace_back("mesh", std::move(mesh));
  if (!remedy.mirrors.empty()) {
    study.emplace_back("modes", io::JsonObject{{"mirrors", io::Json::texts(remedy.mirrors)}});
  }
  io::JsonArray options;
  if (!remedy.engine.empty()) options = {"--engine", remedy.engine};
  io::JsonObject json{{"kind", remedy.kind},
                      {"study", std::move(study)},
                      {"options", std::move(options)},
                      {"degrees_of_freedom", remedy.degrees_of_freedom},
                      {"memory_bytes", remedy.memory_bytes}};
  if (remedy.frequency_error) {
    json.emplace_back("frequency_error", *remedy.frequency_error);
    json.emplace_back("highest_hz", remedy.highest_hz);
  }
  if (remedy.ranks > 0) {
    json.emplace_back("ranks", static_cast<long long>(remedy.ranks));
    json.emplace_back("rank_bytes", remedy.rank_bytes);
  }
  return json;
}

}  // namespace

std::vector<PlacedError> placed_errors(const std::string& message) {
  std::vector<PlacedError> errors;
  TextReader lines(message);
  for (std::string line; std::getline(lines, line);) {
    if (auto error = placed(line)) {
      errors.push_back(std::move(*error));
    } else if (!errors.empty()) {
      errors.back().message += "\n" + line;
    } else {
      errors.push_back({.file = {}, .line = 0, .column = 0, .message = line});
    }
  }
  return errors;
}

std::string with_excerpts(const std::string& message) {
  std::string text;
  for (const auto& error : placed_errors(message)) {
    if (!text.empty()) text += "\n";
    if (error.line == 0) {
      text += error.message;
      continue;
    }
    const auto column = error.column > 0 ? fmt::format(":{}", error.column) : "";
    text +=
        fmt::format("{}:{}{}: {}{}", error.file, error.line, column, error.message, excerpt(error));
  }
  return text;
}

io::Json error_json(const std::string& message, int exit,
                    const std::vector<stage::Remedy>& remedies, const std::string& result) {
  io::JsonArray errors;
  for (const auto& error : placed_errors(message)) {
    io::JsonObject one;
    if (error.line > 0) {
      one.emplace_back("file", error.file);
      one.emplace_back("line", static_cast<long long>(error.line));
    }
    if (error.column > 0) one.emplace_back("column", static_cast<long long>(error.column));
    one.emplace_back("message", error.message);
    errors.emplace_back(std::move(one));
  }
  io::JsonObject error{{"exit", static_cast<long long>(exit)}, {"errors", errors}};
  io::JsonArray ways;
  for (const auto& remedy : remedies) ways.push_back(remedy_json(remedy));
  if (!ways.empty()) error.emplace_back("remedies", std::move(ways));
  auto all =
      result.empty() ? io::JsonObject{} : std::get<io::JsonObject>(io::parse_json(result).value());
  all.emplace_back("error", std::move(error));
  return all;
}

}  // namespace chladni::show
