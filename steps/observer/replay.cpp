#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "dense/algebra.h"
#include "identification/decoupling.h"
#include "priors/interpolator.h"
#include "steps/observer/stated.h"
#include "steps/observer_replay.h"
#include "steps/predicted.h"

namespace chladni::steps {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr Eigen::Index kDrawn = 2000;  // samples of a picture

// Sums over the settled samples of all records, per judge.
struct Sums {
  explicit Sums(Eigen::Index judges) : square(Eigen::VectorXd::Zero(judges)) {}
  Eigen::VectorXd square;

  void add(const Eigen::MatrixXd& values, Eigen::Index from) {
    square += values.bottomRows(values.rows() - from).colwise().squaredNorm().transpose();
  }
  [[nodiscard]] double over(const Sums& size, Eigen::Index judge) const {
    return std::sqrt(square(judge) / size.square(judge));
  }
};

bool measures_displacement(const IdentifiedModel& model) {
  return std::ranges::all_of(model.seen.outputs, [](const auto& output) {
    return output.kind == modal::FrfKind::receptance;
  });
}

// j×p for each k: the judges' shapes of the lowest k modes times the pseudoinverse of the sensors'.
std::vector<Eigen::MatrixXd> static_weights(const Observer& observer) {
  const auto& match = identified_of(*observer.shapes).match;
  const auto p = observer.filter.system.sensors;
  const Eigen::MatrixXd& at_points = observer.places.at_points.shapes;
  std::vector<Eigen::MatrixXd> weights;
  for (Eigen::Index k = 1; k <= std::min(p, at_points.cols()); ++k) {
    const Eigen::MatrixXd at_sensors = match.shapes.topRows(p).leftCols(k);
    weights.push_back(at_points.bottomRows(observer.judges).leftCols(k) *
                      dense::pseudo_inverse(at_sensors));
  }
  return weights;
}

// j×p: rigid-body motion by least squares, at the judges. Empty where places or directions lack.
Eigen::MatrixXd rigid_weights(const study::Study& study, const Observer& observer) {
  const auto& model = identified_of(*observer.shapes);
  const auto frame = identification::channel_frame(model.seen.outputs);
  if (!frame) return {};
  identification::ChannelFrame at;
  at.places.resize(observer.judges, 3);
  at.directions.resize(observer.judges, 3);
  const auto names = observer.names();
  for (Eigen::Index j = 0; j < observer.judges; ++j) {
    const auto& name = names[names.size() - static_cast<std::size_t>(observer.judges - j)];
    const auto& channel = study.sensors[static_cast<std::size_t>(index_of(study.sensors, name))];
    at.places.row(j) = channel.at.point.transpose();
    at.directions.row(j) = channel.direction.transpose();
  }
  const Eigen::Vector3d about = frame->places.colwise().mean().transpose();
  const auto seen = identification::rigid_motions(*frame, about);
  return identification::rigid_motions(at, about) * dense::pseudo_inverse(seen);
}

modal::KalmanFilter without_sensors(modal::KalmanFilter filter) {
  filter.gain.setZero();
  filter.point_gain.setZero();
  return filter;
}

modal::KalmanFilter without_this_sample(modal::KalmanFilter filter) {
  filter.point_gain.setZero();
  return filter;
}

// Everything that is summed over the records.
struct Trial {
  explicit Trial(Eigen::Index judges, std::size_t methods)
      : motion(judges),
        observer(judges),
        prediction(judges),
        rigid(judges),
        model(judges),
        truth(judges),
        statics(methods, Sums(judges)) {}
  Sums motion, observer, prediction, rigid, model, truth;
  std::vector<Sums> statics;
  Eigen::MatrixXd innovation;  // p×p: sum of e eᵀ
  double samples = 0.0;
  std::vector<Eigen::VectorXd> score;  // per judge: |error| over its deviation at each sample
};

class Replaying {
 public:
  Replaying(const study::Study& study, const Observer& observer, const Recordings& recordings,
            const std::optional<modal::KalmanFilter>& truth)
      : observer_(observer),
        recordings_(recordings),
        truth_(truth),
        model_(without_sensors(observer.filter)),
        prediction_(without_this_sample(observer.filter)),
        trial_(observer.judges, 0) {
    if (measures_displacement(identified_of(*observer.shapes))) {
      static_ = static_weights(observer);
      rigid_ = rigid_weights(study, observer);
    }
    trial_ = Trial(observer.judges, static_.size());
    const auto p = observer.filter.system.sensors;
    trial_.innovation = Eigen::MatrixXd::Zero(p, p);
    trial_.score.resize(static_cast<std::size_t>(observer.judges));
  }

  void add(const Recordings::Record& record, Eigen::Index from, ReplayCourse* course) {
    const auto j = observer_.judges;
    const auto& truth = record.judges;
    const auto found = modal::estimate(observer_.filter, record.inputs, record.sensors, true);
    const Eigen::MatrixXd estimated = found.points.rightCols(j);
    const Eigen::MatrixXd deviation = band(observer_, found.states).rightCols(j);
    trial_.motion.add(truth, from);
    trial_.observer.add(estimated - truth, from);
    const auto wrong = [&](const modal::KalmanFilter& filter) -> Eigen::MatrixXd {
      return modal::estimate(filter, record.inputs, record.sensors).points.rightCols(j) - truth;
    };
    trial_.prediction.add(wrong(prediction_), from);
    trial_.model.add(wrong(model_), from);
    if (truth_) trial_.truth.add(wrong(*truth_), from);
    if (rigid_.size() > 0) trial_.rigid.add(record.sensors * rigid_.transpose() - truth, from);
    for (std::size_t k = 0; k < static_.size(); ++k) {
      trial_.statics[k].add(record.sensors * static_[k].transpose() - truth, from);
    }
    const auto settled = truth.rows() - from;
    const Eigen::MatrixXd e = found.innovation.bottomRows(settled);
    trial_.innovation += e.transpose() * e;
    trial_.samples += static_cast<double>(settled);
    add_scores(estimated - truth, deviation, from);
    if (course != nullptr) set_course(truth, estimated, deviation, from, *course);
  }

