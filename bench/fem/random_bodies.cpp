// Random plates, beams and pairs against a dense solver, whole: no mode may be lost.
// random_bodies [COUNT [FIRST_SEED]]
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>

#include "dense/blas.h"
#include "tests/fem/random_body.h"

int main(int argc, char** argv) {
  using namespace chladni;
  dense::use_best_blas_kernel(argv);
  const unsigned count = argc > 1 ? static_cast<unsigned>(std::stoul(argv[1])) : 10000U;
  const unsigned first = argc > 2 ? static_cast<unsigned>(std::stoul(argv[2])) : 1U;
  long modes = 0;
  long repeated = 0;
  int wrong = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const auto body = fem::random_body(seed);
    std::string fault;
    try {
      const auto [found, summary] = fem::modes(body.system, body.options);
      const int differing = fem::differing_modes(
          found.frequency_hz, fem::dense_lambda(body.system, found.mode_count()));
      modes += found.mode_count();
      repeated += static_cast<long>(summary.clusters.size());
      if (differing > 0) fault = std::to_string(differing) + " modes differ";
      if (!summary.complete) fault += " not complete";
    } catch (const std::exception& e) {
      fault = e.what();
    }
    if (!fault.empty()) {
      ++wrong;
      std::printf("%s: %s\n", body.text.c_str(), fault.c_str());
      std::fflush(stdout);
    }
  }
  std::printf("%u bodies, %ld modes, %ld clusters, %d bodies wrong, %.0f CPU s\n", count, modes,
              repeated, wrong, double(std::clock()) / CLOCKS_PER_SEC);
  return wrong == 0 ? 0 : 1;
}
