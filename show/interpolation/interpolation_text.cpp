// Interpolated shapes as a table and JSON.
#include <fmt/format.h>

#include <cmath>

#include "base/percent.h"
#include "show/interpolation.h"
#include "show/readable.h"
#include "steps/interpolation.h"

namespace chladni::show {
namespace {

double mean_of(const Eigen::VectorXd& values) { return values.size() > 0 ? values.mean() : NAN; }

// Simulated modes that the channels cannot see, as text; empty if there are none.
std::string unseen_text(const steps::Interpolated& result) {
  std::string text;
  const auto& simulation = result.simulation;
  const double highest = result.measured.shapes.frequency_hz.maxCoeff();
  for (Eigen::Index j = simulation.rigid_count(); j < result.expected_error.size(); ++j) {
    if (!(result.expected_error(j) > priors::kHardlySeen) ||
        simulation.frequency_hz(j) > 1.2 * highest) {
      continue;
    }
    text += fmt::format("{}{} ({:.1f} Hz, {:.0f} %)", text.empty() ? "" : ", ", j + 1,
                        simulation.frequency_hz(j), 100.0 * result.expected_error(j));
  }
  return text;
}

std::string methods_text(const steps::Interpolated& result) {
  const bool has_truth = result.measured.truth.size() > 0;
  const bool has_hidden = !result.measured.hidden_channels.empty();
  std::string text = fmt::format("{:<30}", "method");
  if (has_truth) text += fmt::format("{:>14}{:>10}{:>14}", "squared error", "worst", "95 % covers");
  if (has_hidden) text += fmt::format("{:>12}{:>12}{:>14}", "held out", "FRF", "95 % covers");
  text += "\n";
  for (const auto& one : result.methods) {
    text += fmt::format("{:<30}", one.method->name);
    if (has_truth) {
      text += fmt::format("{:>14}{:>10}{:>14}", percent(one.error.mean()),
                          percent(one.error.maxCoeff()), percent(mean_of(one.covered)));
    }
    if (has_hidden) {
      text +=
          fmt::format("{:>12}{:>12}{:>14}", percent(mean_of(one.hidden_error)),
                      percent(mean_of(one.hidden_frf_error)), percent(mean_of(one.hidden_covered)));
    }
    text += "\n";
  }
  return text;
}

// Results of each mode, for the first method.
std::string modes_text(const steps::Interpolated& result) {
  const auto& shown = result.methods.front();
  const auto& frequency = result.measured.shapes.frequency_hz;
  const auto& area = result.simulation.area;
  const bool has_truth = shown.error.size() > 0;
  std::string text = fmt::format("\n{}\n{:>4} {:>10} {:>16}{}\n", shown.method->summary, "mode",
                                 "Hz", "1 sigma, rms", has_truth ? "   squared error" : "");
  for (Eigen::Index i = 0; i < frequency.size(); ++i) {
    const double square = shown.surface.mean.col(i).cwiseAbs2().dot(area);
    const double left = shown.surface.deviation.col(i).cwiseAbs2().dot(area);
    text += fmt::format("{:>4} {:>10.2f} {:>16}", i + 1, frequency(i),
                        percent(std::sqrt(left / square)));
    if (has_truth) text += fmt::format(" {:>15}", percent(shown.error(i)));
    text += "\n";
  }
  return text;
}

std::string points_text(const steps::Interpolated& result) {
  if (result.points.empty()) return {};
  const auto& shown = result.methods.front();
  std::string text = "\npoint, mode by mode, +- 1 sigma\n";
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    const auto row = static_cast<Eigen::Index>(p);
    text += fmt::format("{:<12}", result.points[p]);
    for (Eigen::Index i = 0; i < shown.points.mean.cols(); ++i) {
      text += fmt::format(" {:.4f}+-{}", shown.points.mean(row, i),
                          deviation_text(shown.points.deviation(row, i), "{:.4f}"));
    }
    text += "\n";
  }
  return text;
}

io::Json fit_json(const priors::FitSummary& summary) {
  io::JsonObject parameters;
  for (const auto& one : summary.parameters) {
    parameters.emplace_back(one.name, io::JsonObject{{"unit", one.unit},
                                                     {"value", io::Json(one.value)},
                                                     {"at_bound", one.at_bound}});
  }
  return io::JsonObject{{"parameters", parameters},
                        {"log_evidence", io::Json(summary.log_evidence)},
                        {"notes", io::Json::texts(summary.notes)}};
}

io::Json held_out_json(const steps::Measured& measured, const steps::Interpolation& one) {
  io::JsonArray array;
  io::JsonArray scored(static_cast<std::size_t>(measured.shapes.mode_count()), io::Json(false));
  for (const auto k : steps::scored_modes(measured)) {
    scored[static_cast<std::size_t>(k)] = io::Json(true);
  }
  for (std::size_t c = 0; c < measured.hidden_channels.size(); ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    array.push_back(io::JsonObject{{"channel", measured.hidden_channels[c]},
                                   {"frf_error", one.hidden_frf_error(row)},
                                   {"shape_error", one.hidden_error(row)},
                                   {"coverage", one.hidden_covered(row)},
                                   {"value", io::Json(measured.hidden.values.row(row).transpose())},
                                   {"mean", io::Json(one.hidden.mean.row(row).transpose())},
                                   {"std", io::Json(one.hidden.deviation.row(row).transpose())},
                                   {"scored", scored}});
  }
  return array;
}

io::Json points_json(const steps::Interpolated& result, const steps::Interpolation& one) {
  io::JsonArray array;
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    const auto row = static_cast<Eigen::Index>(p);
    const auto at = result.point_places.position.row(row);
    array.push_back(io::JsonObject{{"name", result.points[p]},
                                   {"x_m", at.x()},
                                   {"y_m", at.y()},
                                   {"z_m", at.z()},
                                   {"mean", io::Json(one.points.mean.row(row).transpose())},
                                   {"std", io::Json(one.points.deviation.row(row).transpose())}});
  }
  return array;
}

