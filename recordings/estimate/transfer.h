// Transfer between chosen channels in a periodic experiment, with its variances: the common core of
// the open-loop and the closed-loop estimate.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "recordings/spectra.h"

namespace chladni::recordings {

struct ChannelChoice {
  Side side = Side::outputs;
  Eigen::Index column = 0;
};

struct TransferPlan {
  std::vector<ChannelChoice> to, from;  ///< t and f channels
  Eigen::Index drop = 0;                ///< periods at the start of each record
};

/// The estimate sums over periods first. Each realisation gives a matrix Y U⁻¹ over its
/// experiments; the result is the mean over the realisations (thesis (4.2); Dobrowiecki,
/// Schoukens, Guillaume 2006).
struct Transfer {
  std::vector<Eigen::MatrixXcd> value;  ///< [k], t×f
  Eigen::Index periods = 0;             ///< used per record
  Eigen::Index realisations = 0;
};

/// @throws InvalidInput  no period left, fewer experiments in a realisation than `from` channels,
///                       `from` channels that one realisation cannot separate or that do not repeat
///                       with the period
[[nodiscard]] Transfer transfer(const SpectraSource& spectra, const TransferPlan& plan);

/// Maps a deviation of the transfer, t×f at line k, to the deviation of the wanted quantity.
using Projection = std::function<Eigen::MatrixXcd(std::size_t k, const Eigen::MatrixXcd&)>;

/// Variances of the mean, [k]: `noise` from the periods, `total` from the realisations (equal to
/// the noise for one realisation); empty where the data do not give them. Robust method, Pintelon
/// and Schoukens 2012, section 4.3: the noise of one realisation is s² = Σ_p |(ΔY_p − G ΔU_p)
/// U⁻¹|² / (P(P−1)), of the mean s²/R; the total is Σ_r |G_r − G|² / (R(R−1)).
struct TransferVariances {
  std::vector<Eigen::MatrixXd> total, noise;
  Eigen::Index total_freedom = 0, noise_freedom = 0;  ///< degrees, per complex number
};

[[nodiscard]] TransferVariances variances(const SpectraSource& spectra, const TransferPlan& plan,
                                          const Transfer& mean, const Projection& projection);

}  // namespace chladni::recordings
