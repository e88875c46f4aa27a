#include "stage/remedies/trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <string>
#include <utility>

#include "fem/error_estimate.h"
#include "stage/forecast.h"
#include "stage/mirrors.h"

namespace chladni::stage {
namespace {

constexpr double kShare = 0.9;             // of the memory that a remedy may take
constexpr double kAnalysed = 3e5;          // degrees of freedom: the pattern is analysed up to here
constexpr double kSolved = 2.5e4;          // and the modes are found up to here, in seconds
constexpr double kCoarser = 3.0;           // ratio of the degrees of freedom of two solved meshes
constexpr double kGrowth = 1.4;            // of a factor with them; plates 1.17, blocks 1.37
constexpr double kFreedomsPerMode = 10.0;  // fewer resolve nothing
// The largest estimate of a mesh was an upper side of the largest error up to this, on beams,
// plates and blocks of order 2; above it modes change their order (fem/error_estimate.h).
constexpr double kTooCoarse = 0.2;
constexpr double kFull = 0.8;   // of the room that a mesh takes: no finer one is looked for
constexpr double kAim = 0.98;   // of the room
constexpr double kStep = 1.25;  // between the edges that are tried
constexpr int kHalvings = 5;
constexpr int kAttempts = 8;

// Three digits of millimetres, at least `metres`; as a study that states them is read.
double rounded_up(double metres) {
  const double mm = 1e3 * metres;
  const double step = std::pow(10.0, std::floor(std::log10(mm)) - 2.0);
  return 1e-3 * std::stod(fmt::format("{:.6g}", step * std::ceil(mm / step * (1.0 - 1e-12))));
}

double mean_longest_edge(const mesh::TetMesh& body) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    double longest = 0.0;
    for (const auto& [a, b] : mesh::kTetEdges) {
      longest = std::max(
          longest, (body.points.row(body.tets(t, a)) - body.points.row(body.tets(t, b))).norm());
    }
    sum += longest;
  }
  return sum / static_cast<double>(body.tet_count());
}

// What cannot be tried cannot be proposed.
template <typename Value, typename Try>
std::optional<Value> attempted(Try attempt) {
  try {
    return attempt();
  } catch (const InvalidInput&) {
  } catch (const NumericalFailure&) {
  } catch (const OutOfResources&) {
  } catch (const std::bad_alloc&) {
  }
  return {};
}

WorkOptions quiet_options(const Work& work, double have_bytes) {
  auto options = work.choices();
  options.memory_limit_bytes = static_cast<std::size_t>(have_bytes);
  options.keep_times = false;
  return options;
}

}  // namespace

Trials::Trials(const study::Study& study, const Introduction& introduction, double have_bytes,
               Work& work)
    : study_(study),
      introduction_(introduction),
      have_bytes_(have_bytes),
      by_ranks_(!engine_of(study, work).empty()),
      progress_(work.progress()),
      quiet_(quiet_options(work, have_bytes)) {
  const double rigid = 6.0;
  options_.count = static_cast<int>(std::max(1.0, modes_wanted(study, introduction.body) - rigid));
  options_.certificate = work.choices().certificate;
  options_.seed = work.seed();
  options_.memory_limit_bytes = quiet_.choices().memory_limit_bytes;
}

study::Study Trials::with(const Elements& elements) const {
  study::Study changed = study_;
  if (elements.edge_length > 0.0) changed.mesh.edge_length = elements.edge_length;
  changed.mesh.order = elements.order;
  changed.modes.mirrors = elements.mirrors;
  return changed;
}

std::optional<Cost> Trials::cost(const Elements& elements) const {
  const auto changed = with(elements);
  const bool from_file = study_.geometry.kind == "file";
  return attempted<Cost>([&] {
    return from_file ? forecast(changed, introduction_.outline)
                     : forecast(changed, outline_of(changed));
  });
}

std::optional<Elements> Trials::finest(Elements elements,
                                       const std::function<bool(const Cost&)>& passes) {
  if (study_.geometry.kind == "file" && !introduction_.outline.surface) return {};
  const auto good = [&](double edge) {
    elements.edge_length = edge;
    const auto found = cost(elements);
    return found && passes(*found);
  };
  constexpr double kFinest = 1e-5;  // of the body's size
  const double longest = introduction_.body.extent_m.maxCoeff();
  double edge = rounded_up(longest);
  if (!good(edge)) return {};
  double shorter = rounded_up(edge / kStep);
  for (; shorter > kFinest * longest && good(shorter); shorter = rounded_up(edge / kStep)) {
    edge = shorter;
  }
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double middle = rounded_up(std::sqrt(edge * shorter));
    if (middle >= edge || middle <= shorter) break;
    (good(middle) ? edge : shorter) = middle;
  }
  elements.edge_length = edge;
  return elements;
}

std::optional<Elements> Trials::at_most(Elements elements, double degrees_of_freedom) {
  return finest(std::move(elements),
                [&](const Cost& cost) { return cost.degrees_of_freedom <= degrees_of_freedom; });
}

