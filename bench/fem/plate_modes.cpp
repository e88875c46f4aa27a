// A plate or another body once, from mesh to certified modes, in one JSON line like the peers':
// CPU seconds of the steps, peak resident memory beside the forecast, worst residual.
// plate_modes BRICKS [plate|cube|meshed] [nocount] [BLOCK]
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>

#include "bench/fem/bench_body.h"
#include "dense/blas.h"
#include "fem/factor/factorization.h"
#include "fem/modes.h"
#include "host/parallel.h"

namespace chladni::bench {
namespace {

double seconds_of(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// With the worker that orders the nodes.
double cpu_seconds() {
  rusage own{};
  rusage workers{};
  getrusage(RUSAGE_SELF, &own);
  getrusage(RUSAGE_CHILDREN, &workers);
  return seconds_of(own) + seconds_of(workers);
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

void run(const BenchBody& which, const fem::ModesOptions& options) {
  const auto body = mesh_of(which);
  const double begin = cpu_seconds();
  const auto system = system_of(body);
  const double assembled = cpu_seconds();
  const double before = resident_mb();
  const auto [modes, summary] = fem::modes(system, options);
  const double done = cpu_seconds();
  const auto flexible = modes.frequency_hz.tail(modes.mode_count() - modes.rigid_count);
  std::printf(
      "{\"peer\": \"chladni\", \"body\": \"%s\", \"kernel\": \"%s\", \"dof\": %ld, \"threads\": "
      "%d, "
      "\"assemble_cpu_s\": %.3f, \"cpu_s\": %.2f, \"factor_wall_s\": %.2f, "
      "\"iterate_wall_s\": %.2f, \"certify_wall_s\": %.2f, \"factor_mb\": %.0f, \"peak_mb\": %.0f, "
      "\"forecast_mb\": %.0f, "
      "\"solves\": %d, \"counts\": %d, \"restarts\": %d, \"residual\": %.1e, \"first_hz\": %.6f, "
      "\"last_hz\": %.6f, \"modes\": %ld, "
      "\"complete\": %s}\n",
      which.kind.c_str(), dense::blas_kernel().c_str(), long(system.mass.rows()), thread_count(),
      assembled - begin, done - assembled, summary.factor_seconds, summary.iterate_seconds,
      summary.certify_seconds, summary.factor_bytes / 1048576.0, peak_mb(),
      before + summary.forecast_bytes / 1048576.0, summary.solves, summary.count_attempts,
      summary.restarts, summary.residual.maxCoeff(), flexible(0), flexible(19),
      long(flexible.size()), summary.complete ? "true" : "false");
}

}  // namespace
}  // namespace chladni::bench

int main(int argc, char** argv) {
  chladni::dense::use_best_blas_kernel(argv);
  if (argc < 2) {
    std::cerr << "plate_modes BRICKS [plate|cube|meshed] [nocount] [BLOCK]\n";
    return 2;
  }
  chladni::fem::ModesOptions options{.count = 20};
  chladni::bench::BenchBody body;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "nocount") {
      options.certificate = false;
    } else if (word.find_first_not_of("0123456789") == std::string::npos) {
      options.block = std::stoi(word);
    } else {
      body.kind = word;
    }
  }
  try {
    body.bricks = std::stoi(argv[1]);
    chladni::bench::run(body, options);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
}
