// Measured responses as a table with one line per frequency.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "base/error.h"
#include "io/bytes/csv_table.h"
#include "io/csv.h"
#include "io/frf_file.h"
#include "io/measured/channel_names.h"
#include "io/measured/column_head.h"
#include "io/measured/frf_units.h"
#include "io/measured/measurable.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

enum Part { kRe, kIm, kVariance, kNoise, kCoherence, kPartCount };
constexpr std::array<std::string_view, kPartCount> kPrefix{"re_", "im_", "var_", "noisevar_",
                                                           "coh_"};
constexpr std::string_view kFrequency = "freq_hz";
constexpr std::string_view kAverages = "averages";

/// The columns of one response; −1: none.
struct Columns {
  std::array<Index, kPartCount> at{-1, -1, -1, -1, -1};
};

// The kind that a name without channels states. None: the word is no such name.
std::optional<std::optional<modal::FrfKind>> kind_of_word(std::string_view word) {
  using modal::FrfKind;
  static const std::map<std::string_view, std::optional<FrfKind>> words{
      {"ACCELERANCE", FrfKind::accelerance},
      {"INERTANCE", FrfKind::accelerance},
      {"MOBILITY", FrfKind::mobility},
      {"RECEPTANCE", FrfKind::receptance},
      {"COMPLIANCE", FrfKind::receptance},
      {"ADMITTANCE", FrfKind::receptance},
      {"FRF", std::nullopt},
      {"H", std::nullopt},
      {"H1", std::nullopt},
      {"G", std::nullopt}};
  const auto found = words.find(upper(word));
  if (found == words.end()) return std::nullopt;
  return found->second;
}

// The part of a response that a column name without channels states, such as re, im, coherence.
std::optional<Part> nameless_part(std::string_view column) {
  const std::string word = upper(column);
  if (word == "RE" || word == "REAL") return kRe;
  if (word == "IM" || word == "IMAG" || word == "IMAGINARY") return kIm;
  if (word == "COH" || word == "COHERENCE") return kCoherence;
  if (word == "VAR" || word == "VARIANCE") return kVariance;
  return std::nullopt;
}

struct Layout {
  Index frequency = -1, averages = -1;
  double hertz = 1.0;  // of 1 in the column of frequencies
  std::vector<ChannelPair> pairs;
  std::vector<Columns> columns;  // for each pair
  std::optional<modal::FrfKind> kind;
  std::map<std::string, std::string> unit_of;  // each output; empty: none is stated
  bool nameless = false;
};

class LayoutReader {
 public:
  LayoutReader(const CsvTable& table, const FrfOptions& options)
      : table_(table), options_(options) {}

  Layout layout(std::vector<std::string>& notes) {
    std::vector<std::string> others;
    for (std::size_t c = 0; c < table_.names.size(); ++c) {
      if (!take(c)) others.push_back(shown(table_.names[c]));
    }
    if (!others.empty()) {
      notes.push_back(std::string("the column") + (others.size() > 1 ? "s " : " ") +
                      listed(others) + (others.size() > 1 ? " are" : " is") +
                      " not of a response: not read");
    }
    if (layout_.frequency < 0) {
      throw NoResponses(place() +
                        "there is no column freq_hz; expected a first line such as "
                        "\"freq_hz,re_y1u1,im_y1u1\"");
    }
    if (layout_.pairs.empty()) refuse_no_responses();
    require_whole();
    return std::move(layout_);
  }

 private:
  [[nodiscard]] std::string place() const {
    return table_.file + ": line " + fmt::to_string(table_.header_line) + ": ";
  }
  [[noreturn]] void fail(const std::string& what) const { throw InvalidInput(place() + what); }

  // A column f may be a force beside a time.
  [[noreturn]] void refuse_no_responses() const {
    const std::string none = "there is no column of a response (re_y1u1)";
    bool has_time = false;
    for (std::size_t c = 0; c < table_.names.size(); ++c) {
      has_time = has_time || seconds_of_column(whole_head(table_, c));
    }
    if (has_time) throw NoResponses(place() + none);
    fail(none);
  }

