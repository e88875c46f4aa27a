#include "modal/feedback.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "base/error.h"
#include "base/turn.h"
#include "dense/riccati.h"

namespace chladni::modal {
namespace {

// Known inputs with their delays as states too.
DisturbedModel with_late_inputs(const DisturbedModel& system) {
  auto result = system;
  result.model = with_delay_states(system.model);
  return result;
}

// The whole loop as one linear system. Signals are rows over (states, forces from outside, noise).
class Whole {
 public:
  Whole(const DisturbedModel& plant, const Feedback& feedback)
      : plant_(with_late_inputs(plant)), feedback_(feedback) {
    if (feedback.filter) observer_ = with_delay_states(observer_model(*feedback.filter)).space;
    require_sizes();
    count();
    connect();
  }

  [[nodiscard]] const Eigen::MatrixXd& next() const { return next_; }
  [[nodiscard]] const Eigen::MatrixXd& wanted() const { return wanted_; }
  [[nodiscard]] const Eigen::MatrixXd& force() const { return force_; }
  [[nodiscard]] Eigen::Index states() const { return n_; }
  [[nodiscard]] Eigen::Index forces() const { return q_; }
  [[nodiscard]] Eigen::Index noises() const { return noise_; }

 private:
  void require_sizes() const {
    const auto& law = feedback_.law;
    const auto axes = law.b.cols();
    const auto q = static_cast<Eigen::Index>(feedback_.actuators.size());
    const bool fits = law.a.rows() == law.a.cols() && law.b.rows() == law.a.rows() &&
                      law.c.cols() == law.a.rows() && law.c.rows() == q && law.d.rows() == q &&
                      law.d.cols() == axes && feedback_.delay >= 1 && q > 0;
    const auto& seen = feedback_.filter ? feedback_.points : feedback_.sensors;
    const auto columns =
        feedback_.filter ? feedback_.filter->system.wanted_count() : plant_.sensors;
    require(fits && seen.rows() == axes && seen.cols() == columns,
            "feedback: the sizes of the law and of what it sees do not fit the model");
    require(std::ranges::all_of(feedback_.actuators,
                                [&](auto j) { return j >= 0 && j < plant_.known; }),
            "feedback: it drives an input that the model does not have");
    require(!feedback_.filter || (feedback_.filter->system.known == plant_.known &&
                                  feedback_.filter->system.sensors == plant_.sensors),
            "feedback: the filter has other inputs or sensors than the model");
  }

  void count() {
    q_ = static_cast<Eigen::Index>(feedback_.actuators.size());
    noise_ = plant_.noise_rms.size() + plant_.sensors;
    observer_at_ = plant_.state_count();
    law_at_ = observer_at_ + observer_.a.rows();
    late_at_ = law_at_ + feedback_.law.a.rows();
    n_ = late_at_ + q_ * feedback_.delay;
  }

  [[nodiscard]] Eigen::MatrixXd zeros(Eigen::Index rows) const {
    return Eigen::MatrixXd::Zero(rows, n_ + q_ + noise_);
  }
  [[nodiscard]] Eigen::MatrixXd state(Eigen::Index from, Eigen::Index rows) const {
    auto signal = zeros(rows);
    signal.middleCols(from, rows).setIdentity();
    return signal;
  }

  void connect() {
    const auto& space = plant_.model.space;
    const auto p = plant_.sensors;
    // What acts: the oldest force of the computer, which the filter knows, and one from outside,
    // which it does not: with a filter that knew it, the loop would have the margins of a state
    // that is measured (Doyle, IEEE Trans. Automatic Control 23 (1978) 756).
    const Eigen::MatrixXd u_known = acting(state(late_at_ + q_ * (feedback_.delay - 1), q_));
    auto outside = zeros(q_);
    outside.middleCols(n_, q_).setIdentity();
    const Eigen::MatrixXd u = u_known + acting(outside);
    Eigen::MatrixXd w = zeros(plant_.noise_rms.size());
    w.middleCols(n_ + q_, w.rows()) = plant_.noise_rms.asDiagonal();
    Eigen::MatrixXd inputs(u.rows() + w.rows(), u.cols());
    inputs << u, w;
    const auto x = state(0, plant_.state_count());
    const Eigen::MatrixXd outputs = space.c * x + space.d * inputs;
    Eigen::MatrixXd y = outputs.topRows(p);
    y.rightCols(p) += Eigen::MatrixXd(plant_.sensor_rms.asDiagonal());
    wanted_ = outputs.bottomRows(plant_.wanted_count());
    next_ = zeros(n_);
    next_.topRows(x.rows()) = space.a * x + space.b * inputs;
    const auto axes = seen(u_known, y);
    const auto& law = feedback_.law;
    const auto own = state(law_at_, law.a.rows());
    next_.middleRows(law_at_, own.rows()) = law.a * own + law.b * axes;
    next_.middleRows(late_at_, q_) = law.c * own + law.d * axes;
    const auto kept = q_ * (feedback_.delay - 1);
    next_.bottomRows(kept) = state(late_at_, kept);
    force_ = state(late_at_ + kept, q_);
  }

