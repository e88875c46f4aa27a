#include "simulators/tables/rig.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;

TableChannels few_channels_of_the_table() {
  TableChannels all;
  all.outputs.resize(3, 2);
  all.outputs << -0.21, 0.13, 0.17, 0.24, 0.08, -0.22;
  all.inputs.resize(5, 2);
  all.inputs << -0.26, -0.19, 0.23, 0.04, -0.05, 0.27, 0.12, -0.12, -0.13, 0.02;
  all.output_names = {"s1", "s2", "s3"};
  all.input_names = {"a1", "a2", "a3", "a4", "a5"};
  return all;
}

TableChannels along_the_strip(const std::vector<double>& sensors) {
  TableChannels all;
  all.outputs = Eigen::MatrixX2d::Zero(static_cast<Index>(sensors.size()), 2);
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    all.outputs(static_cast<Index>(i), 0) = sensors[i];
    all.output_names.push_back(fmt::format("y{}", i + 1));
  }
  all.inputs.resize(3, 2);
  all.inputs << -0.2, 0.0, 0.0, 0.0, 0.2, 0.0;
  all.input_names = {"u1", "u2", "u3"};
  return all;
}

Rig table(int degree, const TableChannels& channels) {
  Rig rig;
  rig.body = aluminium_table(degree);
  rig.channels = channels;
  return rig;
}

RitzFixture flexure(double x) {
  RitzFixture one;
  one.place = {x, 0.0};
  one.footprint = 6e-3;
  one.stiffness = 35.0;
  one.turning_x = 0.85;
  one.turning_y = 20.0;
  return one;
}
RitzFixture coil(double x) {
  RitzFixture one;
  one.place = {x, 0.0};
  one.footprint = 10e-3;
  one.mass = 31e-3;
  one.inertia_x = 8e-6;
  return one;
}

Rig strip(int degree, const std::vector<double>& sensors) {
  Rig rig;
  auto& body = rig.body;
  body.length = 0.5;
  body.width = 0.02;
  body.stiffness = isotropic_plane(210e9, 0.3);
  body.density = 7850.0;
  body.thickness = Eigen::MatrixXd::Constant(1, 1, 2e-3);
  body.fixtures = {flexure(-0.24), flexure(0.24), coil(-0.2), coil(0.0), coil(0.2)};
  body.degree = degree + 10;
  body.degree_across = 5;
  rig.channels = along_the_strip(sensors);
  rig.driven_from_below = true;
  rig.damping_ratio = 0.01;
  rig.high_hz = 400.0;
  rig.scale = {0.25 / 19.44, 0.5, 400.0 / 900.0};
  // Springs hold the strip, so it has no rigid-body modes. Along a line, orthotropy is the same as
  // the modulus. The other kinds need a surface.
  rig.without = {"suspension", "orthotropy", "elastic_pad", "line_crack", "other_plate"};
  return rig;
}

std::string millimetres(double metres) { return fmt::format("\"{:.9g} mm\"", 1e3 * metres); }

std::string at(const Rig& rig, const Eigen::Vector2d& place, bool below) {
  const std::string third = below ? ", " + millimetres(-rig.body.thickness(0, 0)) : "";
  return fmt::format("at = [{}, {}{}]\n", millimetres(place.x()), millimetres(place.y()), third);
}

std::string channels_text(const Rig& rig) {
  std::string text;
  const auto add = [&](const char* kind, const std::vector<std::string>& names,
                       const Eigen::MatrixX2d& places, bool below, const char* quantity) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Eigen::Vector2d place = places.row(static_cast<Index>(i)).transpose();
      text += fmt::format("\n[[{}]]\nname = \"{}\"\n{}direction = \"z\"\n{}", kind, names[i],
                          at(rig, place, below), quantity);
    }
  };
  add("sensor", rig.channels.output_names, rig.channels.outputs, false,
      "quantity = \"displacement\"\n");
  add("actuator", rig.channels.input_names, rig.channels.inputs, rig.driven_from_below, "");
  return text;
}