  bool take(std::size_t number) {
    const auto& whole = table_.names[number];
    const auto column = static_cast<Index>(number);
    if (const auto hertz = hertz_of_column(whole_head(table_, number))) {
      if (layout_.frequency >= 0) fail("two columns of frequencies, " + shown(whole));
      layout_.frequency = column;
      layout_.hertz = *hertz;
      return true;
    }
    auto [name, unit] = channel_and_unit(whole);
    if (force_unit(unit)) std::tie(name, unit) = std::pair(whole, "");  // the actuator "u [N]"
    column_ = number;
    unit_ = unit;
    if (name == kAverages) {
      if (layout_.averages >= 0) fail("two columns " + shown(name));
      layout_.averages = column;
      return true;
    }
    for (int part = 0; part < kPartCount; ++part) {
      const auto prefix = kPrefix[static_cast<std::size_t>(part)];
      if (!name.starts_with(prefix)) continue;
      take_part(name, static_cast<Part>(part), name.substr(prefix.size()), column);
      return true;
    }
    const auto part = nameless_part(name);
    if (part) put(only_pair(), *part, column, name);
    return part.has_value();
  }

  void take_part(const std::string& name, Part part, const std::string& word, Index column) {
    const auto kind = kind_of_word(word);
    if (kind && *kind) layout_.kind = *kind;
    put(kind ? only_pair() : pair_of(word, name), part, column, name);
  }

  ChannelPair pair_of(const std::string& word, const std::string& name) const {
    try {
      return channel_pair(word, options_.sensor_names, options_.actuator_names);
    } catch (const InvalidInput& e) {
      fail("column " + shown(name) + ": " + e.what());
    }
  }

  ChannelPair only_pair() {
    layout_.nameless = true;
    const auto one = [](const std::vector<std::string>& names, const char* otherwise) {
      return names.size() == 1 ? names.front() : std::string(otherwise);
    };
    return {one(options_.sensor_names, "y1"), one(options_.actuator_names, "u1")};
  }

  void put(const ChannelPair& pair, Part part, Index column, const std::string& name) {
    const auto [place, is_new] = number_.emplace(pair, layout_.pairs.size());
    if (is_new) {
      layout_.pairs.push_back(pair);
      layout_.columns.emplace_back();
    }
    Index& at = layout_.columns[place->second].at[part];
    if (at >= 0) {
      fail("columns " + shown(table_.names[static_cast<std::size_t>(at)]) + " and " + shown(name) +
           " are of the same response");
    }
    at = column;
    if (part != kRe && part != kIm) return;
    if (!table_.units.empty()) unit_ = response_unit(table_, column_);
    const auto [of_output, is_first] = layout_.unit_of.emplace(pair.first, unit_);
    if (of_output->second == unit_) return;
    const auto said = [](const std::string& unit) { return unit.empty() ? "none" : shown(unit); };
    fail("column " + shown(name) + " has another unit than others of " + pair.first + ": " +
         said(unit_) + " beside " + said(of_output->second));
  }

  void require_whole() const {
    for (std::size_t r = 0; r < layout_.pairs.size(); ++r) {
      for (const Part part : {kRe, kIm}) {
        if (layout_.columns[r].at[part] >= 0) continue;
        fail("the response " + layout_.pairs[r].first + "/" + layout_.pairs[r].second +
             " has no column " + std::string(kPrefix[part]));
      }
    }
  }

  const CsvTable& table_;
  const FrfOptions& options_;
  Layout layout_;
  std::size_t column_ = 0;  // that is read
  std::string unit_;        // of it
  std::map<ChannelPair, std::size_t> number_;
};

void check_frequencies(const CsvTable& table, Index column) {
  for (Index k = 0; k < table.values.rows(); ++k) {
    const double f = table.values(k, column);
    const double before = k == 0 ? -1.0 : table.values(k - 1, column);
    if (f >= 0.0 && f > before) continue;
    throw InvalidInput(
        table.file + ": line " + fmt::to_string(table.line[static_cast<std::size_t>(k)]) + ": " +
        table.names[static_cast<std::size_t>(column)] + " is " + fmt::format("{:.9g}", f) +
        (k == 0 ? "" : " after " + fmt::format("{:.9g}", before)) +
        "; expected ascending frequencies");
  }
}

