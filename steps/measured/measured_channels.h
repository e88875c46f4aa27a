// Matching of the channels of a file with those of the study, and their directions.
#pragma once

#include <string>
#include <vector>

#include "modal/frf_set.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::steps {

/// [rad]: two directions of a channel that differ less are the same.
inline constexpr double kObliqueChannel = 0.01;

/// A channel of the study and its index in the file.
struct MatchedChannel {
  const study::Channel* channel = nullptr;
  Eigen::Index of_file = 0;
  bool turned = false;  ///< the file has the opposite direction
};

/// The study's channels that the file has, in the study's order. A channel matches by name, or else
/// by node and axis, in either direction. If the file states a direction, it must be that of the
/// study, up to the sign. Notes name channels that are not in the file and turned signs. Warnings
/// name channels of the file that are left out.
/// Cost: channels of the study times those of the file.
/// @param file  the name at the start of messages
/// @throws InvalidInput  two of the file fit one of the study, or one fits two; the one at the node
///                       has no direction or an oblique one; a name fits but its direction does
///                       not. The message names the candidates
[[nodiscard]] std::vector<MatchedChannel> matched_channels(
    const std::vector<modal::MeasuredChannel>& measured,
    const std::vector<study::Channel>& channels, const std::string& file, stage::Work& work);

/// Gives a channel of a file the kind of motion that the study's channel measures.
/// @param file  the name at the start of messages
/// @param each_in_si  the study says so of outputs without a unit, which then get it
/// @throws InvalidInput  the file states another kind, or a unit of another kind or of no motion;
///                       or it states no unit, and the study measures velocity or acceleration
void set_kind(modal::MeasuredChannel& one, const study::Channel& channel, const std::string& file,
              bool each_in_si);

}  // namespace chladni::steps