  // Forces of the actuators among the known inputs of the plant.
  [[nodiscard]] Eigen::MatrixXd acting(const Eigen::MatrixXd& forces) const {
    Eigen::MatrixXd u = zeros(plant_.known);
    for (Eigen::Index j = 0; j < q_; ++j) {
      u.row(feedback_.actuators[static_cast<std::size_t>(j)]) += forces.row(j);
    }
    return u;
  }

  // What the law sees; with a filter, which knows the forces u, also its next state.
  Eigen::MatrixXd seen(const Eigen::MatrixXd& u, const Eigen::MatrixXd& y) {
    if (!feedback_.filter) return feedback_.sensors * y;
    const auto x = state(observer_at_, observer_.a.rows());
    Eigen::MatrixXd inputs(u.rows() + y.rows(), u.cols());
    inputs << u, y;
    next_.middleRows(observer_at_, x.rows()) = observer_.a * x + observer_.b * inputs;
    const Eigen::MatrixXd outputs = observer_.c * x + observer_.d * inputs;
    return feedback_.points * outputs.topRows(feedback_.filter->system.wanted_count());
  }

  DisturbedModel plant_;
  const Feedback& feedback_;
  StateSpace observer_;
  Eigen::Index q_ = 0, noise_ = 0, n_ = 0, observer_at_ = 0, law_at_ = 0, late_at_ = 0;
  Eigen::MatrixXd next_, wanted_, force_;
};

}  // namespace

ClosedLoop closed_loop(const DisturbedModel& plant, const Feedback& feedback) {
  const Whole whole(plant, feedback);
  const auto n = whole.states();
  const Eigen::MatrixXd a = whole.next().leftCols(n);
  ClosedLoop result;
  result.pole = a.eigenvalues();
  result.spectral_radius = result.pole.cwiseAbs().maxCoeff();
  if (!(result.spectral_radius < 1.0)) return result;
  const Eigen::MatrixXd moved = whole.next().rightCols(whole.noises());
  const Eigen::MatrixXd p = dense::stationary_covariance(a, moved * moved.transpose());
  const Eigen::MatrixXd c = whole.wanted().leftCols(n);
  const Eigen::MatrixXd through = whole.wanted().rightCols(whole.noises());
  result.rms = ((c * p * c.transpose()).diagonal() + through.cwiseAbs2().rowwise().sum())
                   .cwiseMax(0.0)
                   .cwiseSqrt();
  return result;
}

double modulus_margin(const DisturbedModel& plant, const Feedback& feedback,
                      const Eigen::VectorXd& frequency_hz) {
  const Whole whole(plant, feedback);
  const auto n = whole.states();
  const auto q = whole.forces();
  // The response from a force outside to the whole force is (I − L)⁻¹.
  const Eigen::MatrixXcd a = whole.next().leftCols(n).cast<std::complex<double>>();
  const Eigen::MatrixXcd b = whole.next().middleCols(n, q).cast<std::complex<double>>();
  const Eigen::MatrixXcd c = whole.force().leftCols(n).cast<std::complex<double>>();
  double largest = 0.0;
  for (const double f : frequency_hz) {
    const auto z = std::polar(1.0, kTwoPi * f * plant.model.space.sample_time_s);
    Eigen::MatrixXcd system = -a;
    system.diagonal().array() += z;
    const Eigen::MatrixXcd response =
        c * system.partialPivLu().solve(b) + Eigen::MatrixXcd::Identity(q, q);
    largest = std::max(largest, Eigen::JacobiSVD<Eigen::MatrixXcd>(response).singularValues()(0));
  }
  return largest > 0.0 ? 1.0 / largest : 0.0;
}

Eigen::VectorXd with_resonances(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXcd& pole,
                                double sample_time_s) {
  std::vector<double> lines(frequency_hz.begin(), frequency_hz.end());
  if (lines.empty()) return frequency_hz;
  const double first = frequency_hz(0);
  const double last = frequency_hz.tail(1)(0);
  for (const auto& one : pole) {
    const double hz = std::arg(one) / (kTwoPi * sample_time_s);
    if (!(hz >= first && hz < last)) continue;
    const double half = -std::log(std::abs(one)) / (kTwoPi * sample_time_s);
    const auto above = std::upper_bound(frequency_hz.begin(), frequency_hz.end(), hz);
    if (half >= *above - *(above - 1)) continue;
    for (const double beside : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const double line = hz + beside * half;
      if (line > first && line < last) lines.push_back(line);
    }
  }
  std::ranges::sort(lines);
  return Eigen::Map<const Eigen::VectorXd>(lines.data(), std::ssize(lines));
}

}  // namespace chladni::modal
