#include "steps/observer/stated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "stage/points_on_body.h"

namespace chladni::steps {

mesh::Site site_of(const study::Study& study, const mesh::SiteFinder& finder, double reach,
                   const study::Place& at, const std::string& what) {
  auto site = stage::site_at(finder, at);
  require(site.distance <= reach,
          fmt::format("{}:{}: {} is not on the body, which is {:.3g} mm away", study.file.string(),
                      at.line, what, 1e3 * site.distance));
  return site;
}

modal::Disturbance disturbance_of(const study::DisturbancePlan& plan, const std::string& name,
                                  Eigen::Index input) {
  using enum modal::DisturbanceCourse;
  modal::Disturbance one{.name = name, .input = input, .rms = plan.rms, .density = plan.density};
  if (plan.high_hz > 0.0) one.course = band;
  if (plan.drift_time > 0.0) one.course = drift;
  one.low_hz = plan.low_hz;
  one.high_hz = plan.high_hz;
  one.drift_time_s = plan.drift_time > 0.0 ? plan.drift_time : 1.0;
  return one;
}

double stated_sample_rate(const study::Study& study) {
  double rate = study.observer ? study.observer->sample_rate_hz : 0.0;
  if (rate == 0.0 && study.state_space) rate = study.state_space->sample_rate_hz;
  if (rate == 0.0 && study.experiment) rate = study.experiment->sample_rate_hz;
  return rate;
}

double settling_time(const study::ObserverPlan& plan, const modal::KalmanFilter& filter,
                     double sample_time_s) {
  constexpr double kTimeConstants = 5.0;
  if (plan.settle > 0.0) return plan.settle;
  const double slowest = filter.pole.size() > 0 ? filter.pole.cwiseAbs().maxCoeff() : 0.0;
  if (slowest >= 1.0) return HUGE_VAL;
  return slowest > 0.0 ? kTimeConstants * sample_time_s / -std::log(slowest) : 0.0;
}

Eigen::Index first_settled(double settle_s, double sample_time_s) {
  constexpr double kMoreThanAnyRecord = 1e15;  // which an index still holds
  return static_cast<Eigen::Index>(
      std::min(std::ceil(settle_s / sample_time_s), kMoreThanAnyRecord));
}

std::string nothing_settles(const std::string& file, double settle_s) {
  return fmt::format(
      "{}: every record is shorter than the {:.3g} s in which the filter settles; expected longer "
      "ones, or observer.settle",
      file, settle_s);
}

}  // namespace chladni::steps
