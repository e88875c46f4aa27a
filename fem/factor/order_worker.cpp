// The program chladni-order reads a graph from stdin and writes the order of its elimination to
// stdout (fem/factor/metis_order.h). It is a separate program because METIS cannot be stopped and
// catches SIGTERM. The exit status is 0, or 1 with a line that gives the reason.
#include <cstdio>
#include <exception>

#include "fem/factor/metis_order.h"
#include "host/worker_stdio.h"

int main() {
  try {
    const auto graph = chladni::fem::graph_from(chladni::all_of_stdin());
    chladni::write_to_stdout(chladni::fem::bytes_of(chladni::fem::metis_order(graph)));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
