#include "recordings/virtual_experiment.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>

#include "base/error.h"
#include "recordings/laboratory/rate_path.h"

namespace chladni::recordings {
namespace {

Eigen::Index count(const std::vector<modal::MeasuredChannel>& channels) {
  return static_cast<Eigen::Index>(channels.size());
}

void check_levels(const Eigen::VectorXd& levels, Eigen::Index channels, const std::string& what) {
  require(levels.size() == 0 || levels.size() == channels,
          "virtual experiment: " + what + " of " + fmt::to_string(levels.size()) +
              " channels; expected " + fmt::to_string(channels));
  require(levels.allFinite() && (levels.size() == 0 || levels.minCoeff() >= 0.0),
          "virtual experiment: " + what + " is negative or not finite");
}

// The last commands of every input of the plant, newest first.
class Line {
 public:
  Line(const SampledDelay& delay, Eigen::Index inputs)
      : delay_(delay), past_(Eigen::MatrixXd::Zero(inputs, delay.whole + 3)) {}
  void push(const Eigen::VectorXd& command) {
    newest_ = (newest_ + past_.cols() - 1) % past_.cols();
    past_.col(newest_) = command;
  }
  void replace(const Eigen::VectorXd& command) { past_.col(newest_) = command; }
  /// u[k − whole − i]; k is the sample of the newest command.
  [[nodiscard]] auto acting(Eigen::Index i) const {
    return past_.col((newest_ + delay_.whole + i) % past_.cols());
  }

 private:
  SampledDelay delay_;
  Eigen::MatrixXd past_;
  Eigen::Index newest_ = 0;
};

void add_noise(const Eigen::VectorXd& level, Draw& draw, Eigen::MatrixXd& samples) {
  if (level.size() == 0) return;
  for (Eigen::Index n = 0; n < samples.rows(); ++n) {
    for (Eigen::Index i = 0; i < level.size(); ++i) samples(n, i) += level(i) * draw.normal();
  }
}

double quantised(double value, double step) {
  return step > 0.0 ? step * std::round(value / step) : value;
}

// The command delayed by `by` samples, zero before the start.
Eigen::MatrixXd shifted(const Eigen::MatrixXd& command, Eigen::Index by) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(command.rows(), command.cols());
  if (by < command.rows()) {
    result.bottomRows(command.rows() - by) = command.topRows(command.rows() - by);
  }
  return result;
}

// Computes x_n += A x_{n−1}; column n becomes the state after sample n.
void run_through(const Eigen::MatrixXd& a, Eigen::MatrixXd& states) {
  if (a.rows() == 1) {
    for (Eigen::Index n = 1; n < states.cols(); ++n) states(0, n) += a(0, 0) * states(0, n - 1);
  } else if (a.rows() == 2) {
    const Eigen::Matrix2d fixed = a;
    for (Eigen::Index n = 1; n < states.cols(); ++n) {
      states.col(n).head<2>() += fixed * states.col(n - 1).head<2>();
    }
  } else {
    Eigen::VectorXd next(a.rows());
    for (Eigen::Index n = 1; n < states.cols(); ++n) {
      next.noalias() = a * states.col(n - 1);
      states.col(n) += next;
    }
  }
}

// Simulates one block after the other over the whole record.
Eigen::MatrixXd open_loop(const VirtualRig& rig, const Eigen::MatrixXd& force) {
  const auto delay = sampled_delay(rig.delay_s, rig.sample_time_s);
  const auto now = shifted(force, delay.whole);
  const auto late = shifted(force, delay.whole + 1);
  Eigen::MatrixXd outputs = (delay.weight(0) * now + delay.weight(1) * late +
                             delay.weight(2) * shifted(force, delay.whole + 2)) *
                            rig.plant.d.transpose();
  if (rig.plant.rates) {
    outputs += along_rate_path(rig.plant, delay, rig.sample_time_s, force);
  }
  for (const auto& block : sampled(rig.plant, rig.sample_time_s, delay.fraction)) {
    Eigen::MatrixXd states = block.b * now.transpose();
    if (delay.fraction > 0.0) states += block.b_late * late.transpose();
    run_through(block.a, states);
    const auto rows = outputs.rows() - 1;
    outputs.bottomRows(rows).noalias() += states.leftCols(rows).transpose() * block.c.transpose();
  }
  return outputs;
}

constexpr double kSamePart = 1e-9;  // fractions of a part of a sample that are only rounding

// Simulates the structure in steps: whole samples, or parts of a sample if there is a spring.
class Stepped {
 public:
  explicit Stepped(const VirtualRig& rig)
      : rig_(rig),
        delay_(sampled_delay(rig.delay_s, rig.sample_time_s)),
        parts_(rig.spring ? rig.substeps : 1),
        late_parts_(static_cast<int>(std::floor(delay_.fraction * parts_ + kSamePart))),
        step_(rig.sample_time_s / parts_),
        blocks_(sampled(rig.plant, step_, rig.spring ? 0.0 : delay_.fraction)),
        line_(delay_, rig.plant.input_count()) {
    for (const auto& block : blocks_) states_.emplace_back(Eigen::VectorXd::Zero(block.a.rows()));
    const double rest = delay_.fraction * parts_ - late_parts_;
    if (rig.spring && rest > kSamePart) straddling_ = sampled(rig.plant, step_, rest);
  }

