// Modes and meshes as tables, JSON and CSV.
#include <fmt/format.h>

#include <cmath>

#include "dense/blas.h"
#include "io/result_table.h"
#include "show/solution.h"
#include "stage/solution.h"

namespace chladni::show {
namespace {

/// The cluster of mode i; null for a simple mode.
const fem::Cluster* cluster_of(const fem::ModesSummary& summary, Eigen::Index i) {
  for (const auto& cluster : summary.clusters) {
    if (i >= cluster.first && i < cluster.first + cluster.size) return &cluster;
  }
  return nullptr;
}

std::string remark(const stage::Solution& solution, Eigen::Index i) {
  if (i < solution.modes.rigid_count) return "rigid body";
  const auto* cluster = cluster_of(solution.summary, i);
  if (cluster == nullptr || cluster->first < solution.modes.rigid_count) return "";
  return fmt::format("{} {}-{}", cluster->size == 2 ? "pair" : "cluster", cluster->first + 1,
                     cluster->first + cluster->size);
}

/// Number of decimals that shows two digits of the error.
int digits_for(double error_hz) {
  if (!(error_hz > 0.0)) return 3;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(error_hz))), 1, 6);
}

io::Json channel_json(const std::vector<study::Channel>& channels, const Eigen::MatrixXd& values) {
  io::JsonObject object;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const Eigen::VectorXd row = values.row(static_cast<Eigen::Index>(i)).transpose();
    object.emplace_back(channels[i].name, io::Json(row));
  }
  return object;
}

io::Json clusters_json(const fem::ModesSummary& summary) {
  io::JsonArray clusters;
  for (const auto& cluster : summary.clusters) {
    clusters.push_back(io::JsonObject{{"first", static_cast<long long>(cluster.first)},
                                      {"size", static_cast<long long>(cluster.size)}});
  }
  return clusters;
}

// Null throughout where none were counted.
io::Json certificate_json(const fem::ModesSummary& summary) {
  const bool counted = summary.counted_below_hz > 0.0;
  const auto known = [&](auto value) { return counted ? io::Json(value) : io::Json(); };
  return io::JsonObject{{"below_hz", known(summary.counted_below_hz)},
                        {"found", known(summary.found)},
                        {"counted", known(summary.counted)}};
}

// Without their times: they are among "seconds".
io::Json ranks_json(const cluster::RanksSummary& ranks) {
  io::JsonArray peaks;
  for (const double bytes : ranks.peak_bytes) peaks.emplace_back(bytes);
  return io::JsonObject{
      {"engine", ranks.launcher}, {"shifts", ranks.shifts}, {"peak_memory_bytes", peaks}};
}

Eigen::VectorXd error_hz(const stage::Solution& solution) {
  return solution.frequency_error.cwiseProduct(solution.modes.frequency_hz);
}

}  // namespace

std::string modes_table(const stage::Solution& solution) {
  const auto& modes = solution.modes;
  const Eigen::VectorXd error = error_hz(solution);
  std::vector<std::string> number, errors, remarks;
  for (Eigen::Index i = 0; i < modes.mode_count(); ++i) {
    const bool rigid = i < modes.rigid_count;
    number.push_back(fmt::to_string(i + 1));
    errors.push_back(rigid ? "" : fmt::format("{:.{}f}", error(i), digits_for(error(i))));
    remarks.push_back(remark(solution, i));
  }
  io::ResultTable table{
      "",
      {io::word_column("mode", number, 5),
       io::number_column("frequency", "Hz", modes.frequency_hz, {"{:.3f}"}, 14),
       io::word_column("error [Hz]", errors, 11),
       io::number_column("residual", "", solution.summary.residual, {"{:.1e}"}, 9),
       io::word_column("", remarks)}};
  table.columns[0].gap = 0;
  for (const std::size_t k : {0U, 2U}) table.columns[k].is_number = true;
  return io::text(table) +
         fmt::format("{}{}\n", solution.summary.text,
                     solution.summary.complete ? "" : " (completeness not proved)");
}

