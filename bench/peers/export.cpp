// A body of plate_modes for the peers: plate.inp for CalculiX, K.petsc and M.petsc (both triangles,
// PETSc's binary format) for SLEPc and SciPy. export_plate BRICKS FOLDER [plate|cube|meshed]
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>

#include "base/error.h"
#include "bench/fem/bench_body.h"
#include "io/matrix.h"

namespace chladni::bench {
namespace {

// CalculiX reads at most 20 characters of a number; its ten-node tetrahedron has VTK's order.
void write_calculix(const std::filesystem::path& file, const mesh::TetMesh& body, int modes) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  require(out != nullptr, "cannot write " + file.string());
  std::fprintf(out, "*NODE, NSET=all\n");
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    std::fprintf(out, "%ld,%.12g,%.12g,%.12g\n", long(i + 1), body.points(i, 0), body.points(i, 1),
                 body.points(i, 2));
  }
  std::fprintf(out, "*ELEMENT, TYPE=C3D10, ELSET=body\n");
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    std::fprintf(out, "%ld", long(t + 1));
    for (const auto node : body.tets.row(t)) std::fprintf(out, ",%d", node + 1);
    std::fprintf(out, "\n");
  }
  std::fprintf(out,
               "*MATERIAL, NAME=aluminium\n*ELASTIC\n70e9,0.33\n*DENSITY\n2700\n"
               "*SOLID SECTION, ELSET=body, MATERIAL=aluminium\n"
               "*STEP\n*FREQUENCY, SOLVER=SPOOLES\n%d\n*END STEP\n",
               modes);
  require(std::fclose(out) == 0, "cannot write " + file.string());
}

void write_body(const BenchBody& which, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const auto body = mesh_of(which);
  const auto system = system_of(body);
  io::write_petsc(folder / "K.petsc", system.stiffness, io::PetscIndex::narrow);
  io::write_petsc(folder / "M.petsc", system.mass, io::PetscIndex::narrow);
  write_calculix(folder / "plate.inp", body, 26);
  std::cout << system.mass.rows() << " degrees of freedom\n";
}

}  // namespace
}  // namespace chladni::bench

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::cerr << "export_plate BRICKS FOLDER [plate|cube|meshed]\n";
    return 2;
  }
  try {
    chladni::bench::write_body({argc == 4 ? argv[3] : "plate", std::stoi(argv[1])}, argv[2]);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
}