  /// Outputs at the sample of the newest force.
  [[nodiscard]] Eigen::VectorXd outputs() const {
    Eigen::VectorXd y =
        rig_.plant.d * (delay_.weight(0) * line_.acting(0) + delay_.weight(1) * line_.acting(1) +
                        delay_.weight(2) * line_.acting(2));
    for (std::size_t i = 0; i < blocks_.size(); ++i) y += blocks_[i].c * states_[i];
    return y;
  }
  Line& line() { return line_; }

  /// Advances by one sample; the command of the sample must be in the line.
  void advance() {
    if (!rig_.spring) {
      step(blocks_, line_.acting(0), line_.acting(1));
      return;
    }
    for (int part = 0; part < parts_; ++part) {
      const double spring = spring_force();
      Eigen::VectorXd force = line_.acting(part < late_parts_ ? 1 : 0);
      force(rig_.spring->input) += spring;
      if (part == late_parts_ && !straddling_.empty()) {
        Eigen::VectorXd late = line_.acting(1);
        late(rig_.spring->input) += spring;
        step(straddling_, force, late);
        continue;
      }
      for (std::size_t i = 0; i < blocks_.size(); ++i) {
        states_[i] = blocks_[i].a * states_[i] + blocks_[i].b * force;
      }
    }
  }

 private:
  // `late` acts first, then `now`.
  void step(const std::vector<SampledBlock>& blocks, const Eigen::VectorXd& now,
            const Eigen::VectorXd& late) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      states_[i] = blocks[i].a * states_[i] + blocks[i].b * now + blocks[i].b_late * late;
    }
  }

  // Force at the middle of the step, predicted with the velocity: second order.
  [[nodiscard]] double spring_force() const {
    double middle = 0.0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const auto row = rig_.plant.blocks[i].c.row(rig_.spring->output);
      const Eigen::VectorXd speed = rig_.plant.blocks[i].a * states_[i];
      middle += row.dot(states_[i] + 0.5 * step_ * speed);
    }
    return -rig_.spring->stiffness * middle * middle * middle;
  }

  const VirtualRig& rig_;
  SampledDelay delay_;
  int parts_, late_parts_;
  double step_;
  std::vector<SampledBlock> blocks_;
  std::vector<SampledBlock> straddling_;  // of the part in which the delay ends; empty: between two
  std::vector<Eigen::VectorXd> states_;
  Line line_;
};

// Force on all inputs of the plant: the command and the disturbance.
Eigen::MatrixXd forces(const VirtualRig& rig, const Eigen::MatrixXd& command, Draw& noise) {
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(command.rows(), rig.plant.input_count());
  force.leftCols(command.cols()) = command;
  add_noise(rig.process_noise, noise, force);
  return force;
}

// Feedback of the loop on each input of the plant, sample by sample.
class Feedback {
 public:
  explicit Feedback(const Controller& law)
      : law_(law), states_(Eigen::VectorXd::Zero(law.a.rows())) {}
  void add(const Eigen::VectorXd& seen, Eigen::RowVectorXd& recorded, Eigen::VectorXd& force) {
    const Eigen::VectorXd asked = law_.c * states_ + law_.d * seen;
    states_ = (law_.a * states_ + law_.b * seen).eval();
    for (std::size_t j = 0; j < law_.controlled.size(); ++j) {
      recorded(law_.controlled[j]) += asked(static_cast<Eigen::Index>(j));
      force(law_.controlled[j]) += asked(static_cast<Eigen::Index>(j));
    }
  }

 private:
  const Controller& law_;
  Eigen::VectorXd states_;
};

