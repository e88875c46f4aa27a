// Greedy choice and exchange of the devices of an observer.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "base/error.h"
#include "base/interrupt.h"
#include "dense/riccati.h"
#include "host/parallel.h"
#include "placement/constants.h"
#include "placement/observer_layouts.h"
#include "placement/optimum/spacing.h"
#include "placement/optimum/thinned.h"

namespace chladni::placement {
namespace {

using Indices = std::vector<Eigen::Index>;
using Devices = std::vector<PlacedDevice>;
constexpr double kGain = 1e-9;  // relative; less is rounding

// Rows that are there, and those of the devices that sense or act.
Eigen::MatrixXd rows_of(const ObserverProblem& problem, const Devices& devices, DeviceKind kind) {
  const auto& there = kind == DeviceKind::sensor ? problem.sensors : problem.actuators;
  Indices chosen;
  for (const auto& device : devices) {
    if (device.kind == kind || device.kind == DeviceKind::pair) chosen.push_back(device.site);
  }
  Eigen::MatrixXd rows(there.rows() + std::ssize(chosen), problem.rows.cols());
  if (there.rows() > 0) rows.topRows(there.rows()) = there;
  if (!chosen.empty()) rows.bottomRows(std::ssize(chosen)) = problem.rows(chosen, Eigen::all);
  return rows;
}

// What does not depend on the sensors: the disturbed modes, and what their motion and the error of
// their states cost.
struct Driven {
  ObserverModel::Disturbed system;
  Eigen::MatrixXd q;
  Eigen::MatrixXd weight;  // of the variance of the states
  double cost = 0.0;       // with all states known
};

// Scores layouts, each by its own Riccati equations.
class Scores {
 public:
  explicit Scores(const ObserverProblem& problem) : problem_(problem), model_(problem.task) {}

  [[nodiscard]] bool in_loop() const { return !problem_.counts.only_sensors(); }

  [[nodiscard]] Driven driven(const Devices& devices) const {
    const auto actuators = rows_of(problem_, devices, DeviceKind::actuator);
    Driven result{model_.disturbed(actuators), {}, {}, 0.0};
    const auto n = result.system.a.rows();
    result.q = result.system.q();
    result.weight = model_.weight(n);
    if (!in_loop()) return result;
    const Eigen::MatrixXd b = model_.moved(actuators, n);
    const auto& a = result.system.a;
    const Eigen::MatrixXd s = dense::doubled_riccati(a, b * b.transpose(), result.weight);
    result.cost = s.cwiseProduct(result.q).sum();
    result.weight = (a.transpose() * s * a + result.weight - s).eval();
    return result;
  }

  [[nodiscard]] double cost(const Driven& driven, const Devices& devices) const {
    const auto sensors = rows_of(problem_, devices, DeviceKind::sensor);
    if (sensors.rows() == 0 && in_loop()) return driven.cost;
    const Eigen::MatrixXd c = model_.seen(sensors, driven.system.a.rows());
    const Eigen::MatrixXd p =
        dense::doubled_riccati(driven.system.a.transpose(), c.transpose() * c, driven.q);
    const double before = driven.weight.cwiseProduct(p).sum();
    if (in_loop()) return driven.cost + before;
    const Eigen::MatrixXd seen = c * p;
    Eigen::MatrixXd innovation = seen * c.transpose();
    innovation.diagonal().array() += 1.0;
    const Eigen::MatrixXd known = innovation.llt().solve(seen);
    return before - (seen * driven.weight).cwiseProduct(known).sum();
  }

  [[nodiscard]] double cost(const Devices& devices) const { return cost(driven(devices), devices); }

  // Cost with a device of this kind at each of `candidates`, beside the others; infinite where none
  // may be.
  [[nodiscard]] Eigen::VectorXd costs(const Devices& others, DeviceKind kind,
                                      const Indices& candidates) {
    Eigen::VectorXd all =
        Eigen::VectorXd::Constant(std::ssize(candidates), std::numeric_limits<double>::infinity());
    Indices taken;
    for (const auto& device : others) taken.push_back(device.site);
    const auto same = kind == DeviceKind::sensor ? std::optional(driven(others)) : std::nullopt;
    parallel_tasks(candidates.size(), [&](std::size_t c) {
      throw_if_interrupted();
      if (!fits(problem_.position, problem_.spacing, taken, candidates[c])) return;
      auto devices = others;
      devices.push_back({kind, candidates[c]});
      all(static_cast<Eigen::Index>(c)) = same ? cost(*same, devices) : cost(devices);
    });
    layouts_ += static_cast<int>((all.array() < std::numeric_limits<double>::infinity()).count());
    return all;
  }

