#include "study/tables/array_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "base/quantity.h"
#include "base/text_stream.h"
#include "host/atomic_file.h"
#include "study/device_arrays.h"
#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

using NodeKind = TomlNode::Kind;
using Eigen::Vector2d;

constexpr const char* kForms[] = {"ring", "grid", "hexagon", "csv"};
constexpr std::size_t kLargestCsv = std::size_t{16} << 20U;

Vector2d along(double angle) { return {std::cos(angle), std::sin(angle)}; }

std::vector<ArrayPlace> seen_from_above(const std::vector<Vector2d>& points,
                                        const Vector2d& centre) {
  std::vector<ArrayPlace> all;
  for (const auto& point : points) {
    ArrayPlace place;
    place.point.head<2>() = point;
    const Vector2d off = point - centre;
    if (off.norm() > 1e-9) place.outward = off.normalized();
    all.push_back(place);
  }
  return all;
}

template <typename Plan>
std::vector<ArrayPlace> places_of(TableReader& table, const std::string& form,
                                  const Schema<Plan>& schema) {
  auto part = table.table(form);
  if (!part) return {};
  const auto plan = read_part(*part, schema);
  part->refuse_unknown();
  return seen_from_above(places(plan), plan.centre);
}

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  TextReader stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    const auto begin = cell.find_first_not_of(" \t\"");
    const auto end = cell.find_last_not_of(" \t\"");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return cells;
}

// The head of a CSV of places: where name, x, y and z stand and the unit of each.
struct CsvHead {
  int name = -1;
  int axis[3] = {-1, -1, -1};
  double factor[3] = {1.0, 1.0, 1.0};
  std::size_t columns = 0;
};

CsvHead head_of(const std::vector<std::string>& cells, const std::string& file) {
  CsvHead head;
  head.columns = cells.size();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == "name") {
      head.name = static_cast<int>(i);
      continue;
    }
    const std::size_t axis = cells[i].size() > 2 && cells[i][1] == '_'
                                 ? std::string_view("xyz").find(cells[i][0])
                                 : std::string_view::npos;
    require(axis != std::string_view::npos, file + ":1: a column \"" + cells[i] +
                                                "\"; expected name, x_mm, y_mm or z_mm, or with "
                                                "another unit of length");
    require(head.axis[axis] < 0, file + ":1: two columns of " + cells[i].substr(0, 1));
    head.axis[axis] = static_cast<int>(i);
    head.factor[axis] = unit_factor(cells[i].substr(2), "m");
  }
  require(head.axis[0] >= 0 && head.axis[1] >= 0,
          file + ":1: no columns for x and y; expected a first line such as name,x_mm,y_mm");
  return head;
}

double number_of(const std::string& cell, const std::string& place) {
  double value = 0.0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  require(fault == std::errc() && end == cell.data() + cell.size() && std::isfinite(value),
          place + ": \"" + cell + "\" is no number; expected one such as 12.5");
  return value;
}

std::vector<ArrayPlace> places_of_csv(const std::filesystem::path& file) {
  TextReader lines(read_whole(file, kLargestCsv));
  std::vector<ArrayPlace> all;
  std::optional<CsvHead> head;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
    const auto cells = cells_of(line);
    if (!head) {
      head = head_of(cells, file.string());
      continue;
    }
    const auto where = fmt::format("{}:{}", file.string(), number);
    require(cells.size() == head->columns,
            fmt::format("{}: {} values; expected {}", where, cells.size(), head->columns));
    ArrayPlace place;
    for (int axis = 0; axis < 3; ++axis) {
      if (head->axis[axis] < 0) continue;
      place.point(axis) =
          head->factor[axis] * number_of(cells[static_cast<std::size_t>(head->axis[axis])], where);
    }
    place.from_above = head->axis[2] < 0;
    if (head->name >= 0) place.name = cells[static_cast<std::size_t>(head->name)];
    all.push_back(place);
  }
  require(!all.empty(), file.string() + ": no places; expected a line per place below the names");
  return all;
}

// Heights are those of the array: at = { ring = ..., z = "-12 mm" }.
void put_height(TableReader& table, std::vector<ArrayPlace>& all) {
  const auto z = table.quantity("z", "m");
  if (!z) return;
  for (auto& place : all) {
    place.point.z() = *z;
    place.from_above = false;
  }
}

