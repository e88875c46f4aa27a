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

/// The numbers in the source of the records of one realisation, by their experiments.
using Realisation = std::vector<std::size_t>;

std::vector<Realisation> realisations(const SpectraSource& spectra) {
  std::map<int, Realisation> groups;
  for (std::size_t i = 0; i < spectra.records.size(); ++i) {
    groups[spectra.records[i].realisation].push_back(i);
  }
  std::vector<Realisation> result;
  for (auto& [number, group] : groups) {
    std::stable_sort(group.begin(), group.end(), [&](std::size_t a, std::size_t b) {
      return spectra.records[a].experiment < spectra.records[b].experiment;
    });
    result.push_back(std::move(group));
  }
  return result;
}

/// One period of all experiments of a realisation.
class Period {
 public:
  Period(const SpectraSource& spectra, const Realisation& group, std::size_t period) {
    for (const auto i : group) experiments_.push_back(spectra.period(i, period));
  }

  /// The chosen channels on line k: channels×experiments.
  [[nodiscard]] Eigen::MatrixXcd at(Eigen::Index k,
                                    const std::vector<ChannelChoice>& channels) const {
    Eigen::MatrixXcd result(std::ssize(channels), std::ssize(experiments_));
    for (std::size_t e = 0; e < experiments_.size(); ++e) {
      for (std::size_t i = 0; i < channels.size(); ++i) {
        result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(e)) =
            side_of(experiments_[e], channels[i].side)(k, channels[i].column);
      }
    }
    return result;
  }

 private:
  static const Eigen::MatrixXcd& side_of(const PeriodSpectra& experiment, Side side) {
    if (side == Side::outputs) return *experiment.outputs;
    return side == Side::inputs ? *experiment.inputs : *experiment.references;
  }

  std::vector<PeriodSpectra> experiments_;
};

struct Range {
  std::size_t first, last;  // periods used: first to last − 1
  [[nodiscard]] double count() const { return static_cast<double>(last - first); }
};

Range periods_of(const SpectraSource& spectra, const TransferPlan& plan) {
  std::size_t last = spectra.records.front().periods;
  for (const auto& record : spectra.records) last = std::min(last, record.periods);
  const auto first = static_cast<std::size_t>(std::max<Eigen::Index>(0, plan.drop));
  require(first < last, "FRF estimate: " + fmt::to_string(last) + " periods, of which " +
                            fmt::to_string(first) + " are to be dropped; expected one to be left");
  return {first, last};
}

std::string number_of(const SpectraSource& spectra, const Realisation& group) {
  return "realisation " + fmt::to_string(spectra.records[group.front()].realisation + 1);
}

/// Means over the periods of a realisation, on each line: channels×experiments.
struct Means {
  std::vector<Eigen::MatrixXcd> to, from;
};

Means means_of(const SpectraSource& spectra, const Realisation& group, const TransferPlan& plan,
               Range periods) {
  const auto lines = static_cast<std::size_t>(spectra.head.line_count());
  Means means{std::vector<Eigen::MatrixXcd>(lines), std::vector<Eigen::MatrixXcd>(lines)};
  double change = 0.0;
  double size = 0.0;
  for (auto p = periods.first; p < periods.last; ++p) {
    const Period period(spectra, group, p);
    for (std::size_t line = 0; line < lines; ++line) {
      const auto k = static_cast<Eigen::Index>(line);
      Eigen::MatrixXcd to = period.at(k, plan.to);
      Eigen::MatrixXcd from = period.at(k, plan.from);
      if (p == periods.first) {
        means.to[line] = std::move(to);
        means.from[line] = std::move(from);
        continue;
      }
      if (p == periods.first + 1) {
        change += (from - means.from[line]).squaredNorm();
        size += means.from[line].squaredNorm();
      }
      means.to[line] += to;
      means.from[line] += from;
    }
  }
  require(periods.last - periods.first < 2 || change < 0.25 * size,
          "FRF estimate: the excitation of " + number_of(spectra, group) +
              " does not repeat with a period of " + fmt::to_string(spectra.head.period) +
              " samples");
  for (auto* side : {&means.to, &means.from}) {
    for (auto& mean : *side) mean = Eigen::MatrixXcd(mean / periods.count());
  }
  return means;
}

struct OneRealisation {
  Eigen::MatrixXcd value;    // t×f
  Eigen::MatrixXcd inverse;  // E×f: U⁻¹, or its least-squares inverse
};

