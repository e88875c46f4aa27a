#include "io/report_sections.h"

#include <fmt/format.h>

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "host/atomic_file.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

// The frequency with two decimals, and with more decimals for low frequencies.
std::string hertz(double frequency) {
  if (frequency >= 100.0) return fmt::format("{:.2f}", frequency);
  return frequency >= 10.0 ? fmt::format("{:.3f}", frequency) : fmt::format("{:.4f}", frequency);
}

std::string with_two_digits(double value) {
  if (value >= 10.0) return fmt::format("{:.0f}", value);
  if (value >= 1.0) return fmt::format("{:.1f}", value);
  if (value >= 0.1) return fmt::format("{:.2f}", value);
  if (std::isnan(value)) return "";
  return value >= 1e-3 ? fmt::format("{:.1g}", value) : "< 0.001";
}

// The rounded number, without a minus sign where all digits are zero.
std::string rounded(double value, int decimals) {
  const bool is_zero = std::abs(value) < 0.5 * std::pow(10.0, -decimals);
  return fmt::format("{:.{}f}", is_zero ? 0.0 : value, decimals);
}

std::string numbers(const Eigen::Vector3d& values, double scale, int decimals) {
  return rounded(scale * values(0), decimals) + ", " + rounded(scale * values(1), decimals) + ", " +
         rounded(scale * values(2), decimals);
}

std::string direction_name(const Eigen::Vector3d& direction) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (std::abs(std::abs(direction(axis)) - direction.norm()) > 1e-9 * direction.norm()) continue;
    return std::string(direction(axis) < 0.0 ? "−" : "") + "xyz"[axis];
  }
  return numbers(direction, 1.0, 3);
}

std::string cluster_note(Eigen::Index mode, const std::vector<fem::Cluster>& clusters) {
  for (const fem::Cluster& cluster : clusters) {
    const Eigen::Index last = cluster.first + cluster.size - 1;
    if (mode < cluster.first || mode > last) continue;
    if (cluster.size == 2) return fmt::format("pair with {}", 2 * cluster.first + 2 - mode);
    return fmt::format("one of {}: {} to {}", cluster.size, cluster.first + 1, last + 1);
  }
  return "";
}

// One row for all rigid-body modes, because nothing distinguishes them.
Table::Row rigid_row(Eigen::Index count) {
  return {
      {count == 1 ? "1" : fmt::format("1 to {}", count), "rigid body", "0", "", "", ""}, true, -1};
}

Table::Row flexible_row(const modal::Modes& modes, Eigen::Index mode,
                        const fem::ModesSummary& summary, const Eigen::VectorXd& error,
                        std::size_t shapes) {
  const Eigen::Index flexible = mode - modes.rigid_count;
  const double frequency = modes.frequency_hz(mode);
  return {{fmt::to_string(mode + 1), fmt::format("flexible {}", flexible + 1), hertz(frequency),
           error.size() > 0 ? with_two_digits(frequency * error(mode)) : "",
           fmt::format("{:.0e}", summary.residual(mode)), cluster_note(mode, summary.clusters)},
          false,
          flexible < static_cast<Eigen::Index>(shapes) ? static_cast<int>(flexible) : -1};
}

Table modes_table(const modal::Modes& modes, const fem::ModesSummary& summary,
                  const Eigen::VectorXd& error, std::size_t shapes) {
  Table table{"Click a mode to see it.", {}, {}};
  table.columns = {{"mode"},   {"", false},  {"frequency [Hz]"},
                   {"± [Hz]"}, {"residual"}, {"", false}};
  if (modes.rigid_count > 0) table.rows.push_back(rigid_row(modes.rigid_count));
  for (Eigen::Index k = modes.rigid_count; k < modes.mode_count(); ++k) {
    table.rows.push_back(flexible_row(modes, k, summary, error, shapes));
  }
  return table;
}

Note certificate(const fem::ModesSummary& summary) {
  if (summary.complete) {
    return {Note::Tone::good,
            summary.text + ". An inertia count proves that no mode in that band is missing."};
  }
  return {Note::Tone::warning, (summary.text.empty() ? "" : summary.text + ". ") +
                                   "Not certified: no inertia count was made, so a mode may be "
                                   "missing."};
}

// The inertia as text. Products of inertia that are only round-off become zero.
std::string inertia_lines(Eigen::Matrix3d inertia) {
  const double least = 1e-12 * inertia.trace();
  inertia = inertia.unaryExpr([&](double v) { return std::abs(v) < least ? 0.0 : v; }).eval();
  return fmt::format(
      "xx {:.6g}   yy {:.6g}   zz {:.6g} kg m²\nxy {:.6g}   yz {:.6g}   zx {:.6g} kg m²",
      inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(1, 2), inertia(2, 0));
}

