#include "io/uff/uff.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "io/bytes/escape.h"
#include "io/scan.h"
#include "io/uff/uff_datasets.h"
#include "io/uff/uff_systems.h"

namespace chladni::io {
namespace {

// The number of a dataset from its line: "58", "58b", "2411". Empty: it is no such line.
std::string dataset_number(std::string_view line) {
  const auto words = words_of(line);
  if (words.empty()) return {};
  std::string word = upper(words.front());
  if (words.size() > 1 && word == "58" && upper(words[1]) == "B") word = "58B";
  const auto digits = word.substr(0, word.find_first_not_of("0123456789"));
  const auto tail = word.substr(digits.size());
  if (digits.empty() || digits.size() > 6 || (!tail.empty() && tail != "B")) return {};
  return digits + (tail.empty() ? "" : "b");
}

class UffReader {
 public:
  UffReader(std::string_view bytes, const std::string& name, std::size_t limit,
            const UffVisitor& visit)
      : lines_(bytes, name, limit), name_(name), visit_(visit) {}

  Uff read() {
    skip_to_first();
    while (!lines_.at_end()) {
      const auto line = trimmed(lines_.peek());
      if (line.empty() || line == "-1") {
        lines_.take();
        continue;
      }
      dataset();
    }
    require(any_, name_ +
                      ": no dataset; expected lines of -1 around datasets, as universal files "
                      "have them");
    for (const auto& [number, count] : unknown_) {
      uff_.notes.push_back("dataset " + number +
                           (count > 1 ? ", " + fmt::to_string(count) + " times" : "") +
                           ": not read");
    }
    if (!left_out_.empty()) {
      const bool is_one = left_out_.size() == 1;
      uff_.notes.push_back(listed(left_out_) + (is_one ? " is" : " are") +
                           " placed in a coordinate system and not in the unit of the first "
                           "dataset 164: " +
                           (is_one ? "its place and its system" : "their places and systems") +
                           " are not read");
    }
    for (auto& function : uff_.functions) {
      if (!function.units) function.units = uff_.units;
    }
    return std::move(uff_);
  }

 private:
  void skip_to_first() {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";  // the byte order mark of UTF-8
    if (lines_.rest().starts_with(kMark)) lines_.skip(kMark.size());
    const std::size_t before = lines_.left();
    while (!lines_.at_end() && trimmed(lines_.peek()) != "-1") {
      if (!trimmed(lines_.peek()).empty() && before == lines_.left()) {
        uff_.notes.push_back("line " + fmt::to_string(lines_.line()) +
                             " and what follows up to the first -1: not read");
      }
      lines_.take();
    }
  }

  // Reads what comes after the -1 at the start of a dataset: its number, then its content.
  void dataset() {
    const std::size_t at = lines_.line();
    const std::string head(lines_.take());
    const std::string number = dataset_number(head);
    lines_.enter(number, at);
    if (number.empty()) {
      require(any_, name_ + ": line " + fmt::to_string(at) + ": found " + shown(head) +
                        ", expected the number of a dataset");
      lines_.enter(last_, at);
      lines_.fail("found " + shown(trimmed(head)) + ", expected -1 and the number of a dataset");
    }
    any_ = true;
    last_ = number;
    read_dataset(number, head);
    if (!lines_.at_end_of_dataset()) {
      skip_rest(number);
    } else if (lines_.at_end()) {
      uff_.notes.push_back("dataset " + number + " from line " + fmt::to_string(at) +
                           " ends without -1");
    } else {
      lines_.take();
    }
  }

  void read_dataset(const std::string& number, const std::string& head) {
    if (number == "58" || number == "58b") {
      const auto room = lines_.room();
      uff_.functions.push_back(uff_function(lines_, head, uff_.notes));
      auto& function = uff_.functions.back();
      function.units = current_;
      if (visit_) visit_(function);
      if (function.x.size() == 0 && function.y.size() == 0) lines_.restore_room(room);
    } else if (number == "55" || number == "2414") {
      auto shape =
          number == "55" ? uff_shape_55(lines_, uff_.notes) : uff_shape_2414(lines_, uff_.notes);
      if (shape) uff_.shapes.push_back(std::move(*shape));
    } else if (number == "151") {
      uff_.title = utf8_of(trimmed(lines_.record("model's name")));
      to_delimiter();
    } else if (number == "164") {
      units();
    } else if (number == "15") {
      while (!lines_.at_end_of_dataset()) node_of_15();
    } else if (number == "2411" || number == "781") {
      while (!lines_.at_end_of_dataset()) node_of_2411(number == "781");
    } else if (number == "18" || number == "2420") {
      uff_.defines_systems = true;
      as_far_as_readable("coordinate systems", [&] { read_systems(number); });
    } else if (number == "82") {
      as_far_as_readable("trace lines",
                         [&] { uff_.trace_lines.push_back(uff_trace_line(lines_)); });
    } else if (number == "2412") {
      as_far_as_readable("elements", [&] { read_elements_of_2412(lines_, uff_.elements); });
    } else {
      ++unknown_[number];
      to_delimiter();
    }
  }

  void to_delimiter() {
    while (!lines_.at_delimiter()) lines_.take();
  }

  // Skips lines that do not belong to the dataset. They are noted once per dataset.
  void skip_rest(const std::string& number) {
    const std::size_t from = lines_.line();
    to_delimiter();
    lines_.take();
    uff_.notes.push_back("dataset " + number + ": lines from " + fmt::to_string(from) +
                         " on are more than it says: not read");
  }

