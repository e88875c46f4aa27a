// The keys of sensors, actuators and attachments.
#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

constexpr const char* kAxes = R"("x", "-z", ... or three numbers)";

template <typename Plan>
Key<Plan> name_of(const std::string& meaning) {
  return {.text = {"name", "a text", "needed", meaning},
          .json_name = "name",
          .read = [](TableReader& table, Plan& plan) { plan.name = table.required_text("name"); },
          .json = [](const Plan& plan) { return io::Json(plan.name); }};
}

template <typename Plan>
Key<Plan> place(const std::string& meaning) {
  return {.text = {"at", "two lengths (onto the top along z) or three (the nearest point)",
                   "needed", meaning},
          .json_name = "at_m",
          .read = [](TableReader& table, Plan& plan) { plan.at = read_place(table, "at"); },
          .json = [](const Plan& plan) { return place_json(plan.at); }};
}

/// A direction that must be given.
template <typename Plan>
Key<Plan> direction(const std::string& name, Eigen::Vector3d Plan::*value,
                    const std::string& meaning) {
  return {.text = {name, kAxes, "needed", meaning},
          .json_name = name,
          .read =
              [=](TableReader& table, Plan& plan) {
                if (!table.has(name)) {
                  table.missing(name, R"("x", "y", "z", "-x", "-y", "-z" or three numbers)");
                }
                plan.*value = table.direction(name).value_or(Eigen::Vector3d::UnitZ());
              },
          .json = [=](const Plan& plan) { return io::Json(plan.*value); }};
}

/// The key is left out of study.json where it has its default.
template <typename Plan>
Key<Plan> unless_default(Key<Plan> key, double Plan::*value) {
  key.json = [=](const Plan& plan) -> std::optional<io::Json> {
    if (plan.*value == Plan{}.*value) return std::nullopt;
    return plan.*value;
  };
  return key;
}

Key<Channel> node() {
  return {.text = {"node", "1 to 2147483647", "by name", "its number in a UFF file"},
          .json_name = "node",
          .read = [](TableReader& table,
                     Channel& channel) { channel.node = table.integer("node", 1, 2147483647); },
          .json = [](const Channel& channel) -> std::optional<io::Json> {
            if (!channel.node) return std::nullopt;
            return *channel.node;
          }};
}

Schema<Channel> channel_schema(const std::string& table, const std::vector<std::string>& quantities,
                               const std::string& what) {
  using P = Channel;
  return {
      table,
      {name_of<P>("differs from all others of its kind"), place<P>("its place on the body"),
       direction("direction", &P::direction, "along which it " + what),
       choice("quantity", quantities, &P::quantity, "what it " + what,
              quoted({quantities.front()})),
       node(),
       unless_default(quantity("gain", "1", Sign::positive, &P::gain,
                               "what it " + what + " over what it should"),
                      &P::gain),
       unless_default(quantity("delay", "s", Sign::any, &P::delay, "how late it is"), &P::delay),
       unless_default(quantity("low_pass", "Hz", Sign::positive, &P::low_pass_hz,
                               "corner of its filter or amplifier, of first order", "none"),
                      &P::low_pass_hz)}};
}

}  // namespace

const Schema<Channel>& sensor_schema() {
  static const auto schema =
      channel_schema("[sensor]", {"displacement", "velocity", "acceleration"}, "reads");
  return schema;
}

const Schema<Channel>& actuator_schema() {
  static const auto schema = channel_schema("[actuator]", {"force"}, "pushes");
  return schema;
}

}  // namespace chladni::study
