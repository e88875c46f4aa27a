// A first guess of the delay, before the modes are known well.
#pragma once

#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// The delay [s] under which real residues at these poles fit best, between −0.5 and 2.5 periods
/// of the highest line. Poles barely feel a delay, the phases of their residues do.
/// Cost: a hundred linear fits of the residues.
[[nodiscard]] double scanned_delay(const FitData& data, const Eigen::VectorXcd& poles, bool rigid);

/// pq: likewise for each response, those of one output or input (or all) having one. 0 where
/// nothing is measured. Cost: the same.
[[nodiscard]] Eigen::VectorXd scanned_delays(const FitData& data, const Eigen::VectorXcd& poles,
                                             bool rigid, DelayOf of);

/// The data as they would be without it: G e^{+sτ}. Of each response its own in the second one
/// (pq).
[[nodiscard]] FitData undelayed(const FitData& data, double delay_s);
[[nodiscard]] FitData undelayed(const FitData& data, const Eigen::VectorXd& delay_s);

/// A fit of data without these delays (pq, those of one channel equal) as one of data with them.
void put_back(const Eigen::VectorXd& delay_s, DelayOf of, ModalFit& fit);

}  // namespace chladni::identification