io::JsonObject modes_json(const study::Study& study, const stage::Solution& solution) {
  const auto& model = solution.model;
  const auto& modes = solution.modes;
  const auto& summary = solution.summary;
  io::JsonArray texts;
  for (const auto& line : solution.introduction.warnings) texts.emplace_back(line);
  io::JsonObject json = {
      {"rigid_body_modes", static_cast<long long>(modes.rigid_count)},
      {"frequency_hz", io::Json(modes.frequency_hz)},
      {"frequency_error_hz", io::Json(error_hz(solution))},
      {"damping_ratio", io::Json(modes.damping_ratio)},
      {"residual", io::Json(summary.residual)},
      {"orthogonality", summary.orthogonality},
      {"clusters", clusters_json(summary)},
      {"complete", summary.complete},
      {"certificate", certificate_json(summary)},
      {"degrees_of_freedom", static_cast<long long>(solution.degrees_of_freedom)},
      {"nodes", static_cast<long long>(model.body.node_count())},
      {"tetrahedra", static_cast<long long>(model.body.tet_count())},
      {"order", model.body.order()},
      {"mass_kg", model.mass.mass_kg},
      {"centre_of_mass_m", io::Json(Eigen::VectorXd(model.mass.centre_m))},
      {"inertia_kg_m2", io::Json::rows(Eigen::MatrixXd(model.mass.inertia_kg_m2))},
      {"blas_kernel", dense::blas_kernel()},
      {"sensors",
       channel_json(study.sensors, stage::shapes_at(study.sensors, model.sensors, modes))},
      {"actuators",
       channel_json(study.actuators, stage::shapes_at(study.actuators, model.actuators, modes))},
      {"warnings", texts}};
  if (solution.ranks) json.emplace_back("ranks", ranks_json(*solution.ranks));
  return json;
}

std::vector<io::CsvColumn> modes_columns(const stage::Solution& solution) {
  const Eigen::Index count = solution.modes.mode_count();
  const Eigen::VectorXi number = Eigen::VectorXi::LinSpaced(count, 1, static_cast<int>(count));
  const Eigen::VectorXi rigid =
      (number.array() <= static_cast<int>(solution.modes.rigid_count)).cast<int>();
  return {{"mode", number},
          {"frequency_hz", solution.modes.frequency_hz},
          {"frequency_error_hz", error_hz(solution)},
          {"damping_ratio", solution.modes.damping_ratio},
          {"residual", solution.summary.residual},
          {"rigid", rigid}};
}

io::JsonObject mesh_json(const mesh::TetMesh& body) {
  const auto quality = mesh::quality(body);
  io::JsonArray patches;
  for (const auto& name : body.patch_names) patches.emplace_back(name);
  io::JsonArray regions;
  for (const auto& name : body.region_names) regions.emplace_back(name);
  return {
      {"nodes", static_cast<long long>(body.node_count())},
      {"tetrahedra", static_cast<long long>(body.tet_count())},
      {"order", body.order()},
      {"boundary_faces", static_cast<long long>(body.faces.rows())},
      {"volume_m3", mesh::volume(body)},
      {"patches", patches},
      {"regions", regions},
      {"quality", io::JsonObject{{"smallest_dihedral_degrees", quality.smallest_dihedral_degrees},
                                 {"largest_dihedral_degrees", quality.largest_dihedral_degrees},
                                 {"smallest_radius_ratio", quality.smallest_radius_ratio},
                                 {"mean_radius_ratio", quality.mean_radius_ratio},
                                 {"smallest_volume_m3", quality.smallest_volume},
                                 {"shortest_edge_m", quality.shortest_edge},
                                 {"longest_edge_m", quality.longest_edge}}}};
}

std::string mesh_text(const mesh::TetMesh& body) {
  const auto quality = mesh::quality(body);
  return fmt::format(
      "{} tetrahedra of order {}, {} nodes, {:.6g} cm^3\n"
      "edges {:.3g} to {:.3g} mm, dihedral angles {:.1f} to {:.1f} degrees, radius ratio {:.2f} at "
      "worst and {:.2f} in the mean\n",
      body.tet_count(), body.order(), body.node_count(), 1e6 * mesh::volume(body),
      1e3 * quality.shortest_edge, 1e3 * quality.longest_edge, quality.smallest_dihedral_degrees,
      quality.largest_dihedral_degrees, quality.smallest_radius_ratio, quality.mean_radius_ratio);
}

}  // namespace chladni::show
