// The plate of modes_bench, BRICKS each way, for the peers: plate.inp for CalculiX, K.petsc and
// M.petsc (both triangles, PETSc's binary format) for SLEPc and SciPy. export_plate BRICKS FOLDER
#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "base/error.h"
#include "fem/assemble.h"
#include "mesh/bodies.h"

namespace chladni::bench {
namespace {

template <typename Word>
void write_big_endian(std::ofstream& out, const std::vector<Word>& values) {
  static_assert(std::endian::native == std::endian::little);
  std::vector<char> bytes(values.size() * sizeof(Word));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto word = std::bit_cast<std::array<char, sizeof(Word)>>(values[i]);
    std::reverse_copy(word.begin(), word.end(), bytes.begin() + long(i * sizeof(Word)));
  }
  out.write(bytes.data(), std::streamsize(bytes.size()));
}

// Rows of a symmetric matrix are its columns.
void write_petsc(const std::filesystem::path& file, const SparseMatrix& lower) {
  const SparseMatrix both = lower.selfadjointView<Eigen::Lower>();
  const auto n = static_cast<std::int32_t>(both.cols());
  const auto entries = static_cast<std::int32_t>(both.nonZeros());
  constexpr std::int32_t mark = 1211216;  // MAT_FILE_CLASSID
  std::vector<std::int32_t> head{mark, n, n, entries};
  for (std::int32_t i = 0; i < n; ++i) {
    head.push_back(both.outerIndexPtr()[i + 1] - both.outerIndexPtr()[i]);
  }
  std::ofstream out(file, std::ios::binary);
  write_big_endian(out, head);
  write_big_endian(out, std::vector(both.innerIndexPtr(), both.innerIndexPtr() + entries));
  write_big_endian(out, std::vector(both.valuePtr(), both.valuePtr() + entries));
  require(out.good(), "cannot write " + file.string());
}

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

void write_plate(int bricks, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const auto body =
      mesh::with_order(mesh::layered(mesh::Plate{0.6, 0.6, 0.02}, 0.6 / bricks, 2), 2);
  const auto system = fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)});
  write_petsc(folder / "K.petsc", system.stiffness);
  write_petsc(folder / "M.petsc", system.mass);
  write_calculix(folder / "plate.inp", body, 26);
  std::cout << system.mass.rows() << " degrees of freedom\n";
}

}  // namespace
}  // namespace chladni::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "export_plate BRICKS FOLDER\n";
    return 2;
  }
  try {
    chladni::bench::write_plate(std::stoi(argv[1]), argv[2]);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
}
