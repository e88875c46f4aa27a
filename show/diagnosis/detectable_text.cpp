#include "show/diagnosis/detectable_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "show/readable.h"

namespace chladni::show {
namespace {

using diagnosis::Detectable;

// Worst, median and best of one effect.
struct Range {
  const Detectable *worst = nullptr, *median = nullptr, *best = nullptr;
};

std::vector<Range> ranges(const std::vector<Detectable>& all) {
  std::vector<Range> each;
  for (const auto& one : all) {
    if (each.empty() || each.back().worst->effect != one.effect) each.push_back({&one, &one, &one});
    if (one.of == "median") each.back().median = &one;
    if (one.of == "best") each.back().best = &one;
  }
  return each;
}

bool has_size(const Range& one) { return !one.worst->parameter.empty(); }

std::string size_text(const Detectable& one) {
  if (!std::isfinite(one.size)) return "never";
  const auto [scale, unit] = readable(one.parameter, one.unit, one.size);
  return two_digits(scale * one.size) + (unit.empty() ? "" : " ") + unit;
}

std::string where_text(const Detectable& one) {
  std::string text =
      fmt::format("{}{}{}", fmt::join(one.channels, ", "),
                  one.channels.empty() || one.option.empty() ? "" : ": ", one.option);
  if (one.place) {
    text = fmt::format("({:.0f}, {:.0f}) mm", 1e3 * one.place->x(), 1e3 * one.place->y());
  }
  if (!one.frequency_hz) return text;
  return fmt::format("{}{}{:.0f} Hz", text, text.empty() ? "" : ", ", *one.frequency_hz);
}

// Effects without numbers that could be present without being found.
std::string unseen(const std::vector<Range>& each, double enough) {
  std::string text;
  for (const auto& one : each) {
    if (has_size(one) || one.worst->log_evidence >= enough) continue;
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", one.worst->effect,
                        where_text(*one.worst));
  }
  return text;
}

}  // namespace

std::string detectable_sentence(const std::vector<Detectable>& all, double least_evidence) {
  constexpr std::array<std::string_view, 6> kAsked{"point_mass",      "ground_spring",
                                                   "local_stiffness", "sensor_gain",
                                                   "sensor_position", "youngs_modulus"};
  const auto each = ranges(all);
  std::string text;
  for (const auto asked : kAsked) {
    const auto one = std::ranges::find_if(
        each, [&](const Range& range) { return range.worst->effect == asked; });
    if (one == each.end() || !std::isfinite(one->worst->size)) continue;
    const auto best = size_text(*one->best);
    const auto worst = size_text(*one->worst);
    text += fmt::format("{}{} of {}", text.empty() ? "" : ", ", asked,
                        best == worst ? worst : best + " to " + worst);
  }
  if (text.empty()) return "";
  text = "This experiment finds, 99 times in 100: " + text + ".";
  const auto missed = unseen(each, least_evidence);
  return missed.empty() ? text : text + " It may miss: " + missed + ".";
}

std::string detectable_sentence(const steps::Diagnosed& one) {
  return steps::is_of_modes(one) ? "" : detectable_sentence(one.detectable, one.least_evidence);
}

std::string detectable_table(const std::vector<Detectable>& all, double least_evidence) {
  std::string text = detectable_sentence(all, least_evidence);
  if (text.empty()) return text;
  text += "\n  smallest sizes                      best         median       worst\n";
  for (const auto& one : ranges(all)) {
    if (!has_size(one)) continue;
    text += fmt::format("  {:<20} {:<14} {:<12} {:<12} {}{}\n", one.worst->effect,
                        one.worst->parameter, size_text(*one.best), size_text(*one.median),
                        size_text(*one.worst), one.worst->from_above ? " and below" : "");
  }
  return text;
}

io::Table detectable_sizes(const std::vector<Detectable>& all) {
  io::Table table{
      "Smallest sizes that this experiment finds, 99 times in 100",
      {{"effect", false}, {"size", false}, {"best"}, {"median"}, {"worst"}, {"worst at", false}},
      {}};
  for (const auto& one : ranges(all)) {
    if (!has_size(one)) continue;
    table.rows.push_back(
        {{one.worst->effect, one.worst->parameter, size_text(*one.best), size_text(*one.median),
          size_text(*one.worst) + (one.worst->from_above ? " and below" : ""),
          where_text(*one.worst)}});
  }
  return table;
}

io::JsonArray detectable_json(const std::vector<Detectable>& all) {
  io::JsonArray array;
  for (const auto& one : all) {
    io::JsonObject json{{"effect", one.effect},
                        {"of", std::string(one.of)},
                        {"channels", io::Json::texts(one.channels)},
                        {"log_evidence", one.log_evidence}};
    if (!one.option.empty()) json.emplace_back("option", one.option);
    if (!one.parameter.empty()) {
      json.emplace_back("parameter", one.parameter);
      json.emplace_back("size", one.size);
      json.emplace_back("unit", one.unit);
      json.emplace_back("found", one.from_above ? "below" : "above");
    }
    if (one.place) json.emplace_back("place_m", io::Json(Eigen::VectorXd(*one.place)));
    if (one.frequency_hz) json.emplace_back("frequency_hz", *one.frequency_hz);
    array.emplace_back(std::move(json));
  }
  return array;
}

}  // namespace chladni::show
