#include "study/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "base/error.h"
#include "host/atomic_file.h"
#include "study/problems.h"
#include "study/tables/array_places.h"
#include "study/toml/table_reader.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;
using Kind = TomlNode::Kind;

constexpr std::size_t kLargestPlan = std::size_t{4} << 20U;
constexpr int kMostPoints = 10'000;
const std::vector<std::string> kVerbs{"modes",       "place",    "priors", "identify",
                                      "interpolate", "diagnose", "study"};

TomlNode text_node(std::string text, Kind kind = Kind::text) {
  TomlNode node;
  node.kind = kind;
  node.text = std::move(text);
  return node;
}

TomlNode table_with(const std::string& key, TomlNode value) {
  TomlNode table;
  table.members.push_back({key, 0, 0, std::move(value)});
  return table;
}

// The number in front of a text, and what follows it: "20 mm" is 20 and " mm".
std::optional<std::pair<double, std::string>> number_and_unit(const TomlNode& node) {
  if (node.is_number()) return std::pair(node.number, std::string());
  if (node.kind != Kind::text) return std::nullopt;
  double value = 0.0;
  const char* end = node.text.data() + node.text.size();
  const auto [rest, fault] = std::from_chars(node.text.data(), end, value);
  if (fault != std::errc() || rest == end || !std::isfinite(value)) return std::nullopt;
  return std::pair(value, std::string(rest, end));
}

std::string label_of(const TomlNode& node) {
  if (node.kind == Kind::text) return node.text;
  if (node.kind == Kind::real) return fmt::format("{}", node.number);
  if (node.kind == Kind::integer) return node.text;
  if (node.kind == Kind::truth) return node.truth ? "true" : "false";
  std::string text;
  for (const auto& element : node.elements) text += (text.empty() ? "" : " ") + label_of(element);
  return "[" + text + "]";
}

TomlNode number_node(double value, const std::string& unit) {
  auto text = fmt::format("{:.10g}", value);
  if (!unit.empty()) return text_node(text + unit);
  const bool whole = text.find_first_of(".en") == std::string::npos;
  auto node = text_node(text, whole ? Kind::integer : Kind::real);
  node.number = value;
  return node;
}

void read_range(TableReader& table, SweepAxis& axis) {
  const auto* from = table.find("from");
  const auto* to = table.find("to");
  axis.range.emplace();
  if (from == nullptr || to == nullptr) {
    table.missing(from == nullptr ? "from" : "to", "both ends of the range, such as \"20 mm\"");
    return;
  }
  const auto low = number_and_unit(*from);
  const auto high = number_and_unit(*to);
  if (!low || !high || low->second != high->second) {
    table.wrong(*to, "from and to are " + description(*from) + " and " + description(*to) +
                         "; expected two numbers in one unit, such as \"20 mm\" and \"30 mm\"");
    return;
  }
  auto& range = *axis.range;
  range.from = low->first;
  range.to = high->first;
  range.unit = low->second;
  range.is_logarithmic =
      table.choice("spacing", {"linear", "logarithmic"}).value_or("linear") == "logarithmic";
  if (range.is_logarithmic && !(range.from > 0.0 && range.to > 0.0)) {
    table.wrong(*from, "a logarithmic axis expects two positive numbers");
  }
  const auto count = table.integer("count", 2, kMostPoints).value_or(0);
  for (long long i = 0; i < count; ++i) {
    const auto node = value_on(range, static_cast<double>(i) / static_cast<double>(count - 1));
    axis.points.push_back({label_of(node), document_with(axis.key, node)});
  }
}

void read_values(TableReader& table, const TomlNode& values, SweepAxis& axis) {
  if (values.kind != Kind::array || values.elements.empty()) {
    table.wrong(values, "values is " + description(values) + ", expected an array of values");
    return;
  }
  for (const auto& value : values.elements) {
    axis.points.push_back({label_of(value), document_with(axis.key, value)});
  }
}

