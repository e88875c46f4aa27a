// chladni doctor: is this installation fit, and how fast will it be?
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ostream>

#include "app/command.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/quantity.h"
#include "base/worker.h"
#include "fem/assemble.h"
#include "fem/blas.h"
#include "fem/modes.h"
#include "mesh/bodies.h"

namespace chladni::app {
namespace {

struct Finding {
  bool good = true;
  std::string what, found;
};

Finding kernel() {
  const std::string now = fem::blas_kernel();
  const std::string best = fem::best_blas_kernel();
  const bool slow = now == "Prescott" && !best.empty();
  return {!slow, "BLAS kernel",
          slow ? now + ", but this processor can run " + best +
                     ": several times slower; set OPENBLAS_CORETYPE=" + best
               : now};
}

Finding worker(const std::string& name, const std::string& serves) {
  try {
    return {true, name, worker_path(name).string()};
  } catch (const WorkerDied& e) {
    return {false, name, serves + " will not work: " + e.what()};
  }
}

/// STEP is there where OpenCASCADE was when Chladni was built.
Finding step_reader() {
  auto finding = worker("chladni-step", "reading of .step");
  if (!finding.good) finding = {true, "chladni-step", "not built: .step and .stp cannot be read"};
  return finding;
}

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const auto end = rest.find(':');
    const auto candidate = std::string(rest.substr(0, end)) + "/" + program;
    if (access(candidate.c_str(), X_OK) == 0) return true;
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
  }
  return false;
}

Finding display() {
  const char* name = std::getenv("DISPLAY");
  if (name != nullptr && *name != '\0') return {true, "display", name};
  if (on_path("xvfb-run")) return {true, "display", "none; pictures are painted under xvfb-run"};
  return {false, "display", "none, and no xvfb-run: no pictures; apt-get install xvfb xauth"};
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

Finding memory() {
  const double free = static_cast<double>(available_memory());
  return {free > 1e9, "memory", fmt::format("{:.1f} GB free", 1e-9 * free)};
}

}  // namespace

int doctor(std::ostream& results) {
  const std::array findings = {Finding{true, "chladni", CHLADNI_VERSION},
                               kernel(),
                               Finding{true, "threads", std::to_string(thread_count())},
                               memory(),
                               worker("chladni-tetgen", "meshing of surfaces"),
                               worker("chladni-vtu", "reading of .vtu"),
                               worker("chladni-mat", "reading of .mat"),
                               step_reader(),
                               worker("chladni-painter", "painting"),
                               display(),
                               units(),
                               modes_of_a_plate()};
  bool good = true;
  for (const auto& finding : findings) {
    good = good && finding.good;
    results << fmt::format("{}  {:<16} {}\n", finding.good ? "ok " : "BAD", finding.what,
                           finding.found);
  }
  return good ? 0 : 4;
}

}  // namespace chladni::app