std::string region_list(const mesh::TetMesh& mesh) {
  std::string list;
  for (const std::string& name : mesh.region_names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

const char* cell_name(const mesh::TetMesh& mesh) {
  constexpr std::array names{"linear (4 nodes)", "quadratic (10 nodes)", "cubic (20 nodes)"};
  return names[static_cast<std::size_t>(mesh.order() - 1)];
}

Facts mesh_facts(const mesh::TetMesh& mesh, const mesh::Quality& quality, Eigen::Index size) {
  return {
      "Mesh",
      {{"tetrahedra", fmt::format("{}, {}", mesh.tet_count(), cell_name(mesh))},
       {"nodes", fmt::to_string(mesh.node_count())},
       {"degrees of freedom", fmt::to_string(size)},
       {"regions", region_list(mesh)},
       {"edges", fmt::format("{:.3g} to {:.3g} mm", 1e3 * quality.shortest_edge,
                             1e3 * quality.longest_edge)},
       {"dihedral angles",
        fmt::format("{:.1f} to {:.1f} degrees", quality.smallest_dihedral_degrees,
                    quality.largest_dihedral_degrees)},
       {"radius ratio", fmt::format("{:.3f} smallest, {:.3f} mean (1: regular, 0: flat)",
                                    quality.smallest_radius_ratio, quality.mean_radius_ratio)}}};
}

}  // namespace

Section modes_section(const mesh::TetMesh& mesh, const modal::Modes& modes,
                      const fem::ModesSummary& summary, const Eigen::VectorXd& frequency_error,
                      const std::vector<Marker>& markers, bool from_above) {
  require(summary.residual.size() == modes.mode_count(),
          fmt::format("report: {} residuals for {} modes", summary.residual.size(),
                      modes.mode_count()));
  require(frequency_error.size() == 0 || frequency_error.size() == modes.mode_count(),
          fmt::format("report: {} frequency errors for {} modes", frequency_error.size(),
                      modes.mode_count()));
  Viewer viewer = modes_viewer(mesh, modes, markers);
  Section section{"Modes", {}};
  Table table = modes_table(modes, summary, frequency_error, viewer.shapes.size());
  section.blocks.emplace_back(Beside{{std::move(table), std::move(viewer)}});
  section.blocks.emplace_back(certificate(summary));
  if (frequency_error.size() > 0) {
    section.blocks.emplace_back(Note{
        Note::Tone::quiet,
        std::string("±: estimated error of the mesh") +
            (from_above ? "; the exact frequency of the model lies below the one listed" : "") +
            ". Not in it: material data, clamping, geometry."});
  }
  return section;
}

Section picture_section(const std::string& title, const std::filesystem::path& png,
                        const std::string& caption) {
  return {title, {Image{read_whole(png, std::size_t{64} << 20U), caption}}};
}

Section body_section(const fem::MassProperties& mass, const mesh::TetMesh& mesh,
                     const mesh::Quality& quality, Eigen::Index degrees_of_freedom) {
  const auto box = mesh::bounding_box(mesh.points);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(mass.inertia_kg_m2);
  Facts facts{"Body and what is attached to it",
              {{"size", numbers((box.row(1) - box.row(0)).transpose(), 1e3, 3) + " mm"},
               {"volume", fmt::format("{:.6g} cm³", 1e6 * mesh::volume(mesh))},
               {"mass", fmt::format("{:.6g} kg", mass.mass_kg)},
               {"centre of mass", numbers(mass.centre_m, 1e3, 3) + " mm"}}};
  facts.lines.emplace_back("inertia about it", inertia_lines(mass.inertia_kg_m2));
  const Eigen::Vector3d moments = principal.eigenvalues();
  facts.lines.emplace_back("principal moments", fmt::format("{:.6g}, {:.6g}, {:.6g} kg m²",
                                                            moments(0), moments(1), moments(2)));
  return {"Body and mesh",
          {Beside{{std::move(facts), mesh_facts(mesh, quality, degrees_of_freedom)}}}};
}

Section channels_section(const std::vector<Marker>& channels, const modal::Modes& modes,
                         const Eigen::MatrixXd& shapes) {
  constexpr Eigen::Index most = 8;  // columns that fit on a page
  const Eigen::Index shown =
      shapes.size() == 0 ? 0 : std::min(most, modes.mode_count() - modes.rigid_count);
  require(shapes.size() == 0 || (shapes.rows() == static_cast<Eigen::Index>(channels.size()) &&
                                 shapes.cols() == modes.mode_count()),
          fmt::format("report: shapes at the channels are {} x {}, expected {} x {}", shapes.rows(),
                      shapes.cols(), channels.size(), modes.mode_count()));
  Table table{"", {{"name", false}, {"kind", false}, {"place [mm]"}, {"direction", false}}, {}};
  for (Eigen::Index k = 0; k < shown; ++k) {
    table.columns.push_back({hertz(modes.frequency_hz(modes.rigid_count + k)) + " Hz"});
  }
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Marker& channel = channels[c];
    Table::Row row{{channel.name, channel.kind, numbers(channel.position, 1e3, 1),
                    direction_name(channel.direction)}};
    for (Eigen::Index k = 0; k < shown; ++k) {
      row.cells.push_back(fmt::format(
          "{:+.3f}", shapes(static_cast<Eigen::Index>(c), modes.rigid_count + k) + 0.0));
    }
    table.rows.push_back(std::move(row));
  }
  if (shown > 0) table.caption = "Values of the mode shapes at the channels [kg^-1/2].";
  return {"Channels", {std::move(table)}};
}

Section provenance_section(const std::vector<std::pair<std::string, std::string>>& lines) {
  return {"Provenance", {Facts{"", lines}}};
}

}  // namespace chladni::io