OneRealisation estimate(const SpectraSource& spectra, const Realisation& group, const Means& means,
                        std::size_t line) {
  const auto& in = means.from[line];
  const Eigen::VectorXd size = in.rowwise().norm();
  const auto place = [&] {
    return "FRF estimate: at " + fmt::to_string(spectra.head.hz(line)) + " Hz of " +
           number_of(spectra, group);
  };
  require(size.minCoeff() > 0.0, place() + " a channel is not excited");
  const Eigen::MatrixXcd scaled = size.cwiseInverse().asDiagonal() * in;
  const Eigen::PartialPivLU<Eigen::MatrixXcd> gram(scaled * scaled.adjoint());
  require(gram.rcond() > 1e-12, place() +
                                    " the excited channels cannot be told apart; expected "
                                    "as many independent experiments as channels");
  OneRealisation result;
  result.inverse = scaled.adjoint() * gram.inverse() * size.cwiseInverse().asDiagonal();
  result.value = means.to[line] * result.inverse;
  return result;
}

void check_experiments(const SpectraSource& spectra, const std::vector<Realisation>& groups,
                       const TransferPlan& plan) {
  for (const auto& group : groups) {
    require(group.size() >= plan.from.size(),
            "FRF estimate: " + number_of(spectra, group) + " has " + fmt::to_string(group.size()) +
                " experiments; expected " + fmt::to_string(plan.from.size()) +
                ", one for each excited channel");
  }
}

}  // namespace

Transfer transfer(const SpectraSource& spectra, const TransferPlan& plan) {
  require(!spectra.records.empty(), "FRF estimate: no record");
  require(!plan.from.empty() && !plan.to.empty(), "FRF estimate: no inputs, or no outputs");
  const auto groups = realisations(spectra);
  const auto periods = periods_of(spectra, plan);
  check_experiments(spectra, groups, plan);
  Transfer result{.value = {},
                  .periods = static_cast<Eigen::Index>(periods.last - periods.first),
                  .realisations = static_cast<Eigen::Index>(groups.size())};
  for (const auto& group : groups) {
    const auto means = means_of(spectra, group, plan, periods);
    for (std::size_t line = 0; line < means.to.size(); ++line) {
      auto value = estimate(spectra, group, means, line).value;
      if (&group == &groups.front()) {
        result.value.push_back(std::move(value));
      } else {
        result.value[line] += value;
      }
    }
  }
  for (auto& value : result.value) {
    value = Eigen::MatrixXcd(value / static_cast<double>(groups.size()));
  }
  return result;
}

namespace {

/// Sums over realisations on each line.
struct VarianceSums {
  std::vector<Eigen::MatrixXd> noise, total;
};

void add(const SpectraSource& spectra, const Realisation& group, const TransferPlan& plan,
         Range periods, const Transfer& mean, const Projection& projection, VarianceSums& sums) {
  const auto means = means_of(spectra, group, plan, periods);
  std::vector<OneRealisation> ones;
  for (std::size_t line = 0; line < mean.value.size(); ++line) {
    ones.push_back(estimate(spectra, group, means, line));
    sums.total[line] += projection(line, ones.back().value - mean.value[line]).cwiseAbs2();
  }
  for (auto p = periods.first; p < periods.last; ++p) {
    const Period period(spectra, group, p);
    for (std::size_t line = 0; line < mean.value.size(); ++line) {
      const auto k = static_cast<Eigen::Index>(line);
      const Eigen::MatrixXcd deviation =
          (period.at(k, plan.to) - means.to[line] -
           ones[line].value * (period.at(k, plan.from) - means.from[line])) *
          ones[line].inverse;
      sums.noise[line] += projection(line, deviation).cwiseAbs2();
    }
  }
}

}  // namespace

TransferVariances variances(const SpectraSource& spectra, const TransferPlan& plan,
                            const Transfer& mean, const Projection& projection) {
  const auto groups = realisations(spectra);
  const auto periods = periods_of(spectra, plan);
  const double p = periods.count();
  const auto r = static_cast<double>(groups.size());
  TransferVariances result;
  result.total_freedom = static_cast<Eigen::Index>(groups.size()) - 1;
  result.noise_freedom = static_cast<Eigen::Index>(r * (p - 1.0));
  VarianceSums sums;
  for (std::size_t line = 0; line < mean.value.size(); ++line) {
    const auto shown = projection(line, mean.value[line]);
    sums.noise.emplace_back(Eigen::MatrixXd::Zero(shown.rows(), shown.cols()));
    sums.total.push_back(sums.noise.back());
  }
  for (const auto& group : groups) {
    add(spectra, group, plan, periods, mean, projection, sums);
  }
  for (std::size_t line = 0; line < mean.value.size(); ++line) {
    if (p > 1.0) result.noise.emplace_back(sums.noise[line] / (p * (p - 1.0) * r * r));
    if (r > 1.0) result.total.emplace_back(sums.total[line] / (r * (r - 1.0)));
  }
  if (result.total.empty()) {
    result.total = result.noise;
    result.total_freedom = result.noise_freedom;
  }
  return result;
}

}  // namespace chladni::recordings
