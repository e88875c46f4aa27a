#include "steps/simulated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "identification/delay.h"
#include "io/time_file.h"
#include "recordings/closed_loop.h"
#include "stage/at_channels.h"
#include "stage/channel_paths.h"
#include "stage/diagnosis_structure.h"

namespace chladni::steps {
namespace {

using recordings::ChainMatrices;

modal::FrfKind kind_of(const study::Channel& sensor) {
  if (sensor.quantity == "velocity") return modal::FrfKind::mobility;
  return sensor.quantity == "acceleration" ? modal::FrfKind::accelerance
                                           : modal::FrfKind::receptance;
}

std::string unit_of(modal::FrfKind kind) {
  if (kind == modal::FrfKind::mobility) return "m/s";
  return kind == modal::FrfKind::accelerance ? "m/s^2" : "m";
}

std::vector<modal::MeasuredChannel> channels_of(const std::vector<study::Channel>& channels,
                                                bool sensors) {
  std::vector<modal::MeasuredChannel> result;
  for (const auto& channel : channels) {
    const auto kind = sensors ? kind_of(channel) : modal::FrfKind::receptance;
    result.push_back({.name = channel.name,
                      .node = channel.node,
                      .direction = channel.direction,
                      .position = std::nullopt,
                      .unit = sensors ? unit_of(kind) : "N",
                      .kind = kind});
  }
  return result;
}

// Positions of channels along the thesis' strip [m from its left end].
Eigen::VectorXd along(const study::Study& study, const std::vector<study::Channel>& channels) {
  const auto* strip = std::get_if<mesh::Plate>(&study.geometry.body);
  const recordings::RigidChain thesis;
  require(strip != nullptr && std::abs(strip->length - thesis.length_m) < 1e-9 &&
              std::abs(strip->width - thesis.width_m) < 1e-9 &&
              std::abs(strip->thickness - thesis.thickness_m) < 1e-9,
          "experiment.structure: the chain of rigid bodies is the thesis' beam of 500 x 20 x 2 mm; "
          "the study's body is another");
  Eigen::VectorXd result(static_cast<Eigen::Index>(channels.size()));
  for (std::size_t i = 0; i < channels.size(); ++i) {
    require(std::abs(std::abs(channels[i].direction.z()) - 1.0) < 1e-9 &&
                channels[i].quantity != "velocity" && channels[i].quantity != "acceleration",
            "experiment.structure: the chain moves along z and is measured in displacement; \"" +
                channels[i].name + "\" is not");
    result(static_cast<Eigen::Index>(i)) = channels[i].at.point.x() + 0.5 * strip->length;
  }
  return result;
}

void set_chain(const study::Study& study, Bench& bench) {
  const auto& plan = *study.experiment;
  require(plan.controlled.empty(), "experiment: the chain hangs on flexures and takes no loop");
  const auto chain =
      recordings::matrices(plan.structure == "rigid_chain" ? recordings::beam_with_coils()
                                                           : recordings::beam_with_carried_body());
  bench.rig.plant =
      recordings::plant(chain, along(study, study.sensors), along(study, study.actuators), 1e9);
}

Eigen::Index place_of(const std::vector<study::Channel>& channels, const std::string& name) {
  const auto names = study::names_of(channels);
  return std::find(names.begin(), names.end(), name) - names.begin();
}

// Sets the loop around the rigid-body modes, or the suspension modes: all far below the bandwidth.
void set_loop(const study::Study& study, const modal::ReducedModel& model, Bench& bench) {
  const auto& plan = *study.experiment;
  auto& rig = bench.rig;
  for (const auto& sensor : study.sensors) {
    require(kind_of(sensor) == modal::FrfKind::receptance,
            "experiment.controlled: the loop needs sensors of displacement; \"" + sensor.name +
                "\" is none");
  }
  std::vector<Eigen::Index> controlled;
  for (const auto& name : plan.controlled) controlled.push_back(place_of(study.actuators, name));
  const auto slow = (model.frequency_hz.array() < 0.5 * plan.bandwidth_hz).count();
  rig.controller =
      recordings::stabiliser(model, slow, controlled, plan.bandwidth_hz, rig.sample_time_s);
  if (rig.delay_s >= rig.sample_time_s) return;
  rig.delay_s = rig.sample_time_s;
  bench.notes.push_back(
      fmt::format("the loop takes one sample: a delay of {:.6g} us", 1e6 * rig.delay_s));
}

// What the responses lack of the modes. `asked`, `last`: frequency of the last mode that the study
// asks for, and of the last one that the structure has; 0 where there is none.
void note_modes(const study::ExperimentPlan& plan, double asked, double last, bool folds,
                Bench& bench) {
  if (asked > 0.5 * plan.sample_rate_hz) {
    bench.notes.push_back(fmt::format(
        "modes up to {:.6g} Hz lie above half the sample rate; they {}", asked,
        folds ? "fold back, as in a laboratory without anti-aliasing filters"
              : "only yield statically: velocities and accelerations are recorded through filters "
                "that let nothing fold back"));
  }
  const double high = bench.plan.multisine.high_hz;
  if (last > 0.0 && last < high) {
    bench.notes.push_back(fmt::format(
        "the model ends with its mode at {:.6g} Hz and the band at {:.6g} Hz: the responses lack "
        "the modes from there on; modes.up_to = \"{:.3g} Hz\" has those of the band and what is "
        "left of the next ones",
        last, high, 2.0 * high));
  }
}

// Factor by which its own dynamics raise such a mode at the end of the band, that is told.
constexpr double kFlankTold = 1.5;

// A mode above half the sample rate that only yields statically is missed near the end of the band.
void note_flank(const study::ExperimentPlan& plan, const Eigen::VectorXd& all_hz,
                const Eigen::VectorXd& kept_hz, Bench& bench) {
  if (kept_hz.size() >= all_hz.size()) return;
  const double next = all_hz(kept_hz.size());
  const double high = bench.plan.multisine.high_hz;
  const double grows = 1.0 / (1.0 - std::pow(high / next, 2));
  if (grows < kFlankTold) return;
  bench.notes.push_back(fmt::format(
      "the mode at {:.6g} Hz, above half the sample rate, only yields statically: at {:.6g} Hz, "
      "the end of the band, its part is {:.2g} times too small; sample_rate = \"{:.3g} Hz\" or "
      "more has its resonance",
      next, high, grows, 2.5 * next));
}

// The structure has no fewer modes than a diagnosis takes. Those beyond what the study asks for do
// not fold back: above half the sample rate they only yield statically.
void set_structure(const study::Study& study, stage::Work& work, Bench& bench) {
  const auto& plan = *study.experiment;
  if (plan.structure != "study") return set_chain(study, bench);
  const auto [own, solution] = stage::solved_with_more(study, stage::kDiagnosisModes, work);
  const auto all = recordings::in_view(
      work.timed("reduction", [&] { return stage::at_channels(study, solution); }));
  std::vector<modal::FrfKind> kinds;
  for (const auto& sensor : study.sensors) kinds.push_back(kind_of(sensor));
  const bool folds = std::ranges::count(kinds, modal::FrfKind::receptance) == std::ssize(kinds);
  const auto last_of = [](const Eigen::VectorXd& hz) {
    return hz.size() > 0 ? hz.tail(1)(0) : 0.0;
  };
  const double asked = last_of(own.modes.frequency_hz);
  const double half = 0.5 * plan.sample_rate_hz;
  const auto model = recordings::at_rest_above(all, folds ? std::max(half, asked) : half);
  bench.modes = model.mode_count();
  bench.rig.plant = recordings::plant(model, kinds);
  require(model.rigid_count == 0 || !plan.controlled.empty(),
          fmt::format("experiment: the body is free ({} rigid-body modes in view) and would drift; "
                      "expected controlled = [...] and a bandwidth",
                      model.rigid_count));
  note_modes(plan, asked, last_of(all.frequency_hz), folds, bench);
  note_flank(plan, all.frequency_hz, model.frequency_hz, bench);
  if (!plan.controlled.empty()) set_loop(study, model, bench);
}

void set_excitation(const study::ExperimentPlan& plan, Bench& bench) {
  using recordings::ExcitedLines;
  auto& multisine = bench.plan.multisine;
  multisine.period = plan.samples;
  multisine.sample_time_s = 1.0 / plan.sample_rate_hz;
  multisine.low_hz = plan.low_hz;
  multisine.high_hz = plan.high_hz > 0.0 ? plan.high_hz : 0.125 * plan.sample_rate_hz;
  multisine.lines = plan.lines == "all"   ? ExcitedLines::all
                    : plan.lines == "odd" ? ExcitedLines::odd
                                          : ExcitedLines::odd_with_detection;
  multisine.rms = plan.amplitude;
  bench.plan.scheme = plan.inputs == "orthogonal" ? recordings::InputScheme::orthogonal
                                                  : recordings::InputScheme::one_at_a_time;
  bench.plan.periods = plan.periods;
  bench.plan.warm_up = plan.warm_up;
}

// The excitation of each realisation.
std::vector<recordings::TimeData> parts_of(const recordings::TimeData& excitation) {
  std::vector<recordings::TimeData> parts;
  for (const auto& record : excitation.records) {
    if (parts.empty() || parts.back().records.back().realisation != record.realisation) {
      parts.push_back(excitation);
      parts.back().records.clear();
    }
    parts.back().records.push_back(record);
  }
  return parts;
}

// The first realisation of what is played: the signals of the file, or drawn ones.
recordings::TimeData first_realisation(const recordings::VirtualRig& rig, const Bench& bench,
                                       Draw& draw) {
  const auto sets = parts_of(bench.excitation);
  return sets.empty()
             ? recordings::realisation(rig, bench.plan, 0, draw)
             : recordings::played(rig, sets.front(), bench.plan.periods, bench.plan.warm_up, draw);
}

// Noise: the root mean square of each sensor in a noise-free realisation, times the ratio.
void set_noise(const study::Study& study, unsigned seed, Bench& bench) {
  const auto& plan = *study.experiment;
  auto& rig = bench.rig;
  const auto p = static_cast<Eigen::Index>(rig.outputs.size());
  const auto q = static_cast<Eigen::Index>(rig.inputs.size());
  if (plan.noise > 0.0) rig.sensor_noise = Eigen::VectorXd::Constant(p, plan.noise);
  if (plan.process_noise > 0.0)
    rig.process_noise = Eigen::VectorXd::Constant(q, plan.process_noise);
  if (plan.noise_ratio > 0.0) {
    auto quiet = rig;
    quiet.process_noise.resize(0);
    Draw draw(seed);
    const auto data = first_realisation(quiet, bench, draw);
    Eigen::VectorXd power = Eigen::VectorXd::Zero(p);
    double samples = 0.0;
    for (const auto& record : data.records) {
      power += record.outputs.colwise().squaredNorm().transpose();
      samples += static_cast<double>(record.outputs.rows());
    }
    rig.sensor_noise = plan.noise_ratio * (power / samples).cwiseSqrt();
  }
  if (plan.quantisation > 0.0) rig.quantisation = Eigen::VectorXd::Constant(p, plan.quantisation);
}

// Signals of a file instead of drawn ones.
void set_excitation_of_file(const study::Study& study, Bench& bench) {
  const auto& path = study.experiment->excitation;
  if (path.empty()) return;
  io::TimeOptions options;
  options.actuator_names = study::names_of(study.actuators);
  options.sample_time_s = bench.rig.sample_time_s;
  bench.excitation = io::read_time(path, options).data;
  const auto per_volt = study.design ? study.design->force_per_volt : std::nullopt;
  for (std::size_t j = 0; per_volt && j < bench.excitation.inputs.size(); ++j) {
    auto& input = bench.excitation.inputs[j];
    if (input.unit == "N") continue;
    for (auto& record : bench.excitation.records) {
      record.inputs.col(static_cast<Eigen::Index>(j)) *= *per_volt;
    }
    input.unit = "N";
  }
  bench.plan.multisine.period = bench.excitation.records.front().inputs.rows();
}

// A spring follows the displacement at its place, and pushes back along it.
void set_spring(const study::Study& study, Bench& bench) {
  const auto& plan = *study.experiment;
  if (plan.cubic_stiffness == 0.0) return;
  const recordings::CubicSpring spring{.stiffness = plan.cubic_stiffness,
                                       .output = place_of(study.sensors, plan.cubic_sensor),
                                       .input = place_of(study.actuators, plan.cubic_actuator)};
  const auto& sensor = study.sensors[static_cast<std::size_t>(spring.output)];
  const auto& actuator = study.actuators[static_cast<std::size_t>(spring.input)];
  require(kind_of(sensor) == modal::FrfKind::receptance,
          fmt::format("experiment.cubic_spring: its force follows a displacement, and \"{}\" "
                      "measures {}; expected a sensor of displacement",
                      sensor.name, sensor.quantity));
  require(sensor.direction.dot(actuator.direction) > 1.0 - 1e-6,
          fmt::format("experiment.cubic_spring: \"{}\" and \"{}\" do not point in one direction; "
                      "expected a pair that does",
                      sensor.name, actuator.name));
  bench.rig.spring = spring;
}

// Advises the warm-up that leaves less than a tenth of a deviation.
void advise(const study::ExperimentPlan& plan, recordings::FrfEstimate& estimate) {
  const auto& seen = estimate.transient;
  if (seen.remaining <= 0.1) return;
  const double more = std::ceil(std::log(10.0 * seen.remaining) / -std::log(seen.decay));
  estimate.notes.push_back(fmt::format(
      "experiment.warm_up = {:.0f} would leave less of the transient than a tenth of a deviation",
      plan.warm_up + static_cast<double>(estimate.dropped) + more));
}

}  // namespace

Bench bench_of(const study::Study& study, stage::Work& work) {
  require(study.experiment.has_value(),
          "the study has no [experiment]; expected one, such as [experiment] noise = \"2 nm\"");
  require(!study.sensors.empty() && !study.actuators.empty(),
          "an experiment needs a sensor and an actuator or more");
  const auto& plan = *study.experiment;
  require(!plan.leaves_time || !stage::has_paths(study),
          "experiment.leaves: recordings pass through no gain, delay or low_pass of a channel; "
          "expected leaves = \"frf\", or channels without them");
  Bench bench;
  auto& rig = bench.rig;
  rig.sample_time_s = 1.0 / plan.sample_rate_hz;
  rig.delay_s = plan.delay;
  rig.outputs = channels_of(study.sensors, true);
  rig.inputs = channels_of(study.actuators, false);
  set_excitation(plan, bench);
  set_excitation_of_file(study, bench);
  set_spring(study, bench);
  set_structure(study, work, bench);
  recordings::check(rig);
  set_noise(study, work.seed(), bench);
  return bench;
}

modal::FrfSet simulated_responses(const study::Study& study, const stage::Solution& solution,
                                  const Eigen::VectorXd& frequency_hz) {
  require(!study.sensors.empty() && !study.actuators.empty(),
          study.file.string() + ": responses need a sensor and an actuator");
  modal::FrfSet set;
  set.outputs = channels_of(study.sensors, true);
  set.inputs = channels_of(study.actuators, false);
  const auto place = [](const std::vector<mesh::Site>& sites, auto& channels) {
    for (std::size_t i = 0; i < channels.size(); ++i) channels[i].position = sites[i].position;
  };
  place(solution.model.sensors, set.outputs);
  place(solution.model.actuators, set.inputs);
  set.frequency_hz = frequency_hz;
  const auto model = stage::at_channels(study, solution);
  set.value.assign(static_cast<std::size_t>(frequency_hz.size()),
                   Eigen::MatrixXcd(set.output_count(), set.input_count()));
  for (const auto kind :
       {modal::FrfKind::receptance, modal::FrfKind::mobility, modal::FrfKind::accelerance}) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < set.output_count(); ++i) {
      if (set.outputs[static_cast<std::size_t>(i)].kind == kind) rows.push_back(i);
    }
    if (rows.empty()) continue;
    const auto frf = modal::frf(model, frequency_hz, kind);
    for (std::size_t k = 0; k < set.value.size(); ++k) {
      set.value[k](rows, Eigen::all) = frf.value[k](rows, Eigen::all);
    }
  }
  modal::check(set);
  return stage::recorded(study, std::move(set));
}

