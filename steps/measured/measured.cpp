// Measured shapes: from a table, or from a study that stands for the real body.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/draw.h"
#include "base/error.h"
#include "io/scan.h"
#include "io/shape_table.h"
#include "steps/interpolation.h"
#include "steps/measured/modes_of_files.h"

namespace chladni::steps {
namespace {

constexpr int kModesOfTruth = 12;
constexpr double kOffTheBody = 2e-3;  // [m]: between two models of one body
constexpr double kInView = 1e-2;  // least relative motion of a mode along the surface's directions

// In a table, two channels with the same name cannot be told apart.
void require_distinct_names(const study::Study& study) {
  for (const auto& sensor : study.sensors) {
    for (const auto& actuator : study.actuators) {
      require(sensor.name != actuator.name,
              study.file.string() + ": a sensor and an actuator are both called \"" + sensor.name +
                  "\"; expected different names, a table of shapes has one column for each");
    }
  }
}

// Shapes of another body at given places: at the nearest point of its surface, with the distance.
struct There {
  Eigen::MatrixXd shapes;    // n×modes
  Eigen::VectorXd distance;  // n [m]
};

There shapes_there(const stage::Solution& real, const mesh::SiteFinder& finder,
                   const priors::Places& places) {
  std::vector<mesh::Site> sites;
  Eigen::VectorXd distance(places.count());
  for (Eigen::Index i = 0; i < places.count(); ++i) {
    sites.push_back(finder.nearest(places.position.row(i).transpose()));
    distance(i) = sites.back().distance;
  }
  return {places_at(sites, places.direction, real.modes).shapes, distance};
}

// Flexible modes of the real body that move along the surface's directions, lowest first.
std::vector<Eigen::Index> modes_in_view(const stage::Solution& real, const Eigen::MatrixXd& surface,
                                        int count) {
  const Eigen::VectorXd norm = surface.colwise().norm();
  std::vector<Eigen::Index> columns;
  for (Eigen::Index j = real.modes.rigid_count; j < norm.size(); ++j) {
    if (static_cast<int>(columns.size()) < count && norm(j) > kInView * norm.maxCoeff()) {
      columns.push_back(j);
    }
  }
  return columns;
}

struct Values {
  io::ShapeTable table;   // all channels
  Eigen::MatrixXd truth;  // on the surface
  Eigen::VectorXd area;   // of the surface on the real body
};

Values values_of_truth(const study::Study& study, const stage::Solution& solution,
                       const std::vector<ChannelSite>& channels,
                       const priors::Simulation& simulation, stage::Work& work) {
  const auto& plan = *study.measurement;
  const study::Study real_study = study::read_study(plan.truth, work.choices().allowed);
  const auto part = work.part("truth: ");
  const stage::Solution real = stage::solved(real_study, work);
  const mesh::SiteFinder finder(real.model.body);
  const auto on_surface = shapes_there(real, finder, simulation.surface);
  const auto& surface = on_surface.shapes;
  const int count = plan.modes > 0 ? plan.modes : kModesOfTruth;
  const auto columns = modes_in_view(real, surface, count);
  require(
      plan.modes == 0 || static_cast<int>(columns.size()) == count,
      fmt::format("{}: measurement.modes asks for {} modes and the truth has {} that move along "
                  "the surface's directions; raise modes.count in {}",
                  study.file.string(), count, columns.size(), plan.truth.string()));
  Values values;
  values.truth = surface(Eigen::all, columns);
  values.area = (on_surface.distance.array() <= kOffTheBody).select(simulation.area, 0.0);
  auto& table = values.table;
  for (const auto& channel : channels) table.channels.push_back(channel.name);
  table.frequency_hz = real.modes.frequency_hz(columns);
  table.damping_ratio = real.modes.damping_ratio(columns);
  const auto at_channels = shapes_there(real, finder, places_at(channels, solution.modes));
  require(
      at_channels.distance.maxCoeff() <= kOffTheBody,
      fmt::format("{}: a channel of {} is {:.3g} mm off the body of the truth", plan.truth.string(),
                  study.file.string(), 1e3 * at_channels.distance.maxCoeff()));
  table.values = at_channels.shapes(Eigen::all, columns);
  const Eigen::VectorXd rms =
      (values.truth.cwiseAbs2().transpose() * values.area / values.area.sum()).cwiseSqrt();
  table.deviation = plan.noise * Eigen::VectorXd::Ones(table.values.rows()) * rms.transpose();
  Draw draw(work.seed());
  for (Eigen::Index i = 0; i < table.values.cols(); ++i) {
    for (Eigen::Index k = 0; k < table.values.rows(); ++k) {
      table.values(k, i) += table.deviation(k, i) * draw.normal();
    }
  }
  return values;
}

io::ShapeTable table_part(const io::ShapeTable& table, const std::vector<Eigen::Index>& rows,
                          const std::vector<Eigen::Index>& modes) {
  auto part = table;
  part.channels.clear();
  for (const auto row : rows) {
    part.channels.push_back(table.channels[static_cast<std::size_t>(row)]);
  }
  part.frequency_hz = table.frequency_hz(modes);
  part.damping_ratio = table.damping_ratio(modes);
  part.values = table.values(rows, modes);
  part.deviation = table.deviation(rows, modes);
  part.frequency_std_hz = table.frequency_std_hz(modes);
  part.damping_std = table.damping_std(modes);
  return part;
}

// Empty cells of values are not known: channels that no mode knows are left out, then modes that do
// not know all the others, since the interpolators take a value of each mode at each channel.
io::ShapeTable known_part(const io::ShapeTable& table, const std::string& file, stage::Work& work) {
  const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> known = table.values.array().isFinite();
  if (known.all()) return table;
  std::vector<Eigen::Index> rows;
  std::vector<Eigen::Index> modes;
  std::vector<std::string> lacking;
  for (Eigen::Index k = 0; k < table.values.rows(); ++k) {
    if (known.row(k).any()) {
      rows.push_back(k);
    } else {
      lacking.push_back("\"" + table.channels[static_cast<std::size_t>(k)] + "\"");
    }
  }
  for (Eigen::Index i = 0; i < table.values.cols() && !rows.empty(); ++i) {
    if (known.col(i)(rows).all()) {
      modes.push_back(i);
    } else {
      lacking.push_back(fmt::format("the mode at {:.6g} Hz", table.frequency_hz(i)));
    }
  }
  const auto left_out = known.size() - known.count();
  require(!modes.empty(),
          fmt::format("{}: empty cells: {}, and no mode has a value at each channel; expected one, "
                      "leave out columns of channels that were not measured",
                      file, left_out));
  work.warn(fmt::format("{}: values that are not known (empty cells): {}; left out with them: {}",
                        file, left_out, io::listed(lacking)));
  return table_part(table, rows, modes);
}

io::ShapeTable table_of_file(const study::MeasurementPlan& plan, stage::Work& work) {
  const auto file = plan.shapes.string();
  const auto read = io::read_shapes(plan.shapes, io::ShapesStated::partly);
  require(!read.channels.empty(), file + ": there is no column of a channel");
  auto table = known_part(read, file, work);
  warn_of_unstated(table, file, work);
  table.damping_ratio = table.damping_ratio.array().isNaN().select(0.0, table.damping_ratio);
  for (Eigen::Index i = 0; i < table.values.cols(); ++i) {
    const double rms =
        table.values.col(i).norm() / std::sqrt(static_cast<double>(table.values.rows()));
    for (Eigen::Index k = 0; k < table.values.rows(); ++k) {
      if (table.deviation(k, i) == 0.0) table.deviation(k, i) = plan.noise * rms;
    }
    require(rms > 0.0, fmt::format("{}: all values of mode {} ({:.6g} Hz) are 0",
                                   plan.shapes.string(), i + 1, table.frequency_hz(i)));
  }
  return table;
}

// The table rows of the wanted channels, as measured shapes.
priors::MeasuredShapes part_of(const io::ShapeTable& table,
                               const std::vector<ChannelSite>& channels, const modal::Modes& modes,
                               const fem::LaplaceSpectrum& harmonics) {
  std::vector<Eigen::Index> rows;
  for (const auto& channel : channels) {
    const auto found = std::find(table.channels.begin(), table.channels.end(), channel.name);
    rows.push_back(found - table.channels.begin());
  }
  return {places_at(channels, modes, harmonics), table.frequency_hz, table.values(rows, Eigen::all),
          table.deviation(rows, Eigen::all)};
}

// Rejects columns that are not a channel, and notes channels without a column.
void warn_of_strangers(const io::ShapeTable& table, const std::vector<ChannelSite>& channels,
                       const std::string& file, stage::Work& work) {
  for (const auto& name : table.channels) {
    const bool known = std::any_of(channels.begin(), channels.end(),
                                   [&](const auto& channel) { return channel.name == name; });
    require(known, file + ": the column \"" + name + "\" is no sensor or actuator of the study");
  }
  for (const auto& channel : channels) {
    if (std::find(table.channels.begin(), table.channels.end(), channel.name) ==
        table.channels.end()) {
      work.note("\"" + channel.name + "\" was not measured: " + file + " has no value of it");
    }
  }
}

}  // namespace

std::vector<ChannelSite> channel_sites(const study::Study& study, const stage::Model& model) {
  std::vector<ChannelSite> all;
  for (std::size_t i = 0; i < study.sensors.size(); ++i) {
    all.push_back({study.sensors[i].name, model.sensors[i], study.sensors[i].direction});
  }
  for (std::size_t i = 0; i < study.actuators.size(); ++i) {
    all.push_back({study.actuators[i].name, model.actuators[i], study.actuators[i].direction});
  }
  return all;
}

priors::Places places_at(const std::vector<mesh::Site>& sites, const Points& directions,
                         const modal::Modes& modes, const fem::LaplaceSpectrum& harmonics) {
  const auto n = static_cast<Eigen::Index>(sites.size());
  priors::Places places{Points(n, 3), directions, stage::shapes_at(sites, directions, modes)};
  for (Eigen::Index i = 0; i < n; ++i) {
    places.position.row(i) = sites[static_cast<std::size_t>(i)].position.transpose();
  }
  if (harmonics.eigenvalue.size() > 0) places.harmonics = fem::functions_at(harmonics, sites);
  return places;
}

priors::Places places_at(const std::vector<ChannelSite>& channels, const modal::Modes& modes,
                         const fem::LaplaceSpectrum& harmonics) {
  std::vector<mesh::Site> sites;
  Points directions(static_cast<Eigen::Index>(channels.size()), 3);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    sites.push_back(channels[i].site);
    directions.row(static_cast<Eigen::Index>(i)) = channels[i].direction.transpose();
  }
  return places_at(sites, directions, modes, harmonics);
}