// The degrees of freedom of the variances, one number for all lines. The fewest are taken where
// lines differ, because a set has one number only.
double averages_of(const CsvTable& table, Index column, std::vector<std::string>& notes) {
  if (column < 0) return 0.0;
  double fewest = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (Index k = 0; k < table.values.rows(); ++k) {
    const double value = table.values(k, column);
    if (std::isnan(value)) continue;
    if (value < 0.0) {
      throw InvalidInput(
          fmt::format("{}: line {}: averages is {:g}; expected 0 (not known) or more", table.file,
                      table.line[static_cast<std::size_t>(k)], value));
    }
    fewest = std::min(fewest, value);
    most = std::max(most, value);
  }
  if (most == 0.0) return 0.0;
  if (fewest < most) {
    notes.push_back(
        fmt::format("averages are {:g} to {:g}: the fewest count on all lines", fewest, most));
  }
  return fewest;
}

// The index of a name in the list of its side. A new name is added.
Index number_of(const std::string& name, std::vector<modal::MeasuredChannel>& side,
                std::map<std::string, Index>& numbers) {
  const auto [found, is_new] = numbers.emplace(name, static_cast<Index>(side.size()));
  if (is_new) side.emplace_back().name = name;
  return found->second;
}

/// Row and column of every response in the set.
std::vector<std::pair<Index, Index>> add_channels(const Layout& layout, modal::FrfSet& set) {
  std::map<std::string, Index> outputs;
  std::map<std::string, Index> inputs;
  std::vector<std::pair<Index, Index>> places;
  for (const auto& [sensor, actuator] : layout.pairs) {
    const Index i = number_of(sensor, set.outputs, outputs);
    places.emplace_back(i, number_of(actuator, set.inputs, inputs));
  }
  for (auto& output : set.outputs) {
    output.kind = layout.kind.value_or(output.kind);
    output.unit = layout.unit_of.at(output.name);
  }
  return places;
}

bool has_part(const Layout& layout, Part part) {
  return std::any_of(layout.columns.begin(), layout.columns.end(),
                     [part](const Columns& c) { return c.at[part] >= 0; });
}

void fill(std::vector<Eigen::MatrixXd>& of, const Layout& layout, Part part, const CsvTable& table,
          const std::vector<std::pair<Index, Index>>& places, const modal::FrfSet& set) {
  if (!has_part(layout, part)) return;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  of.assign(static_cast<std::size_t>(table.values.rows()),
            Eigen::MatrixXd::Constant(set.output_count(), set.input_count(), nothing));
  for (std::size_t r = 0; r < places.size(); ++r) {
    const Index column = layout.columns[r].at[part];
    if (column < 0) continue;
    for (Index k = 0; k < table.values.rows(); ++k) {
      const double number = table.values(k, column);
      of[static_cast<std::size_t>(k)](places[r].first, places[r].second) =
          part == kCoherence ? rounded_coherence(number) : number;
    }
  }
}

void fill_values(const Layout& layout, const CsvTable& table,
                 const std::vector<std::pair<Index, Index>>& places, modal::FrfSet& set) {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  set.value.assign(static_cast<std::size_t>(table.values.rows()),
                   Eigen::MatrixXcd::Constant(set.output_count(), set.input_count(),
                                              std::complex<double>(nothing, nothing)));
  for (std::size_t r = 0; r < places.size(); ++r) {
    const auto& at = layout.columns[r].at;
    for (Index k = 0; k < table.values.rows(); ++k) {
      set.value[static_cast<std::size_t>(k)](places[r].first, places[r].second) = {
          table.values(k, at[kRe]), table.values(k, at[kIm])};
    }
  }
}

}  // namespace

