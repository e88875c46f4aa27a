// What is shown and left of a sweep.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/plot.h"
#include "io/result_table.h"
#include "io/scan.h"
#include "show/version.h"
#include "sweep/gathered.h"

namespace chladni::sweep {
namespace {

using Better = study::SweepResult::Better;

constexpr std::size_t kMostShown = 12;  // rows of the front on a terminal
constexpr std::size_t kMostPanels = 24;
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

std::string head_of(const study::SweepResult& result) {
  return result.unit.empty() ? result.name : result.name + " [" + result.unit + "]";
}

std::string quoted_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

io::ResultTable table_of(const Sweep& sweep, const std::vector<const GatheredRow*>& rows) {
  io::ResultTable table;
  std::vector<std::string> numbers;
  for (const auto* row : rows) numbers.push_back(fmt::to_string(row->entry.index + 1));
  table.columns.push_back(io::word_column("variant", numbers, 7));
  for (std::size_t a = 0; a < sweep.plan().axes.size(); ++a) {
    std::vector<std::string> labels;
    std::size_t width = sweep.plan().axes[a].name.size();
    for (const auto* row : rows) {
      labels.push_back(row->entry.labels[a]);
      width = std::max(width, labels.back().size());
    }
    table.columns.push_back(
        io::word_column(sweep.plan().axes[a].name, labels, static_cast<int>(width)));
  }
  for (std::size_t r = 0; r < sweep.plan().results.size(); ++r) {
    Eigen::VectorXd values(std::ssize(rows));
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      values(i) = rows[static_cast<std::size_t>(i)]->results(static_cast<Eigen::Index>(r));
    }
    const auto head = head_of(sweep.plan().results[r]);
    table.columns.push_back(
        io::number_column(head, "", values, {.format = "{:.5g}"},
                          static_cast<int>(std::max<std::size_t>(10, head.size()))));
  }
  return table;
}

// The variant in which a result is best; null if there is none.
const GatheredRow* best_of(const Gathered& gathered, Eigen::Index r, Better better) {
  const GatheredRow* best = nullptr;
  for (const auto& row : gathered.rows) {
    const double value = row.results(r);
    if (!std::isfinite(value)) continue;
    const bool wins = best == nullptr || (better == Better::more ? value > best->results(r)
                                                                 : value < best->results(r));
    if (wins) best = &row;
  }
  return best;
}

// Results that no variant has, though some are done: their place is wrong.
std::string missing_text(const Sweep& sweep, const Gathered& gathered) {
  std::string out;
  for (std::size_t r = 0; r < sweep.plan().results.size() && gathered.done > 0; ++r) {
    const auto& result = sweep.plan().results[r];
    const bool is_there = std::ranges::any_of(gathered.rows, [&](const auto& row) {
      return std::isfinite(row.results(static_cast<Eigen::Index>(r)));
    });
    if (is_there) continue;
    out += fmt::format("warning: {} has no number at \"{}\" in any variant, so there is no {}\n",
                       result.file, result.at, result.name);
  }
  return out;
}

std::vector<const GatheredRow*> front_of(const Gathered& gathered) {
  std::vector<const GatheredRow*> front;
  for (const auto& row : gathered.rows) {
    if (row.on_front) front.push_back(&row);
  }
  return front;
}

struct NumberInUnit {
  double value = 0.0;
  std::string unit;
};

// "20 mm" and "20mm" are 20 of mm.
std::optional<NumberInUnit> leading_number(const std::string& label) {
  NumberInUnit number;
  const char* stop = label.data() + label.size();
  const auto [end, fault] = std::from_chars(label.data(), stop, number.value);
  if (fault != std::errc() || end == label.data()) return std::nullopt;
  number.unit = io::trimmed({end, stop});
  return number;
}

// The numbers of an axis, and its unit; empty if not all points are numbers of one unit.
Eigen::VectorXd numbers_of(const Gathered& gathered, std::size_t axis, std::string& unit) {
  Eigen::VectorXd x(std::ssize(gathered.rows));
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto& label = gathered.rows[static_cast<std::size_t>(i)].entry.labels[axis];
    const auto number = leading_number(label);
    if (!number) return {};
    if (i > 0 && number->unit != unit) return {};
    unit = number->unit;
    x(i) = number->value;
  }
  return x;
}