bool has_shapes(const study::MeasurementPlan& plan) {
  return !plan.shapes.empty() || !plan.truth.empty() || has_responses(plan);
}

Measured measured(const study::Study& study, const stage::Solution& solution,
                  const priors::Simulation& simulation, const fem::LaplaceSpectrum& harmonics,
                  stage::Work& work, const OnIdentified& on_identified) {
  require(study.measurement && has_shapes(*study.measurement),
          study.file.string() +
              ": nothing is measured; expected [measurement] with frf = \"measured.uff\", shapes = "
              "\"shapes.csv\" or truth = \"real.toml\"");
  require_distinct_names(study);
  if (study.measurement->truth.empty() && study.measurement->shapes.empty()) {
    return measured_by_responses(study, solution, harmonics, work, on_identified);
  }
  const auto channels = channel_sites(study, solution.model);
  Values values;
  if (!study.measurement->truth.empty()) {
    values = values_of_truth(study, solution, channels, simulation, work);
  } else {
    values.table = table_of_file(*study.measurement, work);
    warn_of_strangers(values.table, channels, study.measurement->shapes.string(), work);
  }
  const auto& hold_out = study.measurement->hold_out;
  std::vector<ChannelSite> used;
  std::vector<ChannelSite> hidden;
  for (const auto& channel : channels) {
    const auto& known = values.table.channels;
    if (std::find(known.begin(), known.end(), channel.name) == known.end()) continue;
    const bool held_out =
        std::find(hold_out.begin(), hold_out.end(), channel.name) != hold_out.end();
    (held_out ? hidden : used).push_back(channel);
  }
  Measured result;
  for (const auto& channel : used) result.channels.push_back(channel.name);
  for (const auto& channel : hidden) result.hidden_channels.push_back(channel.name);
  result.shapes = part_of(values.table, used, solution.modes, harmonics);
  result.hidden = part_of(values.table, hidden, solution.modes, harmonics);
  result.damping_ratio = values.table.damping_ratio;
  result.truth = std::move(values.truth);
  result.truth_area = std::move(values.area);
  return result;
}

}  // namespace chladni::steps
