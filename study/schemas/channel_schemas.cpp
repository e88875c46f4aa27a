// The keys of sensors, actuators, layouts of them, and attachments.
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

template <typename Plan>
Key<Plan> damping(const std::string& si_unit) {
  return quantity("damping", si_unit, Sign::not_negative, &Plan::damping, "of its dashpot");
}

/// Names of channels. The reader of the table knows which there are.
Key<LayoutPlan> channels(const std::string& name, std::vector<std::string> LayoutPlan::*value) {
  return {.text = {name, "names of " + name + " of the study", "none", "that belong to it"},
          .json_name = name,
          .read = [=](TableReader& table, LayoutPlan& plan) { plan.*value = table.texts(name); },
          .json = [=](const LayoutPlan& plan) { return io::Json::texts(plan.*value); }};
}

/// Another way to say a number of the resonator; its reader computes it.
Key<fem::Resonator> instead(const std::string& name, const std::string& si_unit, Sign sign,
                            const std::string& meaning) {
  return special<fem::Resonator>({name, expected_quantity(si_unit, sign), "none", meaning}, name,
                                 not_shown<fem::Resonator>);
}

}  // namespace

const Schema<AttachmentPlan>& attachment_schema() {
  using P = AttachmentPlan;
  static const Schema<P> schema = {
      "[attachment]",
      {special<P>({"kind", quoted(attachment_kinds()), "needed", "says which other keys it has"},
                  "kind", [](const P& plan) { return io::Json(plan.kind); }),
       name_of<P>("differs from all other attachments'"), place<P>("its place on the body"),
       quantity("footprint", "m", Sign::not_negative, &P::footprint,
                "diameter over which it is spread evenly", "a point"),
       special<P>({"to", "as at", "none", "the other end of a link, which needs it"}, "to_m",
                  [](const P& plan) -> std::optional<io::Json> {
                    if (!plan.to) return std::nullopt;
                    return place_json(*plan.to);
                  })}};
  return schema;
}

const Schema<fem::PointMass>& mass_schema() {
  using P = fem::PointMass;
  static const Schema<P> schema = {
      "[attachment]",
      {needed("mass", "kg", &P::mass, "of the point"),
       {.text = {"inertia", "three quantities in kg m^2, not negative", "none",
                 "about x, y, z through its own centre"},
        .json_name = json_name("inertia", "kg m^2"),
        .read =
            [](TableReader& table, P& mass) {
              const auto inertia = table.quantities("inertia", "kg m^2", 3, Sign::not_negative);
              if (inertia) mass.inertia = inertia->asDiagonal();
            },
        .json = [](const P& mass) { return io::Json(mass.inertia.diagonal()); }}}};
  return schema;
}

const Schema<fem::GroundSpring>& spring_schema() {
  using P = fem::GroundSpring;
  static const Schema<P> schema = {
      "[attachment]",
      {direction("direction", &P::direction, "of the spring to the ground"),
       needed("stiffness", "N/m", &P::stiffness, "of the spring"), damping<P>("N s/m")}};
  return schema;
}

const Schema<fem::GroundSpring>& damper_schema() {
  using P = fem::GroundSpring;
  static const Schema<P> schema = {
      "[attachment]",
      {direction("direction", &P::direction, "of the dashpot to the ground"),
       needed("damping", "N s/m", &P::damping, "of the dashpot")}};
  return schema;
}

const Schema<fem::GroundTorsionSpring>& torsion_spring_schema() {
  using P = fem::GroundTorsionSpring;
  static const Schema<P> schema = {
      "[attachment]",
      {direction("axis", &P::axis, "of the rotation that the spring to the ground resists"),
       needed("stiffness", "N m/rad", &P::stiffness, "of the spring"), damping<P>("N m s/rad")}};
  return schema;
}

const Schema<fem::LinkSpring>& link_schema() {
  using P = fem::LinkSpring;
  static const Schema<P> schema = {
      "[attachment]",
      {{.text = {"direction", kAxes, "the line from at to to", "of the spring"},
        .json_name = "direction",
        .read =
            [](TableReader& table, P& link) {
              link.direction = table.direction("direction").value_or(Eigen::Vector3d::Zero());
            },
        .json = [](const P& link) { return io::Json(link.direction); }},
       needed("stiffness", "N/m", &P::stiffness, "of the spring"),
       damping<P>("N s/m")}};
  return schema;
}

const Schema<fem::Resonator>& resonator_schema() {
  using P = fem::Resonator;
  static const Schema<P> schema = {
      "[attachment]",
      {direction("direction", &P::direction, "of the motion of the mass"),
       needed("mass", "kg", &P::mass, "of the body on the spring"),
       quantity("stiffness", "N/m", Sign::positive, &P::stiffness, "of the spring",
                "from frequency"),
       instead("frequency", "Hz", Sign::positive,
               "of the mass on its spring, instead of stiffness"),
       quantity("damping", "N s/m", Sign::not_negative, &P::damping, "of its dashpot",
                "0, or from damping_ratio"),
       instead("damping_ratio", "1", Sign::not_negative, "instead of damping")}};
  return schema;
}

const Schema<Channel>& sensor_schema() {
  static const auto schema =
      channel_schema("[sensor]", {"displacement", "velocity", "acceleration"}, "reads");
  return schema;
}

const Schema<Channel>& actuator_schema() {
  static const auto schema = channel_schema("[actuator]", {"force"}, "pushes");
  return schema;
}

const Schema<LayoutPlan>& layout_schema() {
  using P = LayoutPlan;
  static const Schema<P> schema = {
      "[layout]",
      {name_of<P>("differs from all other layouts'"), channels("sensors", &P::sensors),
       channels("actuators", &P::actuators)}};
  return schema;
}

}  // namespace chladni::study
