// The plate of modes_bench once, from mesh to certified modes, in one JSON line like the peers':
// CPU seconds of the steps, peak resident memory beside the forecast, worst residual.
// plate_modes BRICKS [nocount] [BLOCK]
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>

#include "dense/blas.h"
#include "fem/assemble.h"
#include "fem/factor/factorization.h"
#include "fem/modes.h"
#include "host/parallel.h"
#include "mesh/bodies.h"

namespace chladni::bench {
namespace {

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1024.0;
}

double resident_mb() {
  std::ifstream in("/proc/self/statm");
  double size = 0.0;
  double resident = 0.0;
  in >> size >> resident;
  return resident * double(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

void run(int bricks, const fem::ModesOptions& options) {
  const auto body =
      mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.6 / bricks, 2), 2);
  const double begin = cpu_seconds();
  const auto system = fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)});
  const double assembled = cpu_seconds();
  const double before = resident_mb();
  const auto [modes, summary] = fem::modes(system, options);
  const double done = cpu_seconds();
  const auto flexible = modes.frequency_hz.tail(modes.mode_count() - modes.rigid_count);
  std::printf(
      "{\"peer\": \"chladni\", \"kernel\": \"%s\", \"dof\": %ld, \"threads\": %d, "
      "\"assemble_cpu_s\": %.3f, \"cpu_s\": %.2f, \"factor_wall_s\": %.2f, "
      "\"iterate_wall_s\": %.2f, \"certify_wall_s\": %.2f, \"factor_mb\": %.0f, \"peak_mb\": %.0f, "
      "\"forecast_mb\": %.0f, "
      "\"solves\": %d, \"residual\": %.1e, \"first_hz\": %.6f, \"last_hz\": %.6f, \"modes\": %ld, "
      "\"complete\": %s}\n",
      dense::blas_kernel().c_str(), long(system.mass.rows()), thread_count(), assembled - begin,
      done - assembled, summary.factor_seconds, summary.iterate_seconds, summary.certify_seconds,
      summary.factor_bytes / 1048576.0, peak_mb(), before + summary.forecast_bytes / 1048576.0,
      summary.solves, summary.residual.maxCoeff(), flexible(0), flexible(19), long(flexible.size()),
      summary.complete ? "true" : "false");
}

}  // namespace
}  // namespace chladni::bench

int main(int argc, char** argv) {
  chladni::dense::use_best_blas_kernel(argv);
  if (argc < 2) {
    std::cerr << "plate_modes BRICKS [nocount] [BLOCK]\n";
    return 2;
  }
  chladni::fem::ModesOptions options{.count = 20};
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "nocount") {
      options.certificate = false;
    } else {
      options.block = std::stoi(word);
    }
  }
  try {
    chladni::bench::run(std::stoi(argv[1]), options);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
}
