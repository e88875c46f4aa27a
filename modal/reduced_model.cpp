#include "modal/reduced_model.h"

#include <fmt/format.h>

#include <string>

#include "base/error.h"

namespace chladni::modal {
namespace {

void require_shape(const Eigen::MatrixXd& found, Eigen::Index rows, Eigen::Index columns,
                   const char* name) {
  const auto text = [](Eigen::Index r, Eigen::Index c) {
    return fmt::to_string(r) + " by " + fmt::to_string(c);
  };
  require(found.rows() == rows && found.cols() == columns,
          std::string("reduced model: ") + name + " is " + text(found.rows(), found.cols()) +
              "; expected " + text(rows, columns));
  require(found.allFinite(), std::string("reduced model: ") + name + " is not finite");
}

}  // namespace

void check(const ReducedModel& model) {
  const auto m = model.mode_count();
  const auto p = model.output_count();
  const auto q = model.input_count();
  const auto d = model.damper_count();
  require_shape(model.frequency_hz, m, 1, "frequency_hz");
  require_shape(model.damping_ratio, m, 1, "damping_ratio");
  require_shape(model.output_shapes, p, m, "output_shapes");
  require_shape(model.input_shapes, m, q, "input_shapes");
  require_shape(model.residual, p, q, "residual");
  if (d > 0) {
    require_shape(model.dampers.shapes, d, m, "dampers.shapes");
    require_shape(model.dampers.to_outputs, p, d, "dampers.to_outputs");
    require_shape(model.dampers.from_inputs, d, q, "dampers.from_inputs");
    require_shape(model.dampers.among, d, d, "dampers.among");
  }
  const bool rigid_are_zero = model.rigid_count >= 0 && model.rigid_count <= m &&
                              model.frequency_hz.head(model.rigid_count).isZero(0.0) &&
                              (model.frequency_hz.tail(m - model.rigid_count).array() > 0.0).all();
  require(rigid_are_zero, "reduced model: the first " + fmt::to_string(model.rigid_count) +
                              " frequencies are those of rigid-body modes; expected them to be 0 "
                              "and all others positive");
}

}  // namespace chladni::modal
