#include "recordings/hammer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "recordings/constants.h"
#include "recordings/estimate/line_variance.h"
#include "recordings/fft.h"
#include "recordings/frf_estimate.h"

namespace chladni::recordings {
namespace {

// 1 until the window's end, then half a cosine down to 0.
Eigen::VectorXd force_window(const Eigen::VectorXd& force, double length_s, double sample_time) {
  Eigen::VectorXd window = Eigen::VectorXd::Ones(force.size());
  if (length_s <= 0.0) return window;
  Eigen::Index peak = 0;
  force.cwiseAbs().maxCoeff(&peak);
  const double length = length_s / sample_time;
  for (Eigen::Index n = 0; n < force.size(); ++n) {
    const double after = (static_cast<double>(n - peak) - length) / (0.25 * length);
    if (after > 0.0) {
      window(n) = after < 1.0 ? 0.5 + 0.5 * std::cos(std::numbers::pi * after) : 0.0;
    }
  }
  return window;
}

struct Lines {
  std::vector<Eigen::Index> index;
  Eigen::VectorXd hz;
};

Lines lines_of(const Recordings& recordings, const HammerOptions& options) {
  const auto samples = recordings.records.front().samples;
  const double step = 1.0 / (static_cast<double>(samples) * recordings.head.sample_time_s);
  Lines lines;
  for (Eigen::Index k = 0; 2 * k <= samples; ++k) {
    const double hz = static_cast<double>(k) * step;
    if (hz >= options.low_hz && (options.high_hz <= 0.0 || hz <= options.high_hz)) {
      lines.index.push_back(k);
    }
  }
  require(!lines.index.empty(), "hammer: no line in the band");
  lines.hz.resize(static_cast<Eigen::Index>(lines.index.size()));
  for (Eigen::Index k = 0; k < lines.hz.size(); ++k) {
    lines.hz(k) = static_cast<double>(lines.index[static_cast<std::size_t>(k)]) * step;
  }
  return lines;
}

/// The samples of a record: the force on one input, and the responses.
struct Blow {
  Eigen::VectorXd force;
  Eigen::MatrixXd outputs;
};

Blow blow_of(const Recordings& recordings, std::size_t record, Eigen::Index input) {
  const auto samples = recordings.records[record].samples;
  Blow blow{recordings.samples(record, Side::inputs, input, 0, samples),
            Eigen::MatrixXd(samples, std::ssize(recordings.head.outputs))};
  for (Eigen::Index i = 0; i < blow.outputs.cols(); ++i) {
    blow.outputs.col(i) = recordings.samples(record, Side::outputs, i, 0, samples);
  }
  return blow;
}

void look_at(const Blow& blow, const Eigen::VectorXd& window, const std::string& name,
             bool windowed, std::vector<std::string>& notes) {
  const Eigen::VectorXd force = blow.force.cwiseAbs();
  const double peak = force.maxCoeff();
  const Eigen::VectorXd outside = (1.0 - window.array()) * force.array();
  if (outside.maxCoeff() > Constants::double_hit * peak) {
    notes.push_back(name + ": a second hit, or noise, of " +
                    fmt::format("{:.6g}", 100.0 * outside.maxCoeff() / peak) +
                    " % of the peak outside the force window");
  }
  if (windowed) return;
  const auto end = std::max<Eigen::Index>(1, blow.outputs.rows() / 20);
  for (Eigen::Index i = 0; i < blow.outputs.cols(); ++i) {
    const Eigen::VectorXd y = blow.outputs.col(i).cwiseAbs();
    if (y.tail(end).maxCoeff() > Constants::at_rest * y.maxCoeff()) {
      notes.push_back(name + ": output " + fmt::to_string(i + 1) +
                      " does not end at rest; expected a longer record or an exponential window");
      return;
    }
  }
}

// Sums over the hits of one input.
struct Sums {
  Eigen::VectorXd force;     // K
  Eigen::MatrixXd response;  // K×p
  Eigen::MatrixXcd cross;    // K×p, conj(F) Y
  double hits = 0.0;
};

Sums sums_of(const Recordings& recordings, Eigen::Index input, const Lines& lines,
             const HammerOptions& options, std::vector<std::string>& notes) {
  const auto& data = recordings.head;
  const auto p = static_cast<Eigen::Index>(data.outputs.size());
  const auto k = lines.hz.size();
  Sums sums{Eigen::VectorXd::Zero(k), Eigen::MatrixXd::Zero(k, p), Eigen::MatrixXcd::Zero(k, p)};
  const auto samples = recordings.records.front().samples;
  Eigen::VectorXd fade = Eigen::VectorXd::Ones(samples);
  if (options.exponential_s > 0.0) {
    for (Eigen::Index n = 0; n < samples; ++n) {
      fade(n) = std::exp(-static_cast<double>(n) * data.sample_time_s / options.exponential_s);
    }
  }
  for (std::size_t i = 0; i < recordings.records.size(); ++i) {
    if (recordings.records[i].experiment != input) continue;
    const auto blow = blow_of(recordings, i, input);
    const auto window = force_window(blow.force, options.force_window_s, data.sample_time_s);
    look_at(blow, window, "record " + fmt::to_string(i + 1), options.exponential_s > 0.0, notes);
    const Eigen::VectorXcd f =
        fourier(blow.force.cwiseProduct(window).cwiseProduct(fade))(lines.index, 0);
    const Eigen::MatrixXcd y = fourier(fade.asDiagonal() * blow.outputs)(lines.index, Eigen::all);
    sums.force += f.cwiseAbs2();
    sums.response += y.cwiseAbs2();
    sums.cross += f.conjugate().asDiagonal() * y;
    sums.hits += 1.0;
  }
  require(sums.hits > 0.0, "hammer: no record hits input \"" +
                               data.inputs[static_cast<std::size_t>(input)].name + "\"");
  require(sums.force.minCoeff() > 0.0, "hammer: a line has no force on input \"" +
                                           data.inputs[static_cast<std::size_t>(input)].name +
                                           "\"; expected a narrower band");
  return sums;
}

modal::FrfSet empty_set(const TimeData& data, const Lines& lines, bool variance) {
  modal::FrfSet set;
  set.outputs = data.outputs;
  set.inputs = data.inputs;
  set.frequency_hz = lines.hz;
  const auto count = lines.index.size();
  const auto p = set.output_count();
  const auto q = set.input_count();
  set.value.assign(count, Eigen::MatrixXcd::Zero(p, q));
  set.coherence.assign(count, Eigen::MatrixXd::Zero(p, q));
  if (variance) set.variance.assign(count, Eigen::MatrixXd::Zero(p, q));
  return set;
}

// K×p: power that the force does not explain, S_yy − |S_fy|²/S_ff, averaged over ±half lines, where
// noise of the force grows with |S_fy/S_ff|².
Eigen::MatrixXd unexplained(const Sums& sums, Eigen::Index half) {
  const Eigen::MatrixXd power =
      (sums.response - sums.force.cwiseInverse().asDiagonal() * sums.cross.cwiseAbs2())
          .cwiseMax(0.0);
  Eigen::MatrixXd result(power.rows(), power.cols());
  for (Eigen::Index i = 0; i < power.cols(); ++i) {
    result.col(i) =
        averaged_variances(power.col(i), sums.cross.col(i).cwiseQuotient(sums.force).cwiseAbs2(),
                           half, std::max(1.0, sums.hits - 1.0));
  }
  return result;
}

// One column of H1, or of H2 (`second`). @param noise  K×p: power that the force does not explain
void fill(const Sums& sums, const Eigen::MatrixXd& noise, Eigen::Index input, modal::FrfSet& set,
          bool second) {
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    const auto line = static_cast<Eigen::Index>(k);
    for (Eigen::Index i = 0; i < set.output_count(); ++i) {
      const auto cross = sums.cross(line, i);
      const double power = sums.response(line, i);
      const auto h1 = cross / sums.force(line);
      const double coherence =
          power > 0.0 ? std::min(1.0, std::norm(cross) / (sums.force(line) * power)) : 0.0;
      const auto value = second && coherence > 0.0 ? h1 / coherence : h1;
      set.value[k](i, input) = value;
      set.coherence[k](i, input) = coherence;
      if (set.variance.empty()) continue;
      const double turned = second && coherence > 0.0 ? 1.0 / (coherence * coherence) : 1.0;
      set.variance[k](i, input) = turned * noise(line, i) / (sums.force(line) * (sums.hits - 1.0));
    }
  }
}

}  // namespace

