// chladni doctor: checks the installation and estimates its speed.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <ostream>
#include <vector>

#include "app/command.h"
#include "app/workers.h"
#include "base/error.h"
#include "base/quantity.h"
#include "dense/blas.h"
#include "fem/assemble.h"
#include "fem/factor_check.h"
#include "fem/modes.h"
#include "host/confinement.h"
#include "host/memory.h"
#include "host/parallel.h"
#include "host/worker.h"
#include "mesh/bodies.h"
#include "show/version.h"

namespace chladni::app {
namespace {

struct Finding {
  bool good = true;
  std::string what, found;
};

Finding kernel() {
  const std::string now = dense::blas_kernel();
  const std::string best = dense::best_blas_kernel();
  const bool slow = now == "Prescott" && !best.empty();
  return {!slow, "BLAS kernel",
          slow ? now + ", but this processor can run " + best +
                     ": several times slower; set OPENBLAS_CORETYPE=" + best
               : now};
}

// The program of a worker; nothing where it is missing and belongs to a package of its own.
std::optional<std::filesystem::path> program_of(const Worker& worker) {
  try {
    return worker_path(worker.name);
  } catch (const WorkerDied&) {
    if (worker.package.empty()) throw;
    return {};
  }
}

Finding found(const Worker& worker) {
  const std::string name(worker.name);
  const std::string serves(worker.serves);
  if (!worker.built) return {true, name, "not built: no " + serves};
  try {
    const auto program = program_of(worker);
    if (!program) {
      return {true, name,
              fmt::format("optional, not installed: no {}; apt-get install {}", serves,
                          worker.package)};
    }
    try_worker(*program, worker.confined);
    return {true, name, program->string()};
  } catch (const WorkerDied& e) {
    return {false, name, serves + " will not work: " + e.what()};
  }
}

Finding confinement() { return {true, "readers", confinement_support().text()}; }

Finding display() {
  const char* name = std::getenv("DISPLAY");
  if (name != nullptr && *name != '\0') return {true, "display", name};
  if (program_on_path("Xvfb")) return {true, "display", "none; pictures are painted on an Xvfb"};
  return {false, "display", "none, and no Xvfb: no pictures; apt-get install xvfb"};
}

Finding units() {
  const double value = quantity("2.7 g/cm^3", "kg/m^3");
  return {std::abs(value - 2700.0) < 1e-6, "units", fmt::format("2.7 g/cm^3 = {} kg/m^3", value)};
}

/// A free plate whose first frequency is known (Legendre Ritz, three dimensions).
Finding modes_of_a_plate() {
  const auto start = std::chrono::steady_clock::now();
  const mesh::Plate plate{.length = 0.6, .width = 0.6, .thickness = 0.02};
  const auto body = with_order(layered(plate, default_layering(plate, 3)), 3);
  const auto system = fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)});
  const auto [modes, summary] = fem::modes(system, {.count = 6});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  const double first = modes.frequency_hz(modes.rigid_count);
  const bool good =
      modes.rigid_count == 6 && summary.complete && std::abs(first / 178.9033 - 1.0) < 0.01;
  return {
      good, "self-check",
      fmt::format("free plate: {} rigid-body modes, first flexible {:.3f} Hz (178.903), {}, "
                  "{} degrees of freedom in {:.2f} s",
                  modes.rigid_count, first, summary.text, system.dofs.free_count, took.count())};
}

// Our count of eigenvalues and CHOLMOD's own, which share no code.
Finding factorisation() {
  const mesh::Plate plate{.length = 0.6, .width = 0.6, .thickness = 0.02};
  const auto body = with_order(layered(plate, 0.15, 1), 2);
  constexpr double hz = 1500.0;
  const auto check =
      fem::factor_check(fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)}), hz);
  return {
      check.good(), "factorisation",
      fmt::format("{} modes below {} Hz by our count, {} by CHOLMOD's LDLᵀ; a solve leaves {:.1g}",
                  check.counted, hz, check.counted_by_cholmod, check.residual)};
}

Finding memory() {
  const double free = static_cast<double>(available_memory());
  return {free > 1e9, "memory", fmt::format("{:.1f} GB free", 1e-9 * free)};
}

}  // namespace

int doctor(std::ostream& results) {
  std::vector<Finding> findings = {{true, "chladni", show::version()},
                                   kernel(),
                                   {true, "threads", fmt::to_string(thread_count())},
                                   memory()};
  for (const auto& worker : kWorkers) findings.push_back(found(worker));
  findings.insert(findings.end(),
                  {confinement(), display(), units(), factorisation(), modes_of_a_plate()});
  bool good = true;
  for (const auto& finding : findings) {
    good = good && finding.good;
    results << fmt::format("{}  {:<16} {}\n", finding.good ? "ok " : "BAD", finding.what,
                           finding.found);
  }
  return good ? 0 : 4;
}

}  // namespace chladni::app
