// Experiments in periods, and the realisations of a virtual laboratory.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"
#include "recordings/laboratory/rate_path.h"
#include "recordings/virtual_experiment.h"

namespace chladni::recordings {
namespace {

TimeData empty_data(const VirtualRig& rig, Eigen::Index period) {
  TimeData data{.outputs = rig.outputs,
                .inputs = rig.inputs,
                .references = {},
                .sample_time_s = rig.sample_time_s,
                .period = period,
                .records = {}};
  if (rig.controller) {
    data.references = rig.inputs;
    for (auto& channel : data.references) channel.name = "r_" + channel.name;
  }
  return data;
}

// One experiment: `inputs` is one period.
Record periodic_record(const VirtualRig& rig, const Eigen::MatrixXd& inputs, Eigen::Index periods,
                       Eigen::Index warm_up, Draw& draw) {
  throw_if_interrupted();
  const auto period = inputs.rows();
  require(period >= 1, "virtual experiment: the excitation has no sample");
  const auto kept = periods * period;
  const auto first = warm_up * period;
  // Rates look ahead, so the rig goes on a little after the last sample that is kept.
  const auto ahead = rig.plant.rates ? kRateAhead : 0;
  const Eigen::MatrixXd command =
      inputs.replicate(warm_up + periods + (ahead + period - 1) / period, 1)
          .topRows(first + kept + ahead);
  Record record = recorded(rig, command, draw);
  record.outputs = Eigen::MatrixXd(record.outputs.middleRows(first, kept));
  record.inputs = Eigen::MatrixXd(record.inputs.middleRows(first, kept));
  record.references =
      rig.controller ? Eigen::MatrixXd(command.middleRows(first, kept)) : Eigen::MatrixXd(kept, 0);
  return record;
}

}  // namespace

TimeData realisation(const VirtualRig& rig, const VirtualExperimentPlan& plan, int number,
                     Draw& draw, double* crest_factor) {
  require(plan.periods >= 1 && plan.warm_up >= 0,
          "virtual experiment: the number of periods is not positive");
  const auto set =
      experiments(plan.multisine, static_cast<Eigen::Index>(rig.inputs.size()), plan.scheme, draw);
  if (crest_factor != nullptr) *crest_factor = std::max(*crest_factor, set.crest_factor);
  auto data = empty_data(rig, plan.multisine.period);
  int experiment = 0;
  for (const auto& inputs : set.inputs) {
    auto record = periodic_record(rig, inputs, plan.periods, plan.warm_up, draw);
    record.experiment = experiment++;
    record.realisation = number;
    data.records.push_back(std::move(record));
  }
  return data;
}

TimeData played(const VirtualRig& rig, const TimeData& excitation, Eigen::Index periods,
                Eigen::Index warm_up, Draw& draw, double* crest_factor) {
  require(std::abs(excitation.sample_time_s / rig.sample_time_s - 1.0) < 1e-6,
          "virtual experiment: the excitation is sampled at " +
              fmt::format("{:.6g}", 1.0 / excitation.sample_time_s) + " Hz, and the rig at " +
              fmt::format("{:.6g}", 1.0 / rig.sample_time_s) + " Hz");
  std::vector<Eigen::Index> columns;
  for (const auto& input : rig.inputs) {
    const auto found =
        std::ranges::find(excitation.inputs, input.name, &modal::MeasuredChannel::name);
    require(found != excitation.inputs.end(),
            "virtual experiment: the excitation has no input \"" + input.name + "\"");
    columns.push_back(found - excitation.inputs.begin());
  }
  require(!excitation.records.empty(), "virtual experiment: the excitation has no record");
  auto data = empty_data(rig, excitation.records.front().inputs.rows());
  for (const auto& one : excitation.records) {
    require(one.inputs.rows() == data.period,
            "virtual experiment: records of the excitation differ in length; expected one period");
    const Eigen::MatrixXd inputs = one.inputs(Eigen::all, columns);
    if (crest_factor != nullptr) {
      for (const auto& column : inputs.colwise()) {
        *crest_factor = std::max(*crest_factor, recordings::crest_factor(column));
      }
    }
    auto record = periodic_record(rig, inputs, periods, warm_up, draw);
    record.experiment = one.experiment;
    record.realisation = one.realisation;
    data.records.push_back(std::move(record));
  }
  return data;
}

TimeData virtual_experiment(const VirtualRig& rig, const VirtualExperimentPlan& plan,
                            int realisations, unsigned seed, const Progress& progress) {
  check(rig);
  require(realisations >= 1, "virtual experiment: no realisations");
  Draw draw(seed);
  TimeData all;
  for (int r = 0; r < realisations; ++r) {
    tell(progress, "shaking", static_cast<double>(r) / realisations);
    auto one = realisation(rig, plan, r, draw);
    if (r == 0) {
      all = std::move(one);
      continue;
    }
    for (auto& record : one.records) all.records.push_back(std::move(record));
  }
  return all;
}

}  // namespace chladni::recordings
