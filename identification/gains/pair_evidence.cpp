#include "identification/gains/pair_evidence.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/finite.h"
#include "dense/algebra.h"
#include "identification/constants.h"

namespace chladni::identification {

namespace {

// ln of the ratio of both sides at the pairs that count for one mode, with its covariance.
struct LogRatios {
  std::vector<Eigen::Index> pairs;
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};

LogRatios log_ratios(const ModalFit& fit, Eigen::Index mode, Eigen::Index group,
                     const std::vector<CollocatedPair>& pairs, const PlaceRatios& ratios,
                     const PairResidues& residues) {
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  LogRatios logs;
  for (Eigen::Index c = 0; c < std::ssize(pairs); ++c) {
    if (residues.telling(c, group)) logs.pairs.push_back(c);
  }
  const auto n = std::ssize(logs.pairs);
  logs.value.resize(n);
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(n, p + q);
  Eigen::VectorXd own(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto c = logs.pairs[static_cast<std::size_t>(k)];
    const auto& pair = pairs[static_cast<std::size_t>(c)];
    const double l = fit.model.output_shapes(pair.output, mode);
    const double r = fit.model.input_shapes(mode, pair.input);
    logs.value(k) = std::log(std::abs(l / (r * ratios.value(c, mode))));
    slope(k, pair.output) = 1.0 / l;
    slope(k, p + pair.input) = -1.0 / r;
    own(k) = ratios.deviation(c, mode) / ratios.value(c, mode);
  }
  logs.covariance = slope * shape_covariance(fit, mode) * slope.transpose();
  logs.covariance += own.cwiseAbs2().asDiagonal();
  return logs;
}

// S⁻¹ without the mode's own α. A value of no variance gets 1e-24, so such values weigh alike.
Eigen::MatrixXd weight_without_scale(const Eigen::MatrixXd& covariance) {
  const auto n = covariance.rows();
  Eigen::MatrixXd spread = covariance;
  spread.diagonal().array() += 1e-24;
  const Eigen::MatrixXd weight = dense::inverse_of(spread.ldlt());
  const Eigen::VectorXd ones = weight * Eigen::VectorXd::Ones(n);
  return weight - ones * ones.transpose() / ones.sum();
}

// Pseudo-inverse, because one common factor of all gains is not determined.
Eigen::MatrixXd inverse_of_told(const Eigen::MatrixXd& normal) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(finite(normal, "gains of the pairs"));
  const double least = 1e-9 * solver.eigenvalues()(normal.rows() - 1);
  const Eigen::VectorXd inverse =
      (solver.eigenvalues().array() > least).select(solver.eigenvalues().cwiseInverse(), 0.0);
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

// The two-way layout: the gains, and the residual of each entry in deviations.
struct Layout {
  Eigen::VectorXd log_gain;
  Eigen::MatrixXd covariance;
  std::vector<Eigen::VectorXd> left;  // for each mode, in the order of its entries
};

Layout layout_of(const std::vector<LogRatios>& modes, Eigen::Index pairs) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(pairs, pairs);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(pairs);
  for (const auto& mode : modes) {
    const Eigen::MatrixXd weight = weight_without_scale(mode.covariance);
    normal(mode.pairs, mode.pairs) += weight;
    right(mode.pairs) += weight * mode.value;
  }
  Layout layout;
  layout.covariance = inverse_of_told(normal);
  layout.log_gain = layout.covariance * right;
  for (const auto& mode : modes) {
    const Eigen::MatrixXd weight = weight_without_scale(mode.covariance);
    const Eigen::VectorXd gap = weight * (mode.value - layout.log_gain(mode.pairs));
    layout.left.emplace_back(gap.cwiseQuotient(weight.diagonal().cwiseSqrt()));
  }
  return layout;
}

// The entry with the largest residual, in deviations.
struct Worst {
  std::size_t mode = 0;
  Eigen::Index entry = 0;
  double off = 0.0;
};

Worst worst_of(const Layout& layout) {
  Worst worst;
  for (std::size_t g = 0; g < layout.left.size(); ++g) {
    Eigen::Index entry = 0;
    const double off = layout.left[g].cwiseAbs().maxCoeff(&entry);
    if (off > worst.off) worst = {g, entry, off};
  }
  return worst;
}

LogRatios without(const LogRatios& mode, Eigen::Index entry) {
  std::vector<Eigen::Index> kept;
  LogRatios result;
  for (Eigen::Index k = 0; k < mode.value.size(); ++k) {
    if (k == entry) continue;
    kept.push_back(k);
    result.pairs.push_back(mode.pairs[static_cast<std::size_t>(k)]);
  }
  result.value = mode.value(kept);
  result.covariance = mode.covariance(kept, kept);
  return result;
}

// Number of modes that give each pair's gain; 0: none.
std::vector<Eigen::Index> told_by(const std::vector<LogRatios>& modes, Eigen::Index pairs) {
  std::vector<Eigen::Index> count(static_cast<std::size_t>(pairs), 0);
  for (const auto& mode : modes) {
    for (const auto c : mode.pairs) ++count[static_cast<std::size_t>(c)];
  }
  return count;
}

// For each pair the number of its part, from 0 on in their order: modes compare the pairs of a
// part, directly or through others.
std::vector<Eigen::Index> parts_of_pairs(const std::vector<LogRatios>& modes, Eigen::Index pairs) {
  std::vector<Eigen::Index> first(static_cast<std::size_t>(pairs));  // the first pair of the part
  std::iota(first.begin(), first.end(), 0);
  for (const auto& mode : modes) {
    for (const auto c : mode.pairs) {
      const auto one = first[static_cast<std::size_t>(mode.pairs.front())];
      const auto other = first[static_cast<std::size_t>(c)];
      std::ranges::replace(first, std::max(one, other), std::min(one, other));
    }
  }
  Eigen::Index next = 0;
  std::vector<Eigen::Index> part(first.size(), 0);
  const auto told = told_by(modes, pairs);
  for (std::size_t c = 0; c < part.size(); ++c) {
    const auto head = static_cast<std::size_t>(first[c]);
    if (told[c] > 0) part[c] = head == c ? next++ : part[head];
  }
  return part;
}

// Sets the gains that modes tell. Over all pairs they are known where all are of one part.
void set_told(const std::vector<LogRatios>& modes, const Layout& layout,
              std::vector<PairGain>& gains) {
  const auto count = told_by(modes, std::ssize(gains));
  const auto part = parts_of_pairs(modes, std::ssize(gains));
  const bool is_whole = std::ranges::max(part) == 0;
  for (std::size_t c = 0; c < gains.size(); ++c) {
    auto& gain = gains[c];
    gain.modes = count[c];
    if (gain.modes == 0) continue;
    const auto row = static_cast<Eigen::Index>(c);
    gain.part = part[c];
    gain.ratio = std::exp(layout.log_gain(row));
    gain.part_std = gain.ratio * std::sqrt(std::max(layout.covariance(row, row), 0.0));
    if (is_whole) gain.ratio_std = gain.part_std;
  }
}

// Removes entries that the others contradict, the worst first, while two modes are left for each
// pair. A gain is the same in all modes; an entry of a pair that is not one place would pull the
// gain with the full certainty of the fit.
std::vector<LogRatios> consistent(std::vector<LogRatios> modes, Eigen::Index pairs) {
  while (true) {
    const auto worst = worst_of(layout_of(modes, pairs));
    if (worst.off < Constants::no_chance) return modes;
    auto fewer = modes;
    auto& mode = fewer[worst.mode];
    mode = without(mode, worst.entry);
    if (mode.pairs.size() < 2) fewer.erase(fewer.begin() + static_cast<long>(worst.mode));
    const auto before = told_by(modes, pairs);
    const auto after = told_by(fewer, pairs);
    for (std::size_t c = 0; c < after.size(); ++c) {
      if (before[c] > 0 && after[c] < 2) return modes;
    }
    modes = std::move(fewer);
  }
}

}  // namespace