std::vector<ArrayPlace> own_place(TableReader& table) {
  const auto place = read_place(table, "at");
  return {{.point = place.point, .from_above = place.from_above, .name = {}, .outward = {0, 0}}};
}

std::string length_text(double metres) {
  return fmt::format("{} m", std::round(metres * 1e12) / 1e12 + 0.0);
}

}  // namespace

std::vector<Vector2d> places(const RingPlan& plan) {
  std::vector<Vector2d> all;
  for (int i = 0; i < plan.count; ++i) {
    all.push_back(plan.centre +
                  plan.radius * along(plan.start + 2.0 * std::numbers::pi * i / plan.count));
  }
  return all;
}

std::vector<Vector2d> places(const HexagonPlan& plan) {
  std::vector<Vector2d> all{plan.centre};
  constexpr double sixth = std::numbers::pi / 3.0;
  for (int ring = 1; ring <= plan.rings; ++ring) {
    for (int side = 0; side < 6; ++side) {
      const Vector2d from = ring * plan.pitch * along(plan.start + sixth * side);
      const Vector2d step = plan.pitch * along(plan.start + sixth * (side + 2));
      for (int i = 0; i < ring; ++i) all.push_back(plan.centre + from + i * step);
    }
  }
  return all;
}

std::vector<Vector2d> places(const GridPlan& plan) {
  std::vector<Vector2d> all;
  for (int row = 0; row < plan.rows; ++row) {
    for (int column = 0; column < plan.columns; ++column) {
      const Vector2d steps(column - 0.5 * (plan.columns - 1), row - 0.5 * (plan.rows - 1));
      all.push_back(plan.centre + steps.cwiseProduct(plan.pitch));
    }
  }
  return all;
}

bool is_array_of_devices(const TomlNode& element) {
  const auto* at = element.kind == NodeKind::table ? member(element, "at") : nullptr;
  return at != nullptr && at->kind == NodeKind::table;
}

bool is_removed(const TomlNode& element) {
  const auto* removed = element.kind == NodeKind::table ? member(element, "removed") : nullptr;
  return removed != nullptr && removed->kind == NodeKind::truth && removed->truth;
}

std::string element_name(const TomlNode& element) {
  const auto* name = element.kind == NodeKind::table ? member(element, "name") : nullptr;
  return name != nullptr && name->kind == NodeKind::text ? name->text : std::string();
}

std::vector<ArrayPlace> array_places(
    const TomlNode& element, const std::string& key,
    const std::function<std::filesystem::path(const std::string&)>& resolved, Problems& problems,
    std::vector<std::filesystem::path>& files) {
  TableReader outer(element, key, problems);
  if (!is_array_of_devices(element)) return own_place(outer);
  const auto& at = *member(element, "at");
  TableReader table(at, outer.name("at"), problems);
  std::vector<std::string> given;
  for (const auto* form : kForms) {
    if (table.has(form)) given.emplace_back(form);
  }
  if (given.size() != 1) {
    problems.add(at.line, at.column,
                 outer.name("at") +
                     " is a table; expected one of ring, grid, hexagon, csv in it, "
                     "such as { ring = { count = 12, radius = \"85 mm\" } }");
    return {};
  }
  std::vector<ArrayPlace> all;
  if (given.front() == "ring") all = places_of(table, "ring", ring_schema());
  if (given.front() == "grid") all = places_of(table, "grid", grid_schema());
  if (given.front() == "hexagon") all = places_of(table, "hexagon", hexagon_schema());
  if (given.front() == "csv") {
    try {
      files.push_back(resolved(table.required_text("csv")));
      all = places_of_csv(files.back());
    } catch (const InvalidInput& e) {
      problems.add(at.line, at.column, table.name("csv") + ": " + e.what());
    }
  }
  put_height(table, all);
  table.refuse_unknown();
  // Their numbers are problems already.
  std::erase_if(all, [](const ArrayPlace& place) { return !place.point.allFinite(); });
  return all;
}

TomlNode text_node(const std::string& text, const TomlNode& like) {
  auto node = node_at(like, NodeKind::text);
  node.text = text;
  return node;
}

TomlNode place_node(const Eigen::Vector3d& point, bool from_above, const TomlNode& like) {
  TomlNode node = text_node("", like);
  node.kind = NodeKind::array;
  for (int axis = 0; axis < (from_above ? 2 : 3); ++axis) {
    node.elements.push_back(text_node(length_text(point(axis)), like));
  }
  return node;
}

}  // namespace chladni::study
