#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "stage/forecast.h"
#include "stage/remedies/trials.h"

namespace chladni::stage {
namespace {

constexpr int kCubic = 3;

// Memory of ranks, above all that was measured with two to seven of them
// (docs/reference/cluster.md).
constexpr double kOfEachRank = 53e6;       // libraries, and buffers between ranks
constexpr double kOfTheFirst = 3e3;        // per degree of freedom: analysis, on one rank
constexpr double kSharedPerFreedom = 1e3;  // among the ranks
constexpr double kSharedPerFactor = 2.5;   // bytes per byte of the factor
constexpr double kFewRanks = 4.0;          // where none are few enough to fit this memory
constexpr double kShareOfRank = 0.9;       // of the memory that a rank may take
constexpr double kMostRanks = 1024.0;

Remedy remedy_of(std::string kind, const Demand& demand, Trials& trials) {
  Remedy remedy{.kind = std::move(kind),
                .edge_length_m = demand.elements.edge_length,
                .order = demand.elements.order,
                .degrees_of_freedom = demand.degrees_of_freedom,
                .memory_bytes = demand.memory_bytes};
  if (const auto error = trials.error(demand)) {
    remedy.frequency_error = error->relative;
    remedy.highest_hz = error->highest_hz;
  }
  return remedy;
}

// The study's own mesh in mirrored parts, or the finest that fits so.
std::optional<Remedy> by_mirrors(const Cost& refused, double more, Trials& trials) {
  Elements elements{.order = refused.order, .mirrors = trials.mirrors(refused.order)};
  if (elements.mirrors.empty()) return {};
  if (const auto own = trials.demand(elements); own && trials.fits(*own)) {
    return Remedy{.kind = "mirror symmetry",
                  .mirrors = elements.mirrors,
                  .degrees_of_freedom = own->degrees_of_freedom,
                  .memory_bytes = own->memory_bytes};
  }
  const auto fits = trials.fitting(elements, more);
  if (!fits) return {};
  auto remedy = remedy_of("mirror symmetry", *fits, trials);
  remedy.mirrors = elements.mirrors;
  return remedy;
}

// The factor of the refused mesh, from two that were analysed.
double factor_of(const Cost& refused, const std::optional<Demand>& fits, Trials& trials) {
  if (!fits) return refused.memory_bytes;  // more than the factor
  const auto small = trials.smaller(fits->elements, fits->degrees_of_freedom / 4.0);
  double growth = 1.4;
  if (small && small->degrees_of_freedom < fits->degrees_of_freedom) {
    growth = std::clamp(std::log(fits->factor_bytes / small->factor_bytes) /
                            std::log(fits->degrees_of_freedom / small->degrees_of_freedom),
                        1.0, 1.5);
  }
  return fits->factor_bytes *
         std::pow(refused.degrees_of_freedom / fits->degrees_of_freedom, growth);
}

// As few ranks as each fit this memory; where no number does, a few on machines that hold them.
std::optional<Remedy> by_ranks(const Cost& refused, double factor_bytes, double have_bytes) {
  if (refused.memory_beside_ranks_bytes > have_bytes) return {};
  const double n = refused.degrees_of_freedom;
  const double own = kOfEachRank + kOfTheFirst * n;
  const double shared = kSharedPerFactor * factor_bytes + kSharedPerFreedom * n;
  const double room = kShareOfRank * have_bytes - own;
  double ranks = room > 0.0 ? std::max(2.0, std::ceil(shared / room)) : kFewRanks;
  if (ranks > kMostRanks) ranks = kFewRanks;
  return Remedy{.kind = "ranks",
                .engine = fmt::format("mpiexec -n {:.0f}", ranks),
                .degrees_of_freedom = n,
                .memory_bytes = refused.memory_beside_ranks_bytes,
                .ranks = static_cast<int>(ranks),
                .rank_bytes = own + shared / ranks};
}

// The error with two digits; rounded up, because it is a bound.
std::string percent(double part) {
  const double percents = std::max(1e-10, 100.0 * part);
  const double step = std::pow(10.0, std::floor(std::log10(percents)) - 1.0);
  return fmt::format("{:.2g} %", step * std::ceil(percents / step));
}

}  // namespace

std::string millimetres(double metres) { return fmt::format("{:.6g} mm", 1e3 * metres); }

std::string Remedy::line() const {
  if (ranks > 0) {
    return fmt::format(
        "--engine \"{}\": the same mesh by {} ranks of {} each, on as many machines as hold them, "
        "and {} here",
        engine, ranks, bytes_text(rank_bytes), bytes_text(memory_bytes));
  }
  std::vector<std::string> parts;
  if (edge_length_m > 0.0) {
    parts.push_back(fmt::format("mesh.edge_length = \"{}\"", millimetres(edge_length_m)));
  }
  if (order > 0) parts.push_back(fmt::format("mesh.order = {}", order));
  if (!mirrors.empty()) {
    parts.push_back(fmt::format("modes.mirrors = [\"{}\"]", fmt::join(mirrors, "\", \"")));
  }
  const auto error = edge_length_m == 0.0 ? std::string("the same frequencies")
                     : frequency_error
                         ? fmt::format("frequencies up to {:.6g} Hz at most {} too high",
                                       highest_hz, percent(*frequency_error))
                         : std::string("the error of its frequencies is not known");
  return fmt::format("{}: {:.0f} degrees of freedom, {}, {}", fmt::join(parts, ", "),
                     degrees_of_freedom, bytes_text(memory_bytes), error);
}

std::vector<Remedy> remedies(const study::Study& study, const Introduction& introduction,
                             const Shortage& shortage, Work& work) {
  const auto& refused = introduction.cost;
  Trials trials(study, introduction, shortage.have_bytes, work);
  const double more = shortage.need_bytes / refused.memory_bytes;
  const auto& mirrors = study.modes.mirrors;
  std::vector<Remedy> ways;
  const auto fits = trials.fitting({.order = refused.order, .mirrors = mirrors}, more);
  if (fits) ways.push_back(remedy_of("coarser mesh", *fits, trials));
  if (refused.order != kCubic) {
    const auto cubic = trials.fitting({.order = kCubic, .mirrors = mirrors}, more);
    if (cubic) ways.push_back(remedy_of("cubic cells", *cubic, trials));
  }
  if (!mirrors.empty() || !engine_of(study, work).empty()) return ways;
  if (auto way = by_mirrors(refused, more, trials)) ways.push_back(std::move(*way));
  const double factor =
      shortage.factor_bytes ? *shortage.factor_bytes : factor_of(refused, fits, trials);
  if (auto way = by_ranks(refused, factor, shortage.have_bytes)) ways.push_back(std::move(*way));
  return ways;
}

void refuse(const study::Study& study, const Introduction& introduction, const Shortage& shortage,
            Work& work) {
  work.note("this does not fit; looking for what does");
  auto ways = remedies(study, introduction, shortage, work);
  auto text = fmt::format(
      "{}: {:.0f} degrees of freedom and {:.0f} modes are forecast to need {} "
      "of memory and there is {}",
      study.file.string(), introduction.cost.degrees_of_freedom,
      modes_wanted(study, introduction.body), bytes_text(shortage.need_bytes),
      bytes_text(shortage.have_bytes));
  text += ways.empty() ? "; no coarser mesh fits: ask for fewer modes (modes.count), or give more "
                         "memory"
                       : "; what fits:";
  for (const auto& way : ways) text += "\n  " + way.line();
  work.clear_progress();
  throw DoesNotFit(text, std::move(ways));
}

}  // namespace chladni::stage
