// Frequency responses from the study's recordings, with how good they are.
#pragma once

#include <filesystem>
#include <optional>

#include "identification/cross_validation.h"
#include "io/time_file.h"
#include "modal/frf_set.h"
#include "recordings/data_quality.h"
#include "stage/work.h"
#include "study/study.h"

namespace chladni::steps {

struct RecordedFrfs {
  modal::FrfSet set;
  std::optional<recordings::DataQuality> quality;
  double added_decay = 0.0;     ///< [rad/s], of an exponential window
  identification::Folds folds;  ///< of periodic recordings, where they are wanted
};

/// What the study says of a file of recordings, and the memory that it may take: a fit needs the
/// other half of what a user states. The period is that of `time` alone.
[[nodiscard]] io::TimeOptions recording_options(const study::Study& study,
                                                const std::filesystem::path& path,
                                                const stage::Work& work);

/// Recordings of a file on the channels of a study, whose names and unit they take where the file
/// has none; notes of the file are told.
/// @param options  what else is known of the file
/// @throws InvalidInput  as io::read_time
[[nodiscard]] io::TimeFile read_recordings(const study::Study& study,
                                           const std::filesystem::path& path,
                                           io::TimeOptions options, stage::Work& work);

/// Periodic recordings with references come from a closed loop; those without a period are blows of
/// a hammer, one actuator each (`experiment`). The hold of commands is taken off.
/// @throws InvalidInput  as io::read_time; no output or no input among the channels; samples were
///                       lost; windows for a periodic excitation; as the estimates
/// @param with_folds  parts that a fit does not see are wanted, too
[[nodiscard]] RecordedFrfs recorded_frfs(const study::Study& study, stage::Work& work,
                                         bool with_folds = false);

}  // namespace chladni::steps