int sign_of_pair(const modal::MeasuredChannel& output, const modal::MeasuredChannel& input) {
  return output.direction.dot(input.direction) < 0.0 ? -1 : 1;
}

PlaceRatios place_ratios(const std::vector<CollocatedPair>& pairs, Eigen::Index modes,
                         double simulation_error) {
  PlaceRatios ratios{Eigen::MatrixXd::Ones(std::ssize(pairs), modes),
                     Eigen::MatrixXd::Zero(std::ssize(pairs), modes)};
  for (Eigen::Index c = 0; c < std::ssize(pairs); ++c) {
    const auto& pair = pairs[static_cast<std::size_t>(c)];
    if (pair.is_one_place()) {
      ratios.value.row(c).setConstant(pair.sign);
      continue;
    }
    require(pair.at_output.size() == modes && pair.at_input.size() == modes,
            "gain match: pair " + fmt::to_string(c + 1) + " has simulated shapes of " +
                fmt::to_string(pair.at_output.size()) + " and " +
                fmt::to_string(pair.at_input.size()) + " modes; expected " + fmt::to_string(modes));
    // A smaller value at either place is a node: the ratio is unknown there.
    const double least = 1e-6 * (pair.at_output.norm() + pair.at_input.norm()) + 1e-300;
    for (Eigen::Index m = 0; m < modes; ++m) {
      const double there = pair.at_output(m);
      const double here = pair.at_input(m);
      if (std::abs(there) < least || std::abs(here) < least) {
        ratios.deviation(c, m) = std::numeric_limits<double>::infinity();
        continue;
      }
      ratios.value(c, m) = there / here;
      // The change can be wrong at either place: near a node of one the ratio is unknown.
      ratios.deviation(c, m) = simulation_error * std::abs((there - here) * ratios.value(c, m)) *
                               std::hypot(1.0 / there, 1.0 / here);
    }
  }
  return ratios;
}

