// What some channels answer to others in a periodic experiment, with its variances: the engine of
// the open and of the closed loop.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "identification/estimate/spectra.h"

namespace chladni::identification {

enum class Side { outputs, inputs, references };

struct ChannelChoice {
  Side side = Side::outputs;
  Eigen::Index column = 0;
};

struct TransferPlan {
  std::vector<ChannelChoice> to, from;  ///< t and f channels
  Eigen::Index drop = 0;                ///< periods at the start of each record
};

/// Sums over periods first, the matrix of each realisation by Y U⁻¹ over its experiments, then the
/// mean over the realisations (thesis (4.2); Dobrowiecki, Schoukens, Guillaume 2006).
struct Transfer {
  std::vector<Eigen::MatrixXcd> value;  ///< [k], t×f
  Eigen::Index periods = 0;             ///< used per record
  Eigen::Index realisations = 0;
};

/// @throws InvalidInput  no period left, fewer experiments in a realisation than `from` channels,
///                       `from` channels that one realisation cannot tell apart, or that do not
///                       repeat with the period
[[nodiscard]] Transfer transfer(const Spectra& spectra, const TransferPlan& plan);

/// How a deviation of the transfer, t×f at line k, shows in what is wanted of it.
using Projection = std::function<Eigen::MatrixXcd(std::size_t k, const Eigen::MatrixXcd&)>;

/// Variances of the mean, [k]: `noise` from the periods, `total` from the realisations (equal to
/// the noise's where there is one only); empty where nothing tells them. Robust method, Pintelon
/// and Schoukens 2012, section 4.3:
/// noise of one realisation s² = Σ_p |(ΔY_p − G ΔU_p) U⁻¹|² / (P(P−1)), of the mean s²/R;
/// total Σ_r |G_r − G|² / (R(R−1)).
struct TransferVariances {
  std::vector<Eigen::MatrixXd> total, noise;
  Eigen::Index total_freedom = 0, noise_freedom = 0;  ///< degrees, per complex number
};

[[nodiscard]] TransferVariances variances(const Spectra& spectra, const TransferPlan& plan,
                                          const Transfer& mean, const Projection& projection);

}  // namespace chladni::identification
