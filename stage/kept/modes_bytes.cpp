#include "stage/kept/modes_bytes.h"

#include "base/error.h"
#include "base/packed.h"
#include "base/sha256.h"
#include "dense/blas.h"
#include "host/loaded_code.h"
#include "host/parallel.h"

namespace chladni::stage {
namespace {

// The names in brackets count the members: one that is added must be packed here too.
void add(const fem::ModesSummary& summary, Packed& to) {
  const auto& [residual, orthogonality, complete, counted_below_hz, counted, found, clusters,
               warnings, block_steps, solves, restarts, count_attempts, forecast_bytes,
               factor_bytes, factor_seconds, iterate_seconds, certify_seconds, text] = summary;
  to.add(residual).add(orthogonality).add(complete).add(counted_below_hz).add(counted).add(found);
  to.add(static_cast<std::int64_t>(clusters.size()));
  for (const auto& [first, size] : clusters) {
    to.add(static_cast<std::int64_t>(first)).add(static_cast<std::int64_t>(size));
  }
  to.add(warnings).add(block_steps).add(solves).add(restarts).add(count_attempts);
  to.add(forecast_bytes).add(factor_bytes).add(factor_seconds).add(iterate_seconds);
  to.add(certify_seconds).add(text);
}

fem::ModesSummary summary_of(Unpacked& from) {
  fem::ModesSummary summary;
  summary.residual = from.array<Eigen::VectorXd>();
  summary.orthogonality = from.number<double>();
  summary.complete = from.number<bool>();
  summary.counted_below_hz = from.number<double>();
  summary.counted = from.number<int>();
  summary.found = from.number<int>();
  const auto clusters = from.number<std::int64_t>();
  for (std::int64_t i = 0; i < clusters; ++i) {
    const auto first = from.number<std::int64_t>();
    summary.clusters.push_back({first, from.number<std::int64_t>()});
  }
  summary.warnings = from.texts();
  for (int* count :
       {&summary.block_steps, &summary.solves, &summary.restarts, &summary.count_attempts}) {
    *count = from.number<int>();
  }
  for (double* value : {&summary.forecast_bytes, &summary.factor_bytes, &summary.factor_seconds,
                        &summary.iterate_seconds, &summary.certify_seconds}) {
    *value = from.number<double>();
  }
  summary.text = from.text();
  return summary;
}

void add(const std::optional<cluster::RanksSummary>& ranks, Packed& to) {
  to.add(ranks.has_value());
  if (!ranks) return;
  const auto& [launcher, peak_bytes, shifts, seconds] = *ranks;
  to.add(launcher).add(shifts).add(seconds).add(static_cast<std::int64_t>(peak_bytes.size()));
  for (const double peak : peak_bytes) to.add(peak);
}

std::optional<cluster::RanksSummary> ranks_of(Unpacked& from) {
  if (!from.number<bool>()) return {};
  cluster::RanksSummary ranks;
  ranks.launcher = from.text();
  ranks.shifts = from.number<int>();
  ranks.seconds = from.number<double>();
  const auto count = from.number<std::int64_t>();
  for (std::int64_t i = 0; i < count; ++i) ranks.peak_bytes.push_back(from.number<double>());
  return ranks;
}

void check(const SolvedModes& solved, Eigen::Index degrees_of_freedom) {
  const auto& [modes, summary] = solved.result;
  const auto count = modes.mode_count();
  require(modes.shapes.rows() == degrees_of_freedom && modes.shapes.cols() == count &&
              summary.residual.size() == count && solved.frequency_error.size() == count &&
              modes.rigid_count >= 0 && modes.rigid_count <= count,
          "kept modes: their sizes do not agree");
  require(modes.shapes.allFinite() && modes.frequency_hz.allFinite() &&
              solved.frequency_error.allFinite(),
          "kept modes: a number is not finite");
  for (Eigen::Index i = 1; i < count; ++i) {
    require(modes.frequency_hz(i - 1) <= modes.frequency_hz(i),
            "kept modes: the frequencies do not ascend");
  }
  for (const auto& cluster : summary.clusters) {
    require(cluster.first >= 0 && cluster.size >= 1 && cluster.size <= count &&
                cluster.first <= count - cluster.size,
            "kept modes: a cluster that is not there");
  }
}

void add(const mesh::Site& site, Packed& to) {
  to.add(site.nodes).add(site.weights).add(site.position).add(site.normal);
}

void add(const fem::Attachment& attachment, Packed& to) {
  add(attachment.site, to);
  to.add(attachment.footprint).add(static_cast<std::int64_t>(attachment.what.index()));
  std::visit(
      [&to](const auto& what) {
        using What = std::decay_t<decltype(what)>;
        if constexpr (std::is_same_v<What, fem::PointMass>) {
          to.add(what.mass).add(what.inertia);
        } else if constexpr (std::is_same_v<What, fem::GroundSpring>) {
          to.add(what.direction).add(what.stiffness).add(what.damping);
        } else if constexpr (std::is_same_v<What, fem::GroundTorsionSpring>) {
          to.add(what.axis).add(what.stiffness).add(what.damping);
        } else if constexpr (std::is_same_v<What, fem::LinkSpring>) {
          add(what.other, to);
          to.add(what.direction).add(what.stiffness).add(what.damping);
        } else {
          static_assert(std::is_same_v<What, fem::Resonator>);
          to.add(what.direction).add(what.mass).add(what.stiffness).add(what.damping);
        }
      },
      attachment.what);
}

}  // namespace

std::string bytes_of(const SolvedModes& solved) {
  const auto& modes = solved.result.modes;
  Packed to;
  to.add(modes.frequency_hz).add(modes.shapes).add(static_cast<std::int64_t>(modes.rigid_count));
  add(solved.result.summary, to);
  to.add(solved.frequency_error);
  add(solved.ranks, to);
  return to.bytes();
}

SolvedModes modes_of_bytes(std::string_view bytes, Eigen::Index degrees_of_freedom) {
  Unpacked from(bytes);
  SolvedModes solved;
  auto& modes = solved.result.modes;
  modes.frequency_hz = from.array<Eigen::VectorXd>();
  modes.damping_ratio = Eigen::VectorXd::Zero(modes.frequency_hz.size());
  modes.shapes = from.array<Eigen::MatrixXd>();
  modes.rigid_count = from.number<std::int64_t>();
  solved.result.summary = summary_of(from);
  solved.frequency_error = from.array<Eigen::VectorXd>();
  solved.ranks = ranks_of(from);
  require(from.is_at_end(), "kept modes: there are bytes after their end");
  check(solved, degrees_of_freedom);
  return solved;
}

std::string fingerprint_of(const Model& model, const std::vector<fem::Support>& supports,
                           const ModesRequest& request) {
  Packed all;
  all.add("modes").add(loaded_code()).add(dense::blas_kernel());
  all.add(thread_count()).add(dense::blas_threads());
  const auto& body = model.body;
  all.add(body.points).add(body.tets).add(body.region).add(body.faces).add(body.face_patch);
  all.add(body.patch_names);
  for (const auto& material : model.materials) all.add(material.stiffness).add(material.density);
  all.add(static_cast<std::int64_t>(supports.size()));
  for (const auto& [patch, x, y, z] : supports) all.add(patch).add(x).add(y).add(z);
  all.add(static_cast<std::int64_t>(model.attachments.size()));
  for (const auto& attachment : model.attachments) add(attachment, all);
  const auto& options = request.options;
  all.add(options.shift_hz).add(options.tolerance).add(options.block).add(options.certificate);
  all.add(options.seed).add(request.launcher).add(request.mirrors);
  return sha256(all.bytes());
}

}  // namespace chladni::stage