Simulated simulated(const study::Study& study, const Bench& bench, stage::Work& work) {
  using namespace identification;
  using namespace recordings;
  const auto& plan = *study.experiment;
  Draw draw(work.seed());
  Simulated result;
  Spectra all;
  const auto progress = work.progress();
  const auto sets = parts_of(bench.excitation);
  const int count = sets.empty() ? plan.realisations : static_cast<int>(sets.size());
  for (int r = 0; r < count; ++r) {
    tell(progress, "shaking", static_cast<double>(r) / count);
    auto data = sets.empty() ? realisation(bench.rig, bench.plan, r, draw, &result.crest_factor)
                             : played(bench.rig, sets[static_cast<std::size_t>(r)], plan.periods,
                                      plan.warm_up, draw, &result.crest_factor);
    const auto& sine = bench.plan.multisine;
    append(all, spectra(data, sine.low_hz, sine.high_hz));
    if (!plan.leaves_time) continue;
    auto& records = result.recordings.records;
    if (r == 0) {
      result.recordings = std::move(data);
    } else {
      std::move(data.records.begin(), data.records.end(), std::back_inserter(records));
    }
  }
  tell(progress, "estimating");
  result.estimate = bench.rig.controller ? closed_loop_estimate(all).estimate : frf_estimate(all);
  work.clear_progress();
  advise(plan, result.estimate);
  auto& set = result.estimate.set;
  const auto seen = phase_delay(without_delay(set, 0.0, bench.rig.sample_time_s),
                                plan.delay + 10.0 * bench.rig.sample_time_s);
  result.phase_delay_s = seen.delay_s;
  result.phase_delay_std_s = seen.std_s;
  if (plan.compensate != "none") {
    set = without_delay(set, plan.compensate == "all" ? bench.rig.delay_s : 0.0,
                        bench.rig.sample_time_s);
  }
  set = stage::recorded(study, std::move(set));
  return result;
}

}  // namespace chladni::steps