Eigen::MatrixXd shape_covariance(const ModalFit& fit, Eigen::Index mode) {
  const auto size = fit.model.output_count() + fit.model.input_count();
  if (mode >= std::ssize(fit.mode_covariance)) return Eigen::MatrixXd::Zero(size, size);
  const auto& all = fit.mode_covariance[static_cast<std::size_t>(mode)];
  if (all.rows() != size + 2) return Eigen::MatrixXd::Zero(size, size);
  return all.bottomRightCorner(size, size);
}

std::vector<modal::ModeGroup> matched_groups(const ModalFit& fit) {
  std::vector<modal::ModeGroup> groups;
  const auto rigid = fit.model.rigid_count;
  if (rigid > 0) groups.push_back({0, rigid});
  Eigen::Index next = rigid;
  for (const auto& group : fit.groups) {
    if (group.first != next) continue;  // a group of rigid-body modes, or not in sequence
    groups.push_back(group);
    next += group.size;
  }
  for (; next < fit.model.mode_count(); ++next) groups.push_back({next, 1});
  return groups;
}

PairResidues pair_residues(const ModalFit& fit, const std::vector<modal::ModeGroup>& groups,
                           const std::vector<CollocatedPair>& pairs, const PlaceRatios& ratios,
                           double significance) {
  PairResidues residues;
  const auto n = std::ssize(pairs);
  const auto count = std::ssize(groups);
  residues.value = residues.deviation = Eigen::MatrixXd::Zero(n, count);
  residues.telling.setConstant(n, count, false);
  const auto p = fit.model.output_count();
  for (Eigen::Index g = 0; g < count; ++g) {
    const auto& group = groups[static_cast<std::size_t>(g)];
    for (Eigen::Index c = 0; c < n; ++c) {
      const auto& pair = pairs[static_cast<std::size_t>(c)];
      double size = 0.0;
      bool known = true;
      for (Eigen::Index m = group.first; m < group.first + group.size; ++m) {
        const double l = fit.model.output_shapes(pair.output, m);
        const double r = fit.model.input_shapes(m, pair.input);
        const auto covariance = shape_covariance(fit, m);
        residues.value(c, g) += std::copysign(1.0, ratios.value(c, m)) * l * r;
        residues.deviation(c, g) += r * r * covariance(pair.output, pair.output) +
                                    l * l * covariance(p + pair.input, p + pair.input) +
                                    2.0 * l * r * covariance(pair.output, p + pair.input);
        size += fit.model.output_shapes.col(m).norm() * fit.model.input_shapes.row(m).norm();
        known = known && ratios.deviation(c, m) * significance < std::abs(ratios.value(c, m));
      }
      residues.deviation(c, g) = std::sqrt(std::max(residues.deviation(c, g), 0.0));
      const double least = std::max(significance * residues.deviation(c, g), 1e-9 * size);
      residues.telling(c, g) = known && std::abs(residues.value(c, g)) > least;
    }
  }
  return residues;
}