FrfFile parse_frf_csv(std::string_view bytes, const std::string& name, const FrfOptions& options) {
  const CsvTable table = csv_table(bytes, name, options.limit_bytes);
  FrfFile file{.format = "CSV", .set = {}, .notes = {}};
  const Layout layout = LayoutReader(table, options).layout(file.notes);
  require(table.values.rows() > 0, name + ": no line of numbers below the names");
  check_frequencies(table, layout.frequency);
  if (layout.nameless) {
    file.notes.push_back("the response has no names: taken as " + layout.pairs.front().first +
                         " over " + layout.pairs.front().second);
  }
  const auto places = add_channels(layout, file.set);
  int parts = 0;
  for (const auto part : {kVariance, kNoise, kCoherence}) parts += has_part(layout, part) ? 1 : 0;
  try {
    require_room(file.set, table.values.rows(), parts, options.limit_bytes);
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what() + " (it has " + fmt::to_string(layout.pairs.size()) +
                       " responses)");
  }
  file.set.frequency_hz = layout.hertz * table.values.col(layout.frequency);
  file.set.averages = averages_of(table, layout.averages, file.notes);
  fill_values(layout, table, places, file.set);
  fill(file.set.variance, layout, kVariance, table, places, file.set);
  fill(file.set.noise_variance, layout, kNoise, table, places, file.set);
  fill(file.set.coherence, layout, kCoherence, table, places, file.set);
  try {
    bring_to_si(file, layout.kind.has_value());
    state_units(file, layout.kind.has_value(), options);
    modal::check(file.set);
  } catch (const InvalidInput& e) {
    throw InvalidInput(name + ": " + e.what());
  }
  return file;
}

namespace {

// "y1u1" if it is read back as these two names, else "y1/u1".
std::string pair_name(const std::string& sensor, const std::string& actuator) {
  const auto is_read_back = [&](const std::string& word) {
    try {
      return channel_pair(word, {}, {}) == ChannelPair(sensor, actuator) && !kind_of_word(word);
    } catch (const InvalidInput&) {
      return false;
    }
  };
  if (is_read_back(sensor + actuator)) return sensor + actuator;
  std::string word = sensor + "/" + actuator;
  require(is_read_back(word) && word.find_first_of("\r\n") == std::string_view::npos,
          "CSV cannot hold the names of the response " + shown(sensor) + " over " +
              shown(actuator) + "; expected names without /, line ends and blanks around them");
  return word;
}

template <typename Matrix, typename Number>
void add_column(const std::vector<Matrix>& of, std::string_view prefix, const std::string& pair,
                Index i, Index j, Number number, std::vector<CsvColumn>& columns) {
  if (of.empty()) return;
  Eigen::VectorXd entries(static_cast<Index>(of.size()));
  for (Index k = 0; k < entries.size(); ++k) {
    entries(k) = number(of[static_cast<std::size_t>(k)](i, j));
  }
  columns.push_back({std::string(prefix) + pair, std::move(entries)});
}

}  // namespace

std::string frf_csv(const modal::FrfSet& set) {
  modal::check(set);
  std::vector<CsvColumn> columns{{std::string(kFrequency), set.frequency_hz}};
  const auto itself = [](double value) { return value; };
  for (Index i = 0; i < set.output_count(); ++i) {
    for (Index j = 0; j < set.input_count(); ++j) {
      const auto pair = pair_name(set.outputs[static_cast<std::size_t>(i)].name,
                                  set.inputs[static_cast<std::size_t>(j)].name);
      const auto real = [](const std::complex<double>& value) { return value.real(); };
      const auto imag = [](const std::complex<double>& value) { return value.imag(); };
      add_column(set.value, kPrefix[kRe], pair, i, j, real, columns);
      add_column(set.value, kPrefix[kIm], pair, i, j, imag, columns);
      add_column(set.variance, kPrefix[kVariance], pair, i, j, itself, columns);
      add_column(set.noise_variance, kPrefix[kNoise], pair, i, j, itself, columns);
      add_column(set.coherence, kPrefix[kCoherence], pair, i, j, itself, columns);
    }
  }
  if (set.averages > 0.0 && !set.variance.empty()) {
    const Eigen::VectorXd same = Eigen::VectorXd::Constant(set.line_count(), set.averages);
    columns.push_back({std::string(kAverages), same});
  }
  return csv(columns);
}

}  // namespace chladni::io