void read_choices(TableReader& table, SweepAxis& axis) {
  for (auto& choice : table.tables("choice")) {
    AxisPoint point{choice.required_text("name"), {}};
    if (const auto* study = choice.find("study"); study != nullptr && study->kind == Kind::table) {
      point.sets = *study;
    } else {
      choice.missing("study", "a table with the keys that this choice sets");
    }
    choice.refuse_unknown();
    axis.points.push_back(std::move(point));
  }
  if (axis.points.empty()) {
    table.missing("choice", "key with values or from, to and count; or [[axis.choice]]");
  }
}

SweepAxis axis_of(TableReader& table) {
  SweepAxis axis;
  const auto* key = table.find("key");
  axis.key = table.text("key").value_or("");
  axis.name = table.text("name").value_or(axis.key.substr(axis.key.find_last_of('.') + 1));
  if (axis.name.empty()) table.missing("name", "a name, or a key");
  try {
    if (key != nullptr) static_cast<void>(document_with(axis.key, {}));
  } catch (const InvalidInput& e) {
    table.wrong(*key, e.what());
    return axis;
  }
  if (key == nullptr) {
    read_choices(table, axis);
  } else if (const auto* values = table.find("values")) {
    read_values(table, *values, axis);
  } else {
    read_range(table, axis);
  }
  table.refuse_unknown();
  return axis;
}

SweepResult result_of(TableReader& table) {
  SweepResult result;
  result.name = table.required_text("name");
  result.file = table.required_text("file");
  result.at = table.required_text("at");
  result.unit = table.text("unit").value_or("");
  const auto better = table.choice("better", {"more", "less"});
  if (better) {
    result.better = *better == "more" ? SweepResult::Better::more : SweepResult::Better::less;
  }
  if (fs::path(result.file).has_parent_path()) {
    table.wrong(*table.find("file"),
                "a result's file is that of a variant's folder, such as \"modes.json\"");
  }
  table.refuse_unknown();
  return result;
}

template <typename Named>
void refuse_repeated(TableReader& root, const std::string& what, const std::vector<Named>& all) {
  std::set<std::string> names;
  for (const auto& one : all) {
    if (!names.insert(one.name).second) {
      root.wrong(*root.find(what), what + " \"" + one.name + "\" is there twice");
    }
  }
}

std::string common_key(const TomlNode& a, const TomlNode& b);

bool is_list_of_names(const TomlNode& node) {
  return node.kind == Kind::array && !node.elements.empty() &&
         std::ranges::none_of(node.elements, [](const auto& e) { return element_name(e).empty(); });
}

// The key that elements of one name in both lists set: "[s1].at".
std::string common_key_of_elements(const TomlNode& a, const TomlNode& b) {
  for (const auto& one : a.elements) {
    const auto name = element_name(one);
    const auto other = std::ranges::find(b.elements, name, element_name);
    if (other == b.elements.end()) continue;
    if (const auto key = common_key(one, *other); !key.empty()) return "[" + name + "]." + key;
  }
  return {};
}

// Whether two tables of one key are bodies of two kinds: the latter takes the place of the former.
bool are_two_bodies(const TomlMember& a, const TomlNode& b) {
  return a.key == "geometry" && std::ranges::none_of(a.value.members, [&](const auto& one) {
           return member(b, one.key) != nullptr;
         });
}

// The key that both documents set, so that one of the values is lost where they are merged. Empty:
// none. A title decides nothing, and the name of an element says which one is meant.
std::string common_key(const TomlNode& a, const TomlNode& b) {
  for (const auto& entry : a.members) {
    const auto* other = member(b, entry.key);
    if (other == nullptr) continue;
    if (entry.key == "name" || entry.key == "title") continue;
    const bool tables = entry.value.kind == Kind::table && other->kind == Kind::table;
    const bool lists = is_list_of_names(entry.value) && is_list_of_names(*other);
    if ((!tables && !lists) || (tables && are_two_bodies(entry, *other))) return entry.key;
    const auto key =
        tables ? common_key(entry.value, *other) : common_key_of_elements(entry.value, *other);
    if (!key.empty()) return entry.key + (tables ? "." : "") + key;
  }
  return {};
}

// The documents of the points of an axis; of a range one, since all set the same key.
std::vector<TomlNode> documents_of(const SweepAxis& axis) {
  if (axis.range) return {document_with(axis.key, value_on(*axis.range, 0.0))};
  std::vector<TomlNode> all;
  for (const auto& point : axis.points) all.push_back(point.sets);
  return all;
}

