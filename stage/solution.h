// The modes of a study's body.
#pragma once

#include <memory>
#include <optional>

#include "cluster/ranks.h"
#include "fem/assemble.h"
#include "fem/modes.h"
#include "stage/estimates/estimate.h"
#include "stage/model.h"
#include "stage/work.h"

namespace chladni::stage {

/// A study before its long step.
struct Introduction {
  Outline outline;
  Understood body;
  Cost cost;
  std::vector<std::string> warnings;
};

struct Solution {
  Introduction introduction;
  Model model;
  std::shared_ptr<const fem::System> system;  ///< K and M of the model
  modal::Modes modes;                         ///< on all nodes: 3·nodes rows
  Eigen::MatrixXd extra_shapes;               ///< for the degrees of freedom that attachments add
  Eigen::VectorXd frequency_error;            ///< per mode, relative; 0 for rigid-body modes
  fem::ModesSummary summary;
  std::optional<cluster::RanksSummary> ranks;  ///< where ranks of MPI found the modes
  Eigen::Index degrees_of_freedom = 0;         ///< free ones
};

/// What starts the ranks that find the modes: the user's choice, or the study's. Empty: none.
[[nodiscard]] std::string engine_of(const study::Study& study, const Work& work);

/// Refuses what does not fit in this process, alone or beside the ranks that find the modes.
/// @throws InvalidInput  more modes below a frequency than the mesh can have
/// @throws DoesNotFit    more memory than there is, with what helps (stage/remedies.h)
void refuse_what_cannot_fit(const study::Study& study, const Introduction& introduction,
                            Work& work);

/// Everything before the modes: geometry, mesh, places, K and M. The memory that a solution would
/// need is not asked for.
/// @throws as its steps
[[nodiscard]] Solution assembled(const study::Study& study, Work& work);

/// Geometry, mesh, assembly and modes. Prints the first line, the forecast and the progress.
/// @throws as its steps
[[nodiscard]] Solution solved(const study::Study& study, Work& work);
/// The same for a study that was introduced before.
[[nodiscard]] Solution solved(const study::Study& study, Introduction introduction, Work& work);

/// A study that is solved once for two purposes: with the modes that it asks for, and with
/// `flexible` modes, or with modes.count where that is larger. The warnings are those of the modes
/// that it asks for.
struct TwoSolutions {
  Solution own, with_more;
};
[[nodiscard]] TwoSolutions solved_with_more(const study::Study& study, int flexible, Work& work);

/// Prints the first line, the notes and the warnings.
[[nodiscard]] Introduction introduced(const study::Study& study, Work& work);

/// Values of the shapes at sites along `directions`, n×3: n×modes [kg^-1/2].
[[nodiscard]] Eigen::MatrixXd shapes_at(const std::vector<mesh::Site>& sites,
                                        const Points& directions, const modal::Modes& modes);

/// Values of the shapes at the channels: channels×modes [kg^-1/2].
[[nodiscard]] Eigen::MatrixXd shapes_at(const std::vector<study::Channel>& channels,
                                        const std::vector<mesh::Site>& sites,
                                        const modal::Modes& modes);

}  // namespace chladni::stage