io::Json method_json(const steps::Interpolated& result, const steps::Interpolation& one) {
  io::JsonObject object = {{"method", one.method->name},
                           {"summary", one.method->summary},
                           {"source", one.method->source},
                           {"fit", fit_json(one.field->summary())},
                           {"held_out", held_out_json(result.measured, one)},
                           {"points", points_json(result, one)}};
  if (one.error.size() > 0) {
    object.emplace_back("surface", io::JsonObject{{"squared_error", io::Json(one.error)},
                                                  {"coverage", io::Json(one.covered)}});
  }
  return object;
}

}  // namespace

std::string interpolation_table(const steps::Interpolated& result) {
  const auto& measured = result.measured;
  std::string text =
      fmt::format("{} shapes measured at {} places, {} held out\n", measured.shapes.mode_count(),
                  measured.channels.size(), measured.hidden_channels.size());
  const auto unseen = unseen_text(result);
  if (!unseen.empty())
    text += "these places hardly see modes of the simulation (what is expected to stay unknown): " +
            unseen + "\n";
  text += "\n" + methods_text(result) + modes_text(result) + points_text(result);
  for (const auto& one : result.methods) {
    for (const auto& note : one.field->summary().notes) {
      text += fmt::format("{}: {}\n", one.method->name, note);
    }
  }
  return text;
}

io::JsonObject interpolation_json(const steps::Interpolated& result) {
  io::JsonArray methods;
  for (const auto& one : result.methods) methods.push_back(method_json(result, one));
  const auto& measured = result.measured;
  return {{"channels", io::Json::texts(measured.channels)},
          {"held_out", io::Json::texts(measured.hidden_channels)},
          {"frequency_hz", io::Json(measured.shapes.frequency_hz)},
          {"before_measuring",
           io::JsonObject{{"frequency_hz", io::Json(result.simulation.frequency_hz)},
                          {"expected_error", io::Json(result.expected_error)}}},
          {"methods", methods}};
}

}  // namespace chladni::show