  [[nodiscard]] Replay result() const {
    Replay replay;
    const auto& stated = observer_.filter.innovation;
    const Eigen::MatrixXd found = trial_.innovation / trial_.samples;
    const auto p = static_cast<double>(found.rows());
    replay.surprise = std::sqrt(stated.llt().solve(found).trace() / p);
    replay.surprise_of = (found.diagonal().array() / stated.diagonal().array()).sqrt();
    replay.seconds = trial_.samples * recordings_.sample_time_s;
    for (Eigen::Index j = 0; j < observer_.judges; ++j) {
      replay.judges.push_back(errors_of(j, replay.surprise));
    }
    return replay;
  }

 private:
  // The judge's own noise is part of what is seen at it.
  [[nodiscard]] double judge_noise(Eigen::Index j) const {
    return recordings_.noise(observer_.filter.system.sensors + j);
  }

  void add_scores(const Eigen::MatrixXd& wrong, const Eigen::MatrixXd& deviation,
                  Eigen::Index from) {
    const auto settled = wrong.rows() - from;
    for (Eigen::Index j = 0; j < observer_.judges; ++j) {
      const double noise = judge_noise(j);
      auto& all = trial_.score[static_cast<std::size_t>(j)];
      const auto before = all.size();
      all.conservativeResize(before + settled);
      all.tail(settled) = wrong.col(j).tail(settled).array().abs() /
                          (deviation.col(j).tail(settled).array().square() + noise * noise).sqrt();
    }
  }

  void set_course(const Eigen::MatrixXd& truth, const Eigen::MatrixXd& estimated,
                  const Eigen::MatrixXd& deviation, Eigen::Index from, ReplayCourse& course) const {
    const auto n = std::min(kDrawn, truth.rows() - from);
    course.time_s =
        Eigen::VectorXd::LinSpaced(n, static_cast<double>(from) * recordings_.sample_time_s,
                                   static_cast<double>(from + n - 1) * recordings_.sample_time_s);
    course.measured = truth.middleRows(from, n);
    course.estimate = estimated.middleRows(from, n);
    course.deviation = deviation.middleRows(from, n);
  }

  [[nodiscard]] JudgedErrors errors_of(Eigen::Index j, double surprise) const {
    const auto names = observer_.names();
    const auto& size = trial_.motion;
    JudgedErrors errors;
    errors.judge = names[names.size() - static_cast<std::size_t>(observer_.judges - j)];
    errors.rms = std::sqrt(size.square(j) / trial_.samples);
    errors.noise = judge_noise(j) / errors.rms;
    errors.observer = trial_.observer.over(size, j);
    errors.prediction = trial_.prediction.over(size, j);
    errors.model = trial_.model.over(size, j);
    errors.truth = truth_ ? trial_.truth.over(size, j) : kUnknown;
    errors.rigid = rigid_.size() > 0 ? trial_.rigid.over(size, j) : kUnknown;
    errors.interpolation = kUnknown;
    for (std::size_t k = 0; k < static_.size(); ++k) {
      const double found = trial_.statics[k].over(size, j);
      if (k > 0 && found >= errors.interpolation) continue;
      errors.interpolation = found;
      errors.interpolation_modes = static_cast<Eigen::Index>(k) + 1;
    }
    const auto& score = trial_.score[static_cast<std::size_t>(j)];
    const auto within = [&](double factor) {
      if (!std::isfinite(judge_noise(j))) return kUnknown;  // and so is what the band has to hold
      return (score.array() <= priors::kTwoSided95 * factor).cast<double>().mean();
    };
    errors.covered = within(1.0);
    errors.covered_widened = within(std::max(1.0, surprise));
    return errors;
  }

  const Observer& observer_;
  const Recordings& recordings_;
  const std::optional<modal::KalmanFilter>& truth_;
  modal::KalmanFilter model_, prediction_;
  std::vector<Eigen::MatrixXd> static_;
  Eigen::MatrixXd rigid_;
  Trial trial_;
};

}  // namespace

Replay replay(const study::Study& study, const Observer& observer, const Recordings& recordings,
              const std::optional<modal::KalmanFilter>& truth) {
  const auto names = observer.names();
  require(observer.judges > 0 &&
              std::vector(names.end() - observer.judges, names.end()) == recordings.judges,
          recordings.file +
              ": the held-out sensors of displacement are not in the recordings to judge the "
              "estimate; expected measurement.hold_out = [...]");
  const double settle_s = settling_time(*study.observer, observer.filter, recordings.sample_time_s);
  const auto from = first_settled(settle_s, recordings.sample_time_s);
  Replaying trial(study, observer, recordings, truth);
  ReplayCourse course;
  Eigen::Index used = 0;
  for (const auto& record : recordings.records) {
    if (record.sensors.rows() <= from) continue;
    trial.add(record, from, used == 0 ? &course : nullptr);
    ++used;
  }
  require(used > 0, nothing_settles(recordings.file, settle_s));
  auto result = trial.result();
  result.settle_s = settle_s;
  result.course = std::move(course);
  const auto skipped = std::ssize(recordings.records) - used;
  if (skipped > 0) {
    result.notes.push_back(fmt::format(
        "{} of {} records are shorter than the {:.3g} s in which the filter settles and "
        "are left out",
        skipped, std::ssize(recordings.records), result.settle_s));
  }
  return result;
}

}  // namespace chladni::steps
