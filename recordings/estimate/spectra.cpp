#include "recordings/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "base/error.h"
#include "recordings/fft.h"

namespace chladni::recordings {
namespace {

std::vector<Eigen::MatrixXcd> by_period(const Eigen::MatrixXd& samples, Eigen::Index period,
                                        const std::vector<Eigen::Index>& lines) {
  std::vector<Eigen::MatrixXcd> result;
  for (Eigen::Index at = 0; at < samples.rows(); at += period) {
    if (samples.cols() == 0) {
      result.emplace_back(static_cast<Eigen::Index>(lines.size()), 0);
      continue;
    }
    result.emplace_back(fourier(samples.middleRows(at, period))(lines, Eigen::all));
  }
  return result;
}

Spectra without_records(const Spectra& spectra) {
  return {.outputs = spectra.outputs,
          .inputs = spectra.inputs,
          .references = spectra.references,
          .sample_time_s = spectra.sample_time_s,
          .period = spectra.period,
          .line = spectra.line,
          .records = {},
          .cleaned_periods = spectra.cleaned_periods};
}

bool same_names(const std::vector<modal::MeasuredChannel>& a,
                const std::vector<modal::MeasuredChannel>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.name == y.name; });
}

}  // namespace

void check_periods(const TimeData& data) {
  std::vector<Eigen::Index> samples;
  for (const auto& record : data.records) samples.push_back(record.outputs.rows());
  check_periods(data, samples);
}

void check_periods(const TimeData& head, const std::vector<Eigen::Index>& samples) {
  require(head.period >= 4,
          "time data: no period is stated; expected the samples of the periodic excitation (hammer "
          "data are estimated with H1 or H2)");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto count = samples[i];
    require(
        count >= head.period && count % head.period == 0,
        "time data: record " + fmt::to_string(i + 1) + " has " + fmt::to_string(count) +
            " samples, " +
            fmt::format("{:.6g}", static_cast<double>(count) / static_cast<double>(head.period)) +
            " periods of " + fmt::to_string(head.period) + "; expected a whole number of periods");
  }
}

SpectraSource source_of(const Spectra& spectra) {
  SpectraSource source{.head = without_records(spectra), .records = {}, .period = {}};
  for (const auto& record : spectra.records) {
    source.records.push_back({record.experiment, record.realisation, record.outputs.size()});
  }
  source.period = [&spectra](std::size_t i, std::size_t p) {
    const auto& record = spectra.records[i];
    return PeriodSpectra{&record.outputs[p], &record.inputs[p], &record.references[p], nullptr};
  };
  return source;
}

Spectra lines_between(const TimeData& data, double low_hz, double high_hz) {
  Spectra result{.outputs = data.outputs,
                 .inputs = data.inputs,
                 .references = data.references,
                 .sample_time_s = data.sample_time_s,
                 .period = data.period,
                 .line = {},
                 .records = {}};
  const double step = 1.0 / (static_cast<double>(data.period) * data.sample_time_s);
  for (Eigen::Index k = 1; 2 * k < data.period; ++k) {
    const double hz = static_cast<double>(k) * step;
    if (hz < low_hz - 1e-9 * step || (high_hz > 0.0 && hz > high_hz + 1e-9 * step)) continue;
    result.line.push_back(k);
  }
  require(!result.line.empty(), "time data: no line between " + fmt::format("{:.6g}", low_hz) +
                                    " and " + fmt::format("{:.6g}", high_hz) +
                                    " Hz; the lines lie " + fmt::format("{:.6g}", step) +
                                    " Hz apart");
  return result;
}

Spectra spectra(const TimeData& data, double low_hz, double high_hz) {
  check(data);
  check_periods(data);
  auto result = lines_between(data, low_hz, high_hz);
  for (const auto& record : data.records) {
    result.records.push_back({record.experiment, record.realisation,
                              by_period(record.outputs, data.period, result.line),
                              by_period(record.inputs, data.period, result.line),
                              by_period(record.references, data.period, result.line)});
  }
  return result;
}

void append(Spectra& all, Spectra more) {
  if (all.records.empty()) {
    all = std::move(more);
    return;
  }
  require(same_names(all.outputs, more.outputs) && same_names(all.inputs, more.inputs) &&
              same_names(all.references, more.references),
          "spectra: the channels differ from those before");
  require(
      all.period == more.period && all.sample_time_s == more.sample_time_s && all.line == more.line,
      "spectra: period, sampling or lines differ from those before");
  std::move(more.records.begin(), more.records.end(), std::back_inserter(all.records));
}

std::vector<Eigen::Index> excited_lines(const Spectra& spectra) {
  return excited_lines(source_of(spectra));
}

std::vector<Eigen::Index> excited_lines(const SpectraSource& source) {
  const auto& spectra = source.head;
  const bool loop = !spectra.references.empty();
  const auto channels =
      static_cast<Eigen::Index>(loop ? spectra.references.size() : spectra.inputs.size());
  Eigen::MatrixXd power = Eigen::MatrixXd::Zero(spectra.line_count(), channels);
  for (std::size_t i = 0; i < source.records.size(); ++i) {
    const auto last = source.period(i, source.records[i].periods - 1);
    power = power.cwiseMax((loop ? last.references : last.inputs)->cwiseAbs2());
  }
  std::vector<Eigen::Index> places;
  const Eigen::RowVectorXd floor = 1e-6 * power.colwise().maxCoeff();
  for (Eigen::Index k = 0; k < spectra.line_count(); ++k) {
    if (channels > 0 && (power.row(k).array() > floor.array()).all()) places.push_back(k);
  }
  return places;
}

Spectra part(const Spectra& spectra, const std::vector<Eigen::Index>& places) {
  Spectra result = spectra;
  result.line.clear();
  for (const auto k : places) result.line.push_back(spectra.line[static_cast<std::size_t>(k)]);
  for (auto& record : result.records) {
    for (auto* side : {&record.outputs, &record.inputs, &record.references}) {
      for (auto& period : *side) period = Eigen::MatrixXcd(period(places, Eigen::all));
    }
  }
  return result;
}

}  // namespace chladni::recordings
