// What the readers' tests share: sample files, bodies to write down, and the message of a refusal.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "base/error.h"
#include "mesh/tet_mesh.h"

namespace chladni::io {

/// A file of tests/fuzz/corpus, "msh/box_41.msh".
inline std::string sample(const std::string& name) {
  std::ifstream in(std::string(CHLADNI_SOURCE_DIR) + "/tests/fuzz/corpus/" + name,
                   std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  EXPECT_TRUE(in.good() && !bytes.str().empty()) << name;
  return bytes.str();
}

/// The message of the InvalidInput that `call` throws; empty, and a failed test, where it does not.
template <class Call>
std::string refusal(const Call& call) {
  try {
    static_cast<void>(call());
  } catch (const InvalidInput& error) {
    return error.what();
  }
  ADD_FAILURE() << "expected InvalidInput";
  return {};
}

/// Does `message` hold `part`? Shows both where it does not.
inline testing::AssertionResult says(const std::string& message, const std::string& part) {
  if (message.find(part) != message.npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << message << "\" does not say \"" << part << "\"";
}

/// `text` with its first `from` turned into `to`; `from` must be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}

/// The bytes of `value`, in reverse order where `big_endian`.
template <class T>
std::string bytes_of(T value, bool big_endian = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big_endian) bytes.assign(bytes.rbegin(), bytes.rend());
  return bytes;
}

/// The unit cube as twelve triangles, outward; 8 corners, patch "cube".
inline mesh::Surface unit_cube() {
  mesh::Surface cube;
  cube.points.resize(8, 3);
  for (int i = 0; i < 8; ++i) cube.points.row(i) << (i & 1), (i >> 1) & 1, (i >> 2) & 1;
  cube.triangles.resize(12, 3);
  cube.triangles << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6,
      0, 6, 2, 1, 3, 7, 1, 7, 5;
  cube.patch = Eigen::VectorXi::Zero(12);
  cube.patch_names = {"cube"};
  return cube;
}

/// Total area of the faces of a patch [length squared]; fails where there is no such patch.
inline double patch_area(const mesh::TetMesh& mesh, const std::string& name) {
  double area = 0.0;
  bool found = false;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    if (mesh.patch_names[static_cast<std::size_t>(mesh.face_patch[f])] != name) continue;
    found = true;
    const Eigen::Vector3d a = mesh.points.row(mesh.faces(f, 0));
    const Eigen::Vector3d b = mesh.points.row(mesh.faces(f, 1)).transpose() - a;
    const Eigen::Vector3d c = mesh.points.row(mesh.faces(f, 2)).transpose() - a;
    area += 0.5 * Eigen::Vector3d(b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2],
                                  b[0] * c[1] - b[1] * c[0])
                      .norm();
  }
  EXPECT_TRUE(found) << "no patch " << name;
  return area;
}

/// Volume of the corner tetrahedra of a region.
inline double region_volume(const mesh::TetMesh& mesh, const std::string& name) {
  mesh::TetMesh part = mesh;
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    if (mesh.region_names[static_cast<std::size_t>(mesh.region[t])] == name) {
      part.tets.row(kept++) = mesh.tets.row(t);
    }
  }
  EXPECT_GT(kept, 0) << "no region " << name;
  part.tets.conservativeResize(kept, Eigen::NoChange);
  return mesh::volume(part);
}

}  // namespace chladni::io
