// Causes that attach something to the body, with keys that are computed.
#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "steps/extend/extended_tables.h"
#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

std::string unused_name(const study::Study& study, const std::string& wanted) {
  const auto taken = [&](const std::string& name) {
    return std::any_of(study.attachments.begin(), study.attachments.end(),
                       [&](const auto& one) { return one.name == name; });
  };
  std::string name = wanted;
  for (int n = 2; taken(name); ++n) name = fmt::format("{}_{}", wanted, n);
  return name;
}

void append(const Extension& by, const std::string& kind, const Members& more) {
  append_attachment(by, place(by), kind, kind, more);
}

std::string mass_with_inertia(const Extension& by) {
  if (!(by.number("mass") > 0.0)) return kNoNegativeMass;
  const double radius = by.number("radius_of_gyration");
  const double inertia = by.number("mass") * radius * radius;
  const Eigen::Vector3d about = inertia * (by.chart.axis_u.cwiseAbs() + by.chart.axis_v.cwiseAbs());
  std::string three;
  for (int k = 0; k < 3; ++k) three += (k > 0 ? ", " : "") + written(about(k), "kg m^2");
  append(by, "mass", {{"mass", written(by.number("mass"), "kg")}, {"inertia", "[" + three + "]"}});
  return {};
}

// The study's damping ratio applies to all modes, so it already damps the resonator. Its dashpot
// gets the difference.
std::string resonator(const Extension& by) {
  const double ratio = by.number("damping_ratio") - by.study.modes.damping_ratio;
  append(by, "resonator",
         {{"direction", normal(by)},
          {"mass", written(by.number("mass"), "kg")},
          {"frequency", written(by.number("frequency"), "Hz")},
          {"damping_ratio", digits(std::max(ratio, 0.0))}});
  if (ratio < 0.0) {
    by.edit.append_comment(fmt::format(
        "Its damping, {:.2g}, is below the {:.2g} that the study gives every mode: taken as that.",
        by.number("damping_ratio"), by.study.modes.damping_ratio));
  }
  return {};
}

constexpr std::array<std::pair<std::string_view, Extend>, 2> kAttachmentEntries{
    {{"mass_with_inertia", mass_with_inertia}, {"resonator", resonator}}};

}  // namespace

std::string written(double value, std::string_view unit) {
  if (unit.empty()) return digits(value);
  if (unit == "m") return study::toml_text(digits(1e3 * value) + " mm");
  if (unit == "s") return study::toml_text(digits(1e6 * value) + " us");
  return study::toml_text(digits(value) + " " + std::string(unit));
}

std::string direction_text(const Eigen::Vector3d& direction) {
  const auto shown = [](double x) { return digits(std::abs(x) < 1e-12 ? 0.0 : x); };
  return fmt::format("[{}, {}, {}]", shown(direction(0)), shown(direction(1)), shown(direction(2)));
}

std::string normal(const Extension& by) {
  if (looks_down(by)) return study::toml_text("z");
  return direction_text(by.chart.axis_u.cross(by.chart.axis_v));
}

void append_attachment(const Extension& by, const std::string& at, const std::string& kind,
                       const std::string& name, const Members& more) {
  Members members{{"kind", study::toml_text(kind)},
                  {"name", study::toml_text(unused_name(by.study, "diagnosed_" + name))},
                  {"at", at}};
  members.insert(members.end(), more.begin(), more.end());
  by.edit.append("attachment", members, by.comment());
}

Extend extend_attachments(std::string_view effect) {
  for (const auto& [name, how] : kAttachmentEntries) {
    if (name == effect) return how;
  }
  return nullptr;
}

}  // namespace chladni::steps
