#include <iostream>

#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"

int main() {
  using namespace chladni;
  const mesh::Plate plate{.length = 0.6, .width = 0.6, .thickness = 0.02};  // [m]
  const auto body = mesh::with_order(mesh::layered(plate, {.edge_length = 0.05}), 3);
  const auto system = fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)});
  const auto [modes, summary] = fem::modes(system, {.count = 3});
  std::cout << modes.frequency_hz.transpose() << '\n' << summary.text << '\n';
}