  [[nodiscard]] Eigen::VectorXd costs(const std::vector<Devices>& layouts) {
    Eigen::VectorXd all(std::ssize(layouts));
    parallel_tasks(layouts.size(), [&](std::size_t k) {
      throw_if_interrupted();
      all(static_cast<Eigen::Index>(k)) = cost(layouts[k]);
    });
    layouts_ += static_cast<int>(all.size());
    return all;
  }

  [[nodiscard]] int layouts() const { return layouts_; }
  [[nodiscard]] const ObserverModel& model() const { return model_; }

 private:
  const ObserverProblem& problem_;
  ObserverModel model_;
  int layouts_ = 0;
};

// The first of the least; rounding does not choose between equal places.
std::optional<Eigen::Index> least(const Eigen::VectorXd& costs) {
  if (costs.size() == 0 || !std::isfinite(costs.minCoeff())) return std::nullopt;
  const double enough = costs.minCoeff() * (1.0 + kGain);
  for (Eigen::Index c = 0; c < costs.size(); ++c) {
    if (costs(c) <= enough) return c;
  }
  return std::nullopt;
}

class Search {
 public:
  explicit Search(const ObserverProblem& problem)
      : problem_(problem), scores_(problem), candidates_(problem.position, problem.rows.rows()) {
    const auto& counts = problem.counts;
    kinds_.insert(kinds_.end(), static_cast<std::size_t>(counts.pairs), DeviceKind::pair);
    kinds_.insert(kinds_.end(), static_cast<std::size_t>(counts.actuators), DeviceKind::actuator);
    kinds_.insert(kinds_.end(), static_cast<std::size_t>(counts.sensors), DeviceKind::sensor);
  }

  // The first start is greedy, the others have every second device at random; none if the spacing
  // leaves no room.
  [[nodiscard]] std::optional<Devices> from_a_start(int start, std::mt19937& random) {
    const auto& coarse = candidates_.coarse();
    Devices devices;
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      const bool drawn = start > 0 && k % 2 == 0;
      const Indices some = drawn ? Indices{coarse[random() % coarse.size()]} : Indices{};
      if (!some.empty() && add(devices, kinds_[k], some)) continue;
      if (!add(devices, kinds_[k], coarse) && !add(devices, kinds_[k], candidates_.all())) {
        return std::nullopt;
      }
    }
    settled_ = exchange(devices, 20, [&](Eigen::Index) -> const Indices& { return coarse; });
    if (candidates_.is_large()) {
      settled_ = false;
      exchange(devices, 10, [&](Eigen::Index site) { return candidates_.near(site); });
    }
    return devices;
  }

  [[nodiscard]] double cost(const Devices& devices) const { return scores_.cost(devices); }
  [[nodiscard]] const Scores& scores() const { return scores_; }
  [[nodiscard]] bool settled() const { return settled_; }

 private:
  bool add(Devices& devices, DeviceKind kind, const Indices& candidates) {
    const auto best = least(scores_.costs(devices, kind, candidates));
    if (!best) return false;
    devices.push_back({kind, candidates[static_cast<std::size_t>(*best)]});
    return true;
  }

  // True if a whole round brought nothing.
  template <typename Candidates>
  bool exchange(Devices& devices, int rounds, const Candidates& candidates) {
    double now = cost(devices);
    for (int round = 0; round < rounds; ++round) {
      bool gained = false;
      for (auto& device : devices) {
        Devices others;
        for (const auto& other : devices) {
          if (&other != &device) others.push_back(other);
        }
        const Indices places = candidates(device.site);
        const auto costs = scores_.costs(others, device.kind, places);
        const auto best = least(costs);
        if (!best || costs(*best) >= now * (1.0 - kGain)) continue;
        device.site = places[static_cast<std::size_t>(*best)];
        now = costs(*best);
        gained = true;
      }
      gained |= move_together(devices, now, candidates);
      if (!gained) return true;
    }
    return false;
  }

  // What one device at a time does not reach: two of different kinds take each other's place, or go
  // elsewhere together, as far apart as before. The loop wants a sensor and an actuator near each
  // other, so that neither leaves alone.
  template <typename Candidates>
  bool move_together(Devices& devices, double& now, const Candidates& candidates) {
    bool gained = false;
    for (std::size_t i = 0; i < devices.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (devices[i].kind == devices[j].kind) continue;
        auto moves = together(devices, i, j, candidates(devices[i].site));
        const auto costs = scores_.costs(moves);
        const auto best = least(costs);
        if (!best || costs(*best) >= now * (1.0 - kGain)) continue;
        devices = moves[static_cast<std::size_t>(*best)];
        now = costs(*best);
        gained = true;
      }
    }
    return gained;
  }

