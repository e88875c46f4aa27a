#include "identification/decoupling.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace chladni::identification {
namespace {

// P with rotations times the rms distance of the channels, so that all columns are lengths.
struct ScaledMotions {
  Eigen::MatrixXd value;
  Eigen::VectorXd scale;  // 6: unit of each column
};

ScaledMotions scaled(const ChannelFrame& frame, const Eigen::Vector3d& about) {
  require(frame.places.rows() > 0 && frame.places.rows() == frame.directions.rows(),
          "decoupling: places and directions of the channels differ in number, or there is none");
  ScaledMotions result{rigid_motions(frame, about), Eigen::VectorXd::Ones(6)};
  const double distance = std::sqrt((frame.places.rowwise() - about.transpose()).squaredNorm() /
                                    static_cast<double>(frame.places.rows()));
  if (distance > 0.0) result.scale.tail(3).setConstant(1.0 / distance);
  result.value = result.value * result.scale.asDiagonal();
  return result;
}

std::string listed(const std::vector<Eigen::Index>& motions) {
  std::string text;
  for (const auto k : motions) {
    text += (text.empty() ? "" : ", ") + std::string(kRigidMotions[static_cast<std::size_t>(k)]);
  }
  return text;
}

}  // namespace

std::optional<ChannelFrame> channel_frame(const std::vector<modal::MeasuredChannel>& channels) {
  const auto n = static_cast<Eigen::Index>(channels.size());
  ChannelFrame frame{Eigen::MatrixX3d(n, 3), Eigen::MatrixX3d(n, 3)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& channel = channels[static_cast<std::size_t>(i)];
    if (!channel.position || channel.direction.norm() == 0.0) return std::nullopt;
    frame.places.row(i) = channel.position->transpose();
    frame.directions.row(i) = channel.direction.normalized().transpose();
  }
  if (n == 0) return std::nullopt;
  return frame;
}

Eigen::MatrixXd rigid_motions(const ChannelFrame& frame, const Eigen::Vector3d& about) {
  Eigen::MatrixXd motions(frame.places.rows(), 6);
  for (Eigen::Index i = 0; i < motions.rows(); ++i) {
    const Eigen::Vector3d direction = frame.directions.row(i);
    const Eigen::Vector3d arm = frame.places.row(i).transpose() - about;
    motions.row(i) << direction.transpose(), arm.cross(direction).transpose();
  }
  return motions;
}

Decoupling sensor_decoupling(const ChannelFrame& sensors, const Eigen::Vector3d& about) {
  const auto motions = scaled(sensors, about);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(motions.value,
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& values = svd.singularValues();
  Decoupling result;
  result.rank = (values.array() > kNoMotion * values(0)).count();
  result.condition = values(0) / values(result.rank - 1);
  const auto r = result.rank;
  const Eigen::MatrixXd seen = svd.matrixV().leftCols(r);
  const Eigen::MatrixXd inverse = motions.scale.asDiagonal() * seen *
                                  values.head(r).cwiseInverse().asDiagonal() *
                                  svd.matrixU().leftCols(r).transpose();
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double part = seen.row(k).norm();
    if (part > 1.0 - kNoMotion) {
      result.told.push_back(k);
    } else {
      (part > kNoMotion ? result.mixed : result.unseen).push_back(k);
    }
  }
  result.matrix = inverse(result.told, Eigen::all);
  return result;
}

Decoupling actuator_decoupling(const ChannelFrame& actuators, const Eigen::Vector3d& about) {
  auto result = sensor_decoupling(actuators, about);
  result.matrix.transposeInPlace();
  return result;
}

std::string decoupling_text(const Decoupling& decoupling, bool actuators) {
  const auto n = actuators ? decoupling.matrix.rows() : decoupling.matrix.cols();
  const auto spare = n - decoupling.rank;
  std::string text = fmt::format("{} {} {} {}", n, actuators ? "actuators" : "sensors",
                                 actuators ? "drive" : "tell",
                                 decoupling.told.empty() ? "no motion" : listed(decoupling.told));
  if (!decoupling.told.empty()) text += actuators ? " by themselves" : " apart";
  text += spare > 0
              ? fmt::format(", {} more than needed{}", spare, actuators ? ": over-actuated" : "")
              : ", none to spare";
  text += fmt::format(" (condition {:.3g})", decoupling.condition);
  if (!decoupling.mixed.empty()) {
    text += fmt::format("; {} only together with others", listed(decoupling.mixed));
  }
  if (!decoupling.unseen.empty()) {
    text += fmt::format("; {} not at all{}", listed(decoupling.unseen),
                        actuators ? ": under-actuated" : "");
  }
  return text;
}

}  // namespace chladni::identification