std::string common_key(const SweepAxis& a, const SweepAxis& b) {
  for (const auto& one : documents_of(a)) {
    for (const auto& other : documents_of(b)) {
      if (auto key = common_key(one, other); !key.empty()) return key;
    }
  }
  return {};
}

// Refuses axes of which one would undo what the other sets.
void refuse_common_keys(TableReader& root, const SweepPlan& plan) {
  for (auto a = plan.axes.begin(); a != plan.axes.end(); ++a) {
    for (auto b = std::next(a); b != plan.axes.end(); ++b) {
      const auto key = common_key(*a, *b);
      if (key.empty()) continue;
      root.wrong(*root.find("axis"), "the axes \"" + a->name + "\" and \"" + b->name +
                                         "\" both set " + key + "; expected one axis of it");
    }
  }
}

void read_sample(TableReader& root, SweepPlan& plan) {
  if (auto table = root.table("sample")) {
    if (table->find("count") == nullptr) table->missing("count", "a number of variants");
    plan.sample_count = table->integer("count", 1, kMostVariants).value_or(1);
    plan.seed = static_cast<unsigned>(table->integer("seed", 0, 4294967295LL).value_or(1));
    table->refuse_unknown();
    return;
  }
  for (const auto& axis : plan.axes) {
    if (axis.points.empty() && axis.range) {
      root.wrong(*root.find("axis"),
                 "axis \"" + axis.name + "\" has no count; expected one, or [sample] with a count");
    }
  }
}

}  // namespace

TomlNode value_on(const AxisRange& range, double share) {
  const double value = range.is_logarithmic ? range.from * std::pow(range.to / range.from, share)
                                            : range.from + share * (range.to - range.from);
  return number_node(value, range.unit);
}

TomlNode document_with(std::string_view key, const TomlNode& value) {
  const auto dot = key.find('.');
  std::string first(key.substr(0, dot));
  const auto wrong = [&] {
    throw InvalidInput("the key \"" + std::string(key) +
                       "\" is no place in a study, expected one such as "
                       "\"geometry.plate.thickness\" or \"sensor[s1].at\"");
  };
  if (first.empty() || key.ends_with('.')) wrong();
  const TomlNode rest =
      dot == std::string_view::npos ? value : document_with(key.substr(dot + 1), value);
  const auto bracket = first.find('[');
  if (bracket == std::string::npos) return table_with(first, rest);
  if (bracket == 0 || !first.ends_with(']') || rest.kind != Kind::table) wrong();
  TomlNode element =
      table_with("name", text_node(first.substr(bracket + 1, first.size() - bracket - 2)));
  element.members.insert(element.members.end(), rest.members.begin(), rest.members.end());
  TomlNode array;
  array.kind = Kind::array;
  array.elements.push_back(std::move(element));
  return table_with(first.substr(0, bracket), std::move(array));
}

SweepPlan read_sweep(const fs::path& file, bool gathers) {
  const TomlNode tree = parse_toml(read_whole(file, kLargestPlan), file.string());
  Problems problems(file.string());
  TableReader root(tree, "", problems, "the plan");
  SweepPlan plan;
  plan.file = file;
  plan.name = file.stem().string();
  plan.title = root.text("title").value_or(plan.name);
  plan.base = fs::absolute(file).parent_path() / root.required_text("base");
  plan.verb = root.choice("verb", kVerbs).value_or("modes");
  for (auto& table : root.tables("axis")) plan.axes.push_back(axis_of(table));
  for (auto& table : root.tables("result")) plan.results.push_back(result_of(table));
  if (plan.axes.empty()) root.missing("axis", "[[axis]], at least one");
  if (gathers && plan.results.empty()) {
    root.missing("result", "[[result]], at least one number to gather");
  }
  refuse_repeated(root, "axis", plan.axes);
  refuse_repeated(root, "result", plan.results);
  refuse_common_keys(root, plan);
  read_sample(root, plan);
  root.refuse_unknown();
  problems.throw_if_any();
  return plan;
}

}  // namespace chladni::study