HammerEstimate hammer_estimate(const TimeData& data, const HammerOptions& options) {
  check(data);
  return hammer_estimate(recordings_of(data), options);
}

HammerEstimate hammer_estimate(const Recordings& recordings, const HammerOptions& options) {
  const auto& data = recordings.head;
  const auto missing = missing_side(data);
  require(missing.empty(), "hammer: " + missing);
  require(!recordings.records.empty(), "hammer: no record; expected one or more");
  for (const auto& record : recordings.records) {
    require(record.samples == recordings.records.front().samples,
            "hammer: records of unequal length");
    require(record.experiment < static_cast<int>(data.inputs.size()),
            "hammer: a record hits input " + fmt::to_string(record.experiment + 1) + " of " +
                fmt::to_string(data.inputs.size()));
  }
  const auto lines = lines_of(recordings, options);
  HammerEstimate result;
  std::vector<Sums> all;
  double fewest = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(data.inputs.size()); ++j) {
    all.push_back(sums_of(recordings, j, lines, options, result.notes));
    fewest = std::min(fewest, all.back().hits);
  }
  result.h1 = empty_set(data, lines, fewest > 1.0);
  result.h2 = result.h1;
  const auto half = lines_for_freedom(static_cast<Eigen::Index>(fewest) - 1);
  if (half > 0) {
    result.notes.push_back("variances are averaged over " + fmt::to_string(2 * half + 1) +
                           " lines");
  }
  for (std::size_t j = 0; j < all.size(); ++j) {
    const auto noise = unexplained(all[j], half);
    fill(all[j], noise, static_cast<Eigen::Index>(j), result.h1, false);
    fill(all[j], noise, static_cast<Eigen::Index>(j), result.h2, true);
  }
  result.h1.averages = result.h2.averages = (fewest - 1.0) * static_cast<double>(2 * half + 1);
  if (fewest < 2.0) {
    result.notes.emplace_back("one hit only: coherence is 1 and nothing tells the variance");
  }
  if (options.exponential_s > 0.0) result.added_decay = 1.0 / options.exponential_s;
  return result;
}

Eigen::VectorXcd true_poles(const Eigen::VectorXcd& fitted, double added_decay) {
  const Eigen::VectorXcd result = fitted.array() + added_decay;
  for (const auto& pole : result) {
    require(pole.real() < 0.0,
            "hammer: a pole decays by " + fmt::format("{:.6g}", added_decay - pole.real()) +
                " /s, less than the window adds: " + fmt::format("{:.6g}", added_decay) + " /s");
  }
  return result;
}

}  // namespace chladni::recordings
