// Decides which spaces between the shells of a surface are filled with material.
#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <optional>

#include "mesh/soundness/shells.h"

namespace chladni::mesh {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Component {
  Eigen::AlignedBox3d box;
  Eigen::Vector3d on_it = Eigen::Vector3d::Zero();  // a point inside one of its triangles
  int outer_shell = -1;                             // the shell that faces the space outside
  std::vector<int> inner_shells;
  int body = -1;
};

Eigen::Vector3d centroid(const Surface& surface, Eigen::Index t) {
  return (surface.points.row(surface.triangles(t, 0)) +
          surface.points.row(surface.triangles(t, 1)) + surface.points.row(surface.triangles(t, 2)))
             .transpose() /
         3.0;
}

void add_shell(Component& component, int shell, double volume) {
  if (volume <= 0.0) {
    component.outer_shell = shell;
  } else if (std::find(component.inner_shells.begin(), component.inner_shells.end(), shell) ==
             component.inner_shells.end()) {
    component.inner_shells.push_back(shell);
  }
}

std::vector<Component> components_of(const Surface& surface, const Shells& shells) {
  std::vector<Component> components(at(shells.component_count));
  for (Eigen::Index t = surface.triangles.rows() - 1; t >= 0; --t) {
    const auto i = static_cast<std::size_t>(t);
    Component& component = components[at(shells.component[i])];
    component.on_it = centroid(surface, t);
    for (int k = 0; k < 3; ++k) {
      component.box.extend(surface.points.row(surface.triangles(t, k)).transpose());
    }
    for (const int shell : {shells.front[i], shells.back[i]}) {
      add_shell(component, shell, shells.volume[at(shell)]);
    }
  }
  return components;
}

bool contains(const Surface& surface, const Shells& shells, int shell,
              const Eigen::Vector3d& point) {
  std::vector<int> sign(shells.front.size());
  for (std::size_t t = 0; t < sign.size(); ++t) {
    sign[t] = (shells.back[t] == shell ? 1 : 0) - (shells.front[t] == shell ? 1 : 0);
  }
  return winding_number(surface, sign, point) > 0.5;
}

// The smallest space of another component that contains component `inner`, and this component.
struct Parent {
  int shell = -1;
  int component = -1;
};
Parent parent_of(int inner, const Surface& surface, const Shells& shells,
                 const std::vector<Component>& components) {
  Parent best;
  for (int c = 0; c < static_cast<int>(components.size()); ++c) {
    const Component& outer = components[at(c)];
    if (c == inner || !outer.box.contains(components[at(inner)].box)) continue;
    for (const int shell : outer.inner_shells) {
      const bool smaller =
          best.shell < 0 || shells.volume[at(shell)] < shells.volume[at(best.shell)];
      if (smaller && contains(surface, shells, shell, components[at(inner)].on_it)) {
        best = {shell, c};
      }
    }
  }
  return best;
}

bool holds_seed(const Surface& surface, const Shells& shells, int shell) {
  return surface.regions.size() > 1 &&
         std::any_of(surface.regions.begin(), surface.regions.end(), [&](const Region& region) {
           return contains(surface, shells, shell, region.inside);
         });
}

std::vector<int> from_large_to_small(const Shells& shells,
                                     const std::vector<Component>& components) {
  std::vector<int> order(components.size());
  std::iota(order.begin(), order.end(), 0);
  const auto size = [&](int c) {  // outer shells have negative volumes
    const int shell = components[at(c)].outer_shell;
    return shell < 0 ? 0.0 : shells.volume[at(shell)];
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) < size(b); });
  return order;
}

}  // namespace

Material material(const Surface& surface, const Shells& shells) {
  std::vector<Component> components = components_of(surface, shells);
  std::vector<char> filled(shells.volume.size(), 0);
  Material found;
  for (const int c : from_large_to_small(shells, components)) {
    Component& component = components[at(c)];
    if (component.outer_shell < 0) continue;
    const Parent parent = parent_of(c, surface, shells, components);
    const bool embedded = parent.shell >= 0 && filled[at(parent.shell)] == 1;
    if (embedded) {
      component.body = components[at(parent.component)].body;
    } else {
      component.body = static_cast<int>(found.bodies.size());
      found.bodies.push_back({0.0, component.box.center()});
    }
    Material::Body& body = found.bodies[at(component.body)];
    filled[at(component.outer_shell)] = embedded ? 1 : 0;
    if (embedded) body.volume += shells.volume[at(component.outer_shell)];
    for (const int shell : component.inner_shells) {
      filled[at(shell)] = !embedded || holds_seed(surface, shells, shell) ? 1 : 0;
      if (filled[at(shell)] == 1) body.volume += shells.volume[at(shell)];
      if (filled[at(shell)] == 0) ++found.void_count;
    }
  }
  for (const Material::Body& body : found.bodies) found.volume += body.volume;
  for (std::size_t t = 0; t < shells.front.size(); ++t) {
    found.front.push_back(filled[at(shells.front[t])]);
    found.back.push_back(filled[at(shells.back[t])]);
  }
  return found;
}

}  // namespace chladni::mesh
