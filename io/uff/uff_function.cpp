// Reads datasets 58 and 58b: functions at nodal degrees of freedom.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "io/bytes/escape.h"
#include "io/measured/measurable.h"
#include "io/scan.h"
#include "io/uff/uff_datasets.h"

namespace chladni::io {
namespace {

// Columns [from, from + size) of a line.
std::string_view columns(std::string_view line, std::size_t from, std::size_t size) {
  return from < line.size() ? line.substr(from, size) : std::string_view();
}

// Whether a word crosses the end of a column.
bool cuts(std::string_view line, std::size_t at) {
  return at > 0 && at < line.size() && line[at] != ' ' && line[at - 1] != ' ';
}

std::string word_of(std::string_view field) {
  const auto word = trimmed(field);
  return upper(word) == "NONE" ? std::string() : utf8_of(word);
}

// The letters of 80 columns. In Latin-1 each byte is a letter; a letter of UTF-8 is kept whole.
std::string letters_of_line(std::string_view line) {
  const bool is_utf8 = valid_utf8(line) == line;
  return utf8_of(is_utf8 ? whole_letters(line, 80) : line.substr(0, 80));
}

int direction_of(const UffLines& lines, std::string_view word) {
  const auto direction = uff_integer(lines, word, "direction");
  if (direction >= -6 && direction <= 6) return static_cast<int>(direction);
  lines.fail("direction " + fmt::to_string(direction) + ", expected -6 to 6");
}

constexpr std::array<std::size_t, 5> kFilled{0, 2, 5, 6, 8};  // whole numbers in record 6
constexpr std::array<std::size_t, 11> kDegreeColumns{0, 5, 15, 20, 30, 41, 51, 55, 66, 76, 80};

// Whether no field of a line in the columns 2(I5,I10), 2(1X,10A1,I10,I4) touches the next one.
bool fields_are_apart(std::string_view line) {
  return std::ranges::none_of(std::array<std::size_t, 5>{5, 15, 20, 51, 76},
                              [&](std::size_t at) { return cuts(line, at); });
}

// Whether the columns of a line have whole numbers where the form wants them.
bool keeps_columns(std::string_view line) {
  if (line.size() <= 66) return false;
  return std::all_of(kFilled.begin(), kFilled.end(), [&](std::size_t field) {
    const auto from = kDegreeColumns[field];
    return integer_in(trimmed(columns(line, from, kDegreeColumns[field + 1] - from))).has_value();
  });
}

// The ten fields of record 6, by columns, or by blanks where a program did not keep the columns.
std::vector<std::string_view> degree_fields(const UffLines& lines, std::string_view line) {
  const bool keeps = keeps_columns(line);
  if (!keeps || !fields_are_apart(line)) {
    auto words = words_of(line);
    if (words.size() == 10) return words;
  }
  if (!keeps) {
    lines.fail("found " + shown(trimmed(line)) +
               ", expected the function type, three numbers, and name, node and direction of "
               "response and reference");
  }
  std::vector<std::string_view> fields;
  for (std::size_t f = 0; f < 10; ++f) {
    fields.push_back(columns(line, kDegreeColumns[f], kDegreeColumns[f + 1] - kDegreeColumns[f]));
    const bool is_number = f != 4 && f != 7;
    if (is_number && trimmed(fields.back()).empty()) fields.back() = "0";
  }
  return fields;
}

void read_degrees(UffLines& lines, UffFunction& function) {
  const std::string line(lines.filled_record("function type"));
  const auto words = degree_fields(lines, line);
  const auto type = uff_integer(lines, words[0], "function type");
  if (type < 0 || type > 1000) lines.fail("function type " + fmt::to_string(type));
  function.type = static_cast<int>(type);
  function.version = uff_integer(lines, words[2], "version");
  function.load_case = uff_integer(lines, words[3], "load case");
  function.response = {word_of(words[4]), uff_integer(lines, words[5], "response node"),
                       direction_of(lines, words[6])};
  function.reference = {word_of(words[7]), uff_integer(lines, words[8], "reference node"),
                        direction_of(lines, words[9])};
}

// Up to three numbers while reading, then the abscissa and a complex value.
constexpr double kBytesPerPoint = 48.0;

/// The data form of record 7.
struct Form {
  int ordinate_type = 0;
  std::size_t points = 0;
  bool even = false;
  double first = 0.0, step = 0.0;
};

Form read_form(UffLines& lines) {
  const std::string line(lines.filled_record("data form"));
  auto words = words_of(line);
  std::vector<std::string_view> numbers;
  if (words.size() < 5) {  // numbers without blanks between them
    for (const std::size_t at : {0, 10, 20}) words.push_back(columns(line, at, 10));
    words.erase(words.begin(), words.end() - 3);
    for (const std::size_t at : {30, 43}) words.push_back(columns(line, at, 13));
  }
  Form form;
  const auto type = uff_integer(lines, words[0], "ordinate data type");
  if (type != 2 && type != 4 && type != 5 && type != 6) {
    lines.fail("ordinate data type " + fmt::to_string(type) +
               ", expected 2 or 4 (real), 5 or 6 (complex)");
  }
  form.ordinate_type = static_cast<int>(type);
  const auto points = uff_integer(lines, words[1], "number of values");
  if (points < 1 || static_cast<unsigned long long>(points) > lines.left()) {
    lines.fail(fmt::to_string(points) + " values, the file has " + fmt::to_string(lines.left()) +
               " bytes left");
  }
  form.points = static_cast<std::size_t>(points);
  lines.take_room(kBytesPerPoint * static_cast<double>(points));
  const auto even = uff_integer(lines, words[2], "abscissa spacing");
  if (even != 0 && even != 1)
    lines.fail("abscissa spacing " + fmt::to_string(even) + ", expected 0 (uneven) or 1 (even)");
  form.even = even == 1;
  const auto number = [&](std::string_view word, const char* what) {
    const auto value = number_in(trimmed(word));
    if (!value && form.even) lines.fail(std::string(what) + ": " + not_a_number(trimmed(word)));
    return value.value_or(0.0);
  };
  form.first = number(words[3], "first abscissa");
  form.step = number(words[4], "abscissa increment");
  return form;
}

UffAxis read_axis(UffLines& lines, const char* what) {
  const std::string line(lines.filled_record(what));
  const auto words = words_of(line);
  if (words.size() < 4) {
    lines.fail("found " + shown(trimmed(line)) + ", expected the " + what +
               ": a type, three exponents, a label and a unit");
  }
  UffAxis axis;
  const auto small = [&](std::string_view word, const char* name, long long most) {
    const auto value = uff_integer(lines, word, name);
    if (value < -most || value > most) lines.fail(std::string(name) + " " + fmt::to_string(value));
    return static_cast<int>(value);
  };
  axis.type = small(words[0], "type of data", 1000);
  axis.length_exponent = small(words[1], "exponent of lengths", 99);
  axis.force_exponent = small(words[2], "exponent of forces", 99);
  const auto end_of_numbers =
      static_cast<std::size_t>(words[3].data() - line.data()) + words[3].size();
  const bool by_columns = end_of_numbers <= 26 && !cuts(line, 46) && line.size() > 26;
  if (by_columns) {
    axis.label = word_of(columns(line, 26, 20));
    axis.unit = word_of(columns(line, 46, 21));
  } else if (words.size() >= 6) {
    axis.label = word_of(words[4]);
    axis.unit = word_of(words[5]);
  }
  return axis;
}

void place_values(const std::vector<double>& numbers, const Form& form, UffLines& lines,
                  UffFunction& function) {
  const auto n = static_cast<Eigen::Index>(form.points);
  function.x.resize(n);
  function.y.resize(n);
  std::size_t at = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    function.x(k) = form.even ? form.first + form.step * static_cast<double>(k) : numbers[at++];
    const double real = numbers[at++];
    function.y(k) = {real, function.is_complex ? numbers[at++] : 0.0};
  }
  if (function.x.allFinite()) return;
  lines.fail("an abscissa is not a finite number");
}

// Notes that six digits of an increment are not enough for a long record: 0.01953125 is written
// 1.95313E-02.
void note_rounding(const UffFunction& function, const Form& form, std::string_view name,
                   std::vector<std::string>& notes) {
  if (!form.even || form.points < 2000 || form.step <= 0.0) return;
  const double decade = std::pow(10.0, std::floor(std::log10(form.step)) - 5.0);
  const double mantissa = form.step / decade;
  if (std::abs(mantissa - std::round(mantissa)) > 1e-6) return;                // it has more digits
  if (std::abs(mantissa / 10.0 - std::round(mantissa / 10.0)) < 1e-6) return;  // or fewer
  const double off = 0.5 * decade * static_cast<double>(form.points);
  if (off < 0.05 * form.step) return;
  notes.push_back("function of line " + fmt::to_string(function.line) + ": the increment " +
                  std::string(name) + " has six digits, so that the last of " +
                  fmt::to_string(form.points) + " lines may be off by up to " +
                  fmt::format("{:.6g}", off));
}

}  // namespace