Eigen::VectorXi pair_signs(const PairResidues& residues) {
  Eigen::VectorXi signs = Eigen::VectorXi::Ones(residues.value.rows());
  for (Eigen::Index c = 0; c < signs.size(); ++c) {
    int votes = 0;
    for (Eigen::Index g = 0; g < residues.value.cols(); ++g) {
      if (residues.telling(c, g)) votes += residues.value(c, g) > 0.0 ? 1 : -1;
    }
    if (votes < 0) signs(c) = -1;
  }
  return signs;
}

PairGains pair_gains(const ModalFit& fit, const std::vector<modal::ModeGroup>& groups,
                     const std::vector<CollocatedPair>& pairs, const PlaceRatios& ratios,
                     const PairResidues& residues) {
  const auto n = std::ssize(pairs);
  PairGains result;
  result.gains.resize(pairs.size());
  if (n > 1) {  // of one pair the ratio to all pairs together is 1
    for (auto& gain : result.gains) gain.ratio_std = std::numeric_limits<double>::infinity();
  }
  result.left = Eigen::MatrixXd::Zero(n, std::ssize(groups));
  std::vector<LogRatios> all;
  std::vector<Eigen::Index> of_group;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].size != 1) continue;
    const auto group = static_cast<Eigen::Index>(g);
    auto logs = log_ratios(fit, groups[g].first, group, pairs, ratios, residues);
    if (logs.pairs.size() < 2) continue;
    all.push_back(std::move(logs));
    of_group.push_back(group);
  }
  if (all.empty()) return result;
  const auto kept = consistent(all, n);
  const auto layout = layout_of(kept, n);
  set_told(kept, layout, result.gains);
  for (std::size_t g = 0; g < all.size(); ++g) {
    const Eigen::MatrixXd weight = weight_without_scale(all[g].covariance);
    const Eigen::VectorXd gap = weight * (all[g].value - layout.log_gain(all[g].pairs));
    result.left(all[g].pairs, of_group[g]) = gap.cwiseQuotient(weight.diagonal().cwiseSqrt());
  }
  return result;
}

Eigen::Index gain_parts(const std::vector<PairGain>& gains) {
  Eigen::Index count = 0;
  for (const auto& gain : gains) {
    if (gain.modes > 0) count = std::max(count, gain.part + 1);
  }
  return count;
}

double gain_scatter(const std::vector<PairGain>& gains) {
  double square = 0.0;
  double freedoms = -static_cast<double>(gain_parts(gains));
  for (const auto& gain : gains) {
    if (gain.modes == 0) continue;
    square += std::pow(std::log(gain.ratio), 2);
    freedoms += 1.0;
  }
  return freedoms > 0.0 ? std::sqrt(square / freedoms) : 0.0;
}

Eigen::VectorXd gain_doubts(const std::vector<PairGain>& gains) {
  const double scatter = gain_scatter(gains);
  Eigen::VectorXd doubts(std::ssize(gains));
  for (std::size_t c = 0; c < gains.size(); ++c) {
    const auto& gain = gains[c];
    const bool is_told = std::isfinite(gain.ratio_std);
    const double own = (is_told ? gain.ratio_std : gain.part_std) / gain.ratio;
    doubts(static_cast<Eigen::Index>(c)) = is_told ? own : std::hypot(own, scatter);
  }
  return doubts;
}

}  // namespace chladni::identification