Eigen::VectorXd column(const Gathered& gathered, Eigen::Index r) {
  Eigen::VectorXd y(std::ssize(gathered.rows));
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    y(i) = gathered.rows[static_cast<std::size_t>(i)].results(r);
  }
  return y;
}

// The range of an axis with some room at both ends.
io::PlotAxis axis_of(const std::string& label, const Eigen::VectorXd& values) {
  io::PlotAxis axis{.label = label, .logarithmic = false, .low = 0.0, .high = 0.0};
  bool first = true;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    axis.low = first ? value : std::min(axis.low, value);
    axis.high = first ? value : std::max(axis.high, value);
    first = false;
  }
  const double room = std::max(0.05 * (axis.high - axis.low), 1e-6 * std::abs(axis.high));
  axis.low -= room;
  axis.high += room;
  return axis;
}

io::PlotPanel panel_of(const Gathered& gathered, const std::string& over, const Eigen::VectorXd& x,
                       const std::string& name, const Eigen::VectorXd& y) {
  using Style = io::PlotSeries::Style;
  io::PlotPanel panel{.title = {}, .x = axis_of(over, x), .y = {}, .series = {}, .verticals = {}};
  panel.y.label = name;
  panel.series.push_back({"variants", x, y, {}, Style::dots, 1, 5.0});
  Eigen::VectorXd front = y;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (!gathered.rows[static_cast<std::size_t>(i)].on_front) front(i) = kNoValue;
  }
  if (front.array().isFinite().any()) {
    panel.series.push_back({"beaten by none", x, front, {}, Style::circles, 2, 9.0});
  }
  return panel;
}

// Each result, a row, over each axis of numbers, a column.
io::Plot responses(const Sweep& sweep, const Gathered& gathered) {
  const auto& plan = sweep.plan();
  io::Plot plot;
  plot.title = plan.title;
  std::vector<std::pair<std::string, Eigen::VectorXd>> axes;
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    std::string unit;
    const auto x = numbers_of(gathered, a, unit);
    const auto bracket = unit.empty() ? "" : " [" + unit + "]";
    if (x.size() > 0) axes.emplace_back(plan.axes[a].name + bracket, x);
  }
  plot.columns = static_cast<int>(axes.size());
  for (std::size_t r = 0; r < plan.results.size(); ++r) {
    if (plot.panels.size() + axes.size() > kMostPanels) break;
    const auto y = column(gathered, static_cast<Eigen::Index>(r));
    for (const auto& [over, x] : axes) {
      plot.panels.push_back(panel_of(gathered, over, x, head_of(plan.results[r]), y));
    }
  }
  return plot;
}

// The second result that is compared over the first one.
io::Plot front_picture(const Sweep& sweep, const Gathered& gathered) {
  const auto& plan = sweep.plan();
  std::vector<std::size_t> compared;
  for (std::size_t r = 0; r < plan.results.size(); ++r) {
    if (plan.results[r].better != Better::none) compared.push_back(r);
  }
  io::Plot plot;
  plot.title = plan.title;
  if (compared.size() < 2) return plot;
  const auto of = [&](std::size_t k) {
    return column(gathered, static_cast<Eigen::Index>(compared[k]));
  };
  plot.panels.push_back(panel_of(gathered, head_of(plan.results[compared[0]]), of(0),
                                 head_of(plan.results[compared[1]]), of(1)));
  return plot;
}

io::JsonObject json_of_entry(const Sweep& sweep, const Entry& entry) {
  io::JsonObject axes;
  for (std::size_t a = 0; a < sweep.plan().axes.size(); ++a) {
    axes.emplace_back(sweep.plan().axes[a].name, entry.labels[a]);
  }
  return {{"variant", entry.index + 1},
          {"state", state(entry.record)},
          {"axes", std::move(axes)},
          {"folder", "variants/" + entry.hash},
          {"error", entry.record ? io::Json(entry.record->error) : io::Json()},
          {"seconds", json_of_seconds(entry.record)}};
}

}  // namespace

