#include "recordings/estimate/transfer.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"

namespace chladni::recordings {
namespace {

using Realisation = std::vector<const Spectra::Record*>;

std::vector<Realisation> realisations(const Spectra& spectra) {
  std::map<int, Realisation> groups;
  for (const auto& record : spectra.records) groups[record.realisation].push_back(&record);
  std::vector<Realisation> result;
  for (auto& [number, group] : groups) {
    std::stable_sort(group.begin(), group.end(),
                     [](const auto* a, const auto* b) { return a->experiment < b->experiment; });
    result.push_back(std::move(group));
  }
  return result;
}

const std::vector<Eigen::MatrixXcd>& side_of(const Spectra::Record& record, Side side) {
  if (side == Side::outputs) return record.outputs;
  return side == Side::inputs ? record.inputs : record.references;
}

// One period of the chosen channels on line k: channels×experiments.
Eigen::MatrixXcd period_of(const Realisation& group, const std::vector<ChannelChoice>& channels,
                           std::size_t period, Eigen::Index k) {
  Eigen::MatrixXcd result(static_cast<Eigen::Index>(channels.size()),
                          static_cast<Eigen::Index>(group.size()));
  for (std::size_t e = 0; e < group.size(); ++e) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(e)) =
          side_of(*group[e], channels[i].side)[period](k, channels[i].column);
    }
  }
  return result;
}

struct Range {
  std::size_t first, last;  // periods used: first to last − 1
  [[nodiscard]] double count() const { return static_cast<double>(last - first); }
};

Range periods_of(const Spectra& spectra, const TransferPlan& plan) {
  std::size_t last = spectra.records.front().outputs.size();
  for (const auto& record : spectra.records) last = std::min(last, record.outputs.size());
  const auto first = static_cast<std::size_t>(std::max<Eigen::Index>(0, plan.drop));
  require(first < last, "FRF estimate: " + fmt::to_string(last) + " periods, of which " +
                            fmt::to_string(first) + " are to be dropped; expected one to be left");
  return {first, last};
}

Eigen::MatrixXcd mean_of(const Realisation& group, const std::vector<ChannelChoice>& channels,
                         Range periods, Eigen::Index k) {
  Eigen::MatrixXcd sum = period_of(group, channels, periods.first, k);
  for (auto p = periods.first + 1; p < periods.last; ++p) sum += period_of(group, channels, p, k);
  return sum / periods.count();
}

struct OneRealisation {
  Eigen::MatrixXcd value;    // t×f
  Eigen::MatrixXcd inverse;  // E×f: U⁻¹, or its least-squares inverse
};

OneRealisation estimate(const Spectra& spectra, const Realisation& group, const TransferPlan& plan,
                        Range periods, Eigen::Index k) {
  const Eigen::MatrixXcd in = mean_of(group, plan.from, periods, k);
  const Eigen::VectorXd size = in.rowwise().norm();
  const auto place = [&] {
    return "FRF estimate: at " + fmt::to_string(spectra.hz(static_cast<std::size_t>(k))) +
           " Hz of realisation " + fmt::to_string(group.front()->realisation + 1);
  };
  require(size.minCoeff() > 0.0, place() + " a channel is not excited");
  const Eigen::MatrixXcd scaled = size.cwiseInverse().asDiagonal() * in;
  const Eigen::PartialPivLU<Eigen::MatrixXcd> gram(scaled * scaled.adjoint());
  require(gram.rcond() > 1e-12, place() +
                                    " the excited channels cannot be told apart; expected "
                                    "as many independent experiments as channels");
  OneRealisation result;
  result.inverse = scaled.adjoint() * gram.inverse() * size.cwiseInverse().asDiagonal();
  result.value = mean_of(group, plan.to, periods, k) * result.inverse;
  return result;
}

void check_repetition(const Spectra& spectra, const std::vector<Realisation>& groups,
                      const TransferPlan& plan, Range periods) {
  for (const auto& group : groups) {
    require(group.size() >= plan.from.size(),
            "FRF estimate: realisation " + fmt::to_string(group.front()->realisation + 1) +
                " has " + fmt::to_string(group.size()) + " experiments; expected " +
                fmt::to_string(plan.from.size()) + ", one for each excited channel");
    if (periods.last - periods.first < 2) continue;
    double change = 0.0;
    double size = 0.0;
    for (Eigen::Index k = 0; k < spectra.line_count(); ++k) {
      const auto first = period_of(group, plan.from, periods.first, k);
      change += (period_of(group, plan.from, periods.first + 1, k) - first).squaredNorm();
      size += first.squaredNorm();
    }
    require(change < 0.25 * size, "FRF estimate: the excitation of realisation " +
                                      fmt::to_string(group.front()->realisation + 1) +
                                      " does not repeat with a period of " +
                                      fmt::to_string(spectra.period) + " samples");
  }
}

}  // namespace

Transfer transfer(const Spectra& spectra, const TransferPlan& plan) {
  require(!spectra.records.empty(), "FRF estimate: no record");
  require(!plan.from.empty() && !plan.to.empty(), "FRF estimate: no inputs, or no outputs");
  const auto groups = realisations(spectra);
  const auto periods = periods_of(spectra, plan);
  check_repetition(spectra, groups, plan, periods);
  Transfer result{.value = {},
                  .periods = static_cast<Eigen::Index>(periods.last - periods.first),
                  .realisations = static_cast<Eigen::Index>(groups.size())};
  for (Eigen::Index k = 0; k < spectra.line_count(); ++k) {
    Eigen::MatrixXcd sum = estimate(spectra, groups.front(), plan, periods, k).value;
    for (std::size_t r = 1; r < groups.size(); ++r) {
      sum += estimate(spectra, groups[r], plan, periods, k).value;
    }
    result.value.push_back(sum / static_cast<double>(groups.size()));
  }
  return result;
}

TransferVariances variances(const Spectra& spectra, const TransferPlan& plan, const Transfer& mean,
                            const Projection& projection) {
  const auto groups = realisations(spectra);
  const auto periods = periods_of(spectra, plan);
  const double p = periods.count();
  const auto r = static_cast<double>(groups.size());
  TransferVariances result;
  result.total_freedom = static_cast<Eigen::Index>(groups.size()) - 1;
  result.noise_freedom = static_cast<Eigen::Index>(r * (p - 1.0));
  for (Eigen::Index k = 0; k < spectra.line_count(); ++k) {
    const auto line = static_cast<std::size_t>(k);
    const auto shown = projection(line, mean.value[line]);
    Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(shown.rows(), shown.cols());
    Eigen::MatrixXd total = noise;
    for (const auto& group : groups) {
      const auto one = estimate(spectra, group, plan, periods, k);
      total += projection(line, one.value - mean.value[line]).cwiseAbs2();
      const auto to = mean_of(group, plan.to, periods, k);
      const auto from = mean_of(group, plan.from, periods, k);
      for (auto period = periods.first; period < periods.last; ++period) {
        const Eigen::MatrixXcd deviation =
            (period_of(group, plan.to, period, k) - to -
             one.value * (period_of(group, plan.from, period, k) - from)) *
            one.inverse;
        noise += projection(line, deviation).cwiseAbs2();
      }
    }
    if (p > 1.0) result.noise.emplace_back(noise / (p * (p - 1.0) * r * r));
    if (r > 1.0) result.total.emplace_back(total / (r * (r - 1.0)));
  }
  if (result.total.empty()) {
    result.total = result.noise;
    result.total_freedom = result.noise_freedom;
  }
  return result;
}

}  // namespace chladni::recordings
