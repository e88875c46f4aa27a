// chladni-order: reads a graph from stdin and writes the order of its elimination to stdout
// (fem/metis_order.h). A program of its own, because METIS cannot be stopped and takes SIGTERM for
// itself. Ends with status 0, or 1 and a line that says why.
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "fem/metis_order.h"

namespace {

std::string all_of_stdin() {
  std::string bytes;
  char chunk[1U << 16U];
  while (const std::size_t count = std::fread(chunk, 1, sizeof chunk, stdin)) {
    bytes.append(chunk, count);
  }
  return bytes;
}

void run() {
  const auto order = chladni::fem::metis_order(chladni::fem::graph_from(all_of_stdin()));
  const std::string reply = chladni::fem::bytes_of(order);
  const bool written = std::fwrite(reply.data(), 1, reply.size(), stdout) == reply.size() &&
                       std::fflush(stdout) == 0;
  if (!written) throw std::runtime_error("cannot write the reply");
}

}  // namespace

int main() {
  try {
    run();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
