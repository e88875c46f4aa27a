#include "simulators/rigs/real_body.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "base/error.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

void add(TableChannels& channels, bool outputs, const std::vector<Eigen::Vector2d>& places) {
  auto& rows = outputs ? channels.outputs : channels.inputs;
  auto& names = outputs ? channels.output_names : channels.input_names;
  rows.resize(static_cast<Index>(places.size()), 2);
  for (std::size_t i = 0; i < places.size(); ++i) {
    rows.row(static_cast<Index>(i)) = places[i].transpose();
    names.push_back(fmt::format("{}{}", outputs ? "s" : "a", i + 1));
  }
}

RealBody table() {
  RealBody made;
  made.rig = rig_named("table");
  const auto wafer = made.rig.channels;
  auto& channels = made.rig.channels;
  channels.outputs = wafer.inputs;
  channels.inputs = wafer.outputs;
  channels.output_names.clear();
  channels.input_names.clear();
  for (int i = 1; i <= 13; ++i) channels.output_names.push_back(fmt::format("s{}", i));
  for (int i = 1; i <= 4; ++i) channels.input_names.push_back(fmt::format("a{}", i));
  made.accelerometer = 4e-3;
  return made;
}

RealBody strip() {
  RealBody made;
  made.rig = rig_named("strip");
  made.rig.high_hz = 1000.0;
  made.accelerometer = 3e-4;
  return made;
}

Rig thin_plate(double side, double thickness, double modulus, double poisson, double density) {
  Rig rig;
  auto& body = rig.body;
  body.length = body.width = side;
  body.thickness = Eigen::MatrixXd::Constant(1, 1, thickness);
  body.stiffness = isotropic_plane(modulus, poisson);
  body.density = density;
  return rig;
}

RealBody disc() {
  RealBody made;
  made.outline = Outline::disc;
  made.rig = thin_plate(0.3, 8e-3, 91e9, 0.24, 2530.0);
  made.rig.damping_ratio = 3e-3;
  made.rig.low_hz = 60.0;
  made.rig.high_hz = 3000.0;
  made.rig.geometry = "{ disc = { diameter = \"300 mm\", thickness = \"8 mm\" } }";
  std::vector<Eigen::Vector2d> sensors{{0.0, 0.0}};
  const auto at = [](double radius, double turns) {
    return Eigen::Vector2d(radius * std::cos(2.0 * pi * turns),
                           radius * std::sin(2.0 * pi * turns));
  };
  for (int i = 0; i < 4; ++i) sensors.push_back(at(0.07, (i + 0.3) / 4.0));
  for (int i = 0; i < 7; ++i) sensors.push_back(at(0.138, (i + 0.1) / 7.0));
  add(made.rig.channels, true, sensors);
  add(made.rig.channels, false, {at(0.12, 0.02), at(0.12, 0.4), at(0.05, 0.75)});
  made.accelerometer = 8e-4;
  return made;
}

// The L as a closed surface. The top is z = 0.
std::string ell_surface(double side, double thickness) {
  const double h = 0.5e3 * side;
  const std::vector<Eigen::Vector2d> rim{{-h, -h}, {h, -h}, {h, 0}, {0, 0}, {0, h}, {-h, h}};
  std::string text = "OFF\n12 20 0\n";
  for (const double z : {0.0, -1e3 * thickness}) {
    for (const auto& corner : rim) {
      text += fmt::format("{:.9g} {:.9g} {:.9g}\n", corner.x(), corner.y(), z);
    }
  }
  // Four triangles about the corner at the origin.
  const std::vector<std::array<int, 3>> top{{3, 0, 1}, {3, 1, 2}, {3, 4, 5}, {3, 5, 0}};
  for (const auto& t : top) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  for (const auto& t : top) text += fmt::format("3 {} {} {}\n", t[0] + 6, t[2] + 6, t[1] + 6);
  for (int i = 0; i < 6; ++i) {
    const int next = (i + 1) % 6;
    text += fmt::format("3 {} {} {}\n3 {} {} {}\n", i, i + 6, next + 6, i, next + 6, next);
  }
  return text;
}

RealBody ell() {
  RealBody made;
  made.outline = Outline::ell;
  made.rig = thin_plate(0.4, 8e-3, 70e9, 0.33, 2700.0);
  made.rig.low_hz = 30.0;
  made.rig.high_hz = 1500.0;
  made.rig.geometry = "{ file = \"body.off\", unit = \"mm\" }";
  made.rig.surface = ell_surface(0.4, 8e-3);
  add(made.rig.channels, true,
      {{-0.18, 0.17},
       {-0.03, 0.18},
       {-0.1, 0.09},
       {-0.17, 0.0},
       {-0.04, -0.03},
       {0.07, -0.05},
       {0.18, -0.02},
       {0.12, -0.11},
       {-0.02, -0.16},
       {0.18, -0.18}});
  add(made.rig.channels, false, {{-0.17, 0.1}, {-0.15, -0.17}, {0.14, -0.16}});
  made.accelerometer = 2e-3;
  return made;
}

double mass_of(const RealBody& body) {
  const auto& plate = body.rig.body;
  const double fraction = body.outline == Outline::disc  ? 0.25 * pi
                          : body.outline == Outline::ell ? 0.75
                                                         : 1.0;
  double mass = fraction * plate.density * plate.length * plate.width * plate.thickness(0, 0);
  for (const auto& one : plate.fixtures) mass += one.mass;
  return mass;
}

}  // namespace

bool RealBody::covers(const Eigen::Vector2d& place, double margin) const {
  const Eigen::Vector2d half(0.5 * rig.body.length, 0.5 * rig.body.width);
  if (outline == Outline::disc) return place.norm() <= half.x() - margin;
  if (((half - place.cwiseAbs()).array() < margin).any()) return false;
  return outline == Outline::rectangle || place.minCoeff() <= -margin;
}

const std::vector<std::string>& real_body_names() {
  static const std::vector<std::string> names{"table", "strip", "disc", "ell"};
  return names;
}

RealBody real_body(const std::string& name) {
  const std::map<std::string, RealBody (*)()> makers{
      {"table", table}, {"strip", strip}, {"disc", disc}, {"ell", ell}};
  const auto found = makers.find(name);
  require(found != makers.end(),
          fmt::format("no body '{}'; there are {}", name, fmt::join(real_body_names(), ", ")));
  auto made = found->second();
  made.rig.name = name;
  made.mass = mass_of(made);
  return made;
}

const BareModes& believed_modes(const RealBody& body) {
  static std::map<std::string, BareModes> kept;
  auto found = kept.find(body.rig.name);
  if (found == kept.end()) {
    found = kept.emplace(body.rig.name, bare_modes(body.rig.body, body.outline)).first;
  }
  return found->second;
}

double first_in_band(const RealBody& body) {
  const auto& hz = believed_modes(body).frequency_hz;
  return hz((hz.array() <= body.rig.low_hz).count());
}

}  // namespace chladni::simulators
