// A first guess of the delay, before the modes are known well.
#pragma once

#include "base/progress.h"
#include "identification/fit_data.h"
#include "identification/modal_fit.h"

namespace chladni::identification {

/// The delay [s] at which real residues at these poles fit best. The search runs from −0.5 to
/// 2.5 periods of the highest line. A short delay hardly changes poles, but it changes the
/// phases of their residues.
/// Cost: a hundred linear fits of the residues.
[[nodiscard]] double scanned_delay(const FitData& data, const Eigen::VectorXcd& poles, bool rigid);

/// pq: the same for each response. The responses of one output or one input (or all) share one
/// delay. 0 where nothing is measured. Cost: the same.
[[nodiscard]] Eigen::VectorXd scanned_delays(const FitData& data, const Eigen::VectorXcd& poles,
                                             bool rigid, DelayOf of);

/// pq [s]: a first value without poles: the delay under which the phases of the responses of one
/// output or one input (or all) are nearest to 0 and 180°, which are those of real modes away from
/// their resonances. 0 where nothing is measured. The search begins at −0.5 periods of the highest
/// line, and ends where squares of evenly spaced lines cannot tell a longer delay from a shorter
/// one, 1/(2 df) further for their mean distance df, but 500 periods further at most. Resonances
/// turn phases back, too: where many modes overlap the value is too large, by several periods.
/// Cost: 25 K operations for each period and delay.
/// @throws Interrupted  see base/interrupt.h
[[nodiscard]] Eigen::VectorXd phase_delays(const FitData& data, DelayOf of,
                                           const Progress& progress = {});

/// The data without the delay: G e^{+sτ}. The second function takes one delay for
/// each response (pq).
[[nodiscard]] FitData undelayed(const FitData& data, double delay_s);
[[nodiscard]] FitData undelayed(const FitData& data, const Eigen::VectorXd& delay_s);

/// Turns a fit of data without these delays (pq, equal in one channel) into one with them.
void put_back(const Eigen::VectorXd& delay_s, DelayOf of, ModalFit& fit);

}  // namespace chladni::identification