  [[nodiscard]] std::vector<Devices> together(const Devices& devices, std::size_t i, std::size_t j,
                                              const Indices& places) const {
    std::vector<Devices> moves{devices};
    std::swap(moves[0][i].site, moves[0][j].site);
    const auto& position = problem_.position;
    if (position.rows() == 0) return moves;
    const Eigen::RowVector3d apart = position.row(devices[j].site) - position.row(devices[i].site);
    Indices others;
    for (std::size_t k = 0; k < devices.size(); ++k) {
      if (k != i && k != j) others.push_back(devices[k].site);
    }
    for (const auto place : places) {
      const Eigen::RowVector3d wanted = position.row(place) + apart;
      const auto beside = *std::ranges::min_element(places, {}, [&](Eigen::Index c) {
        return c == place ? std::numeric_limits<double>::infinity()
                          : (position.row(c) - wanted).squaredNorm();
      });
      auto sites = others;
      if (!fits(position, problem_.spacing, sites, place)) continue;
      sites.push_back(place);
      if (!fits(position, problem_.spacing, sites, beside)) continue;
      moves.push_back(devices);
      moves.back()[i].site = place;
      moves.back()[j].site = beside;
    }
    return moves;
  }

  const ObserverProblem& problem_;
  Scores scores_;
  SearchedCandidates candidates_;
  std::vector<DeviceKind> kinds_;
  bool settled_ = false;
};

void check(const ObserverProblem& problem) {
  const auto& counts = problem.counts;
  require(counts.sensors >= 0 && counts.actuators >= 0 && counts.pairs >= 0 && counts.all() > 0,
          "layout for an observer: no device is to be chosen");
  require(problem.rows.allFinite(), "layout for an observer: what a candidate sees is not finite");
  require(counts.all() <= problem.rows.rows(),
          fmt::format("layout for an observer: {} devices are wanted of {} candidates",
                      counts.all(), problem.rows.rows()));
  require(
      counts.only_sensors() || problem.task.effort > 0.0,
      "layout for an observer: actuators or pairs are to be chosen, and what a force costs is not "
      "stated; expected an effort above 0 m/N");
  require_positions(problem.position, problem.rows.rows(), problem.spacing);
  require(
      problem.position.rows() > 0 || problem.rows.rows() <= 2 * Constants::coarse,
      fmt::format("layout for an observer: {} candidates without positions; expected at most {}, "
                  "or their positions",
                  problem.rows.rows(), 2 * Constants::coarse));
  const bool acted = problem.actuators.rows() > 0 || !counts.only_sensors();
  require(
      acted || !problem.task.fixed.empty(),
      "layout for an observer: the disturbances act at actuators alone, and there is no actuator");
}

int order_of(DeviceKind kind) {
  if (kind == DeviceKind::pair) return 0;
  return kind == DeviceKind::actuator ? 1 : 2;
}

}  // namespace

ObserverValue observer_value(const ObserverProblem& problem,
                             const std::vector<PlacedDevice>& devices) {
  return ObserverModel(problem.task)
      .value(rows_of(problem, devices, DeviceKind::sensor),
             rows_of(problem, devices, DeviceKind::actuator));
}

double cost_of(const ObserverProblem& problem, const ObserverValue& value) {
  return problem.counts.only_sensors() ? value.estimate : value.loop;
}

ObserverChoice best_observer(const ObserverProblem& problem, const ObserverOptions& options) {
  check(problem);
  Search search(problem);
  std::mt19937 random(options.seed);
  ObserverChoice best;
  double lowest = std::numeric_limits<double>::infinity();
  for (int start = 0; start < std::max(1, options.starts); ++start) {
    const auto devices = search.from_a_start(start, random);
    if (!devices) {
      require(start > 0,
              fmt::format("layout for an observer: {} devices at least {:.6g} mm apart do "
                          "not fit",
                          problem.counts.all(), 1e3 * problem.spacing));
      continue;
    }
    const double cost = search.cost(*devices);
    if (cost >= lowest * (1.0 - kGain)) continue;
    lowest = cost;
    best.devices = *devices;
    best.swap_optimal = search.settled();
  }
  std::ranges::sort(best.devices, [](const PlacedDevice& a, const PlacedDevice& b) {
    return std::pair(order_of(a.kind), a.site) < std::pair(order_of(b.kind), b.site);
  });
  best.layouts = search.scores().layouts();
  best.value = observer_value(problem, best.devices);
  const double exact = cost_of(problem, best.value);
  if (!(std::abs(exact - lowest) <= 1e-6 * exact)) {
    throw NumericalFailure(fmt::format(
        "layout for an observer: its Riccati equation gives {:.9g} m^2, and doubling {:.9g} m^2",
        exact, lowest));
  }
  return best;
}

}  // namespace chladni::placement