  double number(std::string_view line, std::size_t& at, const char* what) const {
    const auto value = run_on_number(line, at);
    if (value) return *value;
    lines_.fail(std::string(what) + ": " + not_a_number(line.substr(std::min(at, line.size()))));
  }

  void units() {
    const std::string head(lines_.filled_record("units code"));
    UffUnits units;
    units.description =
        head.size() > 10 ? utf8_of(trimmed(std::string_view(head).substr(10, 20))) : std::string();
    const std::string factors(lines_.filled_record("unit factors"));
    std::size_t at = 0;
    const double length = number(factors, at, "factor of lengths");
    const double force = number(factors, at, "factor of forces");
    if (!(length > 0.0) || !(force > 0.0)) {
      lines_.fail("a unit factor of 0 or less");
    }
    units.length = 1.0 / length;  // the factor is the file's units per metre
    units.force = 1.0 / force;
    if (!std::isfinite(units.length) || !std::isfinite(units.force)) {
      lines_.fail("a unit factor that has no inverse");
    }
    to_delimiter();
    current_ = units;
    if (!uff_.units) uff_.units = units;
    if (uff_.units->length != units.length || uff_.units->force != units.force) {
      uff_.notes.emplace_back(
          "dataset 164 occurs with different units: each holds for what follows");
    }
  }

  // Reads coordinate systems, lines or elements. What cannot be read of them is noted: it matters
  // only to nodes that use such a system, or to a drawing.
  template <class Read>
  void as_far_as_readable(const char* what, Read read) {
    try {
      read();
    } catch (const InvalidInput& e) {
      uff_.notes.push_back(std::string(e.what()) + ": the " + what + " from there on are not read");
      to_delimiter();
    }
  }

  // Reads fields 2 and 3 of a node: the systems of its place and of its displacements.
  [[nodiscard]] UffNodeSystems node_systems(const std::vector<std::string_view>& words) const {
    UffNodeSystems systems;
    if (words.size() > 1) systems.place = uff_integer(lines_, words[1], "system of a place");
    if (words.size() > 2) systems.displacement = uff_integer(lines_, words[2], "system of a node");
    return systems;
  }

  // Lengths of what follows the present dataset 164, in the unit of the first one.
  [[nodiscard]] double in_first_unit() const {
    return current_ && uff_.units ? current_->length / uff_.units->length : 1.0;
  }

  void add_node(long long label, Eigen::Vector3d position, const UffNodeSystems& systems) {
    if (systems.place != 0 && in_first_unit() != 1.0) {
      left_out_.push_back("node " + fmt::to_string(label));
      return;
    }
    position *= in_first_unit();
    const auto [place, is_new] = uff_.nodes.emplace(label, position);
    if (is_new && (systems.place != 0 || systems.displacement != 0)) {
      uff_.node_systems.emplace(label, systems);
    }
    if (is_new) return;
    const auto known = uff_.node_systems.find(label);
    const auto before = known == uff_.node_systems.end() ? UffNodeSystems{} : known->second;
    const auto node = "node " + fmt::to_string(label);
    if (before.displacement != systems.displacement) {
      uff_.notes.push_back(node + " has two coordinate systems of displacements, " +
                           fmt::to_string(before.displacement) + " and " +
                           fmt::to_string(systems.displacement) + ": the first is taken");
    }
    const bool is_same = before.place == systems.place &&
                         (place->second - position).norm() <= 1e-6 * position.norm();
    if (!is_same) uff_.notes.push_back(node + " has two places: the first is taken");
  }

  void read_systems(const std::string& number) {
    number == "18" ? read_systems_of_18(lines_, in_first_unit(), uff_.systems)
                   : read_systems_of_2420(lines_, in_first_unit(), uff_.systems);
  }

  void node_of_15() {
    const auto line = lines_.record("node");
    const auto words = words_of(line.substr(0, 40));
    if (words.size() < 4) {
      lines_.fail("found " + shown(line) + ", expected a node: 4 whole numbers and 3 coordinates");
    }
    std::size_t at = 40;
    if (words.size() > 4) at = static_cast<std::size_t>(words[4].data() - line.data());
    Eigen::Vector3d position;
    for (auto& coordinate : position) coordinate = number(line, at, "coordinate of a node");
    add_node(uff_integer(lines_, words[0], "number of a node"), position, node_systems(words));
  }

  // Reads a node. Dataset 781 states places in the node's own system. Dataset 2411 states them in
  // the part's system, for any export system.
  void node_of_2411(bool in_own_system) {
    const auto words = words_of(lines_.record("node"));
    const auto label = uff_integer(lines_, words[0], "number of a node");
    auto systems = node_systems(words);
    const auto line = lines_.filled_record("coordinates of a node");
    std::size_t at = 0;
    Eigen::Vector3d position;
    for (auto& coordinate : position) coordinate = number(line, at, "coordinate of a node");
    if (!in_own_system) systems.place = 0;
    add_node(label, position, systems);
  }

  UffLines lines_;
  std::string name_, last_;
  const UffVisitor& visit_;
  Uff uff_;
  std::optional<UffUnits> current_;
  std::map<std::string, int> unknown_;
  std::vector<std::string> left_out_;  ///< nodes
  bool any_ = false;
};

}  // namespace

Uff parse_uff(std::string_view bytes, const std::string& name, std::size_t limit,
              const UffVisitor& visit) {
  refuse_utf16(bytes, name);
  return UffReader(bytes, name, limit, visit).read();
}

long long uff_integer(const UffLines& lines, std::string_view word, std::string_view what) {
  const auto value = integer_in(trimmed(word));
  if (value) return *value;
  lines.fail(std::string(what) + ": found " + shown(trimmed(word)) + ", expected a whole number");
}

}  // namespace chladni::io
