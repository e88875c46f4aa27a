// Which channels of a file are the study's, and which way they point.
#pragma once

#include <string>
#include <vector>

#include "app/command.h"
#include "app/study/study.h"
#include "modal/frf_set.h"

namespace chladni::app {

/// A channel of the study and where it stands in the file.
struct MatchedChannel {
  const Channel* channel = nullptr;
  Eigen::Index of_file = 0;
  bool turned = false;  ///< the file has it against the study's direction
};

/// The study's channels that the file has, in the study's order. One of the same name is meant,
/// else the one at the same node along the same axis, either way. Where the file states a direction
/// it must be the study's, up to the sign. Channels that are not in the file are noted, channels of
/// the file that are left out are warned of, turned signs are noted.
/// Cost: channels of the study times those of the file.
/// @param file  the name that messages begin with
/// @throws InvalidInput  two of the file fit one of the study or one fits two; one at the node has
///                       no direction or an oblique one; a name fits and its direction does not.
///                       Names the candidates
[[nodiscard]] std::vector<MatchedChannel> matched_channels(
    const std::vector<modal::MeasuredChannel>& measured, const std::vector<Channel>& channels,
    const std::string& file, Run& run);

}  // namespace chladni::app
