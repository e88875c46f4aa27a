#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

#include "show/readable.h"
#include "show/rigid_body.h"

namespace chladni::show {
namespace {

constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};

// "12.3 +- 0.4", or "-" for what is not told.
std::string with_deviation(double value, double deviation) {
  if (std::isnan(value)) return "-";
  if (deviation <= 0.0) return fmt::format("{:.4g}", value);
  return fmt::format("{:.4g} +- {}", value, deviation_text(deviation));
}

std::string properties_text(const identification::RigidProperties& body) {
  std::string text = fmt::format("{} kg, centre", with_deviation(body.mass, body.mass_std));
  for (Eigen::Index a = 0; a < 3; ++a) {
    text += fmt::format("{} {} {}", a > 0 ? "," : "", kAxisNames[static_cast<std::size_t>(a)],
                        with_deviation(1e3 * body.centre(a), 1e3 * body.centre_std(a)));
  }
  text += " mm\n  inertia about it";
  const char* comma = "";
  for (Eigen::Index a = 0; a < 3; ++a) {
    for (Eigen::Index b = a; b < 3; ++b) {
      if (std::isnan(body.inertia(a, b))) continue;
      text += fmt::format("{} {}{} {}", comma, kAxisNames[static_cast<std::size_t>(a)],
                          kAxisNames[static_cast<std::size_t>(b)],
                          with_deviation(body.inertia(a, b), body.inertia_std(a, b)));
      comma = ",";
    }
  }
  text += *comma == '\0' ? " not told\n" : " kg m^2\n";
  if (body.not_told.empty()) return text;
  return text + fmt::format("  not told by channels there: {}\n", fmt::join(body.not_told, ", "));
}

std::vector<std::string> motion_names(const std::vector<Eigen::Index>& motions) {
  std::vector<std::string> names;
  for (const auto k : motions) {
    names.emplace_back(identification::kRigidMotions[static_cast<std::size_t>(k)]);
  }
  return names;
}

io::Json decoupling_json(const identification::Decoupling& decoupling,
                         const std::vector<std::string>& channels, bool actuators) {
  return io::JsonObject{{"channels", io::Json::texts(channels)},
                        {"motions", io::Json::texts(motion_names(decoupling.told))},
                        {"matrix", io::Json::rows(decoupling.matrix)},
                        {"condition", decoupling.condition},
                        {"rank", static_cast<long long>(decoupling.rank)},
                        {"mixed", io::Json::texts(motion_names(decoupling.mixed))},
                        {"unseen", io::Json::texts(motion_names(decoupling.unseen))},
                        {"told", identification::decoupling_text(decoupling, actuators)}};
}

io::MatValue structure_of(io::MatFields fields) {
  io::MatValue value;
  value.kind = io::MatValue::Kind::structure;
  value.dims = {1, 1};
  value.fields = std::move(fields);
  return value;
}

io::MatValue decoupling_mat(const identification::Decoupling& decoupling,
                            const std::vector<std::string>& channels) {
  return structure_of({{"channels", channels},
                       {"motions", motion_names(decoupling.told)},
                       {"matrix", decoupling.matrix},
                       {"condition", decoupling.condition}});
}

}  // namespace

std::string rigid_body_text(const steps::RigidBodyOfChannels& found) {
  std::string text = "\n";
  if (found.properties) {
    text += fmt::format("rigid body, {} modes{}: ", found.modes,
                        found.suspended.empty() ? " at 0 Hz" : " of its suspension") +
            properties_text(*found.properties);
    if (found.up_to_a_factor) {
      text += "  mass and inertia up to a factor: the file states no unit of its sensors\n";
    }
  }
  return text + "  " + identification::decoupling_text(found.sensors, false) + "\n  " +
         identification::decoupling_text(found.actuators, true) + "\n";
}

io::Json rigid_body_json(const steps::RigidBodyOfChannels& found) {
  io::JsonArray suspended;
  for (const auto m : found.suspended) suspended.emplace_back(static_cast<long long>(m + 1));
  io::JsonObject json{{"modes", static_cast<long long>(found.modes)},
                      {"suspended_modes", suspended},
                      {"about_m", io::Json(found.about)},
                      {"sensors", decoupling_json(found.sensors, found.sensor_names, false)},
                      {"actuators", decoupling_json(found.actuators, found.actuator_names, true)},
                      {"up_to_a_factor", found.up_to_a_factor},
                      {"notes", io::Json::texts(found.notes)}};
  if (!found.properties) return json;
  const auto& body = *found.properties;
  json.emplace_back("mass_kg", body.mass);
  json.emplace_back("mass_std_kg", body.mass_std);
  json.emplace_back("centre_of_mass_m", io::Json(body.centre));
  json.emplace_back("centre_of_mass_std_m", io::Json(body.centre_std));
  json.emplace_back("inertia_kg_m2", io::Json::rows(body.inertia));
  json.emplace_back("inertia_std_kg_m2", io::Json::rows(body.inertia_std));
  json.emplace_back("not_told", io::Json::texts(body.not_told));
  return json;
}

io::MatValue rigid_body_mat(const steps::RigidBodyOfChannels& found) {
  io::MatFields fields{{"about_m", Eigen::MatrixXd(found.about)},
                       {"sensors", decoupling_mat(found.sensors, found.sensor_names)},
                       {"actuators", decoupling_mat(found.actuators, found.actuator_names)}};
  if (found.properties) {
    const auto& body = *found.properties;
    fields.emplace_back("up_to_a_factor", found.up_to_a_factor ? 1.0 : 0.0);
    fields.emplace_back("mass_kg", body.mass);
    fields.emplace_back("mass_std_kg", body.mass_std);
    fields.emplace_back("centre_of_mass_m", Eigen::MatrixXd(body.centre));
    fields.emplace_back("centre_of_mass_std_m", Eigen::MatrixXd(body.centre_std));
    fields.emplace_back("inertia_kg_m2", Eigen::MatrixXd(body.inertia));
    fields.emplace_back("inertia_std_kg_m2", Eigen::MatrixXd(body.inertia_std));
  }
  return structure_of(std::move(fields));
}

}  // namespace chladni::show
