// Causes that attach something to the body or hold it.
#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

using Members = std::vector<std::pair<std::string, std::string>>;

std::string quantity(double value, std::string_view unit) {
  return study::toml_text(digits(value) + " " + std::string(unit));
}

std::string vector(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", digits(v(0)), digits(v(1)), digits(v(2)));
}

std::string normal(const Extension& by) {
  if (looks_down(by)) return study::toml_text("z");
  return vector(by.chart.axis_u.cross(by.chart.axis_v));
}

std::string unused_name(const study::Study& study, const std::string& wanted) {
  const auto taken = [&](const std::string& name) {
    return std::any_of(study.attachments.begin(), study.attachments.end(),
                       [&](const auto& one) { return one.name == name; });
  };
  std::string name = wanted;
  for (int n = 2; taken(name); ++n) name = fmt::format("{}_{}", wanted, n);
  return name;
}

void append_at(const Extension& by, const std::string& at, const std::string& kind,
               const std::string& name, const Members& more) {
  Members members{{"kind", study::toml_text(kind)},
                  {"name", study::toml_text(unused_name(by.study, "diagnosed_" + name))},
                  {"at", at}};
  members.insert(members.end(), more.begin(), more.end());
  by.edit.append("attachment", members, by.comment());
}

void append(const Extension& by, const std::string& kind, const Members& more) {
  append_at(by, place(by), kind, kind, more);
}

std::string no_negative_mass() {
  return "an attachment has no negative mass; less material is a matter of geometry";
}

std::string point_mass(const Extension& by) {
  if (!(by.number("mass") > 0.0)) return no_negative_mass();
  append(by, "mass", {{"mass", quantity(by.number("mass"), "kg")}});
  return {};
}

std::string mass_with_inertia(const Extension& by) {
  if (!(by.number("mass") > 0.0)) return no_negative_mass();
  const double radius = by.number("radius_of_gyration");
  const double inertia = by.number("mass") * radius * radius;
  const Eigen::Vector3d about = inertia * (by.chart.axis_u.cwiseAbs() + by.chart.axis_v.cwiseAbs());
  std::string three;
  for (int k = 0; k < 3; ++k) three += (k > 0 ? ", " : "") + quantity(about(k), "kg m^2");
  append(by, "mass", {{"mass", quantity(by.number("mass"), "kg")}, {"inertia", "[" + three + "]"}});
  return {};
}

std::string carried(const Extension& by, const std::vector<study::Channel>& channels) {
  if (!(by.number("mass") > 0.0)) return no_negative_mass();
  for (const auto& channel : channels) {
    append_at(by, place(channel.at), "mass", "mass_of_" + channel.name,
              {{"mass", quantity(by.number("mass"), "kg")}});
  }
  return {};
}
std::string sensor_masses(const Extension& by) { return carried(by, by.study.sensors); }
std::string actuator_masses(const Extension& by) { return carried(by, by.study.actuators); }

std::string ground_spring(const Extension& by) {
  append(by, "spring",
         {{"direction", normal(by)}, {"stiffness", quantity(by.number("stiffness"), "N/m")}});
  return {};
}

std::string ground_damper(const Extension& by) {
  append(by, "damper",
         {{"direction", normal(by)}, {"damping", quantity(by.number("damping"), "N s/m")}});
  return {};
}

// The study's damping ratio applies to all modes, so it already damps the resonator. Its dashpot
// gets the difference.
std::string resonator(const Extension& by) {
  const double ratio = by.number("damping_ratio") - by.study.modes.damping_ratio;
  append(by, "resonator",
         {{"direction", normal(by)},
          {"mass", quantity(by.number("mass"), "kg")},
          {"frequency", quantity(by.number("frequency"), "Hz")},
          {"damping_ratio", digits(std::max(ratio, 0.0))}});
  if (ratio < 0.0) {
    by.edit.append_comment(fmt::format(
        "Its damping, {:.2g}, is below the {:.2g} that the study gives every mode: taken as that.",
        by.number("damping_ratio"), by.study.modes.damping_ratio));
  }
  return {};
}

std::string suspension(const Extension& /*by*/) {
  return "no key holds a body as a whole: say the springs where they are, or take the control loop "
         "out of the records";
}

constexpr std::array<std::pair<std::string_view, Extend>, 8> kTable{
    {{"point_mass", point_mass},
     {"mass_with_inertia", mass_with_inertia},
     {"sensor_masses", sensor_masses},
     {"actuator_masses", actuator_masses},
     {"ground_spring", ground_spring},
     {"ground_damper", ground_damper},
     {"suspension", suspension},
     {"resonator", resonator}}};

}  // namespace

Extend extend_attachments(std::string_view effect) {
  for (const auto& [name, how] : kTable) {
    if (name == effect) return how;
  }
  return nullptr;
}

}  // namespace chladni::steps