std::string text(const Sweep& sweep, const Gathered& gathered) {
  const auto& plan = sweep.plan();
  std::string out =
      fmt::format("{}\n{} variants: {} done, {} failed, {} open\n", plan.title,
                  gathered.rows.size(), gathered.done, gathered.failed, gathered.open);
  out += missing_text(sweep, gathered);
  for (std::size_t r = 0; r < plan.results.size(); ++r) {
    const auto& result = plan.results[r];
    if (result.better == Better::none) continue;
    const auto* best = best_of(gathered, static_cast<Eigen::Index>(r), result.better);
    if (best == nullptr) continue;
    out += fmt::format("{} {}: {:.5g}{} in variant {} ({})\n",
                       result.better == Better::more ? "most" : "least", result.name,
                       best->results(static_cast<Eigen::Index>(r)),
                       result.unit.empty() ? "" : " " + result.unit, best->entry.index + 1,
                       fmt::join(best->entry.labels, ", "));
  }
  auto front = front_of(gathered);
  if (!front.empty()) {
    out += fmt::format("\n{} variants that no other beats in everything:\n", front.size());
    const auto left = front.size() - std::min(front.size(), kMostShown);
    front.resize(front.size() - left);
    out += io::text(table_of(sweep, front));
    if (left > 0) out += fmt::format("and {} more in table.csv\n", left);
  }
  for (const auto& row : gathered.rows) {
    if (!row.entry.record || row.entry.record->exit == 0) continue;
    out += fmt::format("\nfailed, first of {}: variant {} ({}): {}\n", gathered.failed,
                       row.entry.index + 1, fmt::join(row.entry.labels, ", "),
                       row.entry.record->error);
    break;
  }
  return out;
}

io::Json json(const Sweep& sweep, const std::vector<long long>& which) {
  io::JsonArray variants;
  for (const auto index : which) variants.emplace_back(json_of_entry(sweep, sweep.entry(index)));
  return io::JsonObject{{"chladni", show::version()},
                        {"title", sweep.plan().title},
                        {"verb", sweep.plan().verb},
                        {"variants", std::move(variants)}};
}

io::Json json(const Sweep& sweep, const Gathered& gathered) {
  const auto& plan = sweep.plan();
  io::JsonArray variants;
  for (const auto& row : gathered.rows) {
    io::JsonObject results;
    for (std::size_t r = 0; r < plan.results.size(); ++r) {
      results.emplace_back(plan.results[r].name, row.results(static_cast<Eigen::Index>(r)));
    }
    auto variant = json_of_entry(sweep, row.entry);
    variant.emplace_back("results", std::move(results));
    variant.emplace_back("on_front", row.on_front);
    variants.emplace_back(std::move(variant));
  }
  return io::JsonObject{
      {"chladni", show::version()},     {"title", plan.title},       {"verb", plan.verb},
      {"done", gathered.done},          {"failed", gathered.failed}, {"open", gathered.open},
      {"variants", std::move(variants)}};
}

std::string csv(const Sweep& sweep, const Gathered& gathered) {
  const auto& plan = sweep.plan();
  std::string out = "variant,state";
  for (const auto& axis : plan.axes) out += "," + quoted_cell(axis.name);
  for (const auto& result : plan.results) out += "," + quoted_cell(head_of(result));
  out += ",on_front,folder\n";
  for (const auto& row : gathered.rows) {
    out += fmt::format("{},{}", row.entry.index + 1, state(row.entry.record));
    for (const auto& label : row.entry.labels) out += "," + quoted_cell(label);
    for (const double value : row.results) {
      out += std::isfinite(value) ? fmt::format(",{}", value) : std::string(",");
    }
    out += fmt::format(",{},variants/{}\n", row.on_front ? 1 : 0, row.entry.hash);
  }
  return out;
}

std::vector<std::string> leave(const Sweep& sweep, const Gathered& gathered,
                               const std::filesystem::path& folder, bool pictures) {
  std::filesystem::create_directories(folder);
  io::write_json(folder / "sweep.json", json(sweep, gathered));
  write_atomically(folder / "table.csv", csv(sweep, gathered));
  if (!pictures || gathered.done == 0) return {};
  std::vector<std::string> unpainted;
  const std::pair<const char*, io::Plot> all[] = {{"sweep.png", responses(sweep, gathered)},
                                                  {"front.png", front_picture(sweep, gathered)}};
  for (const auto& [name, plot] : all) {
    if (plot.panels.empty()) continue;
    try {
      io::draw_plot(folder / name, plot);
    } catch (const WorkerDied& fault) {
      std::error_code ignored;
      std::filesystem::remove(folder / name, ignored);  // that of an earlier gathering
      unpainted.push_back(fmt::format("{} is not painted: {}", name, fault.what()));
    }
  }
  return unpainted;
}

}  // namespace chladni::sweep