// The text of one attachment. Each number of a fixture becomes one attachment.
std::string attachment(const Rig& rig, const RitzFixture& one, const std::string& kind,
                       const std::string& name, const std::string& numbers) {
  const bool below = rig.driven_from_below && kind == "mass";
  return fmt::format("\n[[attachment]]\nkind = \"{}\"\nname = \"{}\"\n{}footprint = {}\n{}", kind,
                     name, at(rig, one.place, below), millimetres(one.footprint), numbers);
}

std::string fixture_text(const Rig& rig, const RitzFixture& one, std::size_t number) {
  std::string text;
  const auto add = [&](double size, const std::string& kind, const std::string& name,
                       const std::string& numbers) {
    if (size > 0.0) {
      text += attachment(rig, one, kind, fmt::format("{}_{}", name, number), numbers);
    }
  };
  const auto spring = [](const char* along, double stiffness, const char* unit) {
    return fmt::format("{} = \"{}\"\nstiffness = \"{:.9g} {}\"\n",
                       std::string_view(unit) == "N/m" ? "direction" : "axis", along, stiffness,
                       unit);
  };
  add(one.stiffness, "spring", "sway", spring("z", one.stiffness, "N/m"));
  add(one.turning_x, "torsion_spring", "turn", spring("y", one.turning_x, "N m/rad"));
  add(one.turning_y, "torsion_spring", "roll", spring("x", one.turning_y, "N m/rad"));
  add(one.mass, "mass", "mass",
      fmt::format("mass = \"{:.9g} g\"\ninertia = [\"{:.9g} kg m^2\", \"{:.9g} kg m^2\", \"0 kg "
                  "m^2\"]\n",
                  1e3 * one.mass, one.inertia_y, one.inertia_x));
  // Springs along the plane hold motions that no sensor sees. They are so soft that they turn
  // nothing.
  add(one.stiffness, "spring", "hold_x", spring("x", 100.0, "N/m"));
  add(one.stiffness, "spring", "hold_y", spring("y", 100.0, "N/m"));
  return text;
}

}  // namespace

bool Rig::has(const std::string& kind) const {
  return std::ranges::find(without, kind) == without.end();
}

const std::vector<std::string>& rig_names() {
  static const std::vector<std::string> names{"table", "table_few", "strip", "strip_few"};
  return names;
}

Rig rig_named(const std::string& name, int degree) {
  Rig rig;
  if (name == "table") {
    rig = table(degree, table_channels());
  } else if (name == "table_few") {
    rig = table(degree, few_channels_of_the_table());
  } else if (name == "strip") {
    rig = strip(degree, {-0.2, -0.1, 0.0, 0.1, 0.2});
  } else if (name == "strip_few") {
    rig = strip(degree, {-0.2035, -0.0035, 0.1965});
  } else {
    throw InvalidInput(
        fmt::format("no rig '{}'; there are {}", name, fmt::join(rig_names(), ", ")));
  }
  rig.name = name;
  return rig;
}

std::string study_text(const Rig& rig, double edge_length) {
  const auto& body = rig.body;
  const std::string sides =
      fmt::format("{{ {} = {{ length = {}, width = {}, thickness = {} }} }}",
                  rig.is_slender() ? "beam" : "plate", millimetres(body.length),
                  millimetres(body.width), millimetres(body.thickness(0, 0)));
  const double nu = body.stiffness.q12 / body.stiffness.q11;
  const double modulus = body.stiffness.q11 * (1.0 - nu * nu);
  std::string text = fmt::format(
      "title = \"{}\"\n"
      "geometry = {}\n"
      "material = {{ youngs_modulus = \"{:.9g} GPa\", poissons_ratio = {:.9g}, density = \"{:.9g} "
      "kg/m^3\" }}\n"
      "modes = {{ damping_ratio = {:.9g} }}\n",
      rig.name, rig.geometry.empty() ? sides : rig.geometry, 1e-9 * modulus, nu, body.density,
      rig.damping_ratio);
  if (edge_length > 0.0)
    text += fmt::format("mesh = {{ edge_length = {} }}\n", millimetres(edge_length));
  for (std::size_t i = 0; i < body.fixtures.size(); ++i) {
    text += fixture_text(rig, body.fixtures[i], i + 1);
  }
  return text + channels_text(rig);
}

}  // namespace chladni::simulators
