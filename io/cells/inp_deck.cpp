#include "io/cells/inp_deck.h"

#include <algorithm>

namespace chladni::io {
namespace {

void split(std::string_view text, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    fields.push_back(trimmed(text.substr(start, comma - start)));
    start = comma + 1;
  }
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
}

std::string one_blank_each(std::string_view words) {
  Scanner scanner(words);
  std::string joined;
  for (auto word = scanner.word(); !word.empty(); word = scanner.word()) {
    joined += (joined.empty() ? "" : " ") + upper(word);
  }
  return joined;
}

std::string_view unquoted(std::string_view text) {
  const bool quotes = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quotes ? text.substr(1, text.size() - 2) : text;
}

}  // namespace

std::string Keyword::value(const std::string& parameter) const {
  const auto found = parameters.find(parameter);
  return found == parameters.end() ? std::string() : found->second;
}

std::string label_in(std::string_view field) {
  std::string label(field);
  std::erase(label, '"');
  return label;
}

// Reads the next line that is neither empty nor a comment into text_; false at the end.
bool InpDeck::read_line() {
  while (!pending_ && !ended_) {
    text_ = scanner_.rest_of_line();
    line_ = scanner_.line();
    ended_ = !scanner_.next_line();
    pending_ = !text_.empty() && !text_.starts_with("**");
  }
  return pending_;
}

bool InpDeck::next_keyword(Keyword& keyword) {
  while (read_line() && text_[0] != '*') pending_ = false;
  if (!pending_) return false;
  pending_ = false;
  keyword = {};
  keyword.line = line_;
  std::string whole(text_.substr(1));
  while (whole.ends_with(',') && read_line() && text_[0] != '*') {
    whole += text_;
    pending_ = false;
  }
  std::vector<std::string_view> fields;
  split(whole, fields);
  if (!fields.empty()) keyword.name = one_blank_each(fields[0]);
  for (std::size_t i = 1; i < fields.size(); ++i) {
    const std::size_t equals = std::min(fields[i].find('='), fields[i].size());
    const std::string_view value =
        equals == fields[i].size() ? std::string_view() : fields[i].substr(equals + 1);
    keyword.parameters[one_blank_each(fields[i].substr(0, equals))] =
        std::string(unquoted(trimmed(value)));
  }
  return true;
}

bool InpDeck::next_data(std::vector<std::string_view>& fields) {
  if (!read_line() || text_[0] == '*') return false;
  pending_ = false;
  split(text_, fields);
  return true;
}

double InpDeck::number(std::string_view field) const {
  const auto value = number_in(field);
  if (!value) fail(not_a_number(field));
  return *value;
}

std::int64_t InpDeck::id(std::string_view field) const {
  constexpr std::int64_t kLargest = std::int64_t{1} << 53U;
  const auto value = integer_in(field);
  if (!value || *value < 1 || *value > kLargest) {
    fail("found " + shown(field) + ", expected a whole number from 1");
  }
  return *value;
}

}  // namespace chladni::io