Demand Trials::analysed(const Elements& elements) {
  tell(progress_, "looking for a mesh that fits");
  const auto whole = assembled(with(elements), quiet_);
  const auto& body = whole.model.body;
  const auto cost = forecast(with(elements), body, introduction_.body);
  Demand demand{.elements = elements,
                .degrees_of_freedom = cost.degrees_of_freedom,
                .memory_bytes = by_ranks_ ? cost.memory_beside_ranks_bytes : cost.memory_bytes,
                .cell_size = mean_longest_edge(body)};
  const auto planes = mirrors_of(whole.model, *whole.system, elements.mirrors);
  const auto memory = planes.empty() ? fem::memory_forecast(*whole.system, options_)
                                     : fem::memory_forecast(*whole.system, planes, options_);
  demand.factor_bytes = memory.factor_bytes;
  if (!by_ranks_) demand.memory_bytes = std::max(demand.memory_bytes, memory.total_bytes);
  return demand;
}

std::optional<Demand> Trials::smaller(Elements elements, double degrees_of_freedom) {
  const auto found = at_most(std::move(elements), degrees_of_freedom);
  if (!found) return {};
  return attempted<Demand>([&] { return analysed(*found); });
}

// The demand of a large mesh is taken from that of the largest that is analysed.
std::optional<Demand> Trials::demand(const Elements& elements) {
  const auto expected = cost(elements);
  if (!expected) return {};
  if (expected->degrees_of_freedom <= kAnalysed) {
    return attempted<Demand>([&] { return analysed(elements); });
  }
  auto demand = smaller(elements, kAnalysed);
  if (!demand) return {};
  const double ratio = expected->degrees_of_freedom / demand->degrees_of_freedom;
  demand->memory_bytes *= std::pow(ratio, kGrowth);
  demand->factor_bytes *= std::pow(ratio, kGrowth);
  demand->cell_size *= elements.edge_length / demand->elements.edge_length;
  demand->degrees_of_freedom = expected->degrees_of_freedom;
  demand->elements = elements;
  return demand;
}

bool Trials::fits(const Demand& demand) const {
  return demand.memory_bytes <= kShare * have_bytes_;
}

// The forecast leads to a mesh, the mesh's own demand to a better aim.
std::optional<Demand> Trials::fitting(Elements elements, double more) {
  const double room = kShare * have_bytes_;
  double target = room / std::max(1.0, more);  // of the forecast
  std::optional<Demand> best;
  double last_edge = 0.0;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto tried = finest(elements, [&](const Cost& cost) {
      return (by_ranks_ ? cost.memory_beside_ranks_bytes : cost.memory_bytes) <= target;
    });
    if (!tried || tried->edge_length == last_edge) break;
    last_edge = tried->edge_length;
    const auto found = demand(*tried);
    if (!found || found->degrees_of_freedom < kFreedomsPerMode * options_.count) break;
    if (!fits(*found) && best) break;
    if (fits(*found) && (!best || found->degrees_of_freedom > best->degrees_of_freedom)) {
      best = found;
    }
    if (best && best->memory_bytes > kFull * room) break;
    target *= kAim * room / found->memory_bytes;
  }
  return best;
}

std::vector<std::string> Trials::mirrors(int order) {
  const auto small = at_most({.order = order}, kSolved);
  if (!small) return {};
  std::vector<std::string> axes;
  const auto holding = attempted<std::vector<std::string>>([&] {
    const auto whole = assembled(with(*small), quiet_);
    for (const std::string axis : {"x", "y", "z"}) {
      const auto plane = attempted<std::vector<fem::Mirror>>(
          [&] { return mirrors_of(whole.model, *whole.system, {axis}); });
      if (plane) axes.push_back(axis);
    }
    return axes;
  });
  return holding.value_or(std::vector<std::string>{});
}

std::optional<Trials::Solved> Trials::solved(const Elements& elements) {
  tell(progress_, "estimating the error of a coarser mesh");
  const auto known = attempted<Solved>([&] {
    const auto whole = assembled(with(elements), quiet_);
    const auto found = fem::modes(*whole.system, options_, {});
    const Eigen::VectorXd error =
        fem::frequency_error(whole.model.body, whole.model.materials, *whole.system, found.modes);
    return Solved{{error.maxCoeff(), found.modes.frequency_hz.tail<1>()(0)},
                  mean_longest_edge(whole.model.body)};
  });
  return known && known->error.relative <= kTooCoarse ? known : std::nullopt;
}

// On two coarser meshes a part of the error falls at most as the cells' length to the power
// 2·order, the rate of the elements. All else is taken not to fall: what lies across the layers,
// where the edges do not go, or at singular edges.
std::optional<MeshError> Trials::error(const Demand& demand) {
  const bool is_small = demand.degrees_of_freedom <= kSolved;
  const auto solved_at_most = [&](double degrees_of_freedom) -> std::optional<Solved> {
    const auto elements = at_most(demand.elements, degrees_of_freedom);
    return elements ? solved(*elements) : std::nullopt;
  };
  const auto fine = is_small ? solved(demand.elements) : solved_at_most(kSolved);
  if (!fine) return {};
  if (is_small) return fine->error;
  const auto coarse = solved_at_most(kSolved / kCoarser);
  if (!coarse) return {};
  const double order = 2.0 * demand.elements.order;
  const double coarser = std::pow(coarse->cell_size / fine->cell_size, order);
  const double excess = coarse->error.relative - fine->error.relative;
  const double falling = std::clamp(excess / (coarser - 1.0), 0.0, fine->error.relative);
  auto error = fine->error;
  error.relative -= falling * (1.0 - std::pow(demand.cell_size / fine->cell_size, order));
  return error;
}

}  // namespace chladni::stage