namespace {

// Appends the numbers of one line, until there are `count`. @return the place after the last one
std::size_t take_numbers(const UffLines& lines, std::string_view line, std::size_t count,
                         std::vector<double>& numbers) {
  std::size_t at = 0;
  while (numbers.size() < count) {
    if (const auto value = run_on_number(line, at)) {
      if (!is_measurable(*value)) lines.fail(not_measurable(*value));
      numbers.push_back(*value);
    } else if (at == line.size()) {
      break;
    } else if (upper(line.substr(at, 3)) == "NAN") {
      numbers.push_back(std::nan(""));
      at += 3;
    } else {
      lines.fail(not_a_number(words_of(line.substr(at)).front()));
    }
  }
  return at;
}

}  // namespace

std::vector<double> uff_text_numbers(UffLines& lines, std::size_t count,
                                     std::vector<std::string>& notes) {
  std::vector<double> numbers;
  numbers.reserve(std::min(count, lines.left()));
  while (numbers.size() < count) {
    if (lines.at_delimiter()) {
      lines.fail((lines.at_end() ? "the file ends" : "the dataset ends") + std::string(" after ") +
                 fmt::to_string(numbers.size()) + " numbers, expected " + fmt::to_string(count));
    }
    const auto line = lines.peek();
    const std::size_t end = take_numbers(lines, line, count, numbers);
    if (numbers.size() == count && !trimmed(line.substr(end)).empty()) {
      notes.push_back("line " + fmt::to_string(lines.line()) +
                      " has more numbers than the dataset says");
    }
    if (numbers.size() == count && line.size() == lines.left()) {
      lines.fail("the file ends in its last number, or right behind it without a line end");
    }
    lines.take();
  }
  return numbers;
}

UffFunction uff_function(UffLines& lines, std::string_view head, std::vector<std::string>& notes) {
  UffFunction function;
  function.line = lines.line() - 1;
  function.binary = upper(head).find('B') != std::string::npos;
  for (auto& id : function.id) {
    const auto line = trimmed(lines.record("identification lines"));
    id = upper(line) == "NONE" ? std::string() : letters_of_line(line);
  }
  read_degrees(lines, function);
  const Form form = read_form(lines);
  function.abscissa = read_axis(lines, "abscissa");
  function.ordinate = read_axis(lines, "ordinate");
  function.denominator = read_axis(lines, "ordinate's denominator");
  static_cast<void>(read_axis(lines, "z axis"));
  function.is_complex = form.ordinate_type >= 5;
  const std::size_t each = (function.is_complex ? 2U : 1U) + (form.even ? 0U : 1U);
  const auto numbers = function.binary ? uff_binary_numbers(lines, std::string(head), form.points,
                                                            form.ordinate_type, form.even, notes)
                                       : uff_text_numbers(lines, each * form.points, notes);
  place_values(numbers, form, lines, function);
  note_rounding(function, form, fmt::format("{:.9g}", form.step), notes);
  return function;
}

}  // namespace chladni::io
