// The table of an observer.
#include <fmt/format.h>

#include <cmath>

#include "base/percent.h"
#include "base/turn.h"
#include "show/observer.h"
#include "steps/predicted.h"

namespace chladni::show {

std::string length_text(double metres) {
  if (std::isinf(metres)) return "drifts";
  if (std::isnan(metres)) return "-";
  const double size = std::abs(metres);
  if (size >= 1e-3) return fmt::format("{:.3g} mm", 1e3 * metres);
  if (size >= 1e-6) return fmt::format("{:.3g} um", 1e6 * metres);
  if (size >= 1e-9 || size == 0.0) return fmt::format("{:.3g} nm", 1e9 * metres);
  return fmt::format("{:.3g} pm", 1e12 * metres);
}

namespace {

constexpr double kUnseen = 0.9;  // part of a mode's motion that stays unknown

// Above ten times the motion the number says nothing more.
std::string part(double value) {
  if (std::isnan(value)) return "-";
  return value > 10.0 ? "> 1000 %" : percent(value);
}

std::string other_methods(const steps::JudgedErrors& one) {
  std::string text;
  const auto add = [&](const char* what, double error) {
    if (std::isnan(error)) return;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", what, part(error));
  };
  add("static interpolation", one.interpolation);
  add("rigid body", one.rigid);
  add("the model without sensors", one.model);
  add("the filter that knows the truth", one.truth);
  return text;
}

// Better and worse than static interpolation and the rigid body.
std::string verdict(const steps::JudgedErrors& one) {
  const double rival = std::fmin(one.interpolation, one.rigid);
  const bool pays = std::isnan(rival) || one.observer < rival;
  return fmt::format("{}: {} of its motion of {} rms is estimated wrongly ({}).{}\n", one.judge,
                     percent(one.observer), length_text(one.rms), other_methods(one),
                     pays ? "" : " The observer does not pay here.");
}

std::string expected_verdict(const steps::Observer& observer) {
  std::string text;
  const auto names = observer.names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    text +=
        fmt::format("{}: expected to be known within {} (1 sigma), without sensors {}.\n", names[i],
                    length_text(observer.deviation(k)), length_text(observer.without(k)));
  }
  return text;
}

std::string judges_text(const steps::Replay& replay, const steps::Replay& stated) {
  std::string text =
      fmt::format("\n{:<10}{:>10}{:>10}{:>12}{:>10}{:>14}{:>10}{:>10}{:>10}{:>12}{:>10}\n", "judge",
                  "rms", "observer", "predicted", "static", "modes of it", "rigid", "model",
                  "truth", "95 % covers", "widened");
  for (const auto& one : replay.judges) {
    text +=
        fmt::format("{:<10}{:>10}{:>11}{:>11}{:>11}{:>13}{:>11}{:>12}{:>11}{:>13}{:>10}\n",
                    one.judge, length_text(one.rms), part(one.observer), part(one.prediction),
                    part(one.interpolation), one.interpolation_modes, part(one.rigid),
                    part(one.model), part(one.truth), part(one.covered), part(one.covered_widened));
    if (std::isfinite(one.noise)) {
      text += fmt::format("          its own noise is {} of its motion\n", percent(one.noise));
    }
  }
  return text + fmt::format(
                    "{:.3g} s of recordings, each without its first {:.3g} s. Innovations "
                    "are {:.2f} times what is stated.\n",
                    replay.seconds, replay.settle_s, stated.surprise);
}

// What sensors that were left out in turn say of the band.
std::string left_out_text(const steps::Observer& observer) {
  if (observer.left_out.array().isNaN().all()) {
    return "no sensor can be left out, so nothing but the innovations judges the band\n";
  }
  if (observer.band_factor == 1.0) return {};
  return fmt::format(
      "sensors left out in turn err by up to {:.2f} times their band: it is widened by that\n",
      observer.band_factor);
}

// The noise that the recordings ask for, and what the filter would do with the stated one.
std::string noise_text(const steps::Observed& observed) {
  const auto& noise = observed.observer.noise;
  if (!noise.is_learned()) return {};
  std::string text = fmt::format(
      "noise that the recordings ask for: disturbances {:.3g} times, sensors {:.3g} times what is "
      "stated\n",
      noise.disturbances, noise.sensors);
  text += left_out_text(observed.observer);
  if (!observed.stated) return text;
  for (const auto& one : observed.stated->judges) {
    text +=
        fmt::format("with the noise as stated {} of {} would be wrong, and {} within the band\n",
                    part(one.observer), one.judge, part(one.covered));
  }
  return text;
}

std::string points_text(const steps::Observer& observer) {
  std::string text =
      fmt::format("\n{:<10}{:>12}{:>14}{:>18}{:>14}   1 sigma, under the {} disturbances\n",
                  "point", "estimated", "a sample on", "without sensors", "by its shape",
                  observer.noise.is_learned() ? "learned" : "stated");
  const auto names = observer.names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    text += fmt::format("{:<10}{:>12}{:>14}{:>18}{:>14}\n", names[i],
                        length_text(observer.deviation(k)), length_text(observer.prediction(k)),
                        length_text(observer.without(k)), length_text(observer.shape_deviation(k)));
  }
  return text;
}

std::string modes_text(const steps::Observer& observer) {
  std::string unseen;
  const auto& frequency = steps::identified_of(*observer.shapes).found.fit.model.frequency_hz;
  for (Eigen::Index m = 0; m < observer.unknown_part.size(); ++m) {
    if (!(observer.unknown_part(m) > kUnseen)) continue;
    unseen += fmt::format("{}{} ({:.1f} Hz, {})", unseen.empty() ? "" : ", ", m + 1, frequency(m),
                          percent(observer.unknown_part(m)));
  }
  if (unseen.empty()) return {};
  return "modes of whose motion the sensors tell little: " + unseen + "\n";
}

}  // namespace

std::string observer_table(const steps::Observed& observed) {
  const auto& [observer, replay, stated, loop] = observed;
  std::string text = "\n";
  if (replay) {
    for (const auto& one : replay->judges) text += verdict(one);
    text += judges_text(*replay, stated ? *stated : *replay) + noise_text(observed);
  } else {
    text += expected_verdict(observer);
  }
  if (loop) text += loop_text(*loop);
  text += points_text(observer) + modes_text(observer);
  const auto& system = observer.filter.system;
  const double slowest = observer.filter.pole.cwiseAbs().maxCoeff();
  return text + fmt::format(
                    "filter of {} states at {:.6g} Hz, {} sensors, {} known forces; its "
                    "slowest pole decays in {:.3g} s (observer.h, observer.mat)\n",
                    system.state_count(), 1.0 / observer.sample_time_s, system.sensors,
                    system.known, observer.sample_time_s / -std::log(slowest));
}

}  // namespace chladni::show