// Simulates sample by sample, which a loop and a spring require.
Record in_steps(const VirtualRig& rig, const Eigen::MatrixXd& command, Draw& noise) {
  const auto p = count(rig.outputs);
  Record record{.outputs = Eigen::MatrixXd::Zero(command.rows(), p),
                .inputs = command,
                .references = Eigen::MatrixXd(command.rows(), 0)};
  add_noise(rig.sensor_noise, noise, record.outputs);
  const auto driven = forces(rig, command, noise);
  if (rig.plant.rates) {  // in a loop there are none: check()
    const auto delay = sampled_delay(rig.delay_s, rig.sample_time_s);
    record.outputs += along_rate_path(rig.plant, delay, rig.sample_time_s, driven).leftCols(p);
  }
  Stepped structure(rig);
  std::optional<Feedback> loop;
  if (rig.controller) loop.emplace(*rig.controller);
  for (Eigen::Index n = 0; n < command.rows(); ++n) {
    Eigen::VectorXd force = driven.row(n).transpose();
    structure.line().push(force);
    Eigen::VectorXd y = structure.outputs().head(p) + record.outputs.row(n).transpose();
    for (Eigen::Index i = 0; i < rig.quantisation.size(); ++i) {
      y(i) = quantised(y(i), rig.quantisation(i));
    }
    record.outputs.row(n) = y.transpose();
    if (loop) {  // y does not depend on the newest force: it acts one sample later or more
      Eigen::RowVectorXd sent = record.inputs.row(n);
      loop->add(y, sent, force);
      record.inputs.row(n) = sent;
      structure.line().replace(force);
    }
    structure.advance();
    if (!y.allFinite()) {
      throw NumericalFailure("virtual experiment: the response grows without bound at sample " +
                             fmt::to_string(n));
    }
  }
  return record;
}

}  // namespace

void check(const VirtualRig& rig) {
  const auto p = count(rig.outputs);
  const auto q = count(rig.inputs);
  require(p >= 1 && q >= 1 && p <= rig.plant.output_count() && q <= rig.plant.input_count(),
          "virtual experiment: " + fmt::to_string(p) + " outputs and " + fmt::to_string(q) +
              " inputs; expected one or more, and as many as the structure has at most");
  require(std::isfinite(rig.sample_time_s) && rig.sample_time_s > 0.0,
          "virtual experiment: the sample time is not positive");
  check_levels(rig.sensor_noise, p, "sensor noise");
  check_levels(rig.quantisation, p, "quantisation");
  check_levels(rig.process_noise, q, "process noise");
  const auto delay = sampled_delay(rig.delay_s, rig.sample_time_s);
  if (rig.spring) {
    require(rig.spring->output >= 0 && rig.spring->output < rig.plant.output_count() &&
                rig.spring->input >= 0 && rig.spring->input < rig.plant.input_count() &&
                std::isfinite(rig.spring->stiffness) && rig.substeps >= 1,
            "virtual experiment: the cubic spring is not where the structure has channels");
  }
  if (!rig.controller) return;
  require(!rig.plant.rates, "virtual experiment: a loop needs outputs of displacement");
  require(delay.whole >= 1, "virtual experiment: a loop needs a delay of one sample or more, " +
                                fmt::format("{:.6g}", 1e6 * rig.sample_time_s) + " us");
  for (const auto j : rig.controller->controlled) {
    require(j < q, "virtual experiment: a controlled input is not recorded");
  }
  Plant seen = rig.plant;
  seen.d = Eigen::MatrixXd(seen.d.topRows(p));
  for (auto& block : seen.blocks) block.c = Eigen::MatrixXd(block.c.topRows(p));
  const double largest = largest_eigenvalue(seen, *rig.controller, rig.sample_time_s, rig.delay_s);
  require(largest < 1.0, "virtual experiment: the loop is unstable (an eigenvalue of magnitude " +
                             fmt::format("{:.6g}", largest) +
                             "); lower the bandwidth or the delay, or raise the damping");
}

Record recorded(const VirtualRig& rig, const Eigen::MatrixXd& command, Draw& noise) {
  require(command.cols() == count(rig.inputs) && command.rows() >= 1,
          "virtual experiment: a command for " + fmt::to_string(command.cols()) +
              " inputs; expected " + fmt::to_string(rig.inputs.size()));
  if (rig.controller || rig.spring) return in_steps(rig, command, noise);
  Record record{.outputs = Eigen::MatrixXd::Zero(command.rows(), count(rig.outputs)),
                .inputs = command,
                .references = Eigen::MatrixXd(command.rows(), 0)};
  add_noise(rig.sensor_noise, noise, record.outputs);
  record.outputs += open_loop(rig, forces(rig, command, noise)).leftCols(record.outputs.cols());
  for (Eigen::Index i = 0; i < rig.quantisation.size(); ++i) {
    for (double& value : record.outputs.col(i)) value = quantised(value, rig.quantisation(i));
  }
  return record;
}

}  // namespace chladni::recordings
