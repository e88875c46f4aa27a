#include "mesh/faces.h"

#include <algorithm>

#include "base/error.h"

namespace chladni::mesh {
namespace {

using Triangle = std::array<int, 3>;

constexpr std::array<Triangle, 1> kLinear{{{0, 1, 2}}};
constexpr std::array<Triangle, 4> kQuadratic{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
constexpr std::array<Triangle, 9> kCubic{{{0, 3, 8},
                                          {3, 4, 9},
                                          {4, 1, 5},
                                          {8, 9, 7},
                                          {9, 5, 6},
                                          {7, 6, 2},
                                          {3, 9, 8},
                                          {4, 5, 9},
                                          {9, 6, 7}}};

}  // namespace

std::span<const Triangle> face_triangles(int order) {
  if (order == 1) return kLinear;
  if (order == 2) return kQuadratic;
  return kCubic;
}

int patch_number(const TetMesh& mesh, const std::string& name, const std::string& what) {
  const auto& names = mesh.patch_names;
  const auto found = std::find(names.begin(), names.end(), name);
  std::string known;
  for (const auto& patch : names) known += (known.empty() ? "" : ", ") + patch;
  require(found != names.end(),
          what + ": the body has no patch \"" + name + "\"; there are: " + known);
  return static_cast<int>(found - names.begin());
}

std::vector<char> chosen_patches(const TetMesh& mesh, const std::vector<std::string>& names,
                                 const std::string& what) {
  std::vector<char> chosen(mesh.patch_names.size(), names.empty() ? 1 : 0);
  for (const auto& name : names) {
    (void)patch_number(mesh, name, what);
    for (std::size_t p = 0; p < chosen.size(); ++p) {
      if (mesh.patch_names[p] == name) chosen[p] = 1;
    }
  }
  return chosen;
}

std::vector<char> faces_of_patches(const TetMesh& mesh, const std::vector<std::string>& names,
                                   const std::string& what) {
  const auto chosen = chosen_patches(mesh, names, what);
  std::vector<char> faces;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    faces.push_back(chosen[static_cast<std::size_t>(mesh.face_patch(f))]);
  }
  return faces;
}

}  // namespace chladni::mesh
